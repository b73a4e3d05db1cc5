//! Numbers as texts that read back to the same bits, and bounds as binary32.

/// The shortest decimal that reads back to the number, or `nan`, `inf`, `-inf`.
pub fn decimal_64(x: f64) -> String {
    if x.is_nan() {
        "nan".to_owned()
    } else if x.is_infinite() {
        if x > 0.0 { "inf".to_owned() } else { "-inf".to_owned() }
    } else {
        format!("{x:?}")
    }
}

/// The same of a binary32 number.
pub fn decimal_32(x: f32) -> String {
    if x.is_finite() { format!("{x:?}") } else { decimal_64(f64::from(x)) }
}

/// The least binary32 number that is not below a bound; infinite for NaN.
pub fn upward(bound: f64) -> f32 {
    let near = bound as f32;
    if bound.is_nan() {
        f32::INFINITY
    } else if f64::from(near) < bound {
        near.next_up()
    } else {
        near
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_read_back() {
        for x in [0.0, -0.0, 1.0, 0.1, 1e300, 5e-324, f64::MAX, -1.5e-7, 123456789012.5] {
            assert_eq!(decimal_64(x).parse::<f64>().unwrap().to_bits(), x.to_bits());
        }
        for x in [0.1_f32, 1e-45, f32::MAX, -0.0, 16777216.0] {
            assert_eq!(decimal_32(x).parse::<f32>().unwrap().to_bits(), x.to_bits());
        }
        assert_eq!([decimal_32(f32::NAN), decimal_64(f64::NEG_INFINITY)], ["nan", "-inf"]);
    }

    #[test]
    fn bounds_only_grow() {
        for bound in [0.0, 1e-50, 1e-40, 0.1, 1.0, 1.0 + 1e-9, 3.5e38, 1e300] {
            assert!(f64::from(upward(bound)) >= bound, "{bound}");
        }
        assert_eq!((upward(1.0), upward(0.0), upward(1.0 + 1e-9)), (1.0, 0.0, 1.0_f32.next_up()));
        assert_eq!((upward(f64::NAN), upward(f64::INFINITY)), (f32::INFINITY, f32::INFINITY));
    }
}
