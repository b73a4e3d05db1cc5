//! Vectors and matrices.

use super::super::Corner::*;
use super::super::Row;
use super::{ARITHMETIC, GEOMETRY, all, row, same};

#[rustfmt::skip]
pub(super) static ROWS: &[Row] = &[
    // Vectors and matrices.
    row("dot", same("dot(x, y)"), "f f2 f2", GEOMETRY, &[
        all(Subnormal, "1e-30 0 1e-10 0 ~ 0"),
        all(Overflow, "1e20 0 1e20 0 = any"),
        all(Zero, "0 0 1 1 = 0"),
        all(Equal, "1 2 1 2 ~ 5; 1 1 1 -1 ~ 0"),
    ]),
    row("length", same("length(x)"), "f f2", GEOMETRY, &[
        all(Subnormal, "1e-40 0 ~ 0; 1e-25 0 ~ 0"),
        all(Overflow, "1e20 0 = any"),
        all(Equal, "3 4 ~ 5"),
        all(Zero, "0 0 ~ 0"),
    ]),
    row("distance", same("distance(x, y)"), "f f2 f2", GEOMETRY, &[
        all(Subnormal, "1e-40 0 0 0 ~ 0"),
        all(Overflow, "1e20 0 0 0 = any"),
        all(Zero, "0 0 3 4 ~ 5"),
        all(Equal, "1 2 1 2 ~ 0"),
    ]),
    row("normalize", ["normalize(x).x", "normalize(x).x", "normalize(x).x"], "f f2", GEOMETRY, &[
        all(Subnormal, "1e-40 0 = any"),
        all(Overflow, "1e20 0 = any"),
        all(Range, "0 0 = any"),
        all(Zero, "0 2 ~ 0"),
        all(Equal, "3 4 ~ 0.6"),
    ]),
    row("cross", same("cross(x, y).z"), "f f3 f3", GEOMETRY, &[
        all(Subnormal, "1e-30 0 0 0 1e-10 0 ~ 0"),
        all(Overflow, "1e20 0 0 0 1e20 0 = any"),
        all(Zero, "0 0 0 1 1 1 = 0"),
        all(Equal, "1 0 0 0 1 0 ~ 1; 1 2 3 1 2 3 ~ 0"),
    ]),
    row("faceforward", ["faceforward(x, y, z).x", "faceForward(x, y, z).x", "faceforward(x, y, z).x"], "f f2 f2 f2", GEOMETRY, &[
        all(Subnormal, "1 0 1e-40 0 1 0 ~ -1 | 1"),
        all(Overflow, "1 0 1e20 0 1e20 0 = -1 | 1"),
        all(NotANumber, "1 0 nan 0 1 0 = -1 | 1; 1 0 1 0 nan 0 = -1 | 1; nan 0 1 0 1 0 = any"),
        all(Infinity, "1 0 inf 0 1 0 = -1 | 1; 1 0 1 0 inf 0 = -1 | 1; inf 0 1 0 1 0 = any"),
        all(Zero, "1 0 0 0 1 1 = -1"),
        all(Equal, "1 0 -1 0 1 0 = 1; 1 0 1 0 1 0 = -1"),
    ]),
    row("reflect", same("reflect(x, y).x"), "f f2 f2", GEOMETRY, &[
        all(Subnormal, "1e-40 0 0 1 ~ 0"),
        all(Overflow, "1e20 0 1e20 0 = any"),
        all(Zero, "0 0 1 0 ~ 0"),
        all(Equal, "1 0 1 0 ~ -1"),
    ]),
    row("refract", same("refract(x, y, z).x"), "f f2 f2 f", GEOMETRY, &[
        all(Subnormal, "1e-40 1 0 -1 1 ~ 0"),
        all(Range, "0.9 -0.43588989 0 1 4 = 0"),
        all(Zero, "0 -1 0 1 0.5 ~ 0"),
        all(Equal, "0.6 -0.8 0 1 1 ~ 0.6"),
    ]),
    row("determinant", ["determinant(mat2(x, y))", "determinant(mat2x2f(x, y))", "determinant(float2x2(x, y))"], "f f2 f2", ["8.6", "17.6", "intrinsic functions"], &[
        all(Subnormal, "1e-30 0 0 1e-10 = any"),
        all(Overflow, "1e20 0 0 1e20 = any"),
        all(Zero, "0 0 0 0 = any"),
        all(Equal, "1 2 1 2 = any; 2 0 0 2 = any"),
    ]),
    row("inverse", ["inverse(mat2(x, y))[0].x", "", ""], "f f2 f2", ["8.6", "", ""], &[
        all(Subnormal, "1e-30 0 0 1e-10 = any"),
        all(Range, "1 2 1 2 = any"),
        all(Zero, "0 0 0 0 = any"),
        all(Equal, "2 0 0 2 = any"),
    ]),
    row("matrix * vector", ["(mat2(x, y) * z).x", "(mat2x2f(x, y) * z).x", "mul(z, float2x2(x, y)).x"], "f f2 f2 f2", ARITHMETIC, &[
        all(Subnormal, "1e-30 0 0 1 1e-10 0 ~ 0"),
        all(Overflow, "1e20 0 0 1 1e20 0 = any"),
        all(Zero, "0 0 0 0 1 1 = 0"),
        all(Equal, "1 0 0 1 3 4 ~ 3"),
    ]),
];
