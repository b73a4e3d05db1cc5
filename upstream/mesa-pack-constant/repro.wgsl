fn f(x: f32) -> f32 {
    return unpack4x8snorm(pack4x8snorm(vec4<f32>(-0.25, -0.7, 0.9, 0.1))).z + x;
}
