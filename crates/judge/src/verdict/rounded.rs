//! Literals that are known constants in few digits: `3.141593` for π. Textbooks print them, and the shader means the
//! constant.

use std::f64::consts::{E, FRAC_2_SQRT_PI, LN_2, LN_10, LOG2_E, LOG10_E, PI, SQRT_2};

use base::text::Span;
use program::Program;

/// What is made of literals that are known constants in few digits.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Literals {
    /// Where the shader deviates with the digits that are written, it is judged with the constant.
    #[default]
    Meant,
    /// Every literal counts as it is written.
    Exact,
    /// As `Meant`, for these numbers alone.
    Only(Vec<f64>),
}

impl Literals {
    /// Values of the key `literals` of a suite.
    pub const NAMES: [&str; 2] = ["meant", "exact"];

    /// By the name in a suite.
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "meant" => Some(Self::Meant),
            "exact" => Some(Self::Exact),
            _ => None,
        }
    }

    fn allow(&self, value: f64) -> bool {
        match self {
            Self::Meant => true,
            Self::Exact => false,
            Self::Only(values) => values.contains(&value),
        }
    }
}

/// A literal that is a known constant, correctly rounded or cut to the digits that are written.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounded {
    /// Where it stands in the author's text.
    pub span: Span,
    /// The digits as a number.
    pub written: f64,
    /// The constant in words, such as `2π`.
    pub name: &'static str,
    /// The constant rounded to binary64.
    pub meant: f64,
    /// Significant digits that are written.
    pub digits: usize,
}

/// Significant digits that every number of binary32 carries: FLT_DIG of C.
const DIGITS: usize = f32::DIGITS as usize;

impl Rounded {
    /// True for as many digits as binary32 surely carries.
    pub fn is_precise(&self) -> bool {
        self.digits >= DIGITS
    }

    /// True where a device gets another number than the constant's binary32.
    pub fn is_seen(&self) -> bool {
        self.written as f32 != self.meant as f32
    }
}

const SQRT_3: f64 = 1.732_050_807_568_877_2;
const SQRT_5: f64 = 2.236_067_977_499_79;

/// Numbers that authors write in digits.
pub(super) const CONSTANTS: &[(&str, f64)] = &[
    ("π", PI),
    ("2π", 2.0 * PI),
    ("3π", 3.0 * PI),
    ("4π", 4.0 * PI),
    ("π/2", PI / 2.0),
    ("3π/2", 1.5 * PI),
    ("π/3", PI / 3.0),
    ("2π/3", 2.0 * PI / 3.0),
    ("4π/3", 4.0 * PI / 3.0),
    ("π/4", PI / 4.0),
    ("3π/4", 0.75 * PI),
    ("π/5", PI / 5.0),
    ("2π/5", 0.4 * PI),
    ("π/6", PI / 6.0),
    ("π/8", PI / 8.0),
    ("π/12", PI / 12.0),
    ("1/π", 1.0 / PI),
    ("1/2π", 0.5 / PI),
    ("1/4π", 0.25 / PI),
    ("2/π", 2.0 / PI),
    ("4/π", 4.0 / PI),
    ("π²", PI * PI),
    ("π/180", PI / 180.0),
    ("π/360", PI / 360.0),
    ("180/π", 180.0 / PI),
    ("√π", 1.772_453_850_905_516),
    ("2/√π", FRAC_2_SQRT_PI),
    ("1/√π", 0.564_189_583_547_756_3),
    ("√2π", 2.506_628_274_631_000_5),
    ("1/√2π", 0.398_942_280_401_432_7),
    ("e", E),
    ("1/e", 1.0 / E),
    ("√2", SQRT_2),
    ("1/√2", SQRT_2 / 2.0),
    ("√3", SQRT_3),
    ("√3/2", SQRT_3 / 2.0),
    ("1/√3", SQRT_3 / 3.0),
    ("(√3 - 1)/2", (SQRT_3 - 1.0) / 2.0),
    ("(3 - √3)/6", (3.0 - SQRT_3) / 6.0),
    ("√5", SQRT_5),
    ("(√5 - 1)/4", (SQRT_5 - 1.0) / 4.0),
    ("(5 - √5)/20", (5.0 - SQRT_5) / 20.0),
    ("(1 + √5)/2", (1.0 + SQRT_5) / 2.0),
    ("(√5 - 1)/2", (SQRT_5 - 1.0) / 2.0),
    ("π(3 - √5)", PI * (3.0 - SQRT_5)),
    ("ln 2", LN_2),
    ("1/ln 2", LOG2_E),
    ("ln 10", LN_10),
    ("1/ln 10", LOG10_E),
    ("log2 10", LN_10 / LN_2),
    ("log10 2", LN_2 / LN_10),
    ("1/3", 1.0 / 3.0),
    ("2/3", 2.0 / 3.0),
    ("4/3", 4.0 / 3.0),
    ("5/3", 5.0 / 3.0),
    ("1/6", 1.0 / 6.0),
    ("5/6", 5.0 / 6.0),
    ("1/7", 1.0 / 7.0),
    ("1/9", 1.0 / 9.0),
    ("2/9", 2.0 / 9.0),
    ("4/9", 4.0 / 9.0),
    ("1/11", 1.0 / 11.0),
    ("5/11", 5.0 / 11.0),
    ("1/12", 1.0 / 12.0),
    ("5/12", 5.0 / 12.0),
    ("7/12", 7.0 / 12.0),
    ("1/2.2", 1.0 / 2.2),
    ("1/2.4", 1.0 / 2.4),
    ("1/12.92", 1.0 / 12.92),
    ("1/255", 1.0 / 255.0),
    ("1/65535", 1.0 / 65535.0),
];

/// The constant that a positive number is, in the digits in which it is written.
fn constant(written: f64) -> Option<(&'static str, f64, usize)> {
    // The shortest digits that give the number are those that are written, zeros at the end aside.
    let text = written.to_string();
    let decimals = text.split_once('.')?.1.len();
    let digits = text.trim_start_matches(['0', '.']).bytes().filter(u8::is_ascii_digit).count();
    CONSTANTS.iter().find_map(|&(name, value)| {
        // Cheap, and so far off that no digits are right.
        if (written - value).abs() > 0.1 * value {
            return None;
        }
        let rounded = format!("{value:.decimals$}");
        let exact = format!("{value:.20}");
        let cut = &exact[..exact.len() - (20 - decimals.min(20))];
        let same = |text: &str| text.parse() == Ok(written);
        (same(&rounded) || same(cut)).then_some((name, value, digits))
    })
}

/// The literals of a program that are known constants in few digits.
pub(super) fn find(program: &Program, literals: &Literals) -> Vec<Rounded> {
    let all = program.constants.literals().into_iter().filter(|literal| literals.allow(literal.value));
    let rounded = all.filter_map(|literal| {
        let (name, meant, digits) = constant(literal.value)?;
        let differs = literal.value != meant;
        // One or two digits are a number of their own.
        let is_written_out = digits >= 3;
        (differs && is_written_out).then_some(Rounded {
            span: literal.span,
            written: literal.value,
            name,
            meant,
            digits,
        })
    });
    rounded.collect()
}

#[cfg(test)]
#[expect(clippy::approx_constant, reason = "the digits that authors write")]
mod tests {
    use super::*;

    #[test]
    fn rounded_and_cut_digits_stand_for_a_constant() {
        for (written, name, digits) in [
            (3.141593, "π", 7),
            (3.14159, "π", 6),
            (3.141592, "π", 7),
            (3.14, "π", 3),
            (3.1416, "π", 5),
            (6.283185, "2π", 7),
            (0.017453, "π/180", 5),
            (0.0174533, "π/180", 6),
            (57.29578, "180/π", 7),
            (2.718282, "e", 7),
            (1.414214, "√2", 7),
            (0.707107, "1/√2", 6),
            (0.333333, "1/3", 6),
            (0.666667, "2/3", 6),
            (0.666666, "2/3", 6),
            (1.618034, "(1 + √5)/2", 7),
            (0.693147, "ln 2", 6),
            (0.577350, "1/√3", 5),
        ] {
            let found = constant(written).map(|(name, _, digits)| (name, digits));
            assert_eq!(found, Some((name, digits)), "{written}");
        }
    }

    #[test]
    fn other_digits_do_not() {
        for written in [3.241593, 3.141594, 3.14160, 3.1415929, 3.15, 6.283186, 0.333334, 2.71829, 3.0, 1e-30, 1e30] {
            let found = constant(written).filter(|_| written != 3.14160);
            assert_eq!(found, None, "{written}");
        }
        // Its zero at the end is not seen: four decimals of π.
        assert_eq!(constant(3.14160).map(|(_, _, digits)| digits), Some(5));
    }

    #[test]
    fn the_neighbours_in_binary32_of_a_long_literal_do_not_hide_behind_its_constant() {
        // A mutant of π by one step of binary32 is printed as 3.141593: it is told apart by what the original has.
        assert!(Literals::Meant.allow(3.141593) && !Literals::Exact.allow(3.141593));
        assert!(!Literals::Only(vec![3.14]).allow(3.141593) && Literals::Only(vec![3.14]).allow(3.14));
    }
}
