//! The quick phase of formulas: values with a bound of their error, in fewer operations than [`Exact`] takes. Where
//! every number within the bound is rounded to the same, the value is that of the accurate phase; the rest is left
//! to that, so that the quick phase changes no bit.
//!
//! A. Ziv, Fast evaluation of elementary mathematical functions with correctly rounded last bit, ACM TOMS 17
//! (1991), has the test for functions of one number.
//!
//! A quick phase is worth its lines where a formula takes much of the time: the sphere, and blending with eight
//! bones.

mod skinning;
mod sphere;
#[cfg(test)]
mod tests;

use super::Exact;
use number::twofold::{WIDTH, all_bits, to_odd, two_product};

/// Words of the outputs of formulas that have a quick phase.
pub const WORDS: usize = 4;

/// A formula with a quick phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quick {
    /// Section 9.1, the sphere.
    Sphere,
    /// (76), (79), (80), (81)
    Skinning,
}

/// Inputs of samples of one case, by the place of their words in the list of the formula. Words of samples are in
/// `own` alone, and words that the case has in `case` alone.
#[derive(Clone, Debug, Default)]
pub struct Given {
    /// Words of the samples.
    pub own: Vec<[f64; WIDTH]>,
    /// Words of their case.
    pub case: Vec<f64>,
}

/// What the quick phase finds.
#[derive(Clone, Debug)]
pub struct Near {
    /// Values, rounded to binary64.
    high: [[f64; WIDTH]; WORDS],
    /// What rounding left.
    low: [[f64; WIDTH]; WORDS],
    /// How far the sum of both may be off, in every word.
    off: [f64; WIDTH],
    /// All bits where the values, and the marks, are certain to be those of the accurate phase.
    pub sure: [u64; WIDTH],
    /// All bits where the nearest point of a segment is one of its ends.
    pub segment_end: [u64; WIDTH],
    /// All bits where a segment has the length 0.
    pub degenerate: [u64; WIDTH],
}

impl Default for Near {
    fn default() -> Self {
        let (none, zero) = ([0; WIDTH], [0.0; WIDTH]);
        let words = [zero; WORDS];
        Self { high: words, low: words, off: zero, sure: none, segment_end: none, degenerate: none }
    }
}

impl Quick {
    /// The quick phase of a formula where these of its inputs are those of a case.
    pub fn of(exact: Exact, from_case: impl Iterator<Item = bool>) -> Option<Self> {
        let (quick, own) = match exact {
            Exact::Sphere => (Self::Sphere, sphere::OWN),
            Exact::Skinning => (Self::Skinning, skinning::OWN),
            _ => return None,
        };
        from_case.enumerate().all(|(index, from_case)| from_case == (index >= own)).then_some(quick)
    }

    /// Computes values, and rounds them to binary64 and, in one step, to binary32. They count where `near` is sure.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn evaluate(self, given: &Given, near: &mut Near, values: &mut [[f64; WIDTH]], nearest: &mut [[u32; WIDTH]]) {
        near.sure = [u64::MAX; WIDTH];
        near.segment_end = [0; WIDTH];
        near.degenerate = [0; WIDTH];
        match self {
            Self::Sphere => sphere::sphere(given, near),
            Self::Skinning => skinning::skinning(given, near),
        }
        near.round(values, nearest);
    }
}

impl Near {
    /// Nothing is sure.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn give_up(&mut self) {
        self.sure = [0; WIDTH];
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn round(&mut self, values: &mut [[f64; WIDTH]], nearest: &mut [[u32; WIDTH]]) {
        for word in 0..WORDS {
            for k in 0..WIDTH {
                let high = self.high[word][k];
                let (least, most) = (self.low[word][k] - self.off[k], self.low[word][k] + self.off[k]);
                let (down, up) = (to_odd(high, least) as f32, to_odd(high, most) as f32);
                let same = (high + least == high) & (high + most == high) & (down.to_bits() == up.to_bits());
                self.sure[k] &= all_bits(same);
                values[word][k] = high;
                nearest[word][k] = down.to_bits();
            }
        }
    }
}

/// More than what underflow can change.
const LEAST: f64 = power(-900);

/// 2^n for a normal number.
const fn power(n: i64) -> f64 {
    f64::from_bits(((1023 + n) as u64) << 52)
}

/// The rows of a matrix and its largest entry.
#[cfg_attr(not(debug_assertions), inline(always))]
fn matrix(case: &[f64], at: usize) -> ([[f64; 4]; 4], f64) {
    let (mut rows, mut largest) = ([[0.0; 4]; 4], 0.0_f64);
    for r in 0..4 {
        for c in 0..4 {
            rows[r][c] = case[at + 4 * c + r];
            largest = largest.max(rows[r][c].abs());
        }
    }
    (rows, largest)
}

/// The square of a number in two parts, without that of the second part.
#[cfg_attr(not(debug_assertions), inline(always))]
fn square(a: (f64, f64)) -> (f64, f64) {
    let (high, rest) = two_product(a.0, a.0);
    (high, (a.0 + a.0).mul_add(a.1, rest))
}
