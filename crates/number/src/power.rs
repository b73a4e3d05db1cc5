//! Powers: 2^(b·log2 a), the logarithm and the product in two parts.

use super::dispatch::OfTwo;
use super::double::{product, sum};
use super::exponential::{clamped, power_of_two};
use super::logarithm::parts;
use super::series::{odd_reciprocals, polynomial};

/// ⅓ in two parts.
pub(super) const THIRD: (f64, f64) = (1.0 / 3.0, 1.0 / 3.0 / 18_014_398_509_481_984.0);
/// 2/ln 2 in two parts.
pub(super) const TWO_PER_LN_2: (f64, f64) =
    (f64::from_bits(0x4007_1547_652b_82fe), f64::from_bits(0x3c87_77d0_ffda_0d24));

/// artanh s = s·(1 + z/3 + z²·(…)) with z = s², |s| ≤ 3 − √8: the first term left out is 2^-71.
const SERIES: [f64; 11] = odd_reciprocals(5, 1.0, 1.0);

/// log2 of a finite a > 0 in two parts, with an error of about 2^-64 of it.
#[inline(always)]
fn logarithm(a: f64) -> (f64, f64) {
    let (m, e) = parts(a);
    // s = (m − 1)/(m + 1)
    let f = m - 1.0;
    let below = m + 1.0;
    let below_low = m - (below - 1.0);
    let reciprocal = 1.0 / below;
    let s = f * reciprocal;
    let (back, back_low) = product(s, below);
    let s_low = (((f - back) - back_low) - s * below_low) * reciprocal;
    let (z, z_low) = product(s, s);
    let z_low = z_low + 2.0 * s * s_low;
    // q = z/3 + z²·(…)
    let (third, third_low) = product(z, THIRD.0);
    let (q, q_low) = sum(third, z * z * polynomial(z, &SERIES));
    let q_low = q_low + (third_low + (z * THIRD.1 + z_low * THIRD.0));
    // s + s·q
    let (v, v_low) = product(s, q);
    let (w, w_low) = sum(s, v);
    let w_low = w_low + ((v_low + (s * q_low + s_low * q)) + s_low);
    let (log, log_low) = product(w, TWO_PER_LN_2.0);
    let log_low = log_low + (w * TWO_PER_LN_2.1 + w_low * TWO_PER_LN_2.0);
    let (high, low) = sum(e, log);
    (high, low + log_low)
}

pub(super) struct Power;

impl OfTwo for Power {
    #[inline(always)]
    fn common(a: f64, b: f64) -> f64 {
        /// Any exponent beyond has the result of this one: 0, 1 or infinity.
        const FAR: f64 = (1_u128 << 70) as f64;
        let (log, log_low) = logarithm(a);
        let b = clamped(b, -FAR, FAR);
        let (exponent, low) = product(b, log);
        let low = low + b * log_low;
        let inside = exponent.abs() <= 1100.0;
        power_of_two(clamped(exponent, -1100.0, 1100.0), if inside { low } else { 0.0 })
    }

    #[inline(always)]
    fn is_rare(a: f64, b: f64) -> bool {
        !(a > 0.0 && a < f64::INFINITY && b.abs() < f64::INFINITY)
    }

    /// Zeros, infinities and NaN, for which the standard library is exact; nothing for negative a.
    fn rare(a: f64, b: f64) -> f64 {
        if a < 0.0 { f64::NAN } else { a.powf(b) }
    }
}
