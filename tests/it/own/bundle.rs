//! `--report-dir`: a failing case as files.

use std::fs;

use serde_json::Value;

use super::{folder, suite};
use crate::binary::{Ran, command, run_reported, strings};

const WRONG: &str = "vec2 f(float x, float y) { return vec2(x > 1.0 ? x : y, y); }\n";
const RIGHT: &str = "vec2 f(float x, float y) { return vec2(y, y); }\n";

#[test]
fn a_failing_case_is_written_with_all_that_it_takes_to_see_it_again() {
    let text = suite(&["x", "y"], "reference = \"r.glsl\"");
    let folder = folder(&[("f.glsl", WRONG), ("r.glsl", RIGHT), ("f.suite.toml", &text)]);
    let ran: Ran = command(folder.path(), "check . --lane embedded --report-dir out").output().unwrap().into();
    ran.expect(1);
    let inside = folder.path().join("out/own-embedded-compute-1");
    let read = |name: &str| fs::read_to_string(inside.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert_eq!(read("shader.glsl"), WRONG);
    assert!(read("lowered.glsl").starts_with("#version 450 core"));
    let case: Value = serde_json::from_str(&read("case.json")).unwrap();
    assert_eq!(strings(&case["inputs"], "name"), ["float x", "float y"]);
    assert_eq!(case["inputs"][0]["bits"][0], "40000000", "{case:#}");
    assert_eq!(strings(&case["outputs"], "name"), ["return.x", "return.y"]);
    assert_eq!(strings(&case["outputs"], "bits"), ["40000000", "00000000"], "{case:#}");
    let spirv = fs::read(inside.join("shader.spv")).unwrap();
    assert_eq!(spirv[..4], 0x0723_0203_u32.to_le_bytes());
    let amber = read("case.amber");
    let words = amber.split("SPIRV-HEX\n").nth(1).unwrap().split("END").next().unwrap().split_whitespace();
    let words: Vec<u8> = words.flat_map(|w| u32::from_str_radix(&w[2..], 16).unwrap().to_le_bytes()).collect();
    assert_eq!(words, spirv, "the script holds the same module");
    for part in [
        "BUFFER invocations DATA_TYPE uint32 DATA\n0x40000000 0x00000000\nEND\n",
        "BUFFER outputs DATA_TYPE float SIZE 3 FILL 0.0\n",
        "  ATTACH kernel ENTRY_POINT capture\n",
        "# return.x\nEXPECT outputs IDX 4 TOLERANCE ",
        " EQ 0.0\n",
    ] {
        assert!(amber.contains(part), "{part}\n{amber}");
    }
    // The script goes to its own folder first, and runs from any other.
    let script = read("reproduce.sh");
    assert!(script.lines().nth(1).unwrap().starts_with("cd \"$(dirname \"$0\")\"/"), "{script}");
    let line = script.lines().nth(2).unwrap().to_owned();
    run_reported(folder.path(), &line, &[]).expect(1);
}

#[test]
fn a_run_that_passes_writes_no_case_and_a_vertex_stage_no_script() {
    let text = suite(&["x", "y"], "");
    let dir = folder(&[("f.glsl", RIGHT), ("f.suite.toml", &text)]);
    let ran: Ran = command(dir.path(), "check . --lane embedded --report-dir out").output().unwrap().into();
    ran.expect(0);
    let inside = fs::read_dir(dir.path().join("out")).unwrap().map(|entry| entry.unwrap().path());
    let folders: Vec<_> = inside.filter(|path| path.is_dir()).collect();
    assert_eq!(folders, [dir.path().join("out/plots")], "charts, and no case");
    let stage = "#version 330\nin float x;\nvoid main() { gl_Position = vec4(x, 0.0, 0.0, 1.0); }\n";
    let text = "suite = \"v\"\nshader = \"a.vert\"\nstage = \"vertex\"\nsamples = 64\n\
        relations = [{ kind = \"even\", inputs = [\"x\"] }]\n\
        [[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [-1.0, 1.0]\n";
    let dir = folder(&[("a.vert", stage), ("a.suite.toml", text)]);
    let ran: Ran = command(dir.path(), "check . --lane embedded --report-dir out").output().unwrap().into();
    ran.expect(1);
    let inside = dir.path().join("out/v-embedded-compute-1");
    assert!(inside.join("shader.vert").exists() && inside.join("shader.spv").exists());
    assert!(!inside.join("case.amber").exists());
}

/// What `cargo xtask piglit` finds in a test that was written: whether it passes in strict binary32.
fn passes(text: &str) -> bool {
    use crate::piglit::converter::convert::convert;
    use crate::piglit::converter::format::ShaderTest;
    use crate::piglit::converter::judge::{Found, Runner, judge};
    let test = ShaderTest::parse(text).unwrap_or_else(|e| panic!("{e:#}\n{text}"));
    let converted = convert("case.shader_test", &test).unwrap_or_else(|e| panic!("{e:?}\n{text}"));
    match judge(&converted, Runner::Strict, None) {
        Some(Found::Agrees) => true,
        Some(Found::Disagrees(_)) => false,
        other => panic!("{other:?}\n{text}"),
    }
}

#[test]
fn the_test_for_piglit_fails_as_the_case_does_and_passes_with_the_right_shader() {
    // A function.
    let text = suite(&["x", "y"], "reference = \"r.glsl\"");
    let dir = folder(&[("f.glsl", WRONG), ("r.glsl", RIGHT), ("f.suite.toml", &text)]);
    let ran: Ran = command(dir.path(), "check . --lane embedded --report-dir out").output().unwrap().into();
    ran.expect(1);
    let test = fs::read_to_string(dir.path().join("out/own-embedded-compute-1/case.shader_test")).unwrap();
    assert!(test.contains("\n[require]\nGLSL >= 3.30\n") && test.contains("\nuniform float sc_in_x 2.0\n"), "{test}");
    assert!(!passes(&test), "{test}");
    assert!(passes(&test.replace(WRONG, RIGHT)), "{test}");
    // A vertex stage with an attribute of three numbers and uniforms of several types.
    let wrong = "#version 130\nin vec4 p;\nuniform mat4 m;\nuniform bool flip;\nuniform vec2 w[2];\n\
        void main() { gl_Position = (flip ? -1.0 : 1.0) * (m * p) + vec4(w[1], w[0].x > 1.5 ? 1.0 : 0.0, 0.0); }\n";
    let right = wrong.replace("w[0].x > 1.5 ? 1.0 : 0.0", "0.0");
    let text = "suite = \"v\"\nshader = \"a.vert\"\nstage = \"vertex\"\nsamples = 512\nreference = \"r.vert\"\n\
        [[inputs]]\nnames = [\"p\"]\ngenerator = \"point\"\nrange = [-2.0, 2.0]\ncomponents = 3\n\
        [[inputs]]\nnames = [\"w\"]\ngenerator = \"interval\"\nrange = [-2.0, 2.0]\n\
        [[inputs]]\nnames = [\"flip\"]\ngenerator = \"index\"\nrange = [0, 1]\n\
        [[inputs]]\nnames = [\"m\"]\ngenerator = \"affine\"\nrange = [-2.0, 2.0]\n";
    let dir = folder(&[("a.vert", wrong), ("r.vert", &right), ("a.suite.toml", text)]);
    let ran: Ran = command(dir.path(), "check . --lane embedded --report-dir out").output().unwrap().into();
    let ran = ran.expect(1);
    let test = fs::read_to_string(dir.path().join("out/v-embedded-compute-1/case.shader_test"));
    let test = test.unwrap_or_else(|e| panic!("{e}: {ran:?}"));
    assert!(test.contains("sc_vertex/float/2 p/float/3\n") && test.contains("\nuniform mat4x4 m "), "{test}");
    assert!(!passes(&test), "{test}");
    assert!(passes(&test.replace("w[0].x > 1.5 ? 1.0 : 0.0", "0.0")), "{test}");
}
