//! Tests written in Rust: each kind of expectation with a shader that keeps it and one that does not.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};

use proptest::prelude::*;
use shadercheck_test::{Domain, Law, Shader};

const TEXT: &str = "float area(float a, float b) { return a * b; }\n\
    vec3 moved(vec3 p, mat4 m) { return (m * vec4(p, 1.0)).xyz; }\n\
    float wrong(float x) { return x > 1.0 ? 2.0 * x : x; }\n\
    int halved(int n) { return n / 2; }\n";

fn function(name: &str) -> Shader {
    Shader::from_text("lib.glsl", TEXT).function(name).lane("embedded").samples(1024)
}

/// What `assert_agrees` says of a shader that fails.
#[track_caller]
fn failure(shader: &Shader) -> String {
    let shader = shader.clone();
    let panic = catch_unwind(AssertUnwindSafe(move || shader.assert_agrees())).expect_err("it agrees");
    panic.downcast_ref::<String>().cloned().expect("a message")
}

fn area(inputs: shadercheck_test::Inputs<'_>) -> Vec<f64> {
    vec![inputs.number("a") * inputs.number("b")]
}

#[test]
fn a_closure_is_an_expectation() {
    let shader = function("area").input("a", 0.0..=4.0).input("b", -1.0..=1.0);
    let outcome = shader.clone().expect("return", area).check().unwrap();
    assert!(outcome.passed() && outcome.judged() + outcome.undetermined() == 1024, "{}", outcome.report());
    let off =
        shader.expect("return", |inputs| vec![area(inputs)[0] + if inputs.number("b") > 0.5 { 1e-4 } else { 0.0 }]);
    let reported = failure(&off);
    assert!(reported.starts_with("lib.glsl does not agree\n\nFAIL  area "), "{reported}");
    for part in [
        "the shader deviates from its reference: `return` is ",
        "\n  smallest   float a = 0.0\n",
        "\n             float b = 1.0\n",
        "\n  reference  return = ",
        "\n  reproduce  add .case(\"a=00000000 b=3f800000\")\n",
    ] {
        assert!(reported.contains(part), "{part}\n{reported}");
    }
    // The line of the report runs that case alone.
    let again = off.clone().case("a=00000000 b=3f800000").check().unwrap();
    assert!(!again.passed() && again.judged() == 1, "{}", again.report());
    assert!(off.case("a=00000000 b=00000000").check().unwrap().passed());
}

#[test]
fn matrices_reach_a_closure_column_by_column() {
    function("moved")
        .input("p", -2.0..=2.0)
        .input("m", Domain::affine())
        .expect("return", |inputs| {
            let (p, m): ([f64; 3], [f64; 16]) = (inputs.array("p"), inputs.array("m"));
            (0..3).map(|row| m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row]).collect()
        })
        .law(Law::even(["p"]).of_outputs(["return"]))
        .check()
        .map(|outcome| {
            assert!(outcome.report().contains("the relation `even(p)` does not hold"), "{}", outcome.report());
            assert!(outcome.report().contains(" 0 deviated"), "{}", outcome.report());
        })
        .unwrap();
}

#[test]
fn another_shader_is_an_expectation() {
    let old = Shader::from_text("old.glsl", "float area(float a, float b) { return b * a; }").function("area");
    let shader = function("area").input("a", 0.0..=4.0).input("b", -1.0..=1.0);
    shader.clone().reference(&old).assert_agrees();
    let old =
        Shader::from_text("old.glsl", "float area(float a, float b) { return b * a + 1e-3 * a; }").function("area");
    assert!(failure(&shader.reference(&old)).contains("the shader deviates from its reference"));
}

#[test]
fn a_strategy_is_a_domain_and_shrinks_as_it_does() {
    let eighths = (0_i32..800).prop_map(|k| k as f32 / 8.0);
    let shader = function("wrong").input("x", Domain::strategy(eighths)).expect("return", |i| i.get("x"));
    let reported = failure(&shader);
    let line = reported.lines().find(|line| line.starts_with("  smallest")).unwrap();
    let x: f32 = line.rsplit(' ').next().unwrap().parse().unwrap();
    assert!((1.0..2.0).contains(&x), "{reported}");
    let even = (-50_i32..50).prop_map(|half| 2 * half);
    let halved = |inputs: shadercheck_test::Inputs<'_>| vec![inputs.number("n") / 2.0];
    function("halved").input("n", Domain::strategy(even)).expect("return", halved).assert_agrees();
    let reported = failure(&function("halved").input("n", Domain::strategy(-50_i32..50)).expect("return", halved));
    assert!(reported.contains("int n = 1\n") || reported.contains("int n = -1\n"), "{reported}");
}

#[test]
fn laws_and_macros_and_guesses() {
    let text =
        "uniform float scale;\nvec3 scaled(vec3 normal, vec3 color) { return normal * SIGN + 0.0 * color * scale; }\n";
    let shader = |sign: &str| {
        let shader = Shader::from_text("a.glsl", text).function("scaled").define("SIGN", sign).guess_inputs();
        shader.law(Law::unit()).law(Law::odd(["normal"])).lane("embedded").samples(256)
    };
    shader("-1.0").assert_agrees();
    assert!(failure(&shader("0.5")).contains("the relation `unit` does not hold"));
}

#[test]
fn vertex_stages_run_too() {
    let text = "#version 330\nin vec3 p;\nuniform float s;\nout float d;\nvoid main() { d = p.x; gl_Position = vec4(s * p, 1.0); }\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vert");
    fs::write(&path, text).unwrap();
    let shader = Shader::from_file(&path).unwrap().guess_inputs().lane("embedded").samples(256);
    let position = |inputs: shadercheck_test::Inputs<'_>| {
        let (p, s): ([f64; 3], f64) = (inputs.array("p"), inputs.number("s"));
        vec![s * p[0], s * p[1], s * p[2], 1.0]
    };
    shader.clone().expect("gl_Position", position).expect("d", |i| vec![i.get("p")[0]]).assert_agrees();
    let reported = failure(&shader.clone().expect("d", |i| vec![i.get("p")[1]]));
    assert!(reported.contains("`d` is "), "{reported}");
    let reference = Shader::from_text("r.glsl", "vec4 at(vec3 p, float s) { return vec4(p * s, 1.0); }").function("at");
    shader.reference_of("gl_Position", &reference).assert_agrees();
}

#[test]
fn what_cannot_be_checked_is_an_error_and_says_why() {
    let error = |shader: Shader| shader.check().map(|_| ()).unwrap_err().to_string();
    let area = || function("area").input("a", 0.0..=1.0);
    for (shader, reported) in [
        (area(), "nothing fills the input `b` (float) of the shader"),
        (area().input("bb", 0.0..=1.0), "input `bb`: the shader has no input `bb`; did you mean `b`?"),
        (area().input("b", Domain::rigid()), "input `b`: generator `rigid` fills mat4"),
        (area().input("b", 1.0..=0.0), "input `b`: range [1, 0] is not"),
        (area().input("b", Domain::strategy(any::<bool>())).law(Law::odd(["c"])), "the law `odd` names an input `c`"),
        (
            area().input("b", Domain::strategy([0.0_f32..1.0, 0.0..1.0])),
            "the strategy gives 2 numbers, and 1 are needed",
        ),
        (area().input("b", 1.0).expect("out", |_| vec![]), "gives `out`, and the shader has `float return`"),
        (area().input("b", 1.0).lane("gpu"), "there is no lane `gpu`; did you mean `webgpu`?"),
        (area().input("b", 1.0).case("a=1"), "`1` is not a 32-bit word"),
        (Shader::from_text("a.glsl", TEXT), "choose a function with `function`"),
        (function("gone"), "gone"),
        (Shader::from_text("a.vert", "void main() { gl_Position = x; }"), "a.vert:1:29"),
    ] {
        let found = error(shader);
        assert!(found.contains(reported), "{reported}\n{found}");
    }
    assert!(Shader::from_file("gone.vert").unwrap_err().to_string().contains("cannot read `gone.vert`"));
}

#[test]
fn an_expectation_of_another_size_panics_with_the_name_of_the_output() {
    let shader = function("area").input("a", 0.0..=1.0).input("b", 1.0).expect("return", |_| vec![0.0, 1.0]);
    let reported = failure(&shader);
    assert!(reported.contains("the expectation of `return` gives 2 components, and it has 1"), "{reported}");
}

#[test]
fn too_much_that_decides_nothing_fails() {
    // The direction of a zero vector, for half of the samples.
    let text = "float f(float x) { return normalize(vec2(max(x, 0.0), 0.0)).x; }";
    let shader = Shader::from_text("a.glsl", text).function("f").lane("embedded");
    let reported = failure(&shader.clone().input("x", -1.0..=1.0));
    assert!(reported.contains("% of the samples are undetermined"), "{reported}");
    shader.input("x", -1.0..=1.0).undetermined(0.75).assert_agrees();
}
