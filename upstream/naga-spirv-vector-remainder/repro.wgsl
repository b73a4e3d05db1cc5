@fragment
fn main(@location(0) @interpolate(flat) a: vec2<i32>) -> @location(0) vec4<f32> {
    let m = a % vec2<i32>(3, -2);
    return vec4<f32>(f32(m.x), f32(m.y), 0.0, 1.0);
}
