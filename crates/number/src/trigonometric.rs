//! Sine, cosine and tangent.

use super::dispatch::OfOne;
use super::reduction::{self, LIMIT, Reduced};
use super::series::{factorials, polynomial};

/// sin r = r − r³·(…): the first term left out is 2^-63 of the value.
const SINE: [f64; 8] = factorials(3, 2, -1.0);
/// cos r = 1 − r²/2 + r⁴·(…): the first term left out is 2^-58 of the value.
const COSINE: [f64; 7] = factorials(4, 2, -1.0);

/// Below this, sin x = tan x = x in binary64.
const TINY: f64 = 1.0 / 134_217_728.0;

/// sin and cos of r + tail.
#[inline(always)]
fn sine_cosine(angle: Reduced) -> (f64, f64) {
    let Reduced { r, tail, .. } = angle;
    let z = r * r;
    let half = 0.5 * z;
    let sine = r + (tail * (1.0 - half) - r * z * polynomial(z, &SINE));
    let near = 1.0 - half;
    let cosine = near + (((1.0 - near) - half) + (z * z * polynomial(z, &COSINE) - r * tail));
    (sine, cosine)
}

/// sin of an angle with `more` quarters added.
#[inline(always)]
fn sine_of(angle: Reduced, more: u64) -> f64 {
    let (sine, cosine) = sine_cosine(angle);
    let quarters = angle.quarters.wrapping_add(more);
    let value = if quarters & 1 == 0 { sine } else { cosine };
    f64::from_bits(value.to_bits() ^ (quarters & 2) << 62)
}

#[inline(always)]
fn tangent_of(angle: Reduced) -> f64 {
    let (sine, cosine) = sine_cosine(angle);
    let even = angle.quarters & 1 == 0;
    let (above, below) = if even { (sine, cosine) } else { (-cosine, sine) };
    above / below
}

/// The argument itself where it is tiny, −0 or NaN.
#[inline(always)]
fn unless_tiny(x: f64, value: f64) -> f64 {
    if x.abs() >= TINY { value } else { x }
}

/// A function of an angle.
trait OfAngle: 'static {
    /// The value at a reduced angle.
    fn at(angle: Reduced) -> f64;

    /// The value at `x`, unless it is large, from that at the reduced angle.
    fn adjusted(x: f64, value: f64) -> f64;
}

impl<F: OfAngle> OfOne for F {
    #[inline(always)]
    fn common(x: f64) -> f64 {
        F::adjusted(x, F::at(reduction::small(x)))
    }

    #[inline(always)]
    fn is_rare(x: f64) -> bool {
        x.abs() > LIMIT && x.abs() < f64::INFINITY
    }

    fn rare(x: f64) -> f64 {
        F::at(reduction::large(x, &reduction::window(x)))
    }

    #[inline(always)]
    fn rare_block(x: &[f64], out: &mut [f64]) {
        let exponent = |x: f64| x.to_bits() & 0x7ff0_0000_0000_0000;
        // A sweep has all numbers of a block in one binade, and that vectorises.
        let first = x.first().copied().unwrap_or_default();
        if Self::is_rare(first) && x.iter().all(|x| exponent(*x) == exponent(first)) {
            let window = reduction::window(first);
            for (out, &x) in out.iter_mut().zip(x) {
                *out = F::at(reduction::large(x, &window));
            }
        } else {
            for (out, &x) in out.iter_mut().zip(x).filter(|(_, x)| Self::is_rare(**x)) {
                *out = Self::rare(x);
            }
        }
    }
}

pub(super) struct Sine;

impl OfAngle for Sine {
    #[inline(always)]
    fn at(angle: Reduced) -> f64 {
        sine_of(angle, 0)
    }
    #[inline(always)]
    fn adjusted(x: f64, value: f64) -> f64 {
        unless_tiny(x, value)
    }
}

pub(super) struct Cosine;

impl OfAngle for Cosine {
    #[inline(always)]
    fn at(angle: Reduced) -> f64 {
        sine_of(angle, 1)
    }
    #[inline(always)]
    fn adjusted(x: f64, value: f64) -> f64 {
        if x.is_nan() { x } else { value }
    }
}

pub(super) struct Tangent;

impl OfAngle for Tangent {
    #[inline(always)]
    fn at(angle: Reduced) -> f64 {
        tangent_of(angle)
    }
    #[inline(always)]
    fn adjusted(x: f64, value: f64) -> f64 {
        unless_tiny(x, value)
    }
}
