//! Real numbers with some 100 bits, a few side by side: what values to the last bit of binary64 are
//! computed with.
//!
//! [`Real`] is what a formula asks of numbers. [`Twofold`] computes with pairs of binary64; tests have
//! another implementation with numbers of many bits.
//!
//! Functions are inlined where the program is optimised, so that they become vectors. Without that every
//! number in between has its own room on the stack, which one frame for a whole formula does not have.

#[cfg(test)]
mod big;
mod near;
mod pair;
mod tables;
#[cfg(test)]
mod tests;

use std::ops::{Add, Div, Mul, Neg, Sub};

use pair::Pair;

pub use near::{TURN_OFF, sin_cos_pi_near};
pub use pair::{product, sum, times, two_product, two_sum};

/// Numbers side by side in a [`Twofold`].
pub const WIDTH: usize = 16;

/// Numbers that formulas are written for.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Which of the numbers side by side are meant.
    type Mask: Copy;

    /// The same number in all places.
    fn exact(x: f64) -> Self;

    /// The root.
    fn sqrt(self) -> Self;

    /// The number without its sign.
    fn abs(self) -> Self;

    /// The sum of four products.
    fn dot(a: [Self; 4], b: [Self; 4]) -> Self {
        ((a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]) + a[3] * b[3]
    }

    /// The difference to a number of binary64.
    fn less_word(self, word: Self) -> Self {
        self - word
    }

    /// The difference of two numbers of binary64.
    fn between_words(a: Self, b: Self) -> Self {
        a - b
    }

    /// The sum of four products of numbers of binary64 and others.
    fn dot_of_words(a: [Self; 4], b: [Self; 4]) -> Self {
        Self::dot(a, b)
    }

    /// a·b − c·d.
    fn minor(a: Self, b: Self, c: Self, d: Self) -> Self {
        a * b - c * d
    }

    /// (sin πx, cos πx) for a binary32 number x, or twice one.
    fn sin_cos_pi(self) -> (Self, Self);

    /// x^y; NaN for x < 0.
    fn pow(self, exponent: Self) -> Self;

    /// Where x < y.
    fn less(self, other: Self) -> Self::Mask;

    /// Where x = 0.
    fn is_zero(self) -> Self::Mask;

    /// Both.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;

    /// Either.
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;

    /// `a` where the mask holds, and `b` elsewhere.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;

    /// The largest of the numbers, as far as they are numbers.
    fn largest(self) -> f64;
}

/// [`WIDTH`] numbers in two parts each. Where `SAFE`, infinities and what becomes too large are what they would be
/// in binary64; elsewhere they may be NaN, and arithmetic takes half the time.
#[derive(Clone, Copy, Debug)]
pub struct Twofold<const SAFE: bool = true> {
    high: [f64; WIDTH],
    low: [f64; WIDTH],
}

impl<const SAFE: bool> Twofold<SAFE> {
    /// These numbers.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn of(numbers: [f64; WIDTH]) -> Self {
        Self { high: numbers, low: [0.0; WIDTH] }
    }

    /// Each rounded to binary64.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn rounded(&self) -> &[f64; WIDTH] {
        &self.high
    }

    /// Each rounded to binary32 in one step.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn rounded_32(&self, out: &mut [u32; WIDTH]) {
        for k in 0..WIDTH {
            out[k] = (to_odd(self.high[k], self.low[k]) as f32).to_bits();
        }
    }

    /// Both parts of one of the numbers.
    pub fn parts(&self, k: usize) -> [f64; 2] {
        [self.high[k], self.low[k]]
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn get(&self, k: usize) -> Pair {
        Pair { high: self.high[k], low: self.low[k] }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn set(&mut self, k: usize, pair: Pair) {
        self.high[k] = pair.high;
        self.low[k] = pair.low;
    }
}

/// e^x − 1.
pub(super) fn exp_m1(x: f64) -> f64 {
    if x.abs() < 700.0 { Pair::of(x).exp().sub::<true>(Pair::of(1.0)).high } else { super::EXP.value(x) - 1.0 }
}

/// The sum rounded to binary64 such that a second rounding to fewer bits is right: what is not exact has
/// an odd last bit.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn to_odd(high: f64, low: f64) -> f64 {
    let bits = high.to_bits();
    let towards_zero = (low < 0.0) != (high < 0.0);
    let moved = (bits - u64::from(towards_zero && bits << 1 != 0)) | 1;
    if low == 0.0 { high } else { f64::from_bits(moved) }
}

/// All bits where it holds.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn all_bits(holds: bool) -> u64 {
    u64::from(holds).wrapping_neg()
}

/// `a` for all bits, and `b` for none.
#[cfg_attr(not(debug_assertions), inline(always))]
fn either(mask: u64, a: f64, b: f64) -> f64 {
    f64::from_bits((a.to_bits() & mask) | (b.to_bits() & !mask))
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<const SAFE: bool> $trait for Twofold<SAFE> {
            type Output = Self;

            #[cfg_attr(not(debug_assertions), inline(always))]
            fn $method(self, other: Self) -> Self {
                // Loops and no closures: these are inlined for certain, and become vectors of the caller's width.
                let mut out = self;
                for k in 0..WIDTH {
                    out.set(k, self.get(k).$method::<SAFE>(other.get(k)));
                }
                out
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<const SAFE: bool> Neg for Twofold<SAFE> {
    type Output = Self;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn neg(self) -> Self {
        let mut out = self;
        for k in 0..WIDTH {
            out.set(k, self.get(k).neg());
        }
        out
    }
}

impl<const SAFE: bool> Real for Twofold<SAFE> {
    // All bits or none, as wide as the numbers: what chooses between vectors.
    type Mask = [u64; WIDTH];

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn exact(x: f64) -> Self {
        Self::of([x; WIDTH])
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn dot(a: [Self; 4], b: [Self; 4]) -> Self {
        let mut out = a[0];
        for k in 0..WIDTH {
            let [a, b] = [&a, &b].map(
                #[inline(always)]
                |v| [v[0].get(k), v[1].get(k), v[2].get(k), v[3].get(k)],
            );
            out.set(k, Pair::dot::<SAFE>(a, b));
        }
        out
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn less_word(self, word: Self) -> Self {
        let mut out = self;
        for k in 0..WIDTH {
            out.set(k, self.get(k).add_number::<SAFE>(-word.high[k]));
        }
        out
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn between_words(a: Self, b: Self) -> Self {
        let mut out = a;
        for k in 0..WIDTH {
            out.set(k, Pair::difference::<SAFE>(a.high[k], b.high[k]));
        }
        out
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn dot_of_words(a: [Self; 4], b: [Self; 4]) -> Self {
        let mut out = b[0];
        for k in 0..WIDTH {
            let words = [a[0].high[k], a[1].high[k], a[2].high[k], a[3].high[k]];
            out.set(k, Pair::dot_of_numbers::<SAFE>(words, [b[0].get(k), b[1].get(k), b[2].get(k), b[3].get(k)]));
        }
        out
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn minor(a: Self, b: Self, c: Self, d: Self) -> Self {
        let mut out = a;
        for k in 0..WIDTH {
            out.set(k, Pair::minor::<SAFE>(a.get(k), b.get(k), c.get(k), d.get(k)));
        }
        out
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sqrt(self) -> Self {
        let mut out = self;
        for k in 0..WIDTH {
            out.set(k, self.get(k).sqrt::<SAFE>());
        }
        out
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn abs(self) -> Self {
        let mut out = self;
        for k in 0..WIDTH {
            let sign = self.high[k].to_bits() & (1 << 63);
            out.high[k] = f64::from_bits(self.high[k].to_bits() ^ sign);
            out.low[k] = f64::from_bits(self.low[k].to_bits() ^ sign);
        }
        out
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sin_cos_pi(self) -> (Self, Self) {
        let mut both = [Self::exact(0.0); 2];
        for k in 0..WIDTH {
            let (sin, cos) = Pair::sin_cos_pi(self.high[k]);
            both[0].high[k] = sin.high;
            both[0].low[k] = sin.low;
            both[1].high[k] = cos.high;
            both[1].low[k] = cos.low;
        }
        let [sin, cos] = both;
        (sin, cos)
    }

    fn pow(self, exponent: Self) -> Self {
        let mut out = self;
        for k in 0..WIDTH {
            out.set(k, self.get(k).pow(exponent.get(k)));
        }
        out
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn less(self, other: Self) -> Self::Mask {
        let mut mask = [0; WIDTH];
        for k in 0..WIDTH {
            let (a, b) = (self.get(k), other.get(k));
            // No && and no ||, which are branches.
            mask[k] = all_bits((a.high < b.high) | ((a.high == b.high) & (a.low < b.low)));
        }
        mask
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_zero(self) -> Self::Mask {
        let mut mask = [0; WIDTH];
        for k in 0..WIDTH {
            mask[k] = all_bits(self.high[k] == 0.0);
        }
        mask
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        let mut mask = a;
        for k in 0..WIDTH {
            mask[k] &= b[k];
        }
        mask
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        let mut mask = a;
        for k in 0..WIDTH {
            mask[k] |= b[k];
        }
        mask
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self {
        let mut out = b;
        for k in 0..WIDTH {
            out.high[k] = either(mask[k], a.high[k], b.high[k]);
            out.low[k] = either(mask[k], a.low[k], b.low[k]);
        }
        out
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn largest(self) -> f64 {
        self.high.iter().fold(f64::NEG_INFINITY, |most, &x| if x > most { x } else { most })
    }
}
