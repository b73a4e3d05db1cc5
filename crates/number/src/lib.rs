//! Functions of real numbers on columns: binary64, a slice at a time.
//!
//! | Function | Error in ULP, at most |
//! |---|---|
//! | `asin` | 0.6 |
//! | `log2` | 0.65 |
//! | `acos` | 0.7 |
//! | `sin`, `cos` | 0.75 |
//! | `ln` | 0.8 |
//! | `exp` | 0.85 |
//! | `exp2` | 1.0 |
//! | `pow` | 1.1 |
//! | `atan`, `atan2` | 1.4 |
//! | `tan` | 1.9 |
//!
//! The tests hold thousands of arguments of all binades against numbers of 192 bits, those next to
//! multiples of π/2 and to 1 among them; they fail as well when an error is much less than stated.
//!
//! Each number goes through the same operations, additions and multiplications of binary64 without a
//! fused one, so that the bits are the same on every machine and for every width of its vectors; the
//! width is chosen when the program runs. [`Unary::value`] gives the bits of [`Unary::column`]. The
//! special cases of [`POW`] come from the standard library, where their values are exact.
//!
//! Coefficients are those of Taylor series, computed by the compiler: a few terms more than a minimax
//! polynomial has, and none that must be believed. Constants in two parts are tested.

mod dispatch;
mod double;
mod exponential;
pub mod half;
mod inverse;
pub mod linear;
mod logarithm;
mod power;
mod reduction;
mod series;
mod trigonometric;
pub mod twofold;

pub use dispatch::{Binary, Unary, Wide, count_above, map, map_pairs, run_wide, wide};

/// sin x, x in radians; NaN for infinities.
pub const SIN: Unary = Unary::of::<trigonometric::Sine>();
/// cos x.
pub const COS: Unary = Unary::of::<trigonometric::Cosine>();
/// tan x.
pub const TAN: Unary = Unary::of::<trigonometric::Tangent>();
/// arcsin x in [−π/2, π/2]; NaN for |x| > 1.
pub const ASIN: Unary = Unary::of::<inverse::Arcsine>();
/// arccos x in [0, π]; NaN for |x| > 1.
pub const ACOS: Unary = Unary::of::<inverse::Arccosine>();
/// arctan x in [−π/2, π/2].
pub const ATAN: Unary = Unary::of::<inverse::Arctangent>();
/// The angle of the point (second, first) in [−π, π], as `f64::atan2`.
pub const ATAN2: Binary = Binary::of::<inverse::Angle>();
/// e^x.
pub const EXP: Unary = Unary::of::<exponential::Exponential>();
/// 2^x.
pub const EXP2: Unary = Unary::of::<exponential::PowerOfTwo>();
/// ln x; −∞ for zeros, NaN for x < 0.
pub const LN: Unary = Unary::of::<logarithm::Natural>();
/// log2 x; −∞ for zeros, NaN for x < 0.
pub const LOG2: Unary = Unary::of::<logarithm::BaseTwo>();
/// a^b as the shading languages define it: NaN for a < 0, and otherwise as `f64::powf`.
pub const POW: Binary = Binary::of::<power::Power>();

/// From here on, [`exp_m1`] is computed in two parts.
const SHORT: f64 = 1.0 / 128.0;

/// e^x − 1, with an error of at most 2 ULP.
pub fn exp_m1(x: f64) -> f64 {
    if x.abs() < SHORT { short_exp_m1(x) } else { twofold::exp_m1(x) }
}

#[inline(always)]
fn short_exp_m1(x: f64) -> f64 {
    // What is left out is below 2^-60 of the value.
    let series = (2..=9).rev().fold(1.0, |sum, k| 1.0 + x / f64::from(k) * sum);
    x * series
}

/// [`exp_m1`] of all numbers of a column, with the same bits.
pub fn exp_m1_all(column: &mut [f64]) {
    for block in column.chunks_mut(64) {
        let (mut short, mut long) = ([0.0; 64], 0_u64);
        wide(|| {
            for (short, &x) in short.iter_mut().zip(block.iter()) {
                long |= u64::from(!(x.abs() < SHORT));
                *short = short_exp_m1(x);
            }
        });
        if long == 0 {
            block.copy_from_slice(&short[..block.len()]);
        } else {
            block.iter_mut().for_each(|x| *x = exp_m1(*x));
        }
    }
}

#[cfg(test)]
mod tests;
