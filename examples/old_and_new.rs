//! A rewritten function against the one that it replaces. Run with `cargo run --example old_and_new`.

use shadercheck_test::Shader;

const OLD: &str = "
vec3 rotated(vec3 v, vec4 q) {
  vec4 r = vec4(q.w * v + cross(q.xyz, v), -dot(q.xyz, v));
  return r.w * -q.xyz + q.w * r.xyz + cross(r.xyz, -q.xyz);
}
";
const NEW: &str = "
vec3 rotated(vec3 v, vec4 q) {
  return v * (q.w * q.w - dot(q.xyz, q.xyz)) + 2.0 * (q.xyz * dot(q.xyz, v) + q.w * cross(q.xyz, v));
}
";

fn main() {
    let old = Shader::from_text("old.glsl", OLD).function("rotated");
    Shader::from_text("new.glsl", NEW)
        .function("rotated")
        .reference(&old)
        .input("v", -2.0..=2.0)
        .input("q", -1.0..=1.0)
        .assert_agrees();
}
