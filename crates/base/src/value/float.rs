//! binary32 values as bits.

use std::fmt;

/// A binary32 value that keeps its bits, NaN payloads and the sign of zero included.
///
/// Equality is equality of bits: NaN equals the same NaN, and -0 differs from +0. Whether two
/// values *agree* is not decided here but by `verdict`.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct F32Bits(pub u32);

impl F32Bits {
    /// The bits of `value`.
    pub fn from_f32(value: f32) -> Self {
        Self(value.to_bits())
    }

    /// The number with these bits; NaN keeps its payload.
    pub fn to_f32(self) -> f32 {
        f32::from_bits(self.0)
    }

    /// The value in C99 hexadecimal notation, such as `0x1.921fb6p+1`.
    pub fn to_hex_float(self) -> String {
        let negative = self.0 >> 31 == 1;
        let exponent = (self.0 >> 23 & 0xff) as i32;
        let fraction = self.0 & 0x007f_ffff;
        let sign = if negative { "-" } else { "" };
        match (exponent, fraction) {
            (0xff, 0) => format!("{sign}inf"),
            (0xff, _) => format!("{sign}nan(0x{fraction:06x})"),
            (0, 0) => format!("{sign}0x0p+0"),
            _ => {
                let lead = u32::from(exponent != 0);
                let power = if exponent == 0 { -126 } else { exponent - 127 };
                // 23 fraction bits are 6 hexadecimal digits with one bit to spare.
                let digits = format!("{:06x}", fraction << 1);
                let digits = digits.trim_end_matches('0');
                let point = if digits.is_empty() { "" } else { "." };
                format!("{sign}0x{lead}{point}{digits}p{power:+}")
            }
        }
    }
}

impl fmt::Display for F32Bits {
    /// The shortest decimal that reads back to the same bits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.to_f32();
        let size = value.abs();
        if value.is_nan() {
            f.write_str(&self.to_hex_float())
        } else if size != 0.0 && !(1e-5..1e9).contains(&size) && size.is_finite() {
            write!(f, "{value:e}")
        } else {
            write!(f, "{value:?}")
        }
    }
}

impl fmt::Debug for F32Bits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self} (0x{:08x})", self.0)
    }
}

/// Distance between neighbouring binary32 values at the real number `x`, in the unit of `x`:
/// the gap between the closest binary32 values around it, 2^-149 in the subnormal range.
pub fn ulp_at(x: f64) -> f64 {
    let size = x.abs();
    if size.is_nan() || size == f64::INFINITY {
        return f64::NAN;
    }
    // The exponent of x, from the bits of the binary64: exact, unlike log2.
    let exponent = ((size.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    let exponent = exponent.clamp(-126, 127);
    f64::from_bits(((exponent - 23 + 1023) as u64) << 52)
}

/// How far `actual` lies from the real number `expected`, in ULP at `expected`. NaN when one of
/// them is NaN; infinite when exactly one is infinite or the signs of two infinities differ.
pub fn ulp_distance(expected: f64, actual: f32) -> f64 {
    let actual = f64::from(actual);
    if expected.is_nan() || actual.is_nan() {
        return f64::NAN;
    }
    if expected == actual {
        return 0.0;
    }
    if expected.is_infinite() || actual.is_infinite() {
        return f64::INFINITY;
    }
    (actual - expected).abs() / ulp_at(expected)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_floats_are_those_of_c99() {
        for (value, text) in [
            (1.0, "0x1p+0"),
            (-0.0, "-0x0p+0"),
            (std::f32::consts::PI, "0x1.921fb6p+1"),
            (f32::MIN_POSITIVE, "0x1p-126"),
            (f32::from_bits(1), "0x0.000002p-126"),
            (f32::MAX, "0x1.fffffep+127"),
            (f32::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(F32Bits::from_f32(value).to_hex_float(), text);
        }
    }

    #[test]
    fn ulp_is_the_gap_to_the_next_value() {
        for x in [1.0_f32, 1.5, 2.0, 1e-30, 3.4e38, f32::MIN_POSITIVE] {
            let gap = f64::from(f32::from_bits(x.to_bits() + 1)) - f64::from(x);
            if gap.is_finite() {
                assert_eq!(ulp_at(f64::from(x)), gap, "{x}");
            }
        }
        assert_eq!(ulp_at(0.0), 2f64.powi(-149));
        assert_eq!(ulp_at(1e-60), 2f64.powi(-149));
    }

    #[test]
    fn nan_has_no_distance_and_infinity_is_far() {
        assert!(ulp_distance(1.0, f32::NAN).is_nan());
        assert!(ulp_distance(f64::NAN, 1.0).is_nan());
        assert_eq!(ulp_distance(1.0, f32::INFINITY), f64::INFINITY);
        assert_eq!(ulp_distance(0.0, -0.0), 0.0);
    }

    #[test]
    fn decimals_read_back_to_the_same_bits() {
        for bits in [0x3f80_0001_u32, 0x0000_0001, 0x7f7f_ffff, 0xc049_0fdb, 0x1e3c_e508] {
            assert_eq!(F32Bits(bits).to_string().parse::<f32>().unwrap().to_bits(), bits);
        }
    }
}
