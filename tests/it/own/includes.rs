//! Shaders with `#include`, in every command that runs them.

use std::fs;

use super::{finding, folder, suite};
use crate::binary::{Ran, command, run_in};

const SHADER: &str = "#include \"near.glsl\"\n#include <far.glsl>\nfloat f(float x) { return near(x) + far(x); }\n";
const NEAR: &str = "float near(float x) { return 2.0 * x; }\n";

fn project(far: &str) -> tempfile::TempDir {
    let text = suite(&["x"], "reference = \"model.glsl\"\ninclude = [\"lib\"]");
    let folder = folder(&[
        ("f.glsl", SHADER),
        ("near.glsl", NEAR),
        ("f.suite.toml", &text),
        ("model.glsl", "#include <scale.glsl>\nfloat f(float x) { return SCALE * x; }\n"),
    ]);
    fs::create_dir(folder.path().join("lib")).unwrap();
    fs::write(folder.path().join("lib/far.glsl"), far).unwrap();
    fs::write(folder.path().join("lib/scale.glsl"), "#define SCALE 5.0\n").unwrap();
    folder
}

fn check(folder: &tempfile::TempDir) -> Ran {
    command(folder.path(), "check . --lane embedded").output().unwrap().into()
}

#[test]
fn a_suite_names_folders_for_its_shader_and_its_reference() {
    check(&project("float far(float x) { return 3.0 * x; }\n")).expect(0);
    // A fault of the included file is one of the shader.
    let ran = check(&project("float far(float x) {\n  return 3.5 * x;\n}\n")).expect(1);
    let (message, _) = finding(&ran);
    assert!(message.contains("`return`"), "{message}");
    assert!(ran.out.contains("shader     return = 5.5"), "{}", ran.out);
}

#[test]
fn what_is_not_there_or_cannot_be_read_is_reported_at_the_directive() {
    let folder = project("float far(float x) { return 3.0 * x; }\n");
    let toml = folder.path().join("f.suite.toml");
    let text = fs::read_to_string(&toml).unwrap();
    fs::write(&toml, text.replace("[\"lib\"]", "[\"libs\"]")).unwrap();
    let ran = check(&folder).expect(2);
    assert!(ran.err.contains("f.suite.toml:7:1: cannot read the folder of includes"), "{}", ran.err);
    fs::write(&toml, &text).unwrap();
    fs::remove_file(folder.path().join("lib/far.glsl")).unwrap();
    let ran = check(&folder).expect(1);
    let all = format!("{}{}", ran.out, ran.err);
    assert!(all.contains("`far.glsl` is not found") && all.contains("include = [\"FOLDER\"]"), "{all}");
    fs::write(folder.path().join("lib/far.glsl"), [0u8, 159, 146, 150, 0, 1]).unwrap();
    let ran = check(&folder);
    let all = format!("{}{}", ran.out, ran.err);
    assert!(all.contains("f.glsl:2:1: cannot include `far.glsl`"), "{all}");
}

#[test]
fn a_translation_and_a_first_suite_hold_what_is_included() {
    let folder = project("float far(float x) { return 3.0 * x; }\n");
    let ran = run_in(folder.path(), "translate f.glsl --entry f --to wgsl -I lib").expect(0);
    assert!(ran.out.contains("fn near") && ran.out.contains("fn far"), "{}", ran.out);
    // Of two that end so neither is meant.
    fs::create_dir(folder.path().join("other")).unwrap();
    fs::copy(folder.path().join("lib/far.glsl"), folder.path().join("other/far.glsl")).unwrap();
    let ran = run_in(folder.path(), "translate f.glsl --entry f --to wgsl").expect(1);
    assert!(ran.err.contains("`far.glsl` is not found") && ran.err.contains("-I FOLDER"), "{}", ran.err);
    fs::remove_file(folder.path().join("f.suite.toml")).unwrap();
    fs::write(folder.path().join("f.glsl"), "#include \"near.glsl\"\nfloat f(float x) { return near(x); }\n").unwrap();
    let ran = run_in(folder.path(), "init").expect(0);
    assert!(ran.out.contains("f_near.suite.toml") || ran.out.contains("wrote f.suite.toml"), "{}", ran.out);
    assert!(fs::read_to_string(folder.path().join("f.suite.toml")).unwrap().contains("entry = \"f\""));
}

#[test]
fn a_function_that_reads_what_the_stage_is_given_is_refused_by_name() {
    let shader = "#version 450\nlayout(location = 0) in vec3 n;\nlayout(location = 0) out vec4 c;\n\
        float f(float x) { return x * n.x; }\nvoid main() { c = vec4(f(1.0)); }\n";
    let text = suite(&["x"], "").replace("f.glsl", "f.frag");
    let folder = folder(&[("f.frag", shader), ("f.suite.toml", &text)]);
    let ran = check(&folder).expect(1);
    let all = format!("{}{}", ran.out, ran.err);
    assert!(all.contains("`n`, an input of the stage, cannot be fed or read"), "{all}");
}
