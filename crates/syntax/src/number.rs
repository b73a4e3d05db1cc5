//! Values of numeric literals (GLSL 4.60 specification, sections 4.1.3 and 4.1.4).

use super::ast::Literal;
use super::types::ScalarType;

/// Reads a literal.
///
/// # Errors
/// What is wrong with it, in words that go behind "`1.0.0`".
pub(crate) fn literal(text: &str) -> Result<Literal, &'static str> {
    if let Some(hex) = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        return integer(hex, 16, "is no hexadecimal number");
    }
    let floating = text.contains('.') || text.contains(['e', 'E']) || text.ends_with(['f', 'F']);
    if floating {
        return float(text);
    }
    let digits = text.trim_end_matches(['u', 'U', 's', 'S', 'l', 'L']);
    if digits.len() > 1 && digits.starts_with('0') {
        return integer(&text[1..], 8, "is no octal number, which is what a leading 0 announces");
    }
    integer(text, 10, "is no number")
}

/// True for `1f`: a suffix of a fraction behind a whole number.
pub(crate) fn lacks_point(text: &str) -> bool {
    let digits = text.strip_suffix(['f', 'F']).unwrap_or("");
    !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit())
}

/// Suffixes of whole numbers of other sizes (GL_EXT_shader_explicit_arithmetic_types).
const SIZED: [(&str, ScalarType); 8] = [
    ("us", ScalarType::Uint16),
    ("US", ScalarType::Uint16),
    ("s", ScalarType::Int16),
    ("S", ScalarType::Int16),
    ("ul", ScalarType::Uint64),
    ("UL", ScalarType::Uint64),
    ("l", ScalarType::Int64),
    ("L", ScalarType::Int64),
];

fn integer(text: &str, radix: u32, wrong: &'static str) -> Result<Literal, &'static str> {
    if let Some((digits, ty)) = SIZED.iter().find_map(|(suffix, ty)| Some((text.strip_suffix(suffix)?, *ty))) {
        if digits.is_empty() || !digits.chars().all(|c| c.is_digit(radix)) {
            return Err(wrong);
        }
        let value = u64::from_str_radix(digits, radix).map_err(|_| "does not fit into 64 bits")?;
        if ty.bits() == 16 && value > u64::from(u16::MAX) {
            return Err("does not fit into 16 bits");
        }
        return Ok(Literal::Sized(value, ty));
    }
    let unsigned = text.strip_suffix(['u', 'U']);
    let digits = unsigned.unwrap_or(text);
    if digits.is_empty() || !digits.chars().all(|c| c.is_digit(radix)) {
        return Err(wrong);
    }
    // Literals are 32-bit patterns: 0xffffffff is -1.
    let bits = u32::from_str_radix(digits, radix).map_err(|_| "does not fit into 32 bits")?;
    Ok(if unsigned.is_some() { Literal::Uint(bits) } else { Literal::Int(bits.cast_signed()) })
}

fn float(text: &str) -> Result<Literal, &'static str> {
    let double = text.strip_suffix("lf").or_else(|| text.strip_suffix("LF"));
    let half = text.strip_suffix("hf").or_else(|| text.strip_suffix("HF"));
    let digits = double.or(half).or_else(|| text.strip_suffix(['f', 'F'])).unwrap_or(text);
    let well_formed = {
        let (mantissa, exponent) = match digits.split_once(['e', 'E']) {
            Some((m, e)) => (m, Some(e)),
            None => (digits, None),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let number = |s: &str| s.bytes().all(|b| b.is_ascii_digit());
        let exponent_ok = exponent.is_none_or(|e| {
            let e = e.strip_prefix(['+', '-']).unwrap_or(e);
            !e.is_empty() && number(e)
        });
        number(whole) && number(fraction) && !(whole.is_empty() && fraction.is_empty()) && exponent_ok
    };
    if !well_formed {
        return Err("is no number");
    }
    let value: f64 = digits.parse().map_err(|_| "is no number")?;
    Ok(match (double, half) {
        (Some(_), _) => Literal::Double(value),
        (None, Some(_)) => Literal::Half(value),
        (None, None) => Literal::Float(value),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_forms_have_their_value() {
        let cases = [
            ("0", Literal::Int(0)),
            ("42u", Literal::Uint(42)),
            ("017", Literal::Int(15)),
            ("017u", Literal::Uint(15)),
            ("0xFF", Literal::Int(255)),
            ("0xffffffff", Literal::Int(-1)),
            ("0xffffffffU", Literal::Uint(u32::MAX)),
            ("1.", Literal::Float(1.0)),
            (".5", Literal::Float(0.5)),
            ("6.28125", Literal::Float(6.28125)),
            ("1e-3", Literal::Float(1e-3)),
            ("2.5E+2F", Literal::Float(250.0)),
            ("1f", Literal::Float(1.0)),
            ("1.5lf", Literal::Double(1.5)),
            ("1.5LF", Literal::Double(1.5)),
            ("1.5hf", Literal::Half(1.5)),
            ("2HF", Literal::Half(2.0)),
            ("40000us", Literal::Sized(40000, ScalarType::Uint16)),
            ("0x7FS", Literal::Sized(127, ScalarType::Int16)),
            ("017l", Literal::Sized(15, ScalarType::Int64)),
            ("18446744073709551615UL", Literal::Sized(u64::MAX, ScalarType::Uint64)),
        ];
        for (text, value) in cases {
            assert_eq!(literal(text), Ok(value), "{text}");
        }
    }

    #[test]
    fn a_suffix_of_fractions_lacks_a_point_behind_digits() {
        assert!(["0f", "12F"].iter().all(|text| lacks_point(text)));
        assert!(!["1.f", ".5f", "1e3f", "1", "f", "0xf", "1u"].iter().any(|text| lacks_point(text)));
    }

    #[test]
    fn malformed_literals_are_refused() {
        for text in [
            "1.0.0",
            "08",
            "0x",
            "0xg",
            "1.5x",
            "12abc",
            "1e",
            "1e+",
            "4294967296",
            "5uu",
            "1.0u",
            "0u1",
            ".e1",
            "1.5h",
            "65536us",
            "5su",
        ] {
            assert!(literal(text).is_err(), "{text}");
        }
    }
}
