//! Sine and cosine of parts of a turn in fewer operations than in a pair, with a bound of the error.

use super::pair::{Pair, two_product, two_sum};
use super::tables::{INVERSE_FACTORIALS, PI, SINES};
use crate::double::nearest;

/// Parts of half a turn of which the table has the sines.
const PARTS: f64 = 256.0;

/// How far [`sin_cos_pi_near`] may be off.
pub const TURN_OFF: f64 = f64::from_bits((1023 - 73) << 52);

/// A small angle: its sine a and what is behind it, and its cosine less 1 in two parts.
struct Angle {
    a: f64,
    sine_low: f64,
    bend: f64,
    bend_low: f64,
}

impl Angle {
    /// The first number times the cosine and the second times the sine.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn turn(&self, first: Pair, second: Pair) -> (f64, f64) {
        let (turned, turned_rest) = two_product(second.high, self.a);
        let (bent, bent_rest) = two_product(first.high, self.bend);
        let (high, carried) = two_sum(first.high, turned);
        let (high, more) = two_sum(high, bent);
        let small = second.low.mul_add(self.a, first.low.mul_add(self.bend, first.low));
        let rest = (carried + more) + (turned_rest + bent_rest);
        let low = second.high.mul_add(self.sine_low, first.high.mul_add(self.bend_low, rest + small));
        let value = high + low;
        (value, low - (value - high))
    }
}

/// sin πx and cos πx, each in two parts, within [`TURN_OFF`], for a binary32 number x or twice one, of 2^20 at most; for
/// others the value has no meaning.
///
/// With a, the angle from the next 256th of half a turn, |a| < 2^-7.3: the sine of a is a + a³(…), where what is computed
/// in binary64 is below 2^-24 and within 2^-76; its cosine is 1 − a²/2 + a⁴(…), where that is below 2^-34. Sums of what
/// is below 2^-24 are within 2^-75, and terms that are left out are below 2^-77.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn sin_cos_pi_near(x: f64) -> [(f64, f64); 2] {
    let (turns, _) = nearest(0.5 * x);
    let x = x - 2.0 * turns;
    let (parts, bits) = nearest(PARTS * x);
    let part = x - parts / PARTS;
    let (a, rest) = two_product(PI.high, part);
    let a_low = PI.low.mul_add(part, rest);
    let (square, rest) = two_product(a, a);
    let square_low = (a + a).mul_add(a_low, rest);

    let cubic = (-INVERSE_FACTORIALS[7].high)
        .mul_add(square, INVERSE_FACTORIALS[5].high)
        .mul_add(square, -INVERSE_FACTORIALS[3].high);
    let sine_low = (a * square).mul_add(cubic, a_low);
    let quartic = INVERSE_FACTORIALS[8]
        .high
        .mul_add(square, -INVERSE_FACTORIALS[6].high)
        .mul_add(square, INVERSE_FACTORIALS[4].high);
    let bend = -0.5 * square;
    let bend_low = (square * square).mul_add(quartic, -0.5 * square_low);

    let (s, c) = (SINES[(bits & 511) as usize], SINES[(bits.wrapping_add(PARTS as u64 / 2) & 511) as usize]);
    let angle = Angle { a, sine_low, bend, bend_low };
    [angle.turn(s, c), angle.turn(c, s.neg())]
}
