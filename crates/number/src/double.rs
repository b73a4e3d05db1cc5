//! Numbers in two parts, and conversions that vectorise everywhere.
//!
//! T. J. Dekker, A floating-point technique for extending the available precision, Numerische
//! Mathematik 18 (1971).

/// 1.5·2^52: a number of less than 2^51 added to it is rounded to an integer, ties to even, which is
/// then in the low bits.
pub(super) const TO_INTEGER: f64 = 6_755_399_441_055_744.0;

/// The nearest integer to |x| < 2^51, and its low bits in two's complement.
#[inline(always)]
pub(super) fn nearest(x: f64) -> (f64, u64) {
    let shifted = x + TO_INTEGER;
    (shifted - TO_INTEGER, shifted.to_bits())
}

/// An integer below 2^52 as a number: vectors before AVX-512 have no conversion.
#[inline(always)]
pub(super) fn from_integer(n: u64) -> f64 {
    const TWO_52: f64 = 4_503_599_627_370_496.0;
    f64::from_bits(TWO_52.to_bits() | n) - TWO_52
}

/// The number with the 32 low bits of its significand zero: 21 bits are left.
#[inline(always)]
pub(super) fn upper(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & 0xffff_ffff_0000_0000)
}

/// a·b in two parts: the rounded product and its error, exact but for underflow and 2^-106 of it.
#[inline(always)]
pub(super) fn product(a: f64, b: f64) -> (f64, f64) {
    const HALF: u64 = !0x07ff_ffff;
    // 26 bits and 27: products of two upper parts, and of an upper and a lower one, are exact.
    let a_high = f64::from_bits(a.to_bits() & HALF);
    let b_high = f64::from_bits(b.to_bits() & HALF);
    let (a_low, b_low) = (a - a_high, b - b_high);
    let high = a * b;
    let low = ((a_high * b_high - high) + (a_high * b_low + a_low * b_high)) + a_low * b_low;
    (high, low)
}

/// a + b in two parts, exact; |a| ≥ |b| or a = 0.
#[inline(always)]
pub(super) fn sum(a: f64, b: f64) -> (f64, f64) {
    let high = a + b;
    (high, b - (high - a))
}
