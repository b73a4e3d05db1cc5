fn sc_inverse_2(m: mat2x2<f32>) -> mat2x2<f32> {
  let area = m[0].x * m[1].y - m[1].x * m[0].y;
  return mat2x2<f32>(vec2<f32>(m[1].y, -m[0].y) / area, vec2<f32>(-m[1].x, m[0].x) / area);
}

fn sc_inverse_3(m: mat3x3<f32>) -> mat3x3<f32> {
  let x = cross(m[1], m[2]);
  let y = cross(m[2], m[0]);
  let z = cross(m[0], m[1]);
  let volume = dot(m[0], x);
  return transpose(mat3x3<f32>(x / volume, y / volume, z / volume));
}

fn sc_inverse_4(m: mat4x4<f32>) -> mat4x4<f32> {
  let a = m[0].xyz;
  let b = m[1].xyz;
  let c = m[2].xyz;
  let d = m[3].xyz;
  let ab = cross(a, b);
  let cd = cross(c, d);
  let p = a * m[1].w - b * m[0].w;
  let q = c * m[3].w - d * m[2].w;
  let volume = dot(ab, q) + dot(cd, p);
  let x = vec4<f32>(cross(b, q) + cd * m[1].w, -dot(b, cd));
  let y = vec4<f32>(cross(q, a) - cd * m[0].w, dot(a, cd));
  let z = vec4<f32>(cross(d, p) + ab * m[3].w, -dot(d, ab));
  let w = vec4<f32>(cross(p, c) - ab * m[2].w, dot(c, ab));
  return transpose(mat4x4<f32>(x / volume, y / volume, z / volume, w / volume));
}

fn sc_isnan_1(v: f32) -> bool {
  return (bitcast<u32>(v) & 0x7fffffffu) > 0x7f800000u;
}

fn sc_isnan_2(v: vec2<f32>) -> vec2<bool> {
  return (bitcast<vec2<u32>>(v) & vec2<u32>(0x7fffffffu)) > vec2<u32>(0x7f800000u);
}

fn sc_isnan_3(v: vec3<f32>) -> vec3<bool> {
  return (bitcast<vec3<u32>>(v) & vec3<u32>(0x7fffffffu)) > vec3<u32>(0x7f800000u);
}

fn sc_isnan_4(v: vec4<f32>) -> vec4<bool> {
  return (bitcast<vec4<u32>>(v) & vec4<u32>(0x7fffffffu)) > vec4<u32>(0x7f800000u);
}

fn sc_isinf_1(v: f32) -> bool {
  return (bitcast<u32>(v) & 0x7fffffffu) == 0x7f800000u;
}

fn sc_isinf_2(v: vec2<f32>) -> vec2<bool> {
  return (bitcast<vec2<u32>>(v) & vec2<u32>(0x7fffffffu)) == vec2<u32>(0x7f800000u);
}

fn sc_isinf_3(v: vec3<f32>) -> vec3<bool> {
  return (bitcast<vec3<u32>>(v) & vec3<u32>(0x7fffffffu)) == vec3<u32>(0x7f800000u);
}

fn sc_isinf_4(v: vec4<f32>) -> vec4<bool> {
  return (bitcast<vec4<u32>>(v) & vec4<u32>(0x7fffffffu)) == vec4<u32>(0x7f800000u);
}
