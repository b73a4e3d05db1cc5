fn f(x: f32) -> f32 {
    return atan2(-0.0 * x, x);
}
