//! Literals and constant expressions: what they are meant to be, by what they are folded, and what is made of digits
//! that round a constant.

use super::{check, finding, folder, suite};
use crate::binary::command;

const TURN: &str =
    "vec2 f(float u) { return vec2(cos(6.283185307179586476925 * u), sin(6.283185307179586476925 * u)); }\n";

/// A function that goes round in a circle, with this for a whole turn, behind other lines.
fn turn(before: &str, tau: &str) -> String {
    format!("{before}vec2 f(float u) {{ float a = {tau} * u; return vec2(cos(a), sin(a)); }}\n")
}

/// Ways to write 2π: what stands before the function, and the expression.
const IDIOMS: &[(&str, &str)] = &[
    ("", "6.283185307179586"),
    ("", "(2.0 * 3.14159265358979)"),
    ("const float PI = 3.14159265358979;", "(2.0 * PI)"),
    ("const float PI = 3.14159265358979;", "(PI / 0.5)"),
    ("const float PI = 3.14159265358979;", "(PI * 0.5 * 4.0)"),
    ("const float PI = 3.14159265358979;", "(2 * PI)"),
    ("const float PI = 3.14159265358979;", "max(PI + PI, 1.0)"),
    ("const float PI = 3.14159265358979; const float HALF = PI / 2.0; const float TAU = HALF * 4.0;", "TAU"),
    ("#define PI 3.14159265358979\n", "(2.0 * PI)"),
    ("#define PI 3.14159265358979\n#define TAU (PI * 2.0)\n", "TAU"),
    ("#define PI 3.14159265358979\n#define TIMES(x) ((x) * PI)\n", "TIMES(2.0)"),
    ("", "radians(360.0)"),
    ("", "(2.0 * radians(180.0))"),
    ("const float TAU = radians(360.0);", "TAU"),
    ("", "(2.0 * acos(-1.0))"),
    ("const float PI = acos(-1.0); const float TAU = 2.0 * PI;", "TAU"),
    ("#define PI acos(-1.0)\n", "(2.0 * PI)"),
    ("", "(4.0 * acos(0.0))"),
    ("", "(8.0 * atan(1.0))"),
    ("#define TAU (8.0 * atan(1.0))\n", "TAU"),
    ("", "(2.0 * atan(0.0, -1.0))"),
    ("", "(4.0 * asin(1.0))"),
    ("const float PI = 3.14159265358979;", "(2.0 * sqrt(PI) * sqrt(PI))"),
    ("const float PI = 3.14159265358979;", "mix(PI, 3.0 * PI, 0.5)"),
    ("const float PI = 3.14159265358979;", "(6.0 * PI * (1.0 / 3.0))"),
    ("const float PI = 3.14159265358979;", "(2.0 * PI * log(exp(1.0)))"),
    ("const vec2 K = vec2(1.0, 3.14159265358979);", "(K * 2.0).y"),
    ("const vec3 K = vec3(3.14159265358979) * vec3(1.0, 2.0, 3.0);", "K.zyx.y"),
    ("const float A[2] = float[2](1.0, 3.14159265358979);", "(A[1] * 2.0)"),
    ("struct S { float a; float b; }; const S K = S(1.0, 3.14159265358979);", "(K.b * 2.0)"),
    ("const mat2 M = mat2(1.0, 0.0, 0.0, 3.14159265358979);", "(M * vec2(0.0, 2.0)).y"),
    ("const float PI = 3.14159265358979; float same(const float x) { return x; }", "same(2.0 * PI)"),
    ("const float PI = 3.14159265358979; float TAU = 2.0 * PI;", "TAU"),
    ("const float SCALE = 0.1; const float TAU = 62.83185307179586 * SCALE;", "TAU"),
];

#[test]
fn constants_are_the_numbers_that_their_author_means() {
    let text = suite(&["u"], "reference = \"r.glsl\"");
    for version in ["#version 450\n", "#version 330 core\n"] {
        for (before, tau) in IDIOMS {
            let shader = format!("{version}{}", turn(before, tau));
            let ran = check(&[("f.glsl", &shader), ("r.glsl", TURN), ("f.suite.toml", &text)], &[]).expect(0);
            let judged = ran.out.contains(" 2048 judged") && ran.out.contains(" 2048 agreed");
            assert!(judged && !ran.out.contains("stands for"), "{shader}{}", ran.out);
        }
    }
}

#[test]
fn a_constant_that_is_off_by_a_little_is_a_wrong_one() {
    let text = suite(&["u"], "reference = \"r.glsl\"");
    for (before, tau) in [
        ("const float PI = 3.14159065358979;", "(2.0 * PI)"),
        ("#define PI 3.14159065358979\n", "(PI / 0.5)"),
        ("", "radians(359.9999)"),
        ("", "(2.0 * acos(-0.9999999))"),
        ("const float A[2] = float[2](1.0, 3.14159065358979);", "(A[1] * 2.0)"),
    ] {
        let shader = format!("#version 450\n{}", turn(before, tau));
        let ran = check(&[("f.glsl", &shader), ("r.glsl", TURN), ("f.suite.toml", &text)], &[]).expect(1);
        assert!(ran.out.contains("the shader deviates from its reference"), "{shader}{}", ran.out);
    }
}

/// The only warning of a run.
fn warning(ran: &crate::binary::Ran) -> &str {
    let mut all = ran.out.lines().filter(|line| line.starts_with("warning: "));
    let first = all.next().unwrap_or_else(|| panic!("no warning: {}", ran.out));
    assert_eq!(all.next(), None);
    first
}

/// Runs a turn with this constant against the exact one.
fn with(tau: &str, more: &[&str]) -> crate::binary::Ran {
    let text = suite(&["u"], "reference = \"r.glsl\"");
    check(&[("f.glsl", &turn("", tau)), ("r.glsl", TURN), ("f.suite.toml", &text)], more)
}

#[test]
fn a_rounded_constant_is_a_warning_with_its_effect() {
    for (tau, name) in [
        ("6.283185", "2π in 7 digits"),
        ("6.28318", "2π in 6 digits"),
        ("6.28319", "2π in 6 digits"),
        ("(2.0 * 3.141593)", "π in 7 digits"),
        ("(2.0 * 3.14159)", "π in 6 digits"),
    ] {
        let ran = with(tau, &[]).expect(0);
        let message = warning(&ran);
        assert!(ran.out.contains(" 2048 agreed") && message.contains(name), "{}", ran.out);
        assert!(
            message.contains("f.glsl:1:") && message.contains(" ULP), smallest input u = 2.0; write "),
            "{message}"
        );
    }
    // Every format for programs has it, with the smallest input.
    let json: serde_json::Value = serde_json::from_str(&with("6.283185", &["--format", "json"]).expect(0).out).unwrap();
    let found = &json["suites"][0]["findings"][0];
    assert_eq!((&found["kind"], &found["severity"]), (&"rounded_literal".into(), &"warning".into()), "{found}");
    assert_eq!(found["case"]["inputs"][0]["decimal"][0], "2.0", "{found}");
    // What binary32 makes of it is what it makes of the constant.
    let ran = with("6.2831853", &[]).expect(0);
    assert!(!ran.out.contains("digits"), "{}", ran.out);
}

#[test]
fn a_rounded_constant_fails_where_literals_count_as_written() {
    let ran = with("6.283185", &["--strict-literals"]).expect(1);
    assert!(finding(&ran).0.contains("the shader deviates from its reference"), "{}", ran.out);
    assert!(ran.out.contains("stands for 2π") && ran.out.contains("--strict-literals --lane"), "{}", ran.out);
    let text = suite(&["u"], "literals = \"exact\"\nreference = \"r.glsl\"");
    let shader = turn("", "6.283185");
    check(&[("f.glsl", &shader), ("r.glsl", TURN), ("f.suite.toml", &text)], &[]).expect(1);
    let text = text.replace("exact", "exakt");
    let ran = check(&[("f.glsl", &shader), ("r.glsl", TURN), ("f.suite.toml", &text)], &[]).expect(2);
    assert!(format!("{ran:?}").contains("unknown reading of literals `exakt`"), "{ran:?}");
}

#[test]
fn other_digits_fail_as_ever() {
    for tau in ["6.483185", "6.283186", "6.283195", "6.28", "6.2832", "(2.0 * 3.14)", "(2.0 * 3.241593)"] {
        let ran = with(tau, &[]).expect(1);
        assert!(finding(&ran).0.contains("the shader deviates from its reference"), "{}", ran.out);
    }
}

#[test]
fn few_digits_do_where_a_conforming_device_errs_by_as_much() {
    // The sum is so large that binary32 does not see more digits.
    let reference = "float f(float u) { return 1.0e6 * (u + 3.0) + 1.0 / 3.0; }\n";
    let text = suite(&["u"], "reference = \"r.glsl\"");
    let run = |shader: &str| check(&[("f.glsl", shader), ("r.glsl", reference), ("f.suite.toml", &text)], &[]);
    let ran = run(&reference.replace("1.0 / 3.0", "0.333")).expect(0);
    assert!(warning(&ran).contains("`0.333` at ./f.glsl:1:47 is 1/3 in 3 digits"), "{}", ran.out);
    run(&reference.replace("1.0 / 3.0", "0.483")).expect(1);
}

#[test]
fn literals_that_the_reference_has_as_well_are_no_matter() {
    let text = suite(&["u"], "reference = \"r.glsl\"");
    let shader = turn("", "6.28318");
    let ran = check(&[("f.glsl", &shader), ("r.glsl", &shader), ("f.suite.toml", &text)], &[]).expect(0);
    assert!(!ran.out.contains("digits"), "{}", ran.out);
}

#[test]
fn relations_follow_what_a_literal_stands_for() {
    let law = "relations = [{ kind = \"periodic\", inputs = [\"u\"], period = 1.0 }]";
    let run =
        |tau: &str, more: &[&str]| check(&[("f.glsl", &turn("", tau)), ("f.suite.toml", &suite(&["u"], law))], more);
    run("6.283185307179586", &[]).expect(0);
    let ran = run("6.283185", &[]).expect(0);
    assert!(warning(&ran).contains("2π in 7 digits"), "{}", ran.out);
    let ran = run("6.283185", &["--strict-literals"]).expect(1);
    assert!(finding(&ran).0.contains("the relation"), "{}", ran.out);
    run("6.283285", &[]).expect(1);
}

#[test]
fn a_macro_is_reported_where_it_is_defined() {
    let shader = turn("#define PI 3.14159\n", "(2.0 * PI)");
    let text = suite(&["u"], "reference = \"r.glsl\"");
    let ran = check(&[("f.glsl", &shader), ("r.glsl", TURN), ("f.suite.toml", &text)], &[]).expect(0);
    assert!(warning(&ran).contains("`3.14159` at ./f.glsl:1:12"), "{}", ran.out);
}

#[test]
fn a_mutant_of_a_rounded_literal_is_killed() {
    let text = suite(&["u"], "reference = \"r.glsl\"");
    for tau in ["6.283185", "6.283185307179586"] {
        let files = [("f.glsl", &*turn("", tau)), ("r.glsl", TURN), ("f.suite.toml", &*text)];
        let folder = folder(&files);
        let ran: crate::binary::Ran =
            command(folder.path(), "mutate f.suite.toml --samples 512").output().unwrap().into();
        let ran = ran.expect(0);
        assert!(ran.out.contains("100.0 %") || ran.out.contains("100 %"), "{}", ran.out);
    }
}
