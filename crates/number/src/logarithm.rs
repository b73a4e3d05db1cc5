//! Logarithms.

use super::dispatch::OfOne;
use super::double::{from_integer, upper};
use super::series::{odd_reciprocals, polynomial};

/// ln 2 in two parts; the first has 32 bits.
pub(super) const LN_2_PARTS: (f64, f64) =
    (f64::from_bits(0x3fe6_2e42_fee0_0000), f64::from_bits(0x3dea_39ef_3579_3c76));
/// 1/ln 2 in two parts; the first has 21 bits.
pub(super) const PER_LN_2: (f64, f64) = (f64::from_bits(0x3ff7_1547_0000_0000), f64::from_bits(0x3e99_4ae0_bf85_ddf4));

/// ln((1 + s)/(1 − s)) = 2s + s·z·(…) with z = s², |s| ≤ 3 − √8: the first term left out is 2^-60.
const SERIES: [f64; 10] = odd_reciprocals(3, 2.0, 1.0);

/// x = m·2^e with √½ ≤ m < √2, for a finite x > 0; anything for others.
#[inline(always)]
pub(super) fn parts(x: f64) -> (f64, f64) {
    /// √½, a little above.
    const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    let subnormal = x < f64::MIN_POSITIVE;
    let x = if subnormal { x * 18_014_398_509_481_984.0 } else { x };
    let bias = if subnormal { 1023.0 + 54.0 } else { 1023.0 };
    // Counted from √½ the exponent changes where m does.
    let bits = x.to_bits().wrapping_add(ONE - ROOT_HALF);
    let m = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) + ROOT_HALF);
    (m, from_integer(bits >> 52) - bias)
}

/// The values at the ends of the domain and outside.
#[inline(always)]
fn within_domain(x: f64, value: f64) -> f64 {
    let edge = if x == 0.0 { f64::NEG_INFINITY } else { f64::NAN };
    let edge = if x == f64::INFINITY || x.is_nan() { x } else { edge };
    if x > 0.0 && x < f64::INFINITY { value } else { edge }
}

/// f, f²/2 and the rest of ln(1 + f) = f − f²/2 + rest, for m = 1 + f.
#[inline(always)]
fn expanded(m: f64) -> (f64, f64, f64) {
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let half_square = 0.5 * f * f;
    (f, half_square, s * (half_square + z * polynomial(z, &SERIES)))
}

pub(super) struct Natural;

impl OfOne for Natural {
    #[inline(always)]
    fn common(x: f64) -> f64 {
        let (m, e) = parts(x);
        let (f, half_square, rest) = expanded(m);
        let value = e * LN_2_PARTS.0 - ((half_square - (rest + e * LN_2_PARTS.1)) - f);
        within_domain(x, value)
    }
}

pub(super) struct BaseTwo;

impl OfOne for BaseTwo {
    #[inline(always)]
    fn common(x: f64) -> f64 {
        let (m, e) = parts(x);
        let (f, half_square, rest) = expanded(m);
        // ln m in two parts; the first times the first part of 1/ln 2 is exact.
        let high = upper(f - half_square);
        let low = ((f - high) - half_square) + rest;
        let main = high * PER_LN_2.0;
        let small = (low + high) * PER_LN_2.1 + low * PER_LN_2.0;
        let sum = e + main;
        within_domain(x, sum + (small + ((e - sum) + main)))
    }
}
