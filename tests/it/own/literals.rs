//! Constant expressions: what they are meant to be, whatever folds them.

use super::{check, suite};

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
