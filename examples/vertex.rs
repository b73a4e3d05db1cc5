//! A vertex stage with a macro, its inputs guessed from their names. Run with `cargo run --example vertex`.

use shadercheck_test::{Domain, Law, Shader};

const STAGE: &str = "#version 330 core
layout(location = 0) in vec3 aPosition;
layout(location = 1) in vec3 aNormal;
uniform mat4 view;
uniform mat4 projection;
uniform vec3 offsets[COUNT];
out vec3 normal;

void main() {
  vec3 p = aPosition;
  for (int i = 0; i < COUNT; i++) p += offsets[i];
  normal = aNormal;
  gl_Position = projection * view * vec4(p, 1.0);
}
";

fn main() {
    for count in [1, 4] {
        Shader::from_text("scene.vert", STAGE)
            .define("COUNT", count)
            .input("view", Domain::rigid())
            .guess_inputs()
            .expect("normal", |inputs| inputs.get("aNormal"))
            .law(Law::unit().of_outputs(["normal"]))
            .law(Law::even(["aNormal"]).of_outputs(["gl_Position"]))
            .assert_agrees();
    }
}
