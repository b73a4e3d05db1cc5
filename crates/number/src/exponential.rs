//! Exponential functions.

use std::f64::consts::{LN_2, LOG2_E};

use super::dispatch::OfOne;
use super::double::{TO_INTEGER, nearest};
use super::logarithm::LN_2_PARTS;
use super::series::{factorials, polynomial};

/// e^r = 1 + r + r²·(…) for |r| ≤ ½·ln 2: the first term left out is 2^-57 of the value.
const SERIES: [f64; 12] = factorials(2, 1, 1.0);

/// e^(r + tail).
#[inline(always)]
fn near_zero(r: f64, tail: f64) -> f64 {
    1.0 + (r + (tail + r * r * polynomial(r, &SERIES)))
}

/// x·2^n for an integer |n| ≤ 1100, rounded once.
#[inline(always)]
fn scaled(x: f64, n: f64) -> f64 {
    // The bits of an integer plus the bias, moved to where the exponent is.
    let power = |n: f64| f64::from_bits((n + (TO_INTEGER + 1023.0)).to_bits() << 52);
    let (half, _) = nearest(0.5 * n);
    x * power(half) * power(n - half)
}

/// 2^(x + tail), |x| ≤ 1100.
#[inline(always)]
pub(super) fn power_of_two(x: f64, tail: f64) -> f64 {
    let (n, _) = nearest(x);
    scaled(near_zero(((x - n) + tail) * LN_2, 0.0), n)
}

/// `x` moved into [lo, hi]; NaN stays.
#[inline(always)]
pub(super) fn clamped(x: f64, lo: f64, hi: f64) -> f64 {
    let x = if x < lo { lo } else { x };
    if x > hi { hi } else { x }
}

pub(super) struct Exponential;

impl OfOne for Exponential {
    #[inline(always)]
    fn common(x: f64) -> f64 {
        // Beyond these the result is 0 or infinite.
        let clamped = clamped(x, -760.0, 720.0);
        let (n, _) = nearest(clamped * LOG2_E);
        let (high, low) = (clamped - n * LN_2_PARTS.0, n * LN_2_PARTS.1);
        let r = high - low;
        let value = scaled(near_zero(r, (high - r) - low), n);
        if x.is_nan() { x } else { value }
    }
}

pub(super) struct PowerOfTwo;

impl OfOne for PowerOfTwo {
    #[inline(always)]
    fn common(x: f64) -> f64 {
        let value = power_of_two(clamped(x, -1100.0, 1100.0), 0.0);
        if x.is_nan() { x } else { value }
    }
}
