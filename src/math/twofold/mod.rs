//! Real numbers with some 100 bits, a few side by side: what values to the last bit of binary64 are
//! computed with.
//!
//! [`Real`] is what a formula asks of numbers. [`Twofold`] computes with pairs of binary64; tests have
//! another implementation with numbers of many bits.
//!
//! Functions are inlined where the program is optimised, so that they become vectors. Without that every
//! number in between has its own room on the stack, which one frame for a whole formula does not have.

mod pair;
mod tables;
#[cfg(test)]
pub(crate) mod tests;

use std::ops::{Add, Div, Mul, Neg, Sub};

use pair::Pair;

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

/// [`WIDTH`] numbers in two parts each.
#[derive(Clone, Copy, Debug)]
pub struct Twofold {
    high: [f64; WIDTH],
    low: [f64; WIDTH],
}

impl Twofold {
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
            out[k] = (odd(self.high[k], self.low[k]) as f32).to_bits();
        }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn get(&self, k: usize) -> Pair {
        Pair { high: self.high[k], low: self.low[k] }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn make(f: impl Fn(usize) -> Pair) -> Self {
        let mut out = Self { high: [0.0; WIDTH], low: [0.0; WIDTH] };
        for k in 0..WIDTH {
            let pair = f(k);
            out.high[k] = pair.high;
            out.low[k] = pair.low;
        }
        out
    }
}

/// e^x − 1.
pub(super) fn exp_m1(x: f64) -> f64 {
    if x.abs() < 700.0 { Pair::of(x).exp().sub(Pair::of(1.0)).high } else { super::EXP.value(x) - 1.0 }
}

/// The sum rounded to binary64 such that a second rounding to fewer bits is right: what is not exact has
/// an odd last bit.
#[cfg_attr(not(debug_assertions), inline(always))]
fn odd(high: f64, low: f64) -> f64 {
    let bits = high.to_bits();
    let towards_zero = (low < 0.0) != (high < 0.0);
    let moved = (bits - u64::from(towards_zero && bits << 1 != 0)) | 1;
    if low == 0.0 { high } else { f64::from_bits(moved) }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl $trait for Twofold {
            type Output = Self;

            #[cfg_attr(not(debug_assertions), inline(always))]
            fn $method(self, other: Self) -> Self {
                Self::make(|k| self.get(k).$method(other.get(k)))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for Twofold {
    type Output = Self;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn neg(self) -> Self {
        Self::make(|k| self.get(k).neg())
    }
}

impl Real for Twofold {
    type Mask = [bool; WIDTH];

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn exact(x: f64) -> Self {
        Self::of([x; WIDTH])
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sqrt(self) -> Self {
        Self::make(|k| self.get(k).sqrt())
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
        Self::make(|k| self.get(k).pow(exponent.get(k)))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn less(self, other: Self) -> Self::Mask {
        let mut mask = [false; WIDTH];
        for k in 0..WIDTH {
            let (a, b) = (self.get(k), other.get(k));
            mask[k] = a.high < b.high || (a.high == b.high && a.low < b.low);
        }
        mask
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_zero(self) -> Self::Mask {
        self.high.map(|x| x == 0.0)
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
        Self::make(|k| if mask[k] { a.get(k) } else { b.get(k) })
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn largest(self) -> f64 {
        self.high.iter().fold(f64::NEG_INFINITY, |most, &x| if x > most { x } else { most })
    }
}
