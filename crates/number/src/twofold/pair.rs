//! A number as the unevaluated sum of two binary64 numbers: about 104 bits.
//!
//! T. J. Dekker (1971); M. Joldes, J.-M. Muller, V. Popescu, Tight and rigorous error bounds for basic
//! building blocks of double-word arithmetic, ACM TOMS 44 (2017). A product is split by a fused
//! multiplication, which IEEE 754 defines to the last bit.

use super::tables::{INVERSE_FACTORIALS, LN_2, PI, SINES};
use crate::double::{TO_INTEGER, nearest};
use crate::{EXP, LN};

/// high + low with |low| at most half an ULP of high. `low` is 0 where `high` is infinite or NaN.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pair {
    pub high: f64,
    pub low: f64,
}

/// a + b in two parts, exact.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let high = a + b;
    let part = high - a;
    (high, (a - (high - part)) + (b - part))
}

/// a·b in two parts, exact but for underflow.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn two_product(a: f64, b: f64) -> (f64, f64) {
    let high = a * b;
    (high, a.mul_add(b, -high))
}

/// The product of numbers in two parts, without that of the second parts. Its second part may be large beside the first
/// where those of the numbers are.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn product(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    let (high, rest) = two_product(a.0, b.0);
    (high, a.0.mul_add(b.1, a.1.mul_add(b.0, rest)))
}

/// The product of a number and one in two parts.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn times(a: f64, b: (f64, f64)) -> (f64, f64) {
    let (high, rest) = two_product(b.0, a);
    (high, b.1.mul_add(a, rest))
}

/// The sum of four numbers in two parts each; its second part may be large beside the first where the numbers cancel.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn sum(terms: [(f64, f64); 4]) -> (f64, f64) {
    let (mut sum, mut rest) = terms[0];
    for k in 1..4 {
        let (high, low) = terms[k];
        let (next, carried) = two_sum(sum, high);
        sum = next;
        rest += carried + low;
    }
    (sum, rest)
}

impl Pair {
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn of(x: f64) -> Self {
        Self { high: x, low: 0.0 }
    }

    /// The sum of two parts of which the second is the smaller.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn settled<const SAFE: bool>(a: f64, b: f64) -> Self {
        // Beyond the finite numbers the rest has no meaning, and must not turn an infinity into NaN.
        let high = if !SAFE || a.is_finite() { a + b } else { a };
        let low = b - (high - a);
        Self { high, low: if !SAFE || high.is_finite() { low } else { 0.0 } }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn add<const SAFE: bool>(self, b: Self) -> Self {
        let (high, rest) = two_sum(self.high, b.high);
        let (low, rest_low) = two_sum(self.low, b.low);
        let middle = rest + low;
        let first = high + middle;
        let left = (middle - (first - high)) + rest_low;
        let sum = first + left;
        if !SAFE {
            return Self { high: sum, low: left - (sum - first) };
        }
        let finite = sum.is_finite();
        // Beyond the finite numbers the rest has no meaning, and must not turn an infinity into NaN.
        let beyond = if high.is_finite() { first } else { high };
        Self { high: if finite { sum } else { beyond }, low: if finite { left - (sum - first) } else { 0.0 } }
    }

    /// The same for a number: no second part is added up.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn add_number<const SAFE: bool>(self, b: f64) -> Self {
        if SAFE {
            return self.add::<SAFE>(Self::of(b));
        }
        let (high, rest) = two_sum(self.high, b);
        let middle = rest + self.low;
        let first = high + middle;
        let left = middle - (first - high);
        let sum = first + left;
        Self { high: sum, low: left - (sum - first) }
    }

    /// The difference of two numbers, exact.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn difference<const SAFE: bool>(a: f64, b: f64) -> Self {
        if SAFE {
            return Self::of(a).sub::<SAFE>(Self::of(b));
        }
        let (high, low) = two_sum(a, -b);
        Self { high, low }
    }

    /// The sum of four products, each exact but for what is below the last bits: T. Ogita, S. M. Rump, S. Oishi,
    /// Accurate sum and dot product, SIAM J. Sci. Comput. 26 (2005), algorithm 5.3, with the second parts added to
    /// what is carried. The error is some 2^-102 of the sum of the magnitudes, as for sums one by one.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn dot<const SAFE: bool>(a: [Self; 4], b: [Self; 4]) -> Self {
        Self::sum_of::<SAFE>([a[0].product(b[0]), a[1].product(b[1]), a[2].product(b[2]), a[3].product(b[3])])
    }

    /// The same for numbers that have no second part.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn dot_of_numbers<const SAFE: bool>(a: [f64; 4], b: [Self; 4]) -> Self {
        Self::sum_of::<SAFE>([b[0].part(a[0]), b[1].part(a[1]), b[2].part(a[2]), b[3].part(a[3])])
    }

    /// The sum of products in two parts.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sum_of<const SAFE: bool>(products: [(f64, f64); 4]) -> Self {
        let (high, rest) = sum(products);
        Self::whole::<SAFE>(high, rest)
    }

    /// a·b − c·d in the same way.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn minor<const SAFE: bool>(a: Self, b: Self, c: Self, d: Self) -> Self {
        let (first, rest) = a.product(b);
        let (second, rest_second) = c.product(d);
        let (sum, carried) = two_sum(first, -second);
        Self::whole::<SAFE>(sum, carried + (rest - rest_second))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn product(self, b: Self) -> (f64, f64) {
        product((self.high, self.low), (b.high, b.low))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn part(self, a: f64) -> (f64, f64) {
        times(a, (self.high, self.low))
    }

    /// The sum of two numbers, whichever is larger; `a` alone where that is not finite.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn whole<const SAFE: bool>(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, b);
        if !SAFE {
            return Self { high, low };
        }
        let finite = high.is_finite();
        let beyond = if a.is_finite() { a + b } else { a };
        Self { high: if finite { high } else { beyond }, low: if finite { low } else { 0.0 } }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn sub<const SAFE: bool>(self, b: Self) -> Self {
        self.add::<SAFE>(b.neg())
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn mul<const SAFE: bool>(self, b: Self) -> Self {
        let (high, rest) = two_product(self.high, b.high);
        Self::settled::<SAFE>(high, self.high.mul_add(b.low, self.low.mul_add(b.high, rest)))
    }

    /// The product of finite numbers.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn near(self, b: Self) -> Self {
        self.mul::<false>(b)
    }

    /// The sum of finite numbers of which the second is the smaller by far.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn and(self, b: Self) -> Self {
        let high = self.high + b.high;
        let low = (b.high - (high - self.high)) + (self.low + b.low);
        let sum = high + low;
        Self { high: sum, low: low - (sum - high) }
    }

    /// Times a number.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn times<const SAFE: bool>(self, b: f64) -> Self {
        let (high, rest) = two_product(self.high, b);
        Self::settled::<SAFE>(high, self.low.mul_add(b, rest))
    }

    /// The quotient: that of the first parts, and what it leaves of the dividend by the divisor. Two roundings of
    /// the rest are left, some 2^-102 of the quotient.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn div<const SAFE: bool>(self, b: Self) -> Self {
        let first = self.high / b.high;
        // Exact: what a quotient that was rounded to nearest leaves has no more bits than the dividend.
        let rest = first.mul_add(-b.high, self.high);
        let second = (rest + first.mul_add(-b.low, self.low)) / b.high;
        let sum = Self::settled::<SAFE>(first, second);
        // What has no finite quotient has none to be made better.
        if !SAFE || sum.high.is_finite() { sum } else { Self::of(first) }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn sqrt<const SAFE: bool>(self) -> Self {
        let root = self.high.sqrt();
        let (square, square_low) = two_product(root, root);
        let rest = ((self.high - square) - square_low) + self.low;
        let better = Self::settled::<SAFE>(root, rest / (2.0 * root));
        // One more step: the first leaves an error of 2^-104 and this one less than can be seen.
        let usable = root > 0.0 && root < f64::INFINITY;
        Self { high: if usable { better.high } else { root }, low: if usable { better.low } else { 0.0 } }
    }

    /// (sin πx, cos πx) for a binary32 number x, or twice one.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn sin_cos_pi(x: f64) -> (Self, Self) {
        // From 2^30 on these numbers are even.
        const ALL_EVEN: f64 = 1_073_741_824.0;
        /// Parts of half a turn of which the table has the sines.
        const PARTS: f64 = 256.0;
        let finite = x.is_finite();
        let x = if x.abs() < ALL_EVEN { x } else { 0.0 };
        let (turns, _) = nearest(0.5 * x);
        let x = x - 2.0 * turns;
        let (parts, bits) = nearest(PARTS * x);
        // Angle and square are finite and small, and in each sum the first number is the larger one: nothing of
        // what makes sums and products safe for all numbers is needed here.
        let angle = PI.times::<false>(x - parts / PARTS);
        let square = angle.near(angle);
        let sine = angle.and(series(square, 3).near(square).near(angle));
        let cosine = Self::of(1.0).and(series(square, 2).near(square));
        // Of the low bits of an integer in two's complement: -1 is 511.
        let (of_sine, of_cosine) = (table(bits), table(bits.wrapping_add(PARTS as u64 / 2)));
        let sin = of_sine.near(cosine).add::<false>(of_cosine.near(sine));
        let cos = of_cosine.near(cosine).sub::<false>(of_sine.near(sine));
        let or_nan = |p: Self| if finite { p } else { Self::of(f64::NAN) };
        (or_nan(sin), or_nan(cos))
    }

    /// e^x.
    pub fn exp(self) -> Self {
        if !(self.high.abs() < 750.0) {
            return Self::of(EXP.value(self.high));
        }
        let (n, _) = nearest(self.high * std::f64::consts::LOG2_E);
        let rest = self.sub::<true>(LN_2.times::<true>(n));
        let small = Self { high: rest.high / 64.0, low: rest.low / 64.0 };
        // 1 + r + r²/2 + …; what is left out is below 2^-107.
        let mut sum = Self::of(0.0);
        for k in (1..=14).rev() {
            let coefficient = if k == 1 { Self::of(1.0) } else { factorial(k) };
            sum = sum.mul::<true>(small).add::<true>(coefficient);
        }
        let mut power = sum.mul::<true>(small).add::<true>(Self::of(1.0));
        for _ in 0..6 {
            power = power.mul::<true>(power);
        }
        let two_to = |n: f64| f64::from_bits((n + (TO_INTEGER + 1023.0)).to_bits() << 52);
        let (half, _) = nearest(0.5 * n);
        let scaled = |x: f64| x * two_to(half) * two_to(n - half);
        Self { high: scaled(power.high), low: scaled(power.low) }
    }

    /// ln x for a finite x > 0: one step of Newton's method from binary64.
    pub fn ln(self) -> Self {
        let near = LN.value(self.high);
        let rest = self.mul::<true>(Self::of(-near).exp()).sub::<true>(Self::of(1.0));
        Self::of(near).add::<true>(rest).sub::<true>(rest.mul::<true>(rest).times::<true>(0.5))
    }

    /// x^y; NaN for x < 0.
    pub fn pow(self, exponent: Self) -> Self {
        let finite = self.high < f64::INFINITY && exponent.high.abs() < f64::INFINITY;
        if !(self.high > 0.0 && finite) {
            return Self::of(crate::POW.value(self.high, exponent.high));
        }
        self.ln().mul::<true>(exponent).exp()
    }
}

/// sin(kπ/256) for the nine low bits of k.
#[cfg_attr(not(debug_assertions), inline(always))]
fn table(bits: u64) -> Pair {
    let at = (bits & 511) as usize;
    SINES[at]
}

/// 1/n!
#[cfg_attr(not(debug_assertions), inline(always))]
fn factorial(n: usize) -> Pair {
    INVERSE_FACTORIALS[n]
}

/// -(1/n! - z/(n+2)! + …) of five terms, z up to 3.8e-5: from the third term on in binary64 alone, which leaves
/// 2^-105 of the first.
#[cfg_attr(not(debug_assertions), inline(always))]
fn series(z: Pair, n: usize) -> Pair {
    let tail = |k: usize| factorial(n + 2 * k).high;
    let x = z.high;
    let late = (tail(4) * x - tail(3)) * x + tail(2);
    let second = factorial(n + 2).and(Pair::of(-(late * x)));
    factorial(n).and(second.near(z).neg()).neg()
}
