//! Shapes of values that cross the border between host and shader.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// Type of one component. Each component travels as one 32-bit word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Scalar {
    /// binary32.
    F32,
    /// Two's complement integer.
    I32,
    /// Unsigned integer.
    U32,
    /// 0 or 1.
    Bool,
}

/// Shape of a value: a scalar, vector or matrix, or an array of one of them.
///
/// Words are laid out without padding: arrays element by element, matrices column by column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Shape {
    /// Type of one component.
    pub scalar: Scalar,
    /// Number of columns: 1 unless a matrix.
    pub columns: u8,
    /// Components of one column: 1 for a scalar.
    pub rows: u8,
    /// Number of elements when it is an array.
    pub array: Option<u32>,
    /// True for numbers of binary16, which are given as those of binary32.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub half: bool,
}

impl Shape {
    /// A `float`.
    pub const FLOAT: Self = Self::vector(Scalar::F32, 1);
    /// An `int`.
    pub const INT: Self = Self::vector(Scalar::I32, 1);
    /// A `vec2`.
    pub const VEC2: Self = Self::vector(Scalar::F32, 2);
    /// A `vec3`.
    pub const VEC3: Self = Self::vector(Scalar::F32, 3);
    /// A `vec4`.
    pub const VEC4: Self = Self::vector(Scalar::F32, 4);
    /// A `mat4`.
    pub const MAT4: Self = Self { scalar: Scalar::F32, columns: 4, rows: 4, array: None, half: false };

    /// A vector of `rows` components; one component is a scalar.
    pub const fn vector(scalar: Scalar, rows: u8) -> Self {
        Self { scalar, columns: 1, rows, array: None, half: false }
    }

    /// An array of `len` such values.
    #[must_use]
    pub const fn array_of(self, len: u32) -> Self {
        Self { array: Some(len), ..self }
    }

    /// The same with numbers of binary16.
    #[must_use]
    pub const fn halved(self) -> Self {
        Self { half: true, ..self }
    }

    /// The shape of one element.
    #[must_use]
    pub const fn element(self) -> Self {
        Self { array: None, ..self }
    }

    /// Words of one element.
    pub const fn element_words(self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// Number of elements: 1 unless an array.
    pub fn elements(self) -> usize {
        self.array.unwrap_or(1) as usize
    }

    /// Words of the whole value.
    pub fn words(self) -> usize {
        self.element_words() * self.elements()
    }

    /// Name of the component with the given word index, to be put behind a variable's name:
    /// `.x`, `[2].w`, `[1][3]` for a matrix column and row. Empty for a scalar.
    pub fn component_name(self, word: usize) -> String {
        let per = self.element_words();
        let element = if self.array.is_some() { format!("[{}]", word / per) } else { String::new() };
        let rest = word % per;
        let rows = self.rows as usize;
        if self.columns > 1 {
            format!("{element}[{}][{}]", rest / rows, rest % rows)
        } else if rows > 1 {
            format!("{element}.{}", ["x", "y", "z", "w"][rest])
        } else {
            element
        }
    }
}

impl fmt::Display for Shape {
    /// The GLSL spelling, such as `vec3`, `mat4x3`, `int[8]`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (scalar, prefix) = match self.scalar {
            Scalar::F32 if self.half => ("float16_t", "f16"),
            Scalar::F32 => ("float", ""),
            Scalar::I32 => ("int", "i"),
            Scalar::U32 => ("uint", "u"),
            Scalar::Bool => ("bool", "b"),
        };
        match (self.columns, self.rows) {
            (1, 1) => f.write_str(scalar)?,
            (1, n) => write!(f, "{prefix}vec{n}")?,
            (c, r) if c == r => write!(f, "{prefix}mat{c}")?,
            (c, r) => write!(f, "{prefix}mat{c}x{r}")?,
        }
        self.array.map_or(Ok(()), |len| write!(f, "[{len}]"))
    }
}

/// A spelling that is no shape.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error(
    "`{0}` is not a type that can be fed; use float, int, uint, bool, vec2 to vec4 (also ivec, uvec, bvec), mat2 to mat4 or matCxR, with [N] behind it for an array"
)]
pub struct ShapeError(pub String);

impl FromStr for Shape {
    type Err = ShapeError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let bad = || ShapeError(text.to_owned());
        let (base, array) = match text.split_once('[') {
            None => (text, None),
            Some((base, rest)) => {
                let len = rest.strip_suffix(']').and_then(|n| n.trim().parse().ok()).ok_or_else(bad)?;
                (base, Some(len))
            }
        };
        let base = base.trim();
        // Numbers of binary16 have names of their own: `float16_t`, `f16vec2`.
        if let Some(rest) = base.strip_prefix("f16").filter(|rest| rest.starts_with("vec") || rest.starts_with("mat")) {
            return Ok(Self { array, ..rest.parse::<Self>()?.halved() });
        }
        let size = |s: &str| s.parse::<u8>().ok().filter(|n| (2..=4).contains(n));
        let element = match base {
            "float" => Self::FLOAT,
            "float16_t" => Self::FLOAT.halved(),
            "int" => Self::INT,
            "uint" => Self::vector(Scalar::U32, 1),
            "bool" => Self::vector(Scalar::Bool, 1),
            _ if base.starts_with("mat") => {
                let (columns, rows) = base[3..].split_once('x').unwrap_or((&base[3..], &base[3..]));
                let (columns, rows) = (size(columns).ok_or_else(bad)?, size(rows).ok_or_else(bad)?);
                Self { scalar: Scalar::F32, columns, rows, array: None, half: false }
            }
            _ => {
                let (prefix, n) = base.split_once("vec").ok_or_else(bad)?;
                let scalar = match prefix {
                    "" => Scalar::F32,
                    "i" => Scalar::I32,
                    "u" => Scalar::U32,
                    "b" => Scalar::Bool,
                    _ => return Err(bad()),
                };
                Self::vector(scalar, size(n).ok_or_else(bad)?)
            }
        };
        Ok(Self { array, ..element })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spelling_reads_back() {
        for text in
            ["float", "ivec3", "mat4", "mat2x3", "vec4[8]", "uint[2]", "bvec2", "float16_t", "f16vec2[4]", "f16mat2"]
        {
            assert_eq!(text.parse::<Shape>().unwrap().to_string(), text);
        }
        for text in ["vec5", "mat1", "sampler2D", "vec4[", "", "dvec2", "f16ivec2", "f16f16vec2"] {
            assert!(text.parse::<Shape>().is_err(), "{text}");
        }
    }

    #[test]
    fn components_have_the_names_that_glsl_gives_them() {
        assert_eq!(Shape::VEC3.component_name(2), ".z");
        assert_eq!(Shape::MAT4.component_name(7), "[1][3]");
        assert_eq!(Shape::VEC4.array_of(8).component_name(9), "[2].y");
        assert_eq!(Shape::FLOAT.component_name(0), "");
    }
}
