//! What programs ask of numbers, which sides the answers have, and which classes of arguments there are.

use program::interp::{Binary, Comparison, ToWords, Unary};

/// The side of a slot that did not come to a question.
pub const UNASKED: i8 = i8::MIN;
/// The side of NaN.
const NONE: i8 = i8::MAX;

/// A question about one or two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Question {
    /// A comparison that the author wrote.
    Comparison(Comparison),
    /// Which of two numbers a built-in function takes: `min`, `max`, `clamp`, `step`.
    Choice(Binary),
    /// On which side of zero a number lies, for a function with a bend there.
    Sign(Unary),
    /// Between which whole numbers a number lies.
    Whole(Whole),
    /// The argument of a function that is smooth inside of its domain. It has classes and no sides.
    Argument(Unary),
    /// The base of a power, likewise.
    Base,
}

/// A function with jumps at whole numbers or halves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Whole {
    /// `floor`, `fract`, and all that is made of them.
    Floor,
    /// `ceil`.
    Ceil,
    /// `round`.
    Round,
    /// `trunc`, and conversions to integers.
    Trunc,
}

// Sites have an order; questions need one to be sorted with them.
impl PartialOrd for Question {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Question {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.rank().cmp(&other.rank())
    }
}

/// −1, 0 or 1, as the first number is less, equal or greater; [`NONE`] for NaN.
fn order(a: f64, b: f64) -> i8 {
    a.partial_cmp(&b).map_or(NONE, |order| order as i8)
}

/// The sides of numbers between whole numbers repeat after this many: neighbours differ.
const TURN: f64 = 61.0;

impl Question {
    fn rank(self) -> (u8, u8) {
        match self {
            Self::Comparison(op) => (0, op as u8),
            Self::Choice(op) => (1, op as u8),
            Self::Sign(op) => (2, op as u8),
            Self::Whole(op) => (3, op as u8),
            Self::Argument(op) => (4, op as u8),
            Self::Base => (5, 0),
        }
    }

    /// The question that a function of one number asks.
    pub fn of_unary(op: Unary) -> Option<Self> {
        Some(match op {
            Unary::Abs | Unary::Sign => Self::Sign(op),
            Unary::Floor | Unary::Fract => Self::Whole(Whole::Floor),
            Unary::Ceil => Self::Whole(Whole::Ceil),
            Unary::Round => Self::Whole(Whole::Round),
            Unary::Trunc => Self::Whole(Whole::Trunc),
            Unary::Sqrt
            | Unary::InverseSqrt
            | Unary::NormalScale
            | Unary::Log
            | Unary::Log2
            | Unary::Exp
            | Unary::Exp2
            | Unary::Sin
            | Unary::Cos
            | Unary::Tan
            | Unary::Asin
            | Unary::Acos
            | Unary::Atan
            | Unary::Sinh
            | Unary::Cosh
            | Unary::Tanh
            | Unary::Asinh
            | Unary::Acosh
            | Unary::Atanh => Self::Argument(op),
            Unary::Negate
            | Unary::Radians
            | Unary::Degrees
            | Unary::Half
            | Unary::FrexpFraction
            | Unary::Determinant
            | Unary::Inverse
            | Unary::Narrow => return None,
        })
    }

    /// The question that a function of two numbers asks.
    pub fn of_binary(op: Binary) -> Option<Self> {
        match op {
            Binary::Min | Binary::Max | Binary::Step => Some(Self::Choice(op)),
            Binary::Pow => Some(Self::Base),
            Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide | Binary::Remainder | Binary::Atan2 => {
                None
            }
        }
    }

    /// The question that a conversion asks.
    pub fn of_conversion(op: ToWords) -> Option<Self> {
        match op {
            ToWords::Signed | ToWords::Unsigned => Some(Self::Whole(Whole::Trunc)),
            ToWords::Bits | ToWords::HalfBits | ToWords::FrexpExponent | ToWords::Texel { .. } => None,
        }
    }

    /// True for a question whose answer changes at a boundary.
    pub fn is_searched(self) -> bool {
        match self {
            Self::Comparison(_) | Self::Choice(_) | Self::Sign(_) | Self::Whole(_) => true,
            Self::Argument(_) | Self::Base => false,
        }
    }

    /// The side on which numbers lie, how far they are from another side (NaN where that is no distance), and the class
    /// of the arguments: an index into [`Question::classes`].
    pub fn answer(self, a: f64, b: f64) -> (i8, f64, u8) {
        let ordered = |order: i8| match order {
            -1 => 0,
            0 => 1,
            1 => 2,
            _ => 3,
        };
        match self {
            Self::Comparison(op) => (order(a, b), a - b, u8::from(op.holds(a, b))),
            Self::Choice(_) => (order(a, b), a - b, ordered(order(a, b))),
            Self::Sign(_) => (order(a, 0.0), a, ordered(order(a, 0.0))),
            Self::Whole(op) => {
                let part = match op {
                    Whole::Floor => a.floor(),
                    Whole::Ceil => a.ceil(),
                    Whole::Round => a.round_ties_even(),
                    Whole::Trunc => a.trunc(),
                };
                let side = if part.is_finite() { part.rem_euclid(TURN) as i8 } else { NONE };
                let class = if a.is_nan() {
                    3
                } else if a == part {
                    1
                } else {
                    2 * u8::from(a > 0.0)
                };
                (side, f64::NAN, class)
            }
            Self::Argument(op) => (UNASKED, f64::NAN, argument(op, a)),
            Self::Base => (UNASKED, f64::NAN, size(a)),
        }
    }

    /// Names of the classes of arguments, in the order of their numbers. NaN has none.
    pub fn classes(self) -> &'static [&'static str] {
        match self {
            Self::Comparison(_) => &["false", "true"],
            Self::Choice(_) => &["less", "equal", "greater"],
            Self::Sign(_) => &["negative", "zero", "positive"],
            Self::Whole(_) => &["negative fraction", "whole", "positive fraction"],
            Self::Argument(op) => match op {
                Unary::Sin | Unary::Cos | Unary::Tan => &["up to pi", "beyond pi"],
                Unary::Sqrt | Unary::InverseSqrt | Unary::NormalScale | Unary::Log | Unary::Log2 => SIZES,
                Unary::Asin | Unary::Acos | Unary::Atanh => &["inside (-1, 1)", "-1 or 1", "outside"],
                _ => &["negative", "zero", "positive"],
            },
            Self::Base => SIZES,
        }
    }

    /// What asks, in a word: `clamp` asks as `max` and as `min`.
    pub fn name(self) -> String {
        match self {
            Self::Comparison(_) => "comparison".to_owned(),
            Self::Choice(op) => format!("{op:?}").to_lowercase(),
            Self::Whole(op) => format!("{op:?}").to_lowercase(),
            Self::Argument(Unary::NormalScale) => "normalize".to_owned(),
            Self::Sign(op) | Self::Argument(op) => format!("{op:?}").to_lowercase(),
            Self::Base => "pow".to_owned(),
        }
    }

    /// True when the author wrote a comparison, false for a call of a built-in function.
    pub fn is_comparison(self) -> bool {
        matches!(self, Self::Comparison(_))
    }
}

/// Classes of numbers that should not be negative.
const SIZES: &[&str] = &["negative", "zero", "below 1", "1 or more"];

fn size(x: f64) -> u8 {
    match x {
        x if x < 0.0 => 0,
        0.0 => 1,
        x if x < 1.0 => 2,
        x if x >= 1.0 => 3,
        _ => 4,
    }
}

fn argument(op: Unary, x: f64) -> u8 {
    match op {
        Unary::Sin | Unary::Cos | Unary::Tan => match x.abs() {
            x if x <= std::f64::consts::PI => 0,
            x if x.is_nan() => 2,
            _ => 1,
        },
        Unary::Sqrt | Unary::InverseSqrt | Unary::NormalScale | Unary::Log | Unary::Log2 => size(x),
        Unary::Asin | Unary::Acos | Unary::Atanh => match order(x.abs(), 1.0) {
            -1 => 0,
            0 => 1,
            1 => 2,
            _ => 3,
        },
        _ => match order(x, 0.0) {
            -1 => 0,
            0 => 1,
            1 => 2,
            _ => 3,
        },
    }
}
