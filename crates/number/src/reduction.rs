//! Angles, reduced to [−π/4, π/4] and a number of quarter turns.

use super::double::{from_integer, nearest, product, sum};

/// Up to here quarter turns have 17 bits, and their products with 33 bits of π/2 are exact.
pub(super) const LIMIT: f64 = 131_072.0;

/// π/2 in three parts of 33 bits and the rest.
pub(super) const QUARTER: [f64; 4] = [
    f64::from_bits(0x3ff9_21fb_5440_0000),
    f64::from_bits(0x3dd0_b461_1a60_0000),
    f64::from_bits(0x3ba3_198a_2e00_0000),
    f64::from_bits(0x397b_839a_2520_49c1),
];

/// π/2 in two parts.
pub(super) const HALF_PI: (f64, f64) = (std::f64::consts::FRAC_PI_2, f64::from_bits(0x3c91_a626_3314_5c07));

/// An angle x = quarters·π/2 + r + tail.
#[derive(Clone, Copy)]
pub(super) struct Reduced {
    /// The two low bits count; the others are anything.
    pub quarters: u64,
    /// In [−π/4, π/4], but for a rounding.
    pub r: f64,
    /// At most 1 ULP of r.
    pub tail: f64,
}

/// Reduces |x| ≤ [`LIMIT`]: π/2 has 150 bits here, so that 85 are left after the worst cancellation
/// (W. J. Cody, W. Waite, Software manual for the elementary functions, 1980).
#[inline(always)]
pub(super) fn small(x: f64) -> Reduced {
    let (n, quarters) = nearest(x * std::f64::consts::FRAC_2_PI);
    // Exact: for n ≠ 0 both are multiples of 2^-53, and the difference is less than 1.
    let first = x - n * QUARTER[0];
    // Where the first number of a sum is the smaller one, so much was cancelled that the sum is exact.
    let (second, e2) = sum(first, -(n * QUARTER[1]));
    let (third, e3) = sum(second, -(n * QUARTER[2]));
    let (r, tail) = sum(third, (e2 + e3) - n * QUARTER[3]);
    Reduced { quarters, r, tail }
}

/// The bits of 2/π behind the point.
pub(super) const TWO_OVER_PI: [u32; 38] = [
    0xa2f9_836e,
    0x4e44_1529,
    0xfc27_57d1,
    0xf534_ddc0,
    0xdb62_9599,
    0x3c43_9041,
    0xfe51_63ab,
    0xdebb_c561,
    0xb724_6e3a,
    0x424d_d2e0,
    0x0649_2eea,
    0x09d1_921c,
    0xfe1d_eb1c,
    0xb129_a73e,
    0xe882_35f5,
    0x2ebb_4484,
    0xe99c_7026,
    0xb45f_7e41,
    0x3991_d639,
    0x8353_39f4,
    0x9c84_5f8b,
    0xbdf9_283b,
    0x1ff8_97ff,
    0xde05_980f,
    0xef2f_118b,
    0x5a0a_6d1f,
    0x6d36_7ecf,
    0x27cb_09b7,
    0x4f46_3f66,
    0x9e5f_ea2d,
    0x7527_bac7,
    0xebe5_f17b,
    0x3d07_39f7,
    0x8a52_92ea,
    0x6bfb_5fb1,
    0x1f8d_5d08,
    0x5603_3046,
    0xfc7b_6bab,
];

/// Two neighbouring words each, behind 64 zeros; as many as an index of 6 bits can reach.
const PAIRS: [u64; 64] = {
    let mut words = [0_u64; 65];
    let mut k = 0;
    while k < TWO_OVER_PI.len() {
        words[k + 2] = TWO_OVER_PI[k] as u64;
        k += 1;
    }
    let mut pairs = [0; 64];
    k = 0;
    while k < 64 {
        pairs[k] = words[k] << 32 | words[k + 1];
        k += 1;
    }
    pairs
};

/// Words of 2/π that meet a significand.
const WINDOW: usize = 6;

/// The part of 2/π that counts for the numbers of one binade.
pub(super) type Window = [u32; WINDOW];

/// The window for a number, which depends on its exponent alone.
#[inline(always)]
pub(super) fn window(x: f64) -> Window {
    // The bit of 2/π that has the weight 2 in the product with the last bit of the significand.
    let offset = (x.to_bits() >> 52 & 0x7ff).wrapping_sub(1013);
    let mut window = [0; WINDOW];
    for (k, word) in window.iter_mut().enumerate() {
        let pair = PAIRS[((offset >> 5).wrapping_add(k as u64) & 63) as usize];
        *word = (pair << (offset & 31) >> 32) as u32;
    }
    window
}

/// Reduces LIMIT < |x| < ∞. The product of x and 2/π is taken modulo 4 with 190 bits behind the point,
/// of which 137 are right; no number comes nearer to a multiple of π/2 than 2^-62 of a quarter
/// (M. H. Payne, R. N. Hanek, Radian reduction for trigonometric functions, SIGNUM 18, 1983).
#[inline(always)]
pub(super) fn large(x: f64, window: &Window) -> Reduced {
    const LOW: u64 = 0xffff_ffff;
    let significand = x.to_bits() & 0x000f_ffff_ffff_ffff | 0x0010_0000_0000_0000;
    let (m_low, m_high) = (significand & LOW, significand >> 32);
    let mut words = [0; WINDOW];
    let (mut carry, mut behind) = (0, 0);
    for k in (0..WINDOW).rev() {
        let word = u64::from(window[k]);
        let low = m_low * word;
        let column = (low & LOW) + m_high * behind + carry;
        behind = word;
        words[k] = column & LOW;
        carry = (column >> 32) + (low >> 32);
    }
    // The first word has two bits of quarters; a half is added to round them.
    let half = 0x2000_0000;
    let quarters = (words[0] + half) >> 30;
    let first = from_integer((words[0] + half) & 0x3fff_ffff) - half as f64;
    let power = |exponent: u64| f64::from_bits((1023 - exponent) << 52);
    let (high, e) = sum(first * power(30), from_integer(words[1]) * power(62));
    let behind = e + from_integer(words[2]) * power(94) + from_integer(words[3]) * power(126);
    let (high, low) = sum(high, behind);
    let (turned, rest) = product(high, HALF_PI.0);
    let (r, tail) = sum(turned, rest + (high * HALF_PI.1 + low * HALF_PI.0));
    let negative = x < 0.0;
    Reduced {
        quarters: if negative { quarters.wrapping_neg() } else { quarters },
        r: if negative { -r } else { r },
        tail: if negative { -tail } else { tail },
    }
}
