//! Operators, functions and comparisons of numbers.

use super::super::Corner::*;
use super::super::Row;
use super::{ARITHMETIC, COMPARISON, all, numeric, only, row, same};

#[rustfmt::skip]
pub(super) static ROWS: &[Row] = &[
    // Operators on numbers.
    row("+", same("x + y"), "f f f", ARITHMETIC, &[
        all(Tie, "1 5.9604645e-8 = 1 | 1.0000001; -1 -5.9604645e-8 = -1 | -1.0000001"),
        all(Subnormal, "1e-40 1e-40 ~ 0; 1e-40 0 ~ 0; 1e-40 1 = 1 | 1.0000001"),
        all(Overflow, "max max = any; -max -max = any"),
        all(Absorption, "1 1e-20 = 1 | 1.0000001; 1e20 -1 = 1e20 | 9.9999993e19"),
        all(Zero, "-0 0 = 0; 0 2.5 = 2.5"),
        all(Equal, "1.1 -1.1 = 0"),
    ]),
    row("-", same("x - y"), "f f f", ARITHMETIC, &[
        all(Tie, "1 -5.9604645e-8 = 1 | 1.0000001"),
        all(Subnormal, "1.2e-38 1.19e-38 ~ 0"),
        all(Overflow, "max -max = any"),
        all(Absorption, "1 1e-20 = 1 | 0.99999994"),
        all(Zero, "-0 -0 = 0; 2.5 0 = 2.5"),
        all(Equal, "1.1 1.1 = 0"),
    ]),
    row("*", same("x * y"), "f f f", ARITHMETIC, &[
        all(Tie, "1.0000001 1.5 = 1.5000001 | 1.5000002"),
        all(Subnormal, "1e-30 1e-10 ~ 0; 1e-40 2 ~ 0; 1e-40 1e38 ~ 0.01 | 0"),
        all(Overflow, "1e20 1e20 = any; max -2 = any"),
        all(Zero, "-0 5 = 0; 0 -5 = 0"),
        all(Equal, "1.5 1.5 = 2.25"),
    ]),
    row("/", same("x / y"), "f f f", ARITHMETIC, &[
        all(Subnormal, "1e-30 1e10 ~ 0; 1 1e-40 = any"),
        all(Overflow, "1e38 1e-10 = any"),
        all(Range, "1 0 = any; 0 0 = any; 1 1e38 = any"),
        all(Zero, "0 3 = 0; -0 3 = 0"),
        all(Equal, "3.3 3.3 ~ 1"),
    ]),
    row("negate", same("-x"), "f f", ARITHMETIC, &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Overflow, "max = -max"),
        all(Zero, "0 = 0; -0 = 0"),
    ]),
    row("remainder", ["", "x % y", "fmod(x, y)"], "f f f", ["", "8.7", "intrinsic functions"], &[
        all(Subnormal, "1e-40 1 ~ 0"),
        all(Absorption, "-1e-20 3 ~ -1e-20"),
        all(Range, "5 0 = any; -5 3 ~ -2; 5 -3 ~ 2"),
        all(Zero, "0 3 = 0"),
        all(Equal, "3 3 ~ 0 | 3"),
    ]),
    row("mod", ["mod(x, y)", "", ""], "f f f", ["8.3", "", ""], &[
        all(Subnormal, "1e-40 1 ~ 0"),
        all(Absorption, "-1e-20 3 ~ 3"),
        all(Range, "5 0 = any; -5 3 ~ 1; 5 -3 ~ -1"),
        all(Zero, "0 3 = 0"),
        all(Equal, "3 3 ~ 0 | 3"),
    ]),
    // Functions of numbers.
    row("abs", same("abs(x)"), "f f", numeric("8.3"), &[
        all(Subnormal, "-1e-40 ~ 0"),
        all(Overflow, "-max = max"),
        all(Zero, "-0 = 0"),
    ]),
    row("sign", ["sign(x)", "sign(x)", ""], "f f", numeric("8.3"), &[
        all(Subnormal, "1e-40 = 1 | 0; -1e-40 = -1 | 0"),
        all(Zero, "0 = 0; -0 = 0"),
    ]),
    row("floor", same("floor(x)"), "f f", numeric("8.3"), &[
        all(Subnormal, "1e-40 = 0; -1e-40 = -1 | 0"),
        all(Absorption, "-1e-20 = -1; 0.99999994 = 0"),
        all(Zero, "-0 = 0"),
        all(Equal, "3 = 3; -3 = -3; 8388609 = 8388609"),
    ]),
    row("ceil", same("ceil(x)"), "f f", numeric("8.3"), &[
        all(Subnormal, "1e-40 = 1 | 0; -1e-40 = 0"),
        all(Absorption, "1e-20 = 1; -0.99999994 = 0"),
        all(Zero, "-0 = 0"),
        all(Equal, "3 = 3; -3 = -3; 8388609 = 8388609"),
    ]),
    row("trunc", same("trunc(x)"), "f f", numeric("8.3"), &[
        all(Subnormal, "1e-40 = 0; -1e-40 = 0"),
        all(Absorption, "0.99999994 = 0; -0.99999994 = 0"),
        all(Zero, "-0 = 0"),
        all(Equal, "3 = 3; -3 = -3; -8388609 = -8388609"),
    ]),
    row("round", ["round(x)", "", ""], "f f", ["8.3", "", ""], &[
        all(Tie, "0.5 = 0 | 1; 1.5 = 1 | 2; 2.5 = 2 | 3; -0.5 = 0 | -1; -2.5 = -2 | -3"),
        all(Subnormal, "1e-40 = 0"),
        all(Absorption, "0.49999997 = 0; 0.50000006 = 1; 8388609 = 8388609"),
        all(Zero, "-0 = 0"),
        all(Equal, "3 = 3"),
    ]),
    row("roundEven", ["roundEven(x)", "round(x)", "round(x)"], "f f", numeric("8.3"), &[
        only("GW", Tie, "0.5 = 0; 1.5 = 2; 2.5 = 2; -0.5 = 0; -2.5 = -2"),
        all(Subnormal, "1e-40 = 0"),
        all(Absorption, "0.49999997 = 0; 0.50000006 = 1; 8388609 = 8388609"),
        all(Zero, "-0 = 0"),
        all(Equal, "3 = 3"),
    ]),
    row("fract", ["fract(x)", "fract(x)", "frac(x)"], "f f", numeric("8.3"), &[
        all(Subnormal, "1e-40 ~ 0; -1e-40 ~ 1 | 0"),
        all(Absorption, "-1e-20 = 1 | 0.99999994; 8388609 = 0"),
        all(Zero, "0 = 0; -0 = 0"),
        all(Equal, "2 = 0; -2 = 0"),
    ]),
    row("min", same("min(x, y)"), "f f f", numeric("8.3"), &[
        all(Subnormal, "1e-40 0 ~ 0; 1e-40 -1 = -1"),
        all(Overflow, "max -max = -max"),
        all(Zero, "-0 0 = 0"),
        all(Equal, "2 2 = 2"),
    ]),
    row("max", same("max(x, y)"), "f f f", numeric("8.3"), &[
        all(Subnormal, "1e-40 0 ~ 0; 1e-40 1 = 1"),
        all(Overflow, "max -max = max"),
        all(Zero, "-0 0 = 0"),
        all(Equal, "2 2 = 2"),
    ]),
    row("clamp", same("clamp(x, y, z)"), "f f f f", numeric("8.3"), &[
        all(Subnormal, "1e-40 0 1 ~ 0"),
        only("GH", Range, "0.5 1 0 = any"),
        only("W", Range, "0.5 1 0 = 0 | 0.5"),
        all(Zero, "-0 0 1 = 0"),
        all(Equal, "1 2 2 = 2; 2 2 3 = 2; 3 2 3 = 3"),
    ]),
    row("saturate", ["", "saturate(x)", "saturate(x)"], "f f", ["", "17.5", "intrinsic functions"], &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Range, "1.0000001 = 1; -1 = 0; max = 1"),
        all(Zero, "-0 = 0"),
        all(Equal, "1 = 1"),
    ]),
    row("step", same("step(x, y)"), "f f f", numeric("8.3"), &[
        all(Subnormal, "1e-40 0 = 0 | 1; 0 -1e-40 = 0 | 1"),
        all(Absorption, "1 0.99999994 = 0; 0.99999994 1 = 1"),
        all(Zero, "0 -0 = 1; -0 0 = 1"),
        all(Equal, "1.5 1.5 = 1"),
    ]),
    row("mix", ["mix(x, y, z)", "mix(x, y, z)", "lerp(x, y, z)"], "f f f f", numeric("8.3"), &[
        all(Subnormal, "1e-40 1e-40 0.5 ~ 0"),
        all(Range, "0 1 2 ~ 2; 0 1 -1 ~ -1"),
        all(Zero, "3 5 0 ~ 3; 0 -0 0.5 ~ 0"),
        all(Equal, "2 2 0.25 ~ 2; 3 5 1 ~ 5"),
    ]),
    row("smoothstep", same("smoothstep(x, y, z)"), "f f f f", numeric("8.3"), &[
        all(Subnormal, "0 1 1e-40 ~ 0"),
        all(Range, "0 1 2 ~ 1; 0 1 -1 ~ 0"),
        all(Zero, "0 1 0 ~ 0"),
        all(Equal, "1 1 1 = any; 0 1 1 ~ 1"),
    ]),
    row("fma", ["fma(x, y, z)", "fma(x, y, z)", "mad(x, y, z)"], "f f f f", numeric("8.3"), &[
        all(Subnormal, "1e-30 1e-10 0 ~ 0; 1e-40 1 1 ~ 1"),
        all(Overflow, "1e20 1e20 0 = any"),
        all(Absorption, "1e-10 1e-10 1 ~ 1"),
        all(Zero, "0 5 -0 = 0"),
        all(Equal, "2 3 -6 = 0"),
    ]),
    row("sqrt", same("sqrt(x)"), "f f", ["8.2", "17.5", "intrinsic functions"], &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Overflow, "4e36 ~ 2e18"),
        all(Range, "-1 = any"),
        all(Zero, "0 ~ 0"),
        all(Equal, "1 ~ 1; 4 ~ 2"),
    ]),
    row("inversesqrt", ["inversesqrt(x)", "inverseSqrt(x)", "rsqrt(x)"], "f f", numeric("8.2"), &[
        all(Subnormal, "1e-40 = any"),
        all(Range, "-1 = any; 0 = any"),
        all(Zero, "-0 = any"),
        all(Equal, "1 ~ 1; 4 ~ 0.5"),
    ]),
    row("exp", same("exp(x)"), "f f", numeric("8.2"), &[
        all(Subnormal, "1e-40 ~ 1; -90 ~ 0"),
        all(Overflow, "89 = any"),
        all(Absorption, "1e-20 ~ 1; -200 ~ 0"),
        all(Zero, "0 ~ 1; -0 ~ 1"),
    ]),
    row("exp2", same("exp2(x)"), "f f", numeric("8.2"), &[
        all(Subnormal, "1e-40 ~ 1; -130 ~ 0"),
        all(Overflow, "128 = any"),
        all(Absorption, "1e-20 ~ 1; -300 ~ 0"),
        all(Zero, "0 ~ 1; -0 ~ 1"),
    ]),
    row("log", same("log(x)"), "f f", numeric("8.2"), &[
        all(Subnormal, "1e-40 = any"),
        all(Range, "0 = any; -1 = any"),
        all(Zero, "-0 = any"),
        all(Equal, "1 ~ 0"),
    ]),
    row("log2", same("log2(x)"), "f f", numeric("8.2"), &[
        all(Subnormal, "1e-40 = any"),
        all(Range, "0 = any; -1 = any"),
        all(Zero, "-0 = any"),
        all(Equal, "1 ~ 0; 8 ~ 3"),
    ]),
    row("pow", same("pow(x, y)"), "f f f", numeric("8.2"), &[
        all(Subnormal, "1e-40 1 = any; 2 1e-40 ~ 1"),
        all(Overflow, "10 39 = any"),
        all(Range, "-1 2 = any; 0 0 = any; 0 -1 = any"),
        all(Zero, "2 0 ~ 1; 2 -0 ~ 1"),
        all(Equal, "1 1 ~ 1; 2 2 ~ 4"),
    ]),
    row("sin", same("sin(x)"), "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Range, "max = any"),
        all(Zero, "0 ~ 0; -0 ~ 0"),
    ]),
    row("cos", same("cos(x)"), "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 ~ 1"),
        all(Range, "max = any"),
        all(Zero, "0 ~ 1; -0 ~ 1"),
    ]),
    row("tan", same("tan(x)"), "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Range, "1.5707964 = any; max = any"),
        all(Zero, "0 ~ 0; -0 ~ 0"),
    ]),
    row("asin", same("asin(x)"), "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Range, "1 ~ 1.5707964; -1 ~ -1.5707964; 1.0000001 = any; -2 = any"),
        all(Zero, "0 ~ 0; -0 ~ 0"),
    ]),
    row("acos", same("acos(x)"), "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 ~ 1.5707964"),
        all(Range, "1 ~ 0; -1 ~ 3.1415927; 1.0000001 = any; -2 = any"),
        all(Zero, "0 ~ 1.5707964; -0 ~ 1.5707964"),
    ]),
    row("atan", same("atan(x)"), "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Overflow, "max ~ 1.5707964; -max ~ -1.5707964"),
        all(Zero, "0 ~ 0; -0 ~ 0"),
    ]),
    row("atan2", ["atan(x, y)", "atan2(x, y)", "atan2(x, y)"], "f f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 1 ~ 0; 1e-40 1e-40 = any"),
        all(Range, "0 0 = any; 1 0 ~ 1.5707964; -1 0 ~ -1.5707964"),
        all(Zero, "0 1 ~ 0; -0 1 ~ 0; 0 -1 ~ 3.1415927 | -3.1415927"),
        all(Equal, "2 2 ~ 0.7853982; -2 -2 ~ -2.3561945"),
    ]),
    row("sinh", same("sinh(x)"), "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Overflow, "90 = any"),
        all(Zero, "0 ~ 0; -0 ~ 0"),
    ]),
    row("cosh", same("cosh(x)"), "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 ~ 1"),
        all(Overflow, "90 = any"),
        all(Zero, "0 ~ 1; -0 ~ 1"),
    ]),
    row("tanh", same("tanh(x)"), "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Overflow, "100 = any; 5 ~ 0.9999092"),
        all(Zero, "0 ~ 0; -0 ~ 0"),
    ]),
    row("asinh", ["asinh(x)", "asinh(x)", ""], "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Zero, "0 ~ 0; -0 ~ 0"),
    ]),
    row("acosh", ["acosh(x)", "acosh(x)", ""], "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 = any"),
        all(Range, "0.5 = any; -2 = any"),
        all(Zero, "0 = any"),
    ]),
    row("atanh", ["atanh(x)", "atanh(x)", ""], "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Range, "1 = any; -1 = any; 2 = any"),
        all(Zero, "0 ~ 0; -0 ~ 0"),
    ]),
    row("radians", same("radians(x)"), "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Zero, "0 ~ 0; -0 ~ 0"),
    ]),
    row("degrees", same("degrees(x)"), "f f", numeric("8.1"), &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Overflow, "max = any"),
        all(Zero, "0 ~ 0; -0 ~ 0"),
    ]),
    row("ldexp", ["ldexp(x, y)", "ldexp(x, y)", ""], "f f i", numeric("8.3"), &[
        all(Subnormal, "1 -140 ~ 0; 1e-40 1 ~ 0"),
        all(Overflow, "1 128 = any; max 1 = any"),
        all(Zero, "0 5 = 0; -0 5 = 0; 1.5 0 = 1.5"),
        all(Equal, "1 126 = 8.507059e37; 1 -100 = 7.888609e-31"),
    ]),
    row("fraction of modf", ["", "modf(x).fract", ""], "f f", ["8.3", "17.5", ""], &[
        all(Subnormal, "1e-40 ~ 0"),
        all(Absorption, "-1e-20 ~ -1e-20"),
        all(Zero, "0 = 0; -0 = 0"),
        all(Equal, "-2 = 0"),
    ]),
    row("whole of modf", ["", "modf(x).whole", ""], "f f", ["8.3", "17.5", ""], &[
        all(Subnormal, "1e-40 = 0"),
        all(Absorption, "-1e-20 = 0; 0.99999994 = 0"),
        all(Zero, "0 = 0; -0 = 0"),
        all(Equal, "-2 = -2"),
    ]),
    row("fraction of frexp", ["", "frexp(x).fract", ""], "f f", ["8.3", "17.5", ""], &[
        all(Subnormal, "1e-40 = any"),
        all(Zero, "0 = 0; -0 = 0"),
        all(Equal, "1 = 0.5; 0.99999994 = 0.99999994"),
    ]),
    row("exponent of frexp", ["", "frexp(x).exp", ""], "i f", ["8.3", "17.5", ""], &[
        all(Subnormal, "1e-40 = any"),
        all(Zero, "0 = 0; -0 = 0"),
        all(Equal, "1 = 1; 0.99999994 = 0"),
    ]),
    row("isnan", ["isnan(x)", "", "isnan(x)"], "b f", ["8.3", "", "intrinsic functions"], &[
        all(Subnormal, "1e-40 = false"),
        all(Overflow, "max = false"),
        all(Zero, "-0 = false"),
    ]),
    row("isinf", ["isinf(x)", "", "isinf(x)"], "b f", ["8.3", "", "intrinsic functions"], &[
        all(Subnormal, "1e-40 = false"),
        all(Overflow, "max = false"),
        all(Zero, "-0 = false"),
    ]),
    row("quantizeToF16", ["", "quantizeToF16(x)", ""], "f f", ["", "17.5", ""], &[
        all(Tie, "1.00048828125 = 1 | 1.0009766"),
        all(Subnormal, "1e-40 ~ 0"),
        all(SubnormalHalf, "5.9604645e-8 ~ 0; 1e-7 ~ 0; 3e-8 ~ 0; 6.1035156e-5 ~ 6.1035156e-5"),
        all(Overflow, "65536 = any; 65504 = 65504"),
        all(Zero, "0 = 0; -0 = 0"),
        all(Equal, "1.5 = 1.5"),
    ]),
    // Comparisons.
    row("<", same("x < y"), "b f f", COMPARISON, &[
        all(Subnormal, "0 1e-40 = true | false; 1e-40 1 = true"),
        all(Absorption, "0.99999994 1 = true"),
        all(Zero, "-0 0 = false"),
        all(Equal, "1.5 1.5 = false"),
    ]),
    row("<=", same("x <= y"), "b f f", COMPARISON, &[
        all(Subnormal, "1e-40 0 = true | false"),
        all(Absorption, "1 0.99999994 = false"),
        all(Zero, "0 -0 = true"),
        all(Equal, "1.5 1.5 = true"),
    ]),
    row(">", same("x > y"), "b f f", COMPARISON, &[
        all(Subnormal, "1e-40 0 = true | false"),
        all(Zero, "0 -0 = false"),
        all(Equal, "1.5 1.5 = false"),
    ]),
    row(">=", same("x >= y"), "b f f", COMPARISON, &[
        all(Subnormal, "0 1e-40 = true | false"),
        all(Zero, "-0 0 = true"),
        all(Equal, "1.5 1.5 = true"),
    ]),
    row("==", same("x == y"), "b f f", COMPARISON, &[
        all(Subnormal, "0 1e-40 = true | false"),
        all(Absorption, "1 0.99999994 = false"),
        all(Zero, "-0 0 = true"),
        all(Equal, "1.5 1.5 = true"),
    ]),
    row("!=", same("x != y"), "b f f", COMPARISON, &[
        all(Subnormal, "0 1e-40 = true | false"),
        all(Zero, "-0 0 = false"),
        all(Equal, "1.5 1.5 = false"),
    ]),
    row("select", ["mix(x, y, z)", "select(x, y, z)", "z ? y : x"], "f f f b", numeric("8.3"), &[
        all(Subnormal, "1e-40 1 false ~ 0"),
        all(NotANumber, "nan 1 true = 1; 1 nan false = 1; nan 1 false = any"),
        all(Infinity, "inf 1 true = 1; 1 -inf false = 1; inf 1 false = any"),
        all(Zero, "0 3 false = 0; -0 3 true = 3"),
        all(Equal, "2 2 true = 2"),
    ]),
];
