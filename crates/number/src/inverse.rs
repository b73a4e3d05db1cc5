//! Inverse trigonometric functions.

use std::f64::consts::PI;

use super::dispatch::{OfOne, OfTwo};
use super::double::{sum, upper};
use super::reduction::HALF_PI;
use super::series::{arcsine, odd_reciprocals, polynomial};

/// π in two parts.
const WHOLE_PI: (f64, f64) = (PI, 2.0 * HALF_PI.1);

/// arcsin x = x + x³·(…) for x² ≤ ¼: the first term left out is 2^-60 of the value.
const ARCSINE: [f64; 25] = arcsine();
/// arctan t = t + t³·(…) for |t| ≤ ¼: the first term left out is 2^-60 of the value.
const ARCTANGENT: [f64; 13] = odd_reciprocals(3, -1.0, -1.0);
/// arctan ½ in two parts.
pub(super) const ARCTAN_HALF: (f64, f64) =
    (f64::from_bits(0x3fdd_ac67_0561_bb4f), f64::from_bits(0x3c7a_2b7f_222f_65e2));

/// base + sign·arctan(a/b) for 0 ≤ a ≤ b; the base, in two parts, is 0 or at least π/2.
#[inline(always)]
fn arctangent(a: f64, b: f64, base: (f64, f64), sign: f64) -> f64 {
    // arctan(a/b) = arctan c + arctan((a − cb)/(b + ca)) with c = 0, ½ or 1: cb is exact.
    let (flat, even) = (a < 0.25 * b, a > 0.75 * b);
    let c = if flat { 0.0 } else { 0.5 };
    let c = if even { 1.0 } else { c };
    let known = if flat { (0.0, 0.0) } else { ARCTAN_HALF };
    let known = if even { (0.5 * HALF_PI.0, 0.5 * HALF_PI.1) } else { known };
    let t = sign * ((a - c * b) / (b + c * a));
    let z = t * t;
    let (high, low) = sum(base.0, sign * known.0);
    let low = low + (sign * known.1 + base.1);
    high + (t + (t * z * polynomial(z, &ARCTANGENT) + low))
}

pub(super) struct Arctangent;

impl OfOne for Arctangent {
    #[inline(always)]
    fn common(x: f64) -> f64 {
        /// The values from here on round to π/2.
        const FAR: f64 = (1_u128 << 70) as f64;
        let size = if x.abs() < FAR { x.abs() } else { FAR };
        let steep = size > 1.0;
        let (a, b) = if steep { (1.0, size) } else { (size, 1.0) };
        let base = if steep { HALF_PI } else { (0.0, 0.0) };
        let value = arctangent(a, b, base, if steep { -1.0 } else { 1.0 });
        if x.is_nan() { x } else { value.copysign(x) }
    }
}

pub(super) struct Angle;

impl OfTwo for Angle {
    #[inline(always)]
    fn common(y: f64, x: f64) -> f64 {
        let (height, width) = (y.abs(), x.abs());
        let steep = height > width;
        let (a, b) = if steep { (width, height) } else { (height, width) };
        // Infinities and zeros have the angles of finite points.
        let endless = b == f64::INFINITY;
        let a = if endless { if a == b { 1.0 } else { 0.0 } } else { a };
        let b = if endless || b == 0.0 { 1.0 } else { b };
        // Sums of the largest numbers must not overflow, nor products of the smallest lose bits.
        let scale = if b > 2e300 { 0.0625 } else { 1.0 };
        let scale = if b < 1e-270 { 1_267_650_600_228_229_401_496_703_205_376.0 } else { scale };
        let (a, b) = (a * scale, b * scale);
        let left = x.is_sign_negative();
        let base = if steep { HALF_PI } else { WHOLE_PI };
        let base = if steep || left { base } else { (0.0, 0.0) };
        let value = arctangent(a, b, base, if steep == left { 1.0 } else { -1.0 });
        let value = value.copysign(y);
        let value = if x.is_nan() { x } else { value };
        if y.is_nan() { y } else { value }
    }
}

/// arcsin s for s = |x| ≤ ½ as s + rest, or for s = √((1 − |x|)/2) as s + s_low + rest:
/// (s, s_low, rest).
#[inline(always)]
fn half_angle(x: f64) -> (f64, f64, f64) {
    let size = x.abs();
    let inner = size < 0.5;
    let z = if inner { size * size } else { 0.5 * (1.0 - size) };
    let root = z.sqrt();
    let s = if inner { size } else { root };
    let rest = s * z * polynomial(z, &ARCSINE);
    // √z with more bits than the root has.
    let high = upper(root);
    let low = (z - high * high) / (root + high);
    let low = if root == 0.0 { 0.0 } else { low };
    if inner { (size, 0.0, rest) } else { (high, low, rest) }
}

pub(super) struct Arcsine;

impl OfOne for Arcsine {
    #[inline(always)]
    fn common(x: f64) -> f64 {
        let (s, low, rest) = half_angle(x);
        // π/2 − 2·arcsin s
        let outer = (HALF_PI.0 - 2.0 * s) - (2.0 * (low + rest) - HALF_PI.1);
        let value = if x.abs() < 0.5 { s + rest } else { outer };
        if x.is_nan() { x } else { value.copysign(x) }
    }
}

pub(super) struct Arccosine;

impl OfOne for Arccosine {
    #[inline(always)]
    fn common(x: f64) -> f64 {
        let (s, low, rest) = half_angle(x);
        let inner = HALF_PI.0 - (x - (HALF_PI.1 - rest.copysign(x)));
        let right = 2.0 * (s + (low + rest));
        let left = (WHOLE_PI.0 - 2.0 * s) - (2.0 * (low + rest) - WHOLE_PI.1);
        let outer = if x > 0.0 { right } else { left };
        let value = if x.abs() < 0.5 { inner } else { outer };
        if x.is_nan() { x } else { value }
    }
}
