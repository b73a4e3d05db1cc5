//! What the specifications say of built-in functions, operators and conversions at their edges, as data: a row for each, with
//! inputs of every corner that it has and the values that are right there.
//!
//! [`of_function`], [`of_math`], [`of_binary`], [`of_unary`] and [`of_operation`] lead from every built-in to its rows, so that one
//! without a row does not compile.
//!
//! Tests ask the judge to accept the words that are right in a row and to refuse wrong ones, and run every lane on
//! it. What no lane can be held to is listed in the test, with its reason.

mod functions;
mod number;
mod table;

use std::fmt;

use base::value::Scalar;

pub use functions::{of_binary, of_function, of_math, of_operation, of_unary};
pub use number::{Case, Values};

/// A language that a table has a column for. What GLSL becomes in SPIR-V is held to what GLSL says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Language {
    /// GLSL 4.60, and GLSL ES where it has the function.
    Glsl,
    /// WGSL.
    Wgsl,
    /// HLSL of shader model 6.
    Hlsl,
}

impl Language {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Glsl, Self::Wgsl, Self::Hlsl];

    /// The letter in the cells of the table.
    const fn letter(self) -> char {
        match self {
            Self::Glsl => 'G',
            Self::Wgsl => 'W',
            Self::Hlsl => 'H',
        }
    }
}

impl fmt::Display for Language {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Glsl => "GLSL",
            Self::Wgsl => "WGSL",
            Self::Hlsl => "HLSL",
        })
    }
}

/// An edge of functions on numbers of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Corner {
    /// The exact value lies midway between two results.
    Tie,
    /// An argument or a result of binary32 is subnormal.
    Subnormal,
    /// The same in binary16.
    SubnormalHalf,
    /// The result is larger than any number of its type.
    Overflow,
    /// Of the arguments one is too small to be seen in the result.
    Absorption,
    /// An argument lies where the function is not defined, or at the end of where it is.
    Range,
    /// An argument is no number.
    NotANumber,
    /// A zero of either sign.
    Zero,
    /// An argument is infinite.
    Infinity,
    /// Arguments are equal, or a comparison just holds.
    Equal,
}

impl Corner {
    /// All of them, in the order of the table.
    pub const ALL: [Self; 10] = [
        Self::Tie,
        Self::Subnormal,
        Self::SubnormalHalf,
        Self::Overflow,
        Self::Absorption,
        Self::Range,
        Self::NotANumber,
        Self::Zero,
        Self::Infinity,
        Self::Equal,
    ];

    /// Its name in the book.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tie => "tie",
            Self::Subnormal => "subnormal",
            Self::SubnormalHalf => "subnormal in 16 bits",
            Self::Overflow => "overflow",
            Self::Absorption => "absorption",
            Self::Range => "out of range",
            Self::NotANumber => "NaN",
            Self::Zero => "zero",
            Self::Infinity => "infinity",
            Self::Equal => "equal operands",
        }
    }

    /// What a language says of the corner for all functions that say nothing else; none where each function has its own
    /// rule.
    pub fn rule(self, language: Language) -> Option<&'static str> {
        use Language::{Glsl, Hlsl, Wgsl};
        Some(match (self, language) {
            (Self::Tie, Glsl) => "GLSL 4.60, 4.7.1: the rounding mode is not defined and cannot be set",
            (Self::Tie, Wgsl) => "WGSL 15.7.4: correctly rounded is either neighbour of the exact value",
            (Self::Tie, Hlsl) => "Direct3D 11.3, 3.1.3: to nearest even, which SPIR-V does not promise",
            (Self::Subnormal | Self::SubnormalHalf, Glsl) => {
                "GLSL 4.60, 4.7.1: a subnormal number that is read or made may be flushed to 0"
            }
            (Self::Subnormal | Self::SubnormalHalf, Wgsl) => {
                "WGSL 15.7.2: subnormal inputs and outputs may be flushed to 0"
            }
            (Self::Subnormal | Self::SubnormalHalf, Hlsl) => {
                "Direct3D 11.3, 3.1.3: flushed, or kept, as `-denorm` says: either may come"
            }
            (Self::Overflow | Self::Infinity, Glsl) => {
                "GLSL 4.60, 4.7.1: infinities need not be supported; what they become is not defined"
            }
            (Self::Overflow | Self::Infinity | Self::NotANumber, Wgsl) => {
                "WGSL 15.7.2: implementations may assume that there is no infinity and no NaN; the value is indeterminate"
            }
            (Self::NotANumber, Glsl) => "GLSL 4.60, 4.7.1: NaNs are not required to be generated or kept",
            (Self::Overflow | Self::Infinity | Self::NotANumber, Hlsl) => {
                "HLSL: `isfinite` and the like may be folded; without `precise` no infinity and no NaN is promised"
            }
            (Self::Absorption | Self::Range | Self::Zero | Self::Equal, _) => return None,
        })
    }

    /// True where nothing is promised unless a row says so.
    const fn is_open(self) -> bool {
        matches!(self, Self::NotANumber | Self::Infinity)
    }
}

/// What a row says of a corner, in some languages.
#[derive(Debug)]
pub struct Cell {
    /// The corner.
    pub corner: Corner,
    /// Letters of the languages: `GWH`.
    languages: &'static str,
    /// Cases, as [`Case::read`] has them, with `;` between them.
    pub cases: &'static str,
}

impl Cell {
    /// Whether it is about a language.
    pub fn is_of(&self, language: Language) -> bool {
        self.languages.contains(language.letter())
    }
}

/// A built-in function, operator or conversion.
#[derive(Debug)]
pub struct Row {
    /// Its name, for people.
    pub name: &'static str,
    /// The expression in GLSL, WGSL and HLSL, of arguments x, y, z and w; empty where a language has none.
    texts: [&'static str; 3],
    /// The result and the arguments: `f`, `i`, `u`, `b`, with a digit for vectors.
    form: &'static str,
    /// Where the languages say so.
    sections: [&'static str; 3],
    /// Its corners.
    pub cells: &'static [Cell],
}

impl Row {
    /// The expression in a language; none where it has none.
    pub fn text(&self, language: Language) -> Option<&'static str> {
        Some(self.texts[language as usize]).filter(|text| !text.is_empty())
    }

    /// Where a language says it.
    pub fn section(&self, language: Language) -> &'static str {
        self.sections[language as usize]
    }

    /// The types of the result and of the arguments: scalars, and how many.
    pub fn types(&self) -> Vec<(Scalar, usize)> {
        let of = |token: &str| {
            let mut letters = token.chars();
            let scalar = match letters.next() {
                Some('i') => Scalar::I32,
                Some('u') => Scalar::U32,
                Some('b') => Scalar::Bool,
                _ => Scalar::F32,
            };
            (scalar, letters.next().and_then(|digit| digit.to_digit(10)).unwrap_or(1) as usize)
        };
        self.form.split(' ').map(of).collect()
    }

    /// The cases of a language, by corner: those of the table, and NaN and infinity in the place of each number where the
    /// table says nothing.
    pub fn cases(&self, language: Language) -> Vec<(Corner, Case)> {
        let types = self.types();
        let mut all = Vec::new();
        for corner in Corner::ALL {
            let said = |cell: &&Cell| cell.corner == corner && cell.is_of(language);
            let mut said = self.cells.iter().filter(said).peekable();
            if said.peek().is_none() && corner.is_open() {
                all.extend(Case::open(corner, &types).into_iter().map(|case| (corner, case)));
            }
            let read =
                |text: &str| Case::read(text, &types).unwrap_or_else(|why| panic!("{}: `{text}`: {why}", self.name));
            for cell in said {
                all.extend(cell.cases.split(';').map(|text| (corner, read(text))));
            }
        }
        all
    }
}

/// All rows.
pub fn rows() -> impl Iterator<Item = &'static Row> {
    table::TABLES.into_iter().flatten()
}

#[cfg(test)]
mod tests;
