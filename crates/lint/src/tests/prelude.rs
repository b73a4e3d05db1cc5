//! What hosts put around shaders, seen from what is reported.

use base::text::SourceFile;
use reading::prelude::Wanted;

use crate::{Config, Input, Level, Selection, Settings, run, run_with};

fn reported(name: &str, text: &str) -> Vec<String> {
    let found = run(&[Input::new(SourceFile::new(name, text))]);
    found.iter().map(|d| format!("{} {}", d.code, d.file.locate(d.span.start))).collect()
}

#[test]
fn words_of_precision_stand_for_nothing_where_host_code_is_of_qt() {
    let shader = SourceFile::new("a.frag", "#version 120\nvarying highp vec4 c;\nvoid main() { gl_FragColor = c; }\n");
    let host = |class: &str| SourceFile::new("a.cpp", format!("void f() {{ {class} shader; }}"));
    let codes = |class: &str| {
        let found = run(&[Input::new(shader.clone()), Input::new(host(class))]);
        found.iter().map(|d| d.code.0).collect::<Vec<_>>()
    };
    assert_eq!(codes("QOpenGLShaderProgram"), [""; 0]);
    assert_eq!(codes("ShaderProgram"), ["V002"]);
}

#[test]
fn what_the_host_declares_is_known_and_a_slip_in_it_is_told() {
    let toy = |name: &str| {
        format!(
            "void mainImage(out vec4 color, in vec2 at) {{\n  color = vec4(at / iResolution.xy, {name}, 1.0);\n}}\n"
        )
    };
    assert_eq!(reported("image.frag", &toy("iTime")), [""; 0]);
    assert_eq!(reported("image.frag", &format!("#define NOW iTime\n{}", toy("NOW"))), [""; 0], "a macro for it");
    assert_eq!(reported("image.frag", &toy("iTimme")), ["E020 image.frag:2:37"]);
    assert_eq!(reported("image.frag", &toy("iResolution.w")), ["T009 image.frag:2:49"]);
    let three = |name: &str| {
        format!(
            "const vs = `\nvoid main() {{\n  gl_Position = projectionMatrix * modelViewMatrix * vec4({name}, 1.0);\n}}\n`;\n"
        )
    };
    assert_eq!(reported("a.js", &three("position + normal")), [""; 0]);
    assert_eq!(reported("a.js", &three("position + uv")), ["E031 a.js:3:68"]);
    let own = three("position").replace("void main", "attribute vec3 position;\nvoid main");
    assert_eq!(reported("a.js", &own), [""; 0], "what a text declares itself is left out");
    let block =
        "uniform Model {\n\tmat4\tmodelViewMatrix;\n\tmat3\tnormalMatrix;\n};\nattribute vec3 position;\nvoid main";
    assert_eq!(reported("a.js", &three("position").replace("void main", block)), [""; 0], "in a block as well");
}

#[test]
fn a_prelude_is_asked_for_and_refused_by_name() {
    let toy = "float f() { return iResolution.w; }\n";
    let with = |prelude: Wanted| {
        let settings = Settings { config: Config { prelude, ..Config::default() }, ..Settings::default() };
        let found = run_with(&[Input::new(SourceFile::new("a.glsl", toy))], &settings);
        found.iter().map(|d| d.code.0).collect::<Vec<_>>()
    };
    let named = Wanted::named("shadertoy").unwrap();
    assert_eq!(with(named), ["T009"]);
    assert_eq!(with(Wanted::Nothing), [""; 0]);
    assert_eq!(with(Wanted::Recognised), [""; 0]);
    assert!(Wanted::named("shadertoi").is_none());
}

#[test]
fn inputs_in_the_json_of_a_text_are_declared() {
    let text = |name: &str| {
        format!(
            "/*{{ \"INPUTS\": [ {{ \"NAME\": \"inputImage\", \"TYPE\": \"image\" }},\n  {{ \"NAME\": \"amount\", \"TYPE\": \"float\", \"MIN\": 0, \"MAX\": 1 }} ] }}*/\n\
             void main() {{\n  gl_FragColor = {name} * IMG_THIS_PIXEL(inputImage);\n}}\n"
        )
    };
    let strict = |text: &str| {
        let selection = Selection::default().at(Level::Strict);
        let found =
            run_with(&[Input::new(SourceFile::new("a.fs", text))], &Settings { selection, ..Settings::default() });
        found.iter().map(|d| format!("{} {}", d.code, d.file.locate(d.span.start))).collect::<Vec<_>>()
    };
    assert_eq!(strict(&text("amount")), [""; 0]);
    assert_eq!(reported("a.fs", &text("amuont")), ["E020 a.fs:4:18"]);
    assert_eq!(strict(&text("gain")), ["E020 a.fs:4:18"]);
    assert_eq!(reported("a.fs", &text("vec3(amount)")), ["E031 a.fs:4:31"]);
}
