//! Values of constant expressions.

use std::fmt;

use super::ast::{BinaryOp, UnaryOp};
use super::builtin::BuiltinFunction as F;
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
    /// The scalar type that an expression with this value has.
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

/// Rounds to binary32, to nearest even.
#[expect(clippy::cast_possible_truncation, reason = "rounding is what is wanted")]
pub(crate) fn round(value: f64) -> f32 {
    value as f32
}

/// The value as another scalar type: what a constructor such as `int(x)` or an implicit
/// conversion makes of it. None when the type is no scalar, or the value does not fit.
pub(crate) fn convert(value: Const, ty: &Type) -> Option<Const> {
    let Type::Scalar(scalar) = ty else { return None };
    let number = match value {
        Const::Bool(v) => f64::from(u8::from(v)),
        Const::Int(_) | Const::Uint(_) | Const::Float(_) | Const::Double(_) => value.as_f64()?,
    };
    Some(match scalar {
        ScalarType::Bool => Const::Bool(number != 0.0),
        ScalarType::Float => Const::Float(match value {
            Const::Float(v) => v,
            _ => round(number),
        }),
        ScalarType::Double => Const::Double(number),
        // Between the integer types the bits stay (section 5.4.1).
        ScalarType::Int => Const::Int(match value {
            Const::Uint(v) => v.cast_signed(),
            _ => integer(number, f64::from(i32::MIN), f64::from(i32::MAX)).and_then(|v| i32::try_from(v).ok())?,
        }),
        ScalarType::Uint => Const::Uint(match value {
            Const::Int(v) => v.cast_unsigned(),
            _ => integer(number, 0.0, f64::from(u32::MAX)).and_then(|v| u32::try_from(v).ok())?,
        }),
        // Constants of these types are computed when the shader runs.
        ScalarType::Int8 | ScalarType::Uint8 | ScalarType::Int16 | ScalarType::Uint16 => return None,
        ScalarType::Int64 | ScalarType::Uint64 | ScalarType::Half => return None,
    })
}

/// Drops the fraction of a number inside the range.
#[expect(clippy::cast_possible_truncation, reason = "the range was checked")]
fn integer(value: f64, least: f64, most: f64) -> Option<i64> {
    let whole = value.trunc();
    (least..=most).contains(&whole).then_some(whole as i64)
}

/// `op value`.
pub(crate) fn unary(op: UnaryOp, value: Const) -> Option<Const> {
    Some(match (op, value) {
        (UnaryOp::Plus, Const::Int(_) | Const::Uint(_) | Const::Float(_) | Const::Double(_)) => value,
        (UnaryOp::Minus, Const::Int(v)) => Const::Int(v.wrapping_neg()),
        (UnaryOp::Minus, Const::Uint(v)) => Const::Uint(v.wrapping_neg()),
        (UnaryOp::Minus, Const::Float(v)) => Const::Float(-v),
        (UnaryOp::Minus, Const::Double(v)) => Const::Double(-v),
        (UnaryOp::Not, Const::Bool(v)) => Const::Bool(!v),
        (UnaryOp::Complement, Const::Int(v)) => Const::Int(!v),
        (UnaryOp::Complement, Const::Uint(v)) => Const::Uint(!v),
        _ => return None,
    })
}

/// `left op right`; none for what has no value, such as an integer divided by 0.
pub(crate) fn binary(op: BinaryOp, left: Const, right: Const) -> Option<Const> {
    use Const::{Bool, Double, Float, Int, Uint};
    if matches!(op, BinaryOp::Shl | BinaryOp::Shr) {
        let by = u32::try_from(right.as_integer()?).ok().filter(|n| *n < 32)?;
        return Some(match (op, left) {
            (BinaryOp::Shl, Int(v)) => Int(v << by),
            (BinaryOp::Shl, Uint(v)) => Uint(v << by),
            (_, Int(v)) => Int(v >> by),
            (_, Uint(v)) => Uint(v >> by),
            _ => return None,
        });
    }
    let (left, right) = same_type(left, right)?;
    Some(match (left, right) {
        (Bool(a), Bool(b)) => Bool(match op {
            BinaryOp::And => a && b,
            BinaryOp::Or => a || b,
            BinaryOp::Xor | BinaryOp::NotEqual => a != b,
            BinaryOp::Equal => a == b,
            _ => return None,
        }),
        (Int(a), Int(b)) => match op {
            BinaryOp::Add => Int(a.wrapping_add(b)),
            BinaryOp::Sub => Int(a.wrapping_sub(b)),
            BinaryOp::Mul => Int(a.wrapping_mul(b)),
            BinaryOp::Div => Int(a.checked_div(b)?),
            BinaryOp::Rem => Int(a.checked_rem(b)?),
            BinaryOp::BitAnd => Int(a & b),
            BinaryOp::BitOr => Int(a | b),
            BinaryOp::BitXor => Int(a ^ b),
            _ => Bool(compare(op, a, b)?),
        },
        (Uint(a), Uint(b)) => match op {
            BinaryOp::Add => Uint(a.wrapping_add(b)),
            BinaryOp::Sub => Uint(a.wrapping_sub(b)),
            BinaryOp::Mul => Uint(a.wrapping_mul(b)),
            BinaryOp::Div => Uint(a.checked_div(b)?),
            BinaryOp::Rem => Uint(a.checked_rem(b)?),
            BinaryOp::BitAnd => Uint(a & b),
            BinaryOp::BitOr => Uint(a | b),
            BinaryOp::BitXor => Uint(a ^ b),
            _ => Bool(compare(op, a, b)?),
        },
        (Float(a), Float(b)) => match op {
            BinaryOp::Add => Float(a + b),
            BinaryOp::Sub => Float(a - b),
            BinaryOp::Mul => Float(a * b),
            BinaryOp::Div => Float(a / b),
            _ => Bool(compare(op, a, b)?),
        },
        (Double(a), Double(b)) => match op {
            BinaryOp::Add => Double(a + b),
            BinaryOp::Sub => Double(a - b),
            BinaryOp::Mul => Double(a * b),
            BinaryOp::Div => Double(a / b),
            _ => Bool(compare(op, a, b)?),
        },
        _ => return None,
    })
}

fn compare<T: PartialOrd>(op: BinaryOp, a: T, b: T) -> Option<bool> {
    Some(match op {
        BinaryOp::Less => a < b,
        BinaryOp::Greater => a > b,
        BinaryOp::LessEqual => a <= b,
        BinaryOp::GreaterEqual => a >= b,
        BinaryOp::Equal => a == b,
        BinaryOp::NotEqual => a != b,
        _ => return None,
    })
}

/// Converts the lower one of two numbers to the type of the other.
fn same_type(left: Const, right: Const) -> Option<(Const, Const)> {
    let scalar = |c: Const| c.ty().scalar();
    let (a, b) = (scalar(left)?, scalar(right)?);
    if (a == ScalarType::Bool) != (b == ScalarType::Bool) {
        return None;
    }
    // The order of `ScalarType` is that of the conversions.
    let to = Type::Scalar(a.max(b));
    Some((convert(left, &to)?, convert(right, &to)?))
}

/// A built-in function of scalars, where the result is exact or, for the transcendental ones,
/// binary64 rounded once.
pub(crate) fn call(name: F, args: &[Const]) -> Option<Const> {
    let floats: Option<Vec<f64>> = args.iter().map(|a| a.as_f64()).collect();
    let floats = floats?;
    let of = |v: f64| -> Option<Const> {
        match args.iter().map(|a| a.ty()).find_map(|t| t.scalar().filter(|s| s.is_floating())) {
            Some(ScalarType::Double) => Some(Const::Double(v)),
            _ => Some(Const::Float(round(v))),
        }
    };
    let pick = |i: usize| {
        let highest = args.iter().filter_map(|a| a.ty().scalar()).max()?;
        convert(*args.get(i)?, &Type::Scalar(highest))
    };
    match (name, floats.as_slice()) {
        (F::Radians, [x]) => of(x.to_radians()),
        (F::Degrees, [x]) => of(x.to_degrees()),
        (F::Sin, [x]) => of(x.sin()),
        (F::Cos, [x]) => of(x.cos()),
        (F::Tan, [x]) => of(x.tan()),
        (F::Atan, [x]) => of(x.atan()),
        (F::Acos, [x]) if x.abs() <= 1.0 => of(x.acos()),
        (F::Asin, [x]) if x.abs() <= 1.0 => of(x.asin()),
        (F::Exp, [x]) => of(x.exp()),
        (F::Exp2, [x]) => of(x.exp2()),
        (F::Log, [x]) if *x > 0.0 => of(x.ln()),
        (F::Log2, [x]) if *x > 0.0 => of(x.log2()),
        (F::Sqrt, [x]) if *x >= 0.0 => of(x.sqrt()),
        (F::Inversesqrt, [x]) if *x > 0.0 => of(1.0 / x.sqrt()),
        (F::Pow, [x, y]) if *x > 0.0 => of(x.powf(*y)),
        (F::Floor, [x]) => of(x.floor()),
        (F::Ceil, [x]) => of(x.ceil()),
        (F::Abs, [_]) => match args[0] {
            Const::Int(v) => Some(Const::Int(v.wrapping_abs())),
            Const::Float(v) => Some(Const::Float(v.abs())),
            Const::Double(v) => Some(Const::Double(v.abs())),
            Const::Bool(_) | Const::Uint(_) => None,
        },
        (F::Min, [a, b]) => pick(usize::from(b < a)),
        (F::Max, [a, b]) => pick(usize::from(a < b)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_is_that_of_the_language() {
        use Const::{Bool, Float, Int, Uint};
        let cases = [
            (BinaryOp::Div, Int(7), Int(-2), Some(Int(-3))),
            (BinaryOp::Div, Int(1), Int(0), None),
            (BinaryOp::Add, Int(i32::MAX), Int(1), Some(Int(i32::MIN))),
            (BinaryOp::Mul, Int(3), Float(0.5), Some(Float(1.5))),
            // 0.1 + 0.2 rounds to binary32 after each step.
            (BinaryOp::Add, Float(0.1), Float(0.2), Some(Float(0.1_f32 + 0.2_f32))),
            (BinaryOp::Shl, Uint(1), Int(4), Some(Uint(16))),
            (BinaryOp::Shl, Int(1), Int(32), None),
            (BinaryOp::Less, Int(1), Float(1.5), Some(Bool(true))),
            (BinaryOp::Xor, Bool(true), Bool(true), Some(Bool(false))),
        ];
        for (op, a, b, want) in cases {
            assert_eq!(binary(op, a, b), want, "{a} {} {b}", op.text());
        }
    }

    #[test]
    fn conversions_keep_bits_between_integers_and_refuse_what_does_not_fit() {
        assert_eq!(convert(Const::Int(-1), &Type::UINT), Some(Const::Uint(u32::MAX)));
        assert_eq!(convert(Const::Float(3.9), &Type::INT), Some(Const::Int(3)));
        assert_eq!(convert(Const::Float(3e10), &Type::INT), None);
        assert_eq!(convert(Const::Float(f32::NAN), &Type::INT), None);
        assert_eq!(call(F::Max, &[Const::Int(2), Const::Float(1.0)]), Some(Const::Float(2.0)));
        assert_eq!(call(F::Sqrt, &[Const::Float(-1.0)]), None);
    }
}
