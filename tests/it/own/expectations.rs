//! What gives the expected outputs: a formula, another shader, recorded values, or nothing.

use std::fs;

use super::{check, finding, folder, suite};
use crate::binary::{command, run_reported};

const HYPOT: &str = "float f(float x, float y) { return sqrt(x * x + y * y + 1.0); }\n";
/// Right but for a small range.
const HYPOT_WRONG: &str = "float f(float x, float y) { return sqrt(x * x + y * y + (x > 1.0 ? 1.001 : 1.0)); }\n";

#[test]
fn a_function_of_another_file_is_a_reference() {
    let reference = "// Slow, and right.\nfloat other(float y, float x) { return length(vec3(x, y, 1.0)); }\n";
    let suite = suite(&["x", "y"], "reference = { file = \"slow.glsl\", function = \"other\" }");
    let run = |shader: &str| check(&[("f.glsl", shader), ("slow.glsl", reference), ("f.suite.toml", &suite)], &[]);
    run(HYPOT).expect(0);
    let ran = run(HYPOT_WRONG).expect(1);
    let (message, case) = finding(&ran);
    assert!(message.contains("the shader deviates from its reference: `return` is "), "{message}");
    assert!(ran.out.contains("\n  reference  return = "), "{}", ran.out);
    assert_eq!(case, ["float x = 2.0", "float y = 0.0"]);
}

#[test]
fn parameters_of_other_names_are_taken_in_their_order() {
    let reference = "float f(float a, float b) { return a - b; }\n";
    let suite = suite(&["x", "y"], "reference = \"g.glsl\"");
    let run = |shader: &str| check(&[("f.glsl", shader), ("g.glsl", reference), ("f.suite.toml", &suite)], &[]);
    run("float f(float x, float y) { return x - y; }").expect(0);
    let ran = run("float f(float x, float y) { return y - x; }").expect(1);
    assert_eq!(finding(&ran).1.len(), 2);
    // Other types are no such pair.
    let ran = run("float f(float x, vec2 y) { return x - y.x; }").expect(2);
    assert!(ran.out.contains("needs an input `a` of type `float`; the shader has `float x`, `vec2 y`"), "{}", ran.out);
}

const STAGE: &str = "#version 330\nuniform mat4 view;\nuniform float scale;\nin vec3 p;\nout vec2 uv;\n\
    void main() { uv = 0.5 * p.xy + vec2(0.5); gl_Position = view * vec4(scale * p, 1.0); }\n";
const STAGE_SUITE: &str = "suite = \"move\"\nshader = \"new.vert\"\nstage = \"vertex\"\nsamples = 1024\n\
    reference = \"old.vert\"\n[[inputs]]\nnames = [\"p\"]\ngenerator = \"interval\"\nrange = [-1.0, 1.0]\n\
    [[inputs]]\nnames = [\"view\"]\ngenerator = \"affine\"\n\
    [[inputs]]\nnames = [\"scale\"]\ngenerator = \"interval\"\nrange = [0.5, 2.0]\n";

#[test]
fn the_shader_as_it_was_is_a_reference() {
    let run = |new: &str| check(&[("old.vert", STAGE), ("new.vert", new), ("a.suite.toml", STAGE_SUITE)], &[]);
    // Another way to compute the same, with an input more and outputs in another order.
    let same = "#version 330\nuniform float scale;\nuniform mat4 view;\nin vec3 p;\nout float extra;\nout vec2 uv;\n\
        void main() { gl_Position = view[3] + scale * (view[0] * p.x + view[1] * p.y + view[2] * p.z);\n\
        uv = (p.xy + 1.0) / 2.0; extra = p.z; }\n";
    run(same).expect(0);
    let ran = run(&STAGE.replace("view * vec4(scale * p, 1.0)", "view * vec4(scale * p, scale)")).expect(1);
    let (message, case) = finding(&ran);
    assert!(message.contains("the shader deviates from its reference: `gl_Position."), "{message}");
    assert_eq!(case.len(), 3, "{}", ran.out);
    let ran = run(&STAGE.replace("0.5 * p.xy", "0.5 * p.yx")).expect(1);
    assert!(finding(&ran).0.contains("`uv."), "{}", ran.out);
}

#[test]
fn geometry_stages_are_compared_with_their_vertices_and_strips() {
    let shader = |body: &str| {
        format!(
            "#version 330\nlayout(triangles) in;\nlayout(triangle_strip, max_vertices = 4) out;\nuniform float s;\n\
             void main() {{ for (int i = 0; i < 3; i++) {{ gl_Position = gl_in[i].gl_Position * s; EmitVertex(); }}\n\
             {body} EndPrimitive(); }}\n"
        )
    };
    let suite = "suite = \"g\"\nshader = \"new.geom\"\nstage = \"geometry\"\nsamples = 256\nreference = \"old.geom\"\n\
        [[inputs]]\nnames = [\"gl_Position\"]\ngenerator = \"point\"\nrange = [-1.0, 1.0]\n\
        [[inputs]]\nnames = [\"s\"]\ngenerator = \"interval\"\nrange = [0.0, 2.0]\n";
    let run = |new: &str| check(&[("old.geom", &shader("")), ("new.geom", &shader(new)), ("a.suite.toml", suite)], &[]);
    run("").expect(0);
    let ran = run("gl_Position = gl_in[0].gl_Position; EmitVertex();").expect(1);
    assert!(ran.out.contains("4 vertices emitted, expected 3"), "{}", ran.out);
}

#[test]
fn the_value_of_a_function_stands_for_an_output() {
    let suite = STAGE_SUITE.replace(
        "reference = \"old.vert\"",
        "reference = { file = \"ref.glsl\", function = \"position\", output = \"gl_Position\" }",
    );
    let reference = |scale: &str| {
        format!("vec4 position(mat4 view, vec3 p, float scale) {{ return view * vec4({scale} * p, 1.0); }}\n")
    };
    let run = |text: &str| check(&[("new.vert", STAGE), ("ref.glsl", text), ("a.suite.toml", &suite)], &[]);
    run(&reference("scale")).expect(0);
    run(&reference("1.001 * scale")).expect(1);
    let suite = suite.replace(", output = \"gl_Position\"", "");
    let ran = check(&[("new.vert", STAGE), ("ref.glsl", &reference("scale")), ("a.suite.toml", &suite)], &[]).expect(2);
    assert!(ran.out.contains("no output is in both; `output` in [reference] says which output"), "{}", ran.out);
}

#[test]
fn a_reference_that_is_itself_too_coarse_decides_nothing() {
    // (x + 2^40) - 2^40 keeps few digits of x even in binary64.
    let reference = "float f(float x) { return (x + 1.0e12) - 1.0e12; }\n";
    let text = suite(&["x"], "reference = \"r.glsl\"");
    let shader = "float f(float x) { return x; }\n";
    let ran = check(&[("f.glsl", shader), ("r.glsl", reference), ("f.suite.toml", &text)], &[]).expect(1);
    assert!(ran.out.contains(" 0 deviated") && ran.out.contains("ill-conditioned"), "{}", ran.out);
}

#[test]
fn references_that_do_not_compile_are_reported_at_their_place() {
    let text = suite(&["x", "y"], "reference = \"r.glsl\"");
    let ran = check(&[("f.glsl", HYPOT), ("r.glsl", "float f(float x) { retrun x; }"), ("f.suite.toml", &text)], &[]);
    let ran = ran.expect(2);
    assert!(
        ran.out.contains("the reference of suite `own` cannot be used: ") && ran.out.contains("r.glsl:1:"),
        "{ran:?}"
    );
    let ran = check(&[("f.glsl", HYPOT), ("f.suite.toml", &text)], &[]).expect(2);
    assert!(ran.err.contains("f.suite.toml:6:13: cannot read the reference `./r.glsl`"), "{}", ran.err);
}

#[test]
fn recorded_values_are_compared_row_by_row() {
    let text = "suite = \"own\"\nshader = \"f.glsl\"\nstage = \"function\"\nentry = \"f\"\nrecorded = \"rows.csv\"\n";
    let shader = "vec2 f(float x, int n) { return vec2(x * float(n), x + float(n)); }\n";
    let rows =
        "# made by hand\nx, n, return.x, return.y\n0.5, 2, 1.0, 2.5\n0x3e800000, 4, 1.0, 4.25\n-1.5, -2, 3.0, -3.5\n";
    let run = |rows: &str| check(&[("f.glsl", shader), ("rows.csv", rows), ("f.suite.toml", text)], &[]);
    let ran = run(rows).expect(0);
    assert!(ran.out.contains(" 3 judged         3 agreed"), "{}", ran.out);
    let ran = run(&rows.replace("4.25", "4.2500010")).expect(1);
    let (message, case) = finding(&ran);
    assert!(
        message.contains("the shader deviates from its record: `return.y` is 4.25, expected 4.250001"),
        "{message}"
    );
    assert_eq!(case, ["float x = 0.25", "int n = 4"]);
    assert!(ran.out.contains(" 3 judged         2 agreed       1 deviated"), "{}", ran.out);
    // Half a step of binary32 is allowed, and more where the suite says so.
    run(&rows.replace("4.25", "4.2500001")).expect(0);
    let rough = text.replace("\"rows.csv\"", "{ file = \"rows.csv\", relative_error = 1e-5 }");
    let files = [("f.glsl", shader), ("rows.csv", &rows.replace("4.25", "4.2500010")), ("f.suite.toml", &rough)];
    check(&files, &[]).expect(0);
    let json = "[{\"x\": 0.5, \"n\": 2, \"return\": [1.0, 2.5]}, {\"n\": 4, \"x\": 0.25, \"return\": [1.0, 4.75]}]";
    let text = text.replace("rows.csv", "rows.json");
    let ran = check(&[("f.glsl", shader), ("rows.json", json), ("f.suite.toml", &text)], &[]).expect(1);
    assert!(ran.out.contains("`return.y` is 4.25, expected 4.75"), "{}", ran.out);
}

#[test]
fn records_that_cannot_be_read_are_reported_with_line_and_column() {
    let text = "suite = \"own\"\nshader = \"f.glsl\"\nstage = \"function\"\nentry = \"f\"\nrecorded = \"rows.csv\"\n";
    for (rows, reported) in [
        ("x,retrun\n1,1\n", "rows.csv:1:3: the shader has no input or output `retrun`; did you mean `return`?"),
        ("x,return\n1,one\n", "rows.csv:2:3: `one` is no number"),
        ("x,return\n1\n", "rows.csv:2:1: 1 values stand here, and there are 2 names"),
        ("return\n1\n", "rows.csv:1:1: the input `x` is missing"),
        ("x\n1\n", "rows.csv:1:1: no output is recorded"),
        ("x,x,return\n1,1,1\n", "column 2 stands there twice"),
        ("", "there is no line of names"),
        ("x,return\n1,1\n1,2\n", "rows 1 and 2 have the same inputs and different outputs"),
    ] {
        let shader = "float f(float x) { return x; }\n";
        let ran = check(&[("f.glsl", shader), ("rows.csv", rows), ("f.suite.toml", text)], &[]).expect(2);
        assert!(ran.out.contains(reported), "{reported}\n{}{}", ran.out, ran.err);
    }
    let text = text.replace("rows.csv", "rows.json");
    for (rows, reported) in [
        (
            "[\n  {\"x\": 1, \"return\": 1},\n  {\"x\": \"}{\", \"return\": 1}\n]",
            "rows.json:3:4: object 2: `x` is a number",
        ),
        ("[{\"x\": 1, \"retrun\": 1}]", "rows.json:1:11: the shader has no input or output `retrun`"),
        ("[{\"x\": 1, \"return\": 1},\n {\"return\": 1}]", "rows.json:2:2: object 2 has other names than the first"),
    ] {
        let shader = "float f(float x) { return x; }\n";
        let ran = check(&[("f.glsl", shader), ("rows.json", rows), ("f.suite.toml", &text)], &[]).expect(2);
        assert!(ran.out.contains(reported), "{reported}\n{}{}", ran.out, ran.err);
    }
}

#[test]
fn without_an_expectation_lanes_are_held_against_the_shader() {
    let text = suite(&["x", "y"], "");
    let ran = check(&[("f.glsl", HYPOT), ("f.suite.toml", &text)], &[]).expect(0);
    assert!(ran.out.contains(" 2048 judged"), "{}", ran.out);
}

#[test]
fn two_expectations_are_one_too_many() {
    let text = suite(&["x", "y"], "formula = \"hermite\"\nreference = \"r.glsl\"");
    let ran = check(&[("f.glsl", HYPOT), ("r.glsl", HYPOT), ("f.suite.toml", &text)], &[]).expect(2);
    let reported = "f.suite.toml:7:13: `formula` says what is expected already; remove `reference`, or make two suites";
    assert!(ran.err.contains(reported), "{}", ran.err);
}

#[test]
fn a_failing_case_is_kept_and_shown_again() {
    let text = suite(&["x", "y"], "reference = \"r.glsl\"");
    let folder = folder(&[("f.glsl", HYPOT_WRONG), ("r.glsl", HYPOT), ("f.suite.toml", &text)]);
    let ran: crate::binary::Ran = command(folder.path(), "check . --lane embedded").output().unwrap().into();
    let ran = ran.expect(1);
    let line = ran.out.lines().find_map(|line| line.strip_prefix("  reproduce  ")).unwrap();
    let again = run_reported(folder.path(), line, &[]).expect(1);
    assert!(again.out.contains("the shader deviates from its reference"), "{}", again.out);
    assert!(fs::read_to_string(folder.path().join("f.regressions")).unwrap().contains("own x=40000000 y=00000000"));
}

#[test]
fn a_shader_is_enough_to_name_its_suites() {
    let text = suite(&["x", "y"], "");
    let folder = folder(&[("f.glsl", HYPOT), ("f.suite.toml", &text)]);
    let ran: crate::binary::Ran = command(folder.path(), "check f.glsl --lane embedded").output().unwrap().into();
    assert!(ran.expect(0).out.starts_with("ok    own "));
}

/// References in WGSL are functions; their literals count as they are written.
#[test]
fn a_function_in_wgsl_says_what_is_right() {
    let shader = "float f(float x) { return sin(1.2831853 * x) + 0.1; }\n";
    let right = "const TURN = 1.2831853;\nfn wave(x: f32) -> f32 { return sin(TURN * x); }\n\
        fn f(x: f32) -> f32 { return wave(x) + 0.1; }\n";
    let text = suite(&["x"], "reference = \"model.wgsl\"");
    check(&[("f.glsl", shader), ("model.wgsl", right), ("f.suite.toml", &text)], &[]).expect(0);
    let wrong = right.replace("0.1;", "0.1001;");
    let ran = check(&[("f.glsl", shader), ("model.wgsl", &wrong), ("f.suite.toml", &text)], &[]).expect(1);
    assert!(finding(&ran).0.contains("the shader deviates from its reference"), "{}", ran.out);
    for (model, said) in [
        ("fn g(x: f32) -> f32 { return x; }\n", "there is no function `f`; there are: g"),
        ("fn f(x: f32) -> f32 { return y; }\n", "model.wgsl:1:30"),
        (
            "@group(0) @binding(0) var<uniform> u: f32;\nfn f(x: f32) -> f32 { return x * u; }\n",
            "needs an input `u` of type `f32`",
        ),
    ] {
        let ran = check(&[("f.glsl", shader), ("model.wgsl", model), ("f.suite.toml", &text)], &[]);
        let all = format!("{}{}", ran.out, ran.err);
        assert!(ran.code != 0 && all.contains(said), "{all}");
    }
}

/// And a function in WGSL is run as well as one in GLSL.
#[test]
fn a_function_in_wgsl_is_run() {
    let shader = "fn f(x: f32) -> f32 {\n  var y = x;\n  if x < 0.0 { y = 0.5 * x; }\n  return y;\n}\n";
    let text = suite(&["x"], "reference = \"model.glsl\"").replace("f.glsl", "f.wgsl");
    let model = |half: &str| format!("float f(float x) {{ return x < 0.0 ? {half} * x : x; }}\n");
    check(&[("f.wgsl", shader), ("model.glsl", &model("0.5")), ("f.suite.toml", &text)], &[]).expect(0);
    check(&[("f.wgsl", shader), ("model.glsl", &model("0.25")), ("f.suite.toml", &text)], &[]).expect(1);
}

#[test]
fn a_shader_of_several_texts() {
    let suite = super::suite(&["a"], "linked = [\"lib.glsl\"]\nreference = \"reference.glsl\"");
    let shader = "float twice(float x);\nfloat f(float a) { return twice(a) + 1.0; }\n";
    let reference = "float f(float a) { return a + a + 1.0; }\n";
    for (library, status) in
        [("float twice(float x) { return x * 2.0; }\n", 0), ("float twice(float x) { return x * 3.0; }\n", 1)]
    {
        let files = [
            ("own.suite.toml", suite.as_str()),
            ("f.glsl", shader),
            ("lib.glsl", library),
            ("reference.glsl", reference),
        ];
        let ran = super::check(&files, &[]);
        assert_eq!(ran.code, status, "{}", ran.out);
    }
}
