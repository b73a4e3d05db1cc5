//! Every built-in function. The expected values come from the standard library or from arithmetic by
//! hand.

use naga::MathFunction as Mf;

use super::super::{Binary64, FUEL};
use super::support::{assert_near, batch, compile, floats, glsl, is_near, row, row32, wgsl};
use crate::interp::code::Inst;

/// The function, WGSL arguments and result, the body, one row of words, and what comes out.
pub(super) struct Row {
    pub fun: Mf,
    pub text: &'static str,
    pub input: Vec<u32>,
    pub output: Vec<f64>,
}

fn real(fun: Mf, text: &'static str, input: &[f32], output: &[f64]) -> Row {
    Row { fun, text, input: floats(input), output: output.to_vec() }
}

fn word(fun: Mf, text: &'static str, input: &[u32], output: &[f64]) -> Row {
    Row { fun, text, input: input.to_vec(), output: output.to_vec() }
}

const X: f32 = 0.625;
const W: f64 = X as f64;

/// A function of one number, at 0.625.
fn at(fun: Mf, text: &'static str, output: f64) -> Row {
    real(fun, text, &[X], &[output])
}

fn minus(n: u32) -> u32 {
    n.wrapping_neg()
}

/// At least one row for each function that a front end makes.
pub(super) fn rows() -> Vec<Row> {
    let root = |x: f64| x.sqrt();
    vec![
        real(Mf::Abs, "(x: vec2f) -> vec2f { return abs(x); }", &[-2.5, 3.0], &[2.5, 3.0]),
        word(Mf::Abs, "(x: vec2<i32>) -> vec2<i32> { return abs(x); }", &[minus(7), 7], &[7.0, 7.0]),
        real(Mf::Min, "(x: f32, y: f32) -> f32 { return min(x, y); }", &[2.0, -1.0], &[-1.0]),
        word(Mf::Min, "(x: i32, y: i32) -> i32 { return min(x, y); }", &[minus(2), 1], &[-2.0]),
        word(Mf::Min, "(x: u32, y: u32) -> u32 { return min(x, y); }", &[minus(2), 1], &[1.0]),
        real(Mf::Max, "(x: f32, y: f32) -> f32 { return max(x, y); }", &[2.0, -1.0], &[2.0]),
        word(Mf::Max, "(x: i32, y: i32) -> i32 { return max(x, y); }", &[minus(2), 1], &[1.0]),
        word(Mf::Max, "(x: u32, y: u32) -> u32 { return max(x, y); }", &[minus(2), 1], &[4_294_967_294.0]),
        real(
            Mf::Clamp,
            "(x: vec3f, l: f32, h: f32) -> vec3f { return clamp(x, vec3f(l), vec3f(h)); }",
            &[-3.0, 0.5, 7.0, -1.0, 2.0],
            &[-1.0, 0.5, 2.0],
        ),
        word(
            Mf::Clamp,
            "(x: i32, l: i32, h: i32) -> i32 { return clamp(x, l, h); }",
            &[minus(9), minus(3), 4],
            &[-3.0],
        ),
        real(Mf::Saturate, "(x: vec3f) -> vec3f { return saturate(x); }", &[-1.0, 0.25, 4.0], &[0.0, 0.25, 1.0]),
        at(Mf::Cos, "(x: f32) -> f32 { return cos(x); }", W.cos()),
        at(Mf::Cosh, "(x: f32) -> f32 { return cosh(x); }", W.cosh()),
        at(Mf::Sin, "(x: f32) -> f32 { return sin(x); }", W.sin()),
        at(Mf::Sinh, "(x: f32) -> f32 { return sinh(x); }", W.sinh()),
        at(Mf::Tan, "(x: f32) -> f32 { return tan(x); }", W.tan()),
        at(Mf::Tanh, "(x: f32) -> f32 { return tanh(x); }", W.tanh()),
        at(Mf::Acos, "(x: f32) -> f32 { return acos(x); }", W.acos()),
        at(Mf::Asin, "(x: f32) -> f32 { return asin(x); }", W.asin()),
        at(Mf::Atan, "(x: f32) -> f32 { return atan(x); }", W.atan()),
        at(Mf::Asinh, "(x: f32) -> f32 { return asinh(x); }", (W + root(W * W + 1.0)).ln()),
        real(Mf::Acosh, "(x: f32) -> f32 { return acosh(x); }", &[1.5], &[(1.5 + root(1.25)).ln()]),
        at(Mf::Atanh, "(x: f32) -> f32 { return atanh(x); }", 0.5 * ((1.0 + W) / (1.0 - W)).ln()),
        real(Mf::Atan2, "(y: f32, x: f32) -> f32 { return atan2(y, x); }", &[1.0, -2.0], &[1_f64.atan2(-2.0)]),
        real(Mf::Radians, "(x: f32) -> f32 { return radians(x); }", &[90.0], &[std::f64::consts::FRAC_PI_2]),
        real(Mf::Degrees, "(x: f32) -> f32 { return degrees(x); }", &[2.0], &[360.0 / std::f64::consts::PI]),
        real(Mf::Ceil, "(x: vec2f) -> vec2f { return ceil(x); }", &[1.25, -1.25], &[2.0, -1.0]),
        real(Mf::Floor, "(x: vec2f) -> vec2f { return floor(x); }", &[1.25, -1.25], &[1.0, -2.0]),
        real(Mf::Round, "(x: vec3f) -> vec3f { return round(x); }", &[2.5, 3.5, -0.75], &[2.0, 4.0, -1.0]),
        real(Mf::Trunc, "(x: vec2f) -> vec2f { return trunc(x); }", &[2.75, -2.75], &[2.0, -2.0]),
        real(Mf::Fract, "(x: vec2f) -> vec2f { return fract(x); }", &[1.75, -1.75], &[0.75, 0.25]),
        real(
            Mf::Modf,
            "(x: f32) -> vec2f { let r = modf(x); return vec2f(r.fract, r.whole); }",
            &[-1.75],
            &[-0.75, -1.0],
        ),
        real(
            Mf::Frexp,
            "(x: vec2f) -> vec4f { let r = frexp(x); return vec4f(r.fract, vec2f(r.exp)); }",
            &[12.0, -0.375],
            &[0.75, -0.75, 4.0, -1.0],
        ),
        Row {
            fun: Mf::Ldexp,
            text: "(x: f32, e: i32) -> f32 { return ldexp(x, e); }",
            input: vec![3_f32.to_bits(), minus(5)],
            output: vec![3.0 / 32.0],
        },
        at(Mf::Exp, "(x: f32) -> f32 { return exp(x); }", W.exp()),
        at(Mf::Exp2, "(x: f32) -> f32 { return exp2(x); }", W.exp2()),
        at(Mf::Log, "(x: f32) -> f32 { return log(x); }", W.ln()),
        at(Mf::Log2, "(x: f32) -> f32 { return log2(x); }", W.ln() / std::f64::consts::LN_2),
        real(Mf::Pow, "(x: f32, y: f32) -> f32 { return pow(x, y); }", &[2.0, 10.0], &[1024.0]),
        real(Mf::Pow, "(x: f32, y: f32) -> f32 { return pow(x, y); }", &[-2.0, 2.0], &[f64::NAN]),
        at(Mf::Sqrt, "(x: f32) -> f32 { return sqrt(x); }", W.sqrt()),
        at(Mf::InverseSqrt, "(x: f32) -> f32 { return inverseSqrt(x); }", 1.0 / W.sqrt()),
        real(Mf::Sign, "(x: vec3f) -> vec3f { return sign(x); }", &[-3.0, 0.0, 0.5], &[-1.0, 0.0, 1.0]),
        word(Mf::Sign, "(x: vec2<i32>) -> vec2<i32> { return sign(x); }", &[minus(3), 8], &[-1.0, 1.0]),
        real(Mf::Fma, "(a: f32, b: f32, c: f32) -> f32 { return fma(a, b, c); }", &[3.0, 5.0, 7.0], &[22.0]),
        real(
            Mf::Mix,
            "(a: vec2f, b: vec2f, t: f32) -> vec2f { return mix(a, b, t); }",
            &[1.0, 2.0, 5.0, 4.0, 0.25],
            &[2.0, 2.5],
        ),
        real(Mf::Step, "(e: vec2f, x: vec2f) -> vec2f { return step(e, x); }", &[1.0, 1.0, 0.5, 1.0], &[0.0, 1.0]),
        // t = 1/4: 1/16 · (3 − 1/2).
        real(
            Mf::SmoothStep,
            "(a: f32, b: f32, x: f32) -> f32 { return smoothstep(a, b, x); }",
            &[1.0, 5.0, 2.0],
            &[0.15625],
        ),
        real(Mf::Dot, "(a: vec3f, b: vec3f) -> f32 { return dot(a, b); }", &[1.0, 2.0, 3.0, 5.0, 7.0, 11.0], &[52.0]),
        word(Mf::Dot, "(a: vec2<i32>, b: vec2<i32>) -> i32 { return dot(a, b); }", &[minus(2), 3, 5, 7], &[11.0]),
        real(
            Mf::Cross,
            "(a: vec3f, b: vec3f) -> vec3f { return cross(a, b); }",
            &[1.0, 2.0, 3.0, 5.0, 7.0, 11.0],
            &[1.0, 4.0, -3.0],
        ),
        real(Mf::Length, "(a: vec3f) -> f32 { return length(a); }", &[2.0, 3.0, 6.0], &[7.0]),
        real(Mf::Distance, "(a: vec2f, b: vec2f) -> f32 { return distance(a, b); }", &[1.0, 2.0, 4.0, 6.0], &[5.0]),
        real(Mf::Normalize, "(a: vec2f) -> vec2f { return normalize(a); }", &[3.0, -4.0], &[0.6, -0.8]),
        real(
            Mf::FaceForward,
            "(n: vec2f, i: vec2f, r: vec2f) -> vec2f { return faceForward(n, i, r); }",
            // 3 − 5 < 0
            &[1.0, 2.0, 1.0, -5.0, 3.0, 1.0],
            &[1.0, 2.0],
        ),
        real(
            Mf::Reflect,
            "(i: vec2f, n: vec2f) -> vec2f { return reflect(i, n); }",
            &[1.0, -2.0, 0.6, 0.8],
            &[
                // dot = 0.6f − 1.6f, both rounded to binary32.
                1.0 - 2.0 * (f64::from(0.6_f32) - 2.0 * f64::from(0.8_f32)) * f64::from(0.6_f32),
                -2.0 - 2.0 * (f64::from(0.6_f32) - 2.0 * f64::from(0.8_f32)) * f64::from(0.8_f32),
            ],
        ),
        // dot = −5/16, k = 1 − 1/4·(1 − 25/256).
        real(
            Mf::Refract,
            "(i: vec2f, n: vec2f, eta: f32) -> vec2f { return refract(i, n, eta); }",
            &[0.75, -0.5, 0.25, 1.0, 0.5],
            &[0.375 - 0.25 * (root(0.774_414_062_5) - 0.15625), -0.25 - (root(0.774_414_062_5) - 0.15625)],
        ),
        // k = 1 − 4·(1 − 1/4) < 0.
        real(
            Mf::Refract,
            "(i: vec2f, n: vec2f, eta: f32) -> vec2f { return refract(i, n, eta); }",
            &[3.0, -0.5, 0.0, 1.0, 2.0],
            &[0.0, 0.0],
        ),
        real(
            Mf::Transpose,
            "(m0: vec3f, m1: vec3f) -> vec4f { let t = transpose(mat2x3f(m0, m1)); return vec4f(t[0], t[2]); }",
            &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
            &[1.0, 4.0, 3.0, 6.0],
        ),
        real(
            Mf::Determinant,
            "(a: vec3f, b: vec3f, c: vec3f) -> f32 { return determinant(mat3x3f(a, b, c)); }",
            &[2.0 + 1.0 / 4096.0, 1.0, 3.0, 0.0, 4.0, 1.0, 5.0, 2.0, 2.0],
            // (2 + 2^-12)·(8 − 2) − 1·(0 − 5) + 3·(0 − 20)
            &[-43.0 + 6.0 / 4096.0],
        ),
        real(
            Mf::QuantizeToF16,
            "(x: f32) -> f32 { return quantizeToF16(x); }",
            &[1.0 + 1.0 / 1536.0],
            &[1.0 + 1.0 / 1024.0],
        ),
        word(Mf::CountTrailingZeros, "(x: vec2u) -> vec2u { return countTrailingZeros(x); }", &[40, 0], &[3.0, 32.0]),
        word(Mf::CountLeadingZeros, "(x: vec2u) -> vec2u { return countLeadingZeros(x); }", &[40, 0], &[26.0, 32.0]),
        word(Mf::CountOneBits, "(x: u32) -> u32 { return countOneBits(x); }", &[0xf0f1], &[9.0]),
        word(Mf::ReverseBits, "(x: u32) -> u32 { return reverseBits(x); }", &[0x8000_0002], &[1_073_741_825.0]),
        word(
            Mf::FirstTrailingBit,
            "(x: vec2<i32>) -> vec2<i32> { return firstTrailingBit(x); }",
            &[24, 0],
            &[3.0, -1.0],
        ),
        word(
            Mf::FirstLeadingBit,
            "(x: vec3<i32>) -> vec3<i32> { return firstLeadingBit(x); }",
            &[24, minus(5), minus(1)],
            &[4.0, 2.0, -1.0],
        ),
        word(Mf::FirstLeadingBit, "(x: u32) -> u32 { return firstLeadingBit(x); }", &[minus(5)], &[31.0]),
        word(
            Mf::ExtractBits,
            "(x: u32, o: u32, c: u32) -> u32 { return extractBits(x, o, c); }",
            &[0x1234, 4, 8],
            &[35.0],
        ),
        word(
            Mf::ExtractBits,
            "(x: i32, o: u32, c: u32) -> i32 { return extractBits(x, o, c); }",
            &[0xe0, 5, 3],
            &[-1.0],
        ),
        word(
            Mf::ExtractBits,
            "(x: u32, o: u32, c: u32) -> u32 { return extractBits(x, o, c); }",
            &[minus(1), 28, 9],
            &[15.0],
        ),
        word(
            Mf::InsertBits,
            "(x: u32, n: u32, o: u32, c: u32) -> u32 { return insertBits(x, n, o, c); }",
            &[0xffff, 0x12, 4, 8],
            &[f64::from(0xf12f)],
        ),
        word(
            Mf::Dot4I8Packed,
            "(a: u32, b: u32) -> i32 { return dot4I8Packed(a, b); }",
            &[0x01ff_0203, 0x0405_0607],
            &[
                // (3, 2, −1, 1)·(7, 6, 5, 4)
                32.0,
            ],
        ),
        word(
            Mf::Dot4U8Packed,
            "(a: u32, b: u32) -> u32 { return dot4U8Packed(a, b); }",
            &[0x01ff_0203, 0x0405_0607],
            &[1312.0],
        ),
        real(
            Mf::Pack4x8snorm,
            "(x: vec4f) -> u32 { return pack4x8snorm(x); }",
            &[1.0, -1.0, 0.5, -9.0],
            &[
                // 127, −127, ⌊64⌋, −127
                f64::from(0x8140_817f_u32),
            ],
        ),
        real(
            Mf::Pack4x8unorm,
            "(x: vec4f) -> u32 { return pack4x8unorm(x); }",
            &[1.0, -1.0, 0.5, 0.2],
            &[f64::from(0x3380_00ff_u32)],
        ),
        real(
            Mf::Pack2x16snorm,
            "(x: vec2f) -> u32 { return pack2x16snorm(x); }",
            &[1.0, -1.0],
            &[f64::from(0x8001_7fff_u32)],
        ),
        real(
            Mf::Pack2x16unorm,
            "(x: vec2f) -> u32 { return pack2x16unorm(x); }",
            &[1.0, 0.5],
            &[f64::from(0x8000_ffff_u32)],
        ),
        real(
            Mf::Pack2x16float,
            "(x: vec2f) -> u32 { return pack2x16float(x); }",
            &[1.0, -2.0],
            &[f64::from(0xc000_3c00_u32)],
        ),
        word(
            Mf::Pack4xI8,
            "(x: vec4<i32>) -> u32 { return pack4xI8(x); }",
            &[minus(1), 2, 259, 4],
            &[f64::from(0x0403_02ff_u32)],
        ),
        word(Mf::Pack4xU8, "(x: vec4u) -> u32 { return pack4xU8(x); }", &[1, 2, 259, 4], &[f64::from(0x0403_0201_u32)]),
        word(
            Mf::Pack4xI8Clamp,
            "(x: vec4<i32>) -> u32 { return pack4xI8Clamp(x); }",
            &[minus(1), 2, 259, minus(400)],
            &[f64::from(0x807f_02ff_u32)],
        ),
        word(
            Mf::Pack4xU8Clamp,
            "(x: vec4u) -> u32 { return pack4xU8Clamp(x); }",
            &[1, 2, 259, 4],
            &[f64::from(0x04ff_0201_u32)],
        ),
        word(
            Mf::Unpack4x8snorm,
            "(x: u32) -> vec4f { return unpack4x8snorm(x); }",
            &[0x8081_7f01],
            &[1.0 / 127.0, 1.0, -1.0, -1.0],
        ),
        word(
            Mf::Unpack4x8unorm,
            "(x: u32) -> vec4f { return unpack4x8unorm(x); }",
            &[0x0033_ff01],
            &[1.0 / 255.0, 1.0, 0.2, 0.0],
        ),
        word(Mf::Unpack2x16snorm, "(x: u32) -> vec2f { return unpack2x16snorm(x); }", &[0x8000_7fff], &[1.0, -1.0]),
        word(Mf::Unpack2x16unorm, "(x: u32) -> vec2f { return unpack2x16unorm(x); }", &[0x3333_ffff], &[1.0, 0.2]),
        word(Mf::Unpack2x16float, "(x: u32) -> vec2f { return unpack2x16float(x); }", &[0xc000_3c00], &[1.0, -2.0]),
        word(
            Mf::Unpack4xI8,
            "(x: u32) -> vec4<i32> { return unpack4xI8(x); }",
            &[0x80ff_0201],
            &[1.0, 2.0, -1.0, -128.0],
        ),
        word(Mf::Unpack4xU8, "(x: u32) -> vec4u { return unpack4xU8(x); }", &[0x80ff_0201], &[1.0, 2.0, 255.0, 128.0]),
    ]
}

/// Checks a row with instructions changed by `fault`. Gives what came out.
pub(super) fn check(row: &Row, fault: impl Fn(&mut Vec<Inst>)) -> Option<Vec<f64>> {
    let shader = wgsl(&format!("fn f{}", row.text));
    let mut executable = compile(&shader).unwrap();
    fault(&mut executable.body);
    let meaning = executable.run::<Binary64>(&batch(std::slice::from_ref(&row.input)), FUEL).unwrap();
    let found = meaning.vertex(0, 0).to_vec();
    (!is_near(&found, &row.output)).then_some(found)
}

#[test]
fn every_function_has_the_value_of_its_definition() {
    for row in rows() {
        let wrong = check(&row, |_| {});
        assert!(wrong.is_none(), "{:?} {}: {wrong:?}, expected {:?}", row.fun, row.text, row.output);
    }
}

#[test]
fn every_row_uses_its_function() {
    for row in rows() {
        let (module, _) = wgsl(&format!("fn f{}", row.text));
        let mut functions = module.functions.iter().flat_map(|(_, f)| f.expressions.iter());
        let used = functions.any(|(_, e)| matches!(e, naga::Expression::Math { fun, .. } if *fun == row.fun));
        assert!(used, "{:?}", row.fun);
    }
}

#[test]
fn functions_that_glsl_alone_has() {
    // Columns (1, 2) and (3, 5): determinant −1.
    let inverse = glsl("vec4 f(vec2 a, vec2 b) { mat2 m = inverse(mat2(a, b)); return vec4(m[0], m[1]); }");
    assert_near(&row(&inverse, &floats(&[1.0, 2.0, 3.0, 5.0])), &[-5.0, 2.0, 3.0, -1.0], "inverse");
    // A product with the inverse is 1, for a matrix without symmetry.
    let text = "vec3 f(vec3 a, vec3 b, vec3 c, vec3 v) { mat3 m = mat3(a, b, c); return inverse(m) * (m * v); }";
    let input = [2.0, 1.0, 3.0, 0.0, 4.0, 1.0, 5.0, 2.0, 2.0, 7.0, -1.0, 3.0];
    assert_near(&row(&glsl(text), &floats(&input)), &[7.0, -1.0, 3.0], "inverse of a mat3");
    let text =
        "vec4 f(vec4 a, vec4 b, vec4 c, vec4 d, vec4 v) { mat4 m = mat4(a, b, c, d); return inverse(m) * (m * v); }";
    let mut input: Vec<f32> = (0..16).map(|k| ((k * 7) % 11) as f32 - 3.0 + f32::from(k % 5 == 0) * 9.0).collect();
    input.extend([1.0, 2.0, -3.0, 4.0]);
    let found = row(&glsl(text), &floats(&input));
    let off = found.iter().zip([1.0, 2.0, -3.0, 4.0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-13, "inverse of a mat4: {found:?}");
    let outer = glsl("vec4 f(vec2 c, vec2 r) { mat2 m = outerProduct(c, r); return vec4(m[0], m[1]); }");
    assert_near(&row(&outer, &floats(&[2.0, 3.0, 5.0, 7.0])), &[10.0, 15.0, 14.0, 21.0], "outerProduct");
    // x − y·⌊x/y⌋, unlike `%`.
    let modulo = glsl("float f(float x, float y) { return mod(x, y); }");
    assert_near(&row(&modulo, &floats(&[-1.5, 1.0])), &[0.5], "mod");
    let select = glsl("vec2 f(vec2 a, vec2 b, float t) { return mix(a, b, bvec2(t > 0.0, t > 1.0)); }");
    assert_near(&row(&select, &floats(&[1.0, 2.0, 3.0, 4.0, 0.5])), &[3.0, 2.0], "mix with booleans");
}

#[test]
fn strict_binary32_rounds_each_operation_in_the_order_of_the_source() {
    let sum = wgsl("fn f(a: f32, b: f32, c: f32) -> f32 { return a + b + c; }");
    let tiny = 2_f32.powi(-24);
    // 1 + 2^-24 ties to 1, twice; in the other order the sum of the two is kept.
    assert_eq!(row32(&sum, &floats(&[1.0, tiny, tiny])), floats(&[1.0]));
    assert_eq!(row32(&sum, &floats(&[tiny, tiny, 1.0])), floats(&[1.0 + 2.0 * tiny]));
    assert_near(&row(&sum, &floats(&[1.0, tiny, tiny])), &[1.0 + 2.0 * f64::from(tiny)], "binary64");
    let sine = wgsl("fn f(x: f32) -> f32 { return sin(x); }");
    // The nearest binary32 to sin(1) = 0.8414709848….
    assert_eq!(row32(&sine, &floats(&[1.0])), floats(&[0.841_470_96]));
    let root = wgsl("fn f(x: f32) -> f32 { return sqrt(x) * 0.5; }");
    assert_eq!(
        row32(&root, &floats(&[f32::from_bits(1)])),
        vec![(2_f32.powi(-76) * std::f32::consts::SQRT_2).to_bits()]
    );
    let product = wgsl("fn f(x: f32, y: f32) -> f32 { return x * y; }");
    assert_eq!(row32(&product, &floats(&[1e-30, 1e-10])), floats(&[1e-30_f32 * 1e-10]), "subnormals are kept");
    assert_eq!(row32(&product, &floats(&[1e30, 1e10])), floats(&[f32::INFINITY]));
    assert_near(&row(&product, &floats(&[1e30, 1e10])), &[f64::from(1e30_f32) * 1e10], "binary64 goes on");
}
