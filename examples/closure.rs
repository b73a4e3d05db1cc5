//! A function of a library against a closure, with laws beside it. Run with `cargo run --example closure`.

use shadercheck_test::{Domain, Law, Shader};

const LIBRARY: &str = "
float luminance(vec3 color) { return dot(color, vec3(0.2126, 0.7152, 0.0722)); }

vec3 saturated(vec3 color, float amount) {
  return mix(vec3(luminance(color)), color, amount);
}
";

fn main() {
    let shader = Shader::from_text("color.glsl", LIBRARY).function("saturated");
    shader
        .input("color", 0.0..=1.0)
        .input("amount", 0.0..=2.0)
        .expect("return", |inputs| {
            let ([r, g, b], amount) = (inputs.array("color"), inputs.number("amount"));
            let grey = 0.2126 * r + 0.7152 * g + 0.0722 * b;
            [r, g, b].map(|c| grey * (1.0 - amount) + c * amount).to_vec()
        })
        .law(Law::scales(["color"], 1))
        .assert_agrees();
    Shader::from_text("color.glsl", LIBRARY)
        .function("luminance")
        .input("color", Domain::from(0.0..=1.0))
        .law(Law::range(0.0..=1.0))
        .assert_agrees();
}
