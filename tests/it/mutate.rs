//! Mutation testing end to end: planted suites, loops that never end, the command.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// A suite for a Hermite curve.
const SUITE: &str = "suite = \"planted\"\ntitle = \"Planted\"\nshader = \"planted.glsl\"\nstage = \"function\"\nentry = \"hermite\"\n\
         formula = \"hermite\"\nsamples = 4096\n\n\
         [[inputs]]\nnames = [\"p0\", \"p1\", \"m0\", \"m1\"]\ngenerator = \"vector\"\nrange = [-2.0, 2.0]\n\n\
         [[inputs]]\nnames = [\"s\"]\ngenerator = \"interval\"\nrange = [0.0, 1.0]\n\n\
         [floors]\njudged = 1000\n";

const HERMITE: &str = "#version 150 core
vec4 hermite(vec4 p0, vec4 p1, vec4 m0, vec4 m1, float s)
{
  vec4 dp = p0 - p1;
  vec4 a = 2.0 * dp + m0 + m1;
  vec4 b = -3.0 * dp - 2.0 * m0 - m1;
  return ((a * s + b) * s + m0) * s + p0;
}
";

/// Writes a suite and its shader.
fn plant(folder: &Path, shader: &str) -> String {
    std::fs::write(folder.join("planted.suite.toml"), SUITE).unwrap();
    std::fs::write(folder.join("planted.glsl"), shader).unwrap();
    folder.join("planted.suite.toml").display().to_string()
}

fn mutate(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_shadercheck"));
    command.arg("mutate").args(arguments).env("XDG_RUNTIME_DIR", std::env::temp_dir()).output().unwrap()
}

fn parsed(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|e| panic!("{e}\n{}", String::from_utf8_lossy(&output.stderr)))
}

const ABOVE_ULP: &str = "arithmetic,sign,operand-order,swap-input,constant";

#[test]
fn a_suite_that_is_exact_lets_nothing_through() {
    let folder = tempfile::tempdir().unwrap();
    let file = plant(folder.path(), HERMITE);
    let output = mutate(&[&file, "--samples", "4096", "--operator", ABOVE_ULP, "--floor", "100", "--format", "json"]);
    let value = parsed(&output);
    assert_eq!(
        (value["score"]["survived"].as_u64(), value["score"]["unmoved"].as_u64()),
        (Some(0), Some(0)),
        "{value:#}"
    );
    assert!(value["score"]["killed"].as_u64().unwrap() > 40, "{value:#}");
    assert_eq!(value["score"]["invalid"], 0);
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn an_output_that_no_formula_gives_lets_faults_through() {
    let folder = tempfile::tempdir().unwrap();
    let beside =
        HERMITE.replace("float s)", "float s, out vec4 beside)").replace("  return", "  beside = 3.0 * p0;\n  return");
    let file = plant(folder.path(), &beside);
    let arguments = [&*file, "--samples", "4096", "--operator", "constant", "--floor", "99"];
    let output = mutate(&arguments);
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("`3.0` becomes `3.0001` (+1e-4): survived; `beside"), "{text}");
    assert!(text.contains(": beside = 3.0 * p0;\n"), "{text}");
    let value = parsed(&mutate(&[&arguments[..], &["--format", "json"]].concat()));
    let moved = value["suites"][0]["mutants"].as_array().unwrap().iter().filter(|m| m["outcome"] == "survived");
    let distances: Vec<f64> = moved.map(|m| m["moved_bounds"].as_f64().unwrap()).collect();
    assert!(!distances.is_empty() && distances.iter().all(|d| *d > 10.0), "{distances:?}");
}

#[test]
fn a_loop_that_never_ends_is_noticed_and_the_run_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let looped = HERMITE.replace("  return (", "  for (int i = 0; i < 1; ++i) a += 0.0 * b;\n  return (");
    let file = plant(folder.path(), &looped);
    let value = parsed(&mutate(&[&file, "--samples", "512", "--operator", "drop-statement", "--format", "json"]));
    let mutants = value["suites"][0]["mutants"].as_array().unwrap();
    assert_eq!(mutants.len(), 2, "{value:#}");
    assert!(mutants.iter().any(|m| m["killed_by"] == "does not finish"), "{value:#}");
    assert!(mutants.iter().any(|m| m["outcome"] != "killed"), "{value:#}");
}

#[test]
fn a_shader_that_fails_its_own_suite_gets_no_score() {
    let folder = tempfile::tempdir().unwrap();
    let file = plant(folder.path(), &HERMITE.replace("+ p0", "- p0"));
    let output = mutate(&[&file, "--samples", "512"]);
    assert_eq!(output.status.code(), Some(2));
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert!(
        complaint.contains("the unchanged shader fails (the shader deviates from its formula: `return.x` is"),
        "{complaint}"
    );
}

#[test]
fn a_shader_stands_for_the_suite_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    plant(folder.path(), HERMITE);
    let shader = folder.path().join("planted.glsl").display().to_string();
    let value = parsed(&mutate(&[&shader, "--samples", "256", "--operator", "sign", "--format", "json"]));
    assert_eq!((&value["suites"][0]["suite"], value["score"]["killed"].as_u64()), (&"planted".into(), Some(1)));
}

#[test]
fn an_unknown_operator_is_named_with_the_nearest_one() {
    let output = mutate(&["sphere", "--operator", "constnat"]);
    assert_eq!(output.status.code(), Some(2));
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert!(complaint.contains("did you mean `constant`?"), "{complaint}");
}

#[test]
fn every_mutant_of_the_shipped_shaders_can_be_run() {
    // A few samples kill most mutants; here it counts that none is refused.
    let value = parsed(&mutate(&[
        "--shipped",
        "--samples",
        "64",
        "--operator",
        "drop-statement,integer,swizzle,matrix,condition",
        "--format",
        "json",
    ]));
    assert_eq!(value["score"]["invalid"], 0, "{value:#}");
    assert!(value["score"]["killed"].as_u64().unwrap() > 90, "{value:#}");
    assert_eq!(value["failed"].as_array().unwrap().len(), 0, "{value:#}");
}
