//! What a domain of numbers must be able to do.
//!
//! The interpreter splits every operation on vectors and matrices, and every function that the
//! specifications define by a formula (`dot`, `length`, `mix`, matrix products …), into the scalar
//! operations of this file, in the order of the source. A domain gives these a meaning. It sees
//! columns: one value for each slot. Integers and booleans are exact in every domain, and the
//! interpreter keeps them itself.
//!
//! An operation may be carried out in all slots, those that do not take this path included: what they
//! get is never looked at. [`Domain::merge`] and [`Domain::poison`] alone have to respect their mask.

use super::code::Guarded;
use super::slots::{Mask, Words};
use crate::{Grade, Manner};
use base::value::Scalar;

/// Names the expression that an operation belongs to; see
/// [`Executable::place`](super::Executable::place).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Site(u32);

/// Bits of a site that are its number; those above say how its operations are done.
const NUMBER: u32 = (1 << 28) - 1;

impl Site {
    pub(super) fn new(index: usize) -> Self {
        Self(index as u32 & NUMBER)
    }

    /// The same place, with operations that are done in a manner.
    #[must_use]
    pub fn done(self, manner: Manner) -> Self {
        let grade = match manner.grade {
            Grade::Full => 0,
            Grade::Medium => 1 << 28,
            Grade::Low => 2 << 28,
            Grade::Half => 3 << 28,
        };
        Self(self.0 & NUMBER | grade | u32::from(manner.precise) << 30 | u32::from(manner.ties) << 31)
    }

    /// The same place, with an operation that rounds halves in a direction that the implementation chooses.
    #[must_use]
    pub fn open_at_ties(self) -> Self {
        Self(self.0 | 1 << 31)
    }

    /// True where the implementation chooses the direction in which halves are rounded.
    pub fn is_open_at_ties(self) -> bool {
        self.0 >> 31 == 1
    }

    /// Number of the site, counted from 0 in each executable.
    pub fn index(self) -> usize {
        (self.0 & NUMBER) as usize
    }

    /// The precision at which its operations are done: that of binary16 for numbers of that type; else full, but in a
    /// program that was compiled to be [lowered](super::compile_lowered).
    pub fn grade(self) -> Grade {
        match self.0 >> 28 & 3 {
            0 => Grade::Full,
            1 => Grade::Medium,
            2 => Grade::Low,
            _ => Grade::Half,
        }
    }

    /// The same place, with operations that may be regrouped and contracted.
    #[must_use]
    pub fn without_precise(self) -> Self {
        Self(self.0 & !(1 << 30))
    }

    /// True where nothing may be regrouped or contracted.
    pub fn is_precise(self) -> bool {
        self.0 >> 30 & 1 == 1
    }
}

/// An operation on one real number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unary {
    /// −x; exact.
    Negate,
    /// |x|; exact.
    Abs,
    /// −1, 0 or 1.
    Sign,
    /// Largest integer ≤ x.
    Floor,
    /// Smallest integer ≥ x.
    Ceil,
    /// Nearest integer, halves to even.
    Round,
    /// Integer part.
    Trunc,
    /// x − ⌊x⌋, rounded once.
    Fract,
    /// √x.
    Sqrt,
    /// 1/√x.
    InverseSqrt,
    /// e^x.
    Exp,
    /// 2^x.
    Exp2,
    /// ln x.
    Log,
    /// log₂ x.
    Log2,
    /// sin x.
    Sin,
    /// cos x.
    Cos,
    /// tan x.
    Tan,
    /// arcsin x.
    Asin,
    /// arccos x.
    Acos,
    /// arctan x.
    Atan,
    /// sinh x.
    Sinh,
    /// cosh x.
    Cosh,
    /// tanh x.
    Tanh,
    /// arsinh x.
    Asinh,
    /// arcosh x.
    Acosh,
    /// artanh x.
    Atanh,
    /// x·π/180.
    Radians,
    /// x·180/π.
    Degrees,
    /// Nearest binary16.
    Half,
    /// Fraction of x = f·2^e with ½ ≤ |f| < 1.
    FrexpFraction,
    /// 1/√x as the factor of `normalize`, which specifications define in more than one way.
    NormalScale,
    /// x, the result of `determinant`: specifications promise nothing for it.
    Determinant,
    /// x, a component of `inverse`: specifications promise nothing for it.
    Inverse,
    /// x, as a number of the precision of its site: what a variable of `mediump` takes.
    Narrow,
}

impl Unary {
    /// All of them but `Narrow`, which no function of a module is.
    pub const ALL: [Self; 33] = [
        Self::Negate,
        Self::Abs,
        Self::Sign,
        Self::Floor,
        Self::Ceil,
        Self::Round,
        Self::Trunc,
        Self::Fract,
        Self::Sqrt,
        Self::InverseSqrt,
        Self::Exp,
        Self::Exp2,
        Self::Log,
        Self::Log2,
        Self::Sin,
        Self::Cos,
        Self::Tan,
        Self::Asin,
        Self::Acos,
        Self::Atan,
        Self::Sinh,
        Self::Cosh,
        Self::Tanh,
        Self::Asinh,
        Self::Acosh,
        Self::Atanh,
        Self::Radians,
        Self::Degrees,
        Self::Half,
        Self::FrexpFraction,
        Self::NormalScale,
        Self::Determinant,
        Self::Inverse,
    ];

    /// True when the two have the same values everywhere and differ in what is promised alone.
    pub fn equals(self, other: Self) -> bool {
        let value = |op| match op {
            Self::NormalScale => Self::InverseSqrt,
            Self::Inverse => Self::Determinant,
            op => op,
        };
        value(self) == value(other)
    }
}

/// An operation on two real numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Binary {
    /// a + b.
    Add,
    /// a − b.
    Subtract,
    /// a·b.
    Multiply,
    /// a/b.
    Divide,
    /// a − b·trunc(a/b).
    Remainder,
    /// The lesser; `a` unless `b < a`.
    Min,
    /// The greater; `a` unless `a < b`.
    Max,
    /// a^b for a ≥ 0; no number for a < 0, as in GLSL.
    Pow,
    /// Angle of the point (b, a).
    Atan2,
    /// 0 where b < a, else 1.
    Step,
}

impl Binary {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Add,
        Self::Subtract,
        Self::Multiply,
        Self::Divide,
        Self::Remainder,
        Self::Min,
        Self::Max,
        Self::Pow,
        Self::Atan2,
        Self::Step,
    ];
}

/// A question about two real numbers. NaN answers no to all but `NotEqual`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Comparison {
    /// a = b.
    Equal,
    /// a ≠ b.
    NotEqual,
    /// a < b.
    Less,
    /// a ≤ b.
    LessEqual,
    /// a > b.
    Greater,
    /// a ≥ b.
    GreaterEqual,
}

impl Comparison {
    /// The answer for two numbers.
    #[inline]
    pub fn holds<T: PartialOrd>(self, a: T, b: T) -> bool {
        match self {
            Self::Equal => a == b,
            Self::NotEqual => a != b,
            Self::Less => a < b,
            Self::LessEqual => a <= b,
            Self::Greater => a > b,
            Self::GreaterEqual => a >= b,
        }
    }
}

/// A question about one real number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Class {
    /// Is it NaN?
    Nan,
    /// Is it infinite?
    Infinite,
}

/// From a real number to a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ToWords {
    /// Signed integer: towards 0, clamped to the binary32 numbers of the range; 0 for NaN.
    Signed,
    /// Unsigned integer: towards 0, clamped to the binary32 numbers of the range; 0 for NaN.
    Unsigned,
    /// The bits of the nearest binary32.
    Bits,
    /// The bits of the nearest binary16.
    HalfBits,
    /// Exponent of x = f·2^e with ½ ≤ |f| < 1, signed; 0 for 0.
    FrexpExponent,
    /// The texel in which a coordinate lies, signed: ⌊x⌋ clamped to a range; the lower end for NaN.
    Texel {
        /// Lower end.
        low: i32,
        /// Upper end.
        high: i32,
    },
}

/// From a word to a real number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FromWords {
    /// A signed integer, rounded where the domain has not enough digits.
    Signed,
    /// An unsigned integer, rounded where the domain has not enough digits.
    Unsigned,
    /// The bits of a binary32.
    Bits,
    /// The lower 16 bits as a binary16.
    HalfBits,
}

/// Where an input comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WordSource {
    /// A word of the record of the invocation.
    Invocation(u32),
    /// A word of the record of the case.
    Case(u32),
}

/// A domain of numbers, with what it has to remember about one chunk of slots.
pub trait Domain {
    /// One value for each slot. A default column need not hold any: it marks a place.
    type Column: Default + Send;
    /// What an output word is handed out as.
    type Word: Copy + Default + Send + Sync + std::fmt::Debug;

    /// Forgets the last chunk.
    fn begin(&mut self) {}
    /// A column that holds zeros.
    fn column(&mut self) -> Self::Column;
    /// A constant, exactly as it stands in the module: binary32. `site` is `None` for a number of a
    /// defining formula, such as the 3 in `smoothstep`.
    fn constant(&mut self, site: Option<Site>, value: f32, out: &mut Self::Column);
    /// An input: the bits of binary32 numbers.
    fn input(&mut self, source: WordSource, words: &Words, out: &mut Self::Column);
    /// An operation on one number. Results matter in the slots of `active` alone.
    fn unary(&mut self, site: Site, op: Unary, active: &Mask, a: &Self::Column, out: &mut Self::Column);
    /// An operation on two numbers. Results matter in the slots of `active` alone.
    fn binary(
        &mut self,
        site: Site,
        op: Binary,
        active: &Mask,
        a: &Self::Column,
        b: &Self::Column,
        out: &mut Self::Column,
    );
    /// a·2^e for signed integers e.
    fn scale(&mut self, site: Site, a: &Self::Column, exponent: &Words, out: &mut Self::Column);
    /// Compares two numbers. Answers matter in the slots of `active` alone.
    fn compare(
        &mut self,
        site: Site,
        op: Comparison,
        active: &Mask,
        a: &Self::Column,
        b: &Self::Column,
        out: &mut Words,
    );
    /// Notes a question about two whole numbers, which the interpreter answers itself. Only the slots of `active`
    /// ask it.
    #[inline]
    fn compare_words(&mut self, site: Site, op: Comparison, signed: bool, active: &Mask, a: &Words, b: &Words) {
        let _ = (site, op, signed, active, a, b);
    }
    /// Asks what kind of number it is. Answers matter in the slots of `active` alone.
    fn classify(&mut self, site: Site, class: Class, active: &Mask, a: &Self::Column, out: &mut Words);
    /// Converts to words. Gives the slots whose value does not fit. Results matter in the slots of
    /// `active` alone.
    fn words_of(&mut self, site: Site, op: ToWords, active: &Mask, a: &Self::Column, out: &mut Words) -> Mask;
    /// Converts from words.
    fn reals_of(&mut self, site: Site, op: FromWords, a: &Words, out: &mut Self::Column);
    /// Slots of `active` in which the result of a function is undefined; none for a domain that does not look.
    fn outside(&self, what: Guarded, active: &Mask, x: &Self::Column, y: &Self::Column) -> Mask {
        let _ = (what, active, x, y);
        Mask::NONE
    }
    /// Arguments in one slot as numbers, for messages.
    fn shown(&self, column: &Self::Column, slot: usize) -> f64 {
        let _ = (column, slot);
        f64::NAN
    }
    /// Notes that what comes of this place in these slots is not promised.
    fn doubt(&mut self, site: Site, slots: &Mask) {
        let _ = (site, slots);
    }
    /// True when it has no room for another round of a loop: the slots that go on are given up then.
    fn is_full(&self) -> bool {
        false
    }
    /// Notes that these slots are given up in a loop: nothing is known of what comes of them.
    fn give_up(&mut self, site: Site, slots: &Mask) {
        let _ = (site, slots);
    }
    /// Copies a column.
    fn copy(&mut self, from: &Self::Column, to: &mut Self::Column);
    /// Copies the slots of `mask` and leaves the others.
    fn merge(&mut self, mask: &Mask, from: &Self::Column, to: &mut Self::Column);
    /// Marks the slots of `mask` as never written.
    fn poison(&mut self, mask: &Mask, to: &mut Self::Column);
    /// The value of a slot as an output word; `None` when it was never written.
    fn word(&self, column: &Self::Column, slot: usize) -> Option<Self::Word>;
    /// An exact word as an output word.
    fn exact(word: u32, scalar: Scalar) -> Self::Word;
}
