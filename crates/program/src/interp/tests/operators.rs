//! Operators, conversions, swizzles and matrices.

use naga::MathFunction;

use super::functions::{Row, check};
use super::support::{assert_near, floats, glsl, row, row32, wgsl};

fn real(text: &'static str, input: &[f32], output: &[f64]) -> Row {
    // Rows are shared with those of functions; the function is not looked at.
    Row { fun: MathFunction::Abs, text, input: floats(input), output: output.to_vec() }
}

fn word(text: &'static str, input: &[u32], output: &[f64]) -> Row {
    Row { fun: MathFunction::Abs, text, input: input.to_vec(), output: output.to_vec() }
}

fn minus(n: u32) -> u32 {
    n.wrapping_neg()
}

pub(super) fn rows() -> Vec<Row> {
    vec![
        real("(a: f32, b: f32) -> f32 { return a + b; }", &[7.0, 2.0], &[9.0]),
        real("(a: f32, b: f32) -> f32 { return a - b; }", &[7.0, 2.0], &[5.0]),
        real("(a: f32, b: f32) -> f32 { return a * b; }", &[7.0, 2.0], &[14.0]),
        real("(a: f32, b: f32) -> f32 { return a / b; }", &[7.0, 2.0], &[3.5]),
        real("(a: f32, b: f32) -> f32 { return a % b; }", &[-7.5, 2.0], &[-1.5]),
        real("(a: f32) -> f32 { return -a; }", &[7.0], &[-7.0]),
        real("(a: vec2f, b: f32) -> vec2f { return a * b; }", &[7.0, 2.0, 3.0], &[21.0, 6.0]),
        real("(a: vec2f, b: f32) -> vec2f { return b - a; }", &[7.0, 2.0, 3.0], &[-4.0, 1.0]),
        real("(a: vec2f, b: vec2f) -> vec2f { return a / b; }", &[7.0, 2.0, 2.0, 8.0], &[3.5, 0.25]),
        word("(a: i32, b: i32) -> i32 { return a + b; }", &[minus(7), 2], &[-5.0]),
        word("(a: u32, b: u32) -> u32 { return a + b; }", &[minus(1), 3], &[2.0]),
        word("(a: i32, b: i32) -> i32 { return a - b; }", &[minus(7), 2], &[-9.0]),
        word("(a: u32, b: u32) -> u32 { return a - b; }", &[9, 2], &[7.0]),
        word("(a: i32, b: i32) -> i32 { return a * b; }", &[minus(7), 2], &[-14.0]),
        word("(a: u32, b: u32) -> u32 { return a * b; }", &[0x8000_0001, 2], &[2.0]),
        word("(a: i32, b: i32) -> i32 { return a / b; }", &[minus(7), 2], &[-3.0]),
        word("(a: u32, b: u32) -> u32 { return a / b; }", &[minus(6), 2], &[2_147_483_645.0]),
        word("(a: i32, b: i32) -> i32 { return a % b; }", &[minus(7), 2], &[-1.0]),
        word("(a: u32, b: u32) -> u32 { return a % b; }", &[7, 4], &[3.0]),
        word("(a: i32) -> i32 { return -a; }", &[7], &[-7.0]),
        word("(a: i32) -> i32 { return ~a; }", &[7], &[-8.0]),
        word("(a: u32, b: u32) -> u32 { return a & b; }", &[12, 10], &[8.0]),
        word("(a: u32, b: u32) -> u32 { return a | b; }", &[12, 10], &[14.0]),
        word("(a: u32, b: u32) -> u32 { return a ^ b; }", &[12, 10], &[6.0]),
        word("(a: i32, b: u32) -> i32 { return a << b; }", &[minus(3), 2], &[-12.0]),
        word("(a: i32, b: u32) -> i32 { return a >> b; }", &[minus(12), 2], &[-3.0]),
        word("(a: u32, b: u32) -> u32 { return a >> b; }", &[minus(12), 28], &[15.0]),
        word("(a: u32, b: u32) -> u32 { return select(1u, 0u, a < b); }", &[3, minus(1)], &[0.0]),
        word("(a: i32, b: i32) -> u32 { return select(1u, 0u, a < b); }", &[3, minus(1)], &[1.0]),
        word("(a: u32, b: u32) -> u32 { return select(1u, 0u, a <= b); }", &[3, minus(1)], &[0.0]),
        word("(a: i32, b: i32) -> u32 { return select(1u, 0u, a <= b); }", &[3, minus(1)], &[1.0]),
        word("(a: i32, b: i32) -> u32 { return select(1u, 0u, a > b); }", &[3, minus(1)], &[0.0]),
        word("(a: u32, b: u32) -> u32 { return select(1u, 0u, a >= b); }", &[3, minus(1)], &[1.0]),
        word("(a: u32, b: u32) -> u32 { return select(1u, 0u, a == b); }", &[3, 3], &[0.0]),
        word("(a: u32, b: u32) -> u32 { return select(1u, 0u, a != b); }", &[3, 3], &[1.0]),
    ]
}

#[test]
fn every_operator_has_the_value_of_its_definition() {
    for row in rows() {
        let wrong = check(&row, |_| {});
        assert!(wrong.is_none(), "{}: {wrong:?}, expected {:?}", row.text, row.output);
    }
}

#[test]
fn comparisons_of_numbers_and_of_nan() {
    let text = "fn f(a: f32, b: f32) -> u32 {
        return u32(a < b) + 2 * u32(a <= b) + 4 * u32(a > b) + 8 * u32(a >= b) + 16 * u32(a == b) + 32 * u32(a != b);
    }";
    let shader = wgsl(text);
    for (a, b, expected) in [
        (1.0, 2.0, 1 + 2 + 32),
        (2.0, 1.0, 4 + 8 + 32),
        (2.0, 2.0, 2 + 8 + 16),
        (0.0, -0.0, 2 + 8 + 16),
        (f32::NAN, 1.0, 32),
    ] {
        assert_eq!(row32(&shader, &floats(&[a, b])), [expected], "{a} {b}");
    }
}

#[test]
fn conversions_and_reinterpretations() {
    let shader = wgsl("fn f(x: f32) -> vec4<i32> { return vec4(i32(x), i32(u32(x)), bitcast<i32>(x), i32(bool(x))); }");
    assert_eq!(row32(&shader, &floats(&[2.75])), [2, 2, 2.75_f32.to_bits(), 1]);
    assert_eq!(row32(&shader, &floats(&[0.0])), [0, 0, 0, 0]);
    let shader = wgsl("fn f(i: i32) -> vec4f { return vec4(f32(i), f32(u32(i)), bitcast<f32>(i), f32(i != 0)); }");
    assert_eq!(row(&shader, &[minus(4)])[..2], [-4.0, 4_294_967_292.0]);
    assert!(row(&shader, &[minus(4)])[2].is_nan());
    assert_eq!(row(&shader, &[0x4049_0fdb])[2..], [f64::from(std::f32::consts::PI), 1.0]);
    // 2^24 + 1 is no binary32, and is a binary64.
    let shader = wgsl("fn f(i: i32) -> f32 { return f32(i); }");
    assert_eq!(row32(&shader, &[16_777_217]), floats(&[16_777_216.0]));
    assert_eq!(row(&shader, &[16_777_217]), [16_777_217.0]);
}

#[test]
fn matrices_are_column_by_column() {
    // Columns (1, 2) (3, 4) (5, 6).
    let m = "mat3x2f(vec2f(1, 2), vec2f(3, 4), vec2f(5, 6))";
    let times = wgsl(&format!("fn f(v: vec3f) -> vec2f {{ var m = {m}; return m * v; }}"));
    assert_near(&row(&times, &floats(&[1.0, 10.0, 100.0])), &[531.0, 642.0], "m * v");
    let from_left = wgsl(&format!("fn f(v: vec2f) -> vec3f {{ var m = {m}; return v * m; }}"));
    assert_near(&row(&from_left, &floats(&[1.0, 10.0])), &[21.0, 43.0, 65.0], "v * m");
    let product = wgsl(&format!(
        "fn f(a: vec3f, b: vec3f) -> vec4f {{ var m = {m}; let p = m * mat2x3f(a, b); return vec4f(p[0], p[1]); }}"
    ));
    let input = [1.0, 10.0, 100.0, 2.0, 0.0, 1.0];
    assert_near(&row(&product, &floats(&input)), &[531.0, 642.0, 7.0, 10.0], "m * n");
    let scaled = wgsl(&format!("fn f(s: f32) -> vec2f {{ var m = {m}; return (s * m - m * 2.0)[2] + (m + m)[0]; }}"));
    assert_near(&row(&scaled, &floats(&[3.0])), &[5.0 + 2.0, 6.0 + 4.0], "scaled");
}

#[test]
fn swizzles_splats_and_logic() {
    let shader = wgsl("fn f(v: vec4f) -> vec4f { return v.wzyx + vec4f(v.y) + vec4f(v.xx, 0.5, 0.25); }");
    assert_near(&row(&shader, &floats(&[1.0, 2.0, 4.0, 8.0])), &[11.0, 7.0, 4.5, 3.25], "swizzle");
    let shader = wgsl(
        "fn f(a: i32, b: i32) -> vec4<i32> {
        let p = a > 0; let q = b > 0; let v = vec2<bool>(p, q);
        return vec4(i32(p && q), i32(p || q), i32(all(v)) + 2 * i32(any(v)), i32(!p) + 2 * i32(p != q));
    }",
    );
    assert_eq!(row32(&shader, &[1, 0]), [0, 1, 2, 2]);
    assert_eq!(row32(&shader, &[0, 0]), [0, 0, 0, 1]);
    assert_eq!(row32(&shader, &[1, 1]), [1, 1, 3, 0]);
    let shader = wgsl("fn f(a: vec2f, b: vec2f) -> vec2f { return select(a, b, vec2<bool>(a.x < b.x, a.y < b.y)); }");
    assert_near(&row(&shader, &floats(&[1.0, 9.0, 2.0, 3.0])), &[2.0, 9.0], "select");
    let shader = glsl("ivec2 f(float x) { return ivec2(isnan(x), isinf(x)); }");
    assert_eq!(row32(&shader, &floats(&[f32::NAN])), [1, 0]);
    assert_eq!(row32(&shader, &floats(&[f32::NEG_INFINITY])), [0, 1]);
    assert_eq!(row32(&shader, &floats(&[1.0])), [0, 0]);
}

#[test]
fn literals_keep_the_value_they_have_in_the_module() {
    let shader = glsl("float f(float s) { return 6.28318530717958648 * s; }");
    assert_eq!(row(&shader, &floats(&[1.0])), [f64::from(std::f32::consts::TAU)]);
}
