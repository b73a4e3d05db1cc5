//! binary16.

/// The bits of the binary16 number nearest to `value`, halves to even; infinite beyond its range.
pub fn to_bits(value: f64) -> u16 {
    let sign = u16::from(value.is_sign_negative()) << 15;
    let size = value.abs();
    if size.is_nan() {
        return sign | 0x7e00;
    }
    // Half way between the greatest finite number, 65504, and 2^16.
    if size >= 65520.0 {
        return sign | 0x7c00;
    }
    let exponent = (((size.to_bits() >> 52) & 0x7ff) as i32 - 1023).max(-14);
    // The gap between neighbours is 2^(exponent − 10): the quotient is exact, its rounding is the only one.
    let steps = (size * f64::from_bits(((1023 + 10 - exponent) as u64) << 52)).round_ties_even() as u16;
    // A normal number counts its 1024 leading steps as one exponent; a carry runs into the exponent.
    sign | ((((exponent + 14) as u16) << 10) + steps)
}

/// The value of the bits of a binary16 number.
pub fn from_bits(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    let size = match exponent {
        0x1f if fraction != 0.0 => f64::NAN,
        0x1f => f64::INFINITY,
        0 => fraction * 2f64.powi(-24),
        _ => (1024.0 + fraction) * 2f64.powi(exponent - 25),
    };
    sign * size
}

/// The number of binary16 nearest to a number of binary32, as one of binary32. NaN stays as it is, payload and all.
pub fn nearest(x: f32) -> f32 {
    if x.is_nan() { x } else { from_bits(to_bits(f64::from(x))) as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_its_own_nearest() {
        for bits in 0..=u16::MAX {
            let value = from_bits(bits);
            if !value.is_nan() {
                assert_eq!(to_bits(value), bits, "{value}");
            }
        }
    }

    #[test]
    fn halves_go_to_even_and_large_numbers_to_infinity() {
        // Neighbours of 1 are 2^-10 apart.
        let ulp = 2f64.powi(-10);
        assert_eq!(to_bits(1.0 + ulp / 2.0), 0x3c00);
        assert_eq!(to_bits(1.0 + 1.5 * ulp), 0x3c02);
        assert_eq!(to_bits(1.0 + ulp / 2.0 + 1e-9), 0x3c01);
        assert_eq!((to_bits(65519.9), to_bits(65520.0), to_bits(-1e9)), (0x7bff, 0x7c00, 0xfc00));
        assert_eq!((to_bits(2f64.powi(-25)), to_bits(2f64.powi(-24))), (0, 1));
        assert_eq!((from_bits(0xc000), from_bits(0x0001)), (-2.0, 2f64.powi(-24)));
        assert!(from_bits(to_bits(f64::NAN)).is_nan());
    }
}
