//! Words of outputs as what they are.

use base::value::{F32Bits, Scalar};

/// A word with its bits: a number, an integer or a truth value, as its type says.
pub(crate) fn word(bits: u32, scalar: Scalar) -> String {
    match scalar {
        Scalar::F32 => format!("{:?}", F32Bits(bits)),
        Scalar::I32 => format!("{} (0x{bits:08x})", bits.cast_signed()),
        Scalar::U32 => format!("{bits} (0x{bits:08x})"),
        Scalar::Bool if bits <= 1 => (bits == 1).to_string(),
        Scalar::Bool => format!("0x{bits:08x}, where true is 1"),
    }
}

/// An expression, without its middle where it has more characters than these.
#[cfg(feature = "run")]
pub(crate) fn shortened(text: &str, most: usize) -> String {
    let all: Vec<char> = text.chars().collect();
    if all.len() <= most {
        return text.to_owned();
    }
    let half = (most - 1) / 2;
    let (start, end) = (&all[..half], &all[all.len() - half..]);
    start.iter().chain(&['…']).chain(end).collect()
}

/// A number in four digits, without a power of ten where people write none: 36.84, 0.001961, 2.5e9.
#[cfg(feature = "run")]
pub(crate) fn readable(x: f64) -> String {
    let short = format!("{x:.3e}");
    let plain = x == 0.0 || (1e-4..1e7).contains(&x.abs());
    if plain { short.parse::<f64>().map_or(short, |x| x.to_string()) } else { short }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_a_power_of_ten_only_where_people_write_one() {
        let all = [36.8449, 130.24, 0.001_960_78, 0.0, 2.5e9, 3e-7].map(readable);
        assert_eq!(all, ["36.84", "130.2", "0.001961", "0", "2.500e9", "3.000e-7"]);
    }

    #[test]
    fn words_are_what_their_type_says() {
        for (bits, scalar, shown) in [
            (0x3f80_0000, Scalar::F32, "1.0 (0x3f800000)"),
            (9, Scalar::I32, "9 (0x00000009)"),
            (0xffff_ffff, Scalar::I32, "-1 (0xffffffff)"),
            (0xffff_ffff, Scalar::U32, "4294967295 (0xffffffff)"),
            (0x7fff_ff80, Scalar::I32, "2147483520 (0x7fffff80)"),
            (1, Scalar::Bool, "true"),
            (0, Scalar::Bool, "false"),
            (7, Scalar::Bool, "0x00000007, where true is 1"),
        ] {
            assert_eq!(word(bits, scalar), shown);
        }
    }
}
