//! Values of constant expressions.

use std::fmt;

use super::types::{ScalarType, Type};

/// A folded scalar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Const {
    /// `bool`
    Bool(bool),
    /// `int`
    Int(i32),
    /// `uint`
    Uint(u32),
    /// `float`, rounded to binary32 after every operation
    Float(f32),
    /// `double`
    Double(f64),
}

impl Const {
    /// Its type.
    pub fn ty(self) -> Type {
        Type::Scalar(match self {
            Self::Bool(_) => ScalarType::Bool,
            Self::Int(_) => ScalarType::Int,
            Self::Uint(_) => ScalarType::Uint,
            Self::Float(_) => ScalarType::Float,
            Self::Double(_) => ScalarType::Double,
        })
    }

    /// The value of an `int` or `uint`.
    pub fn as_integer(self) -> Option<i64> {
        match self {
            Self::Int(v) => Some(i64::from(v)),
            Self::Uint(v) => Some(i64::from(v)),
            Self::Bool(_) | Self::Float(_) | Self::Double(_) => None,
        }
    }

    /// The value of any number, in binary64.
    pub fn as_f64(self) -> Option<f64> {
        match self {
            Self::Bool(_) => None,
            Self::Int(v) => Some(f64::from(v)),
            Self::Uint(v) => Some(f64::from(v)),
            Self::Float(v) => Some(f64::from(v)),
            Self::Double(v) => Some(v),
        }
    }
}

impl fmt::Display for Const {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bool(v) => write!(f, "{v}"),
            Self::Int(v) => write!(f, "{v}"),
            Self::Uint(v) => write!(f, "{v}u"),
            Self::Float(v) => write!(f, "{v:?}"),
            Self::Double(v) => write!(f, "{v:?}lf"),
        }
    }
}
