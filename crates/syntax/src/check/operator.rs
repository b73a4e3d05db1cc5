//! Result types of operators (GLSL 4.60 specification, sections 5.9 and 5.10).

use super::super::ast::{BinaryOp, UnaryOp};
use super::super::types::{Conversions, ScalarType, Type};

/// Why an operator does not take its operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Misfit {
    /// The types do not belong together.
    Operands,
    /// `%` on floating-point operands.
    FloatRemainder,
    /// Sizes of a matrix product.
    MatrixSize,
    /// `<` and the like on vectors.
    VectorRelation,
    /// `!`, `&&`, `||`, `^^` on something that is no `bool`.
    Logic,
}

/// The scalar type that both convert to.
fn common(a: ScalarType, b: ScalarType, rules: Conversions) -> Option<ScalarType> {
    if rules.scalar(a, b) {
        Some(b)
    } else if rules.scalar(b, a) {
        Some(a)
    } else {
        None
    }
}

/// Type of `left op right`.
pub(super) fn binary(op: BinaryOp, left: &Type, right: &Type, rules: Conversions) -> Result<Type, Misfit> {
    if left.is_error() || right.is_error() {
        return Ok(match op {
            // These are `bool` whatever stands around them.
            BinaryOp::Less | BinaryOp::Greater | BinaryOp::LessEqual | BinaryOp::GreaterEqual => Type::BOOL,
            BinaryOp::Equal | BinaryOp::NotEqual | BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => Type::BOOL,
            _ => Type::Error,
        });
    }
    match op {
        BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div => arithmetic(op, left, right, rules),
        BinaryOp::Rem => {
            let floating = |t: &Type| t.scalar().is_some_and(ScalarType::is_floating);
            if floating(left) || floating(right) {
                return Err(Misfit::FloatRemainder);
            }
            integers(left, right, rules)
        }
        BinaryOp::BitAnd | BinaryOp::BitXor | BinaryOp::BitOr => integers(left, right, rules),
        BinaryOp::Shl | BinaryOp::Shr => {
            // The operands may differ in sign; a scalar is not shifted by a vector.
            let integer = |t: &Type| t.scalar().is_some_and(ScalarType::is_integer);
            let sizes = match (left, right) {
                (_, Type::Scalar(_)) => true,
                (Type::Vector(_, n), Type::Vector(_, m)) => n == m,
                _ => false,
            };
            if integer(left) && integer(right) && sizes { Ok(left.clone()) } else { Err(Misfit::Operands) }
        }
        BinaryOp::Less | BinaryOp::Greater | BinaryOp::LessEqual | BinaryOp::GreaterEqual => match (left, right) {
            (Type::Scalar(a), Type::Scalar(b)) if *a != ScalarType::Bool && *b != ScalarType::Bool => {
                common(*a, *b, rules).map(|_| Type::BOOL).ok_or(Misfit::Operands)
            }
            (Type::Vector(..), _) | (_, Type::Vector(..)) => Err(Misfit::VectorRelation),
            _ => Err(Misfit::Operands),
        },
        BinaryOp::Equal | BinaryOp::NotEqual => {
            let comparable = |t: &Type| !matches!(t, Type::Void) && !t.contains_opaque();
            if comparable(left) && comparable(right) && (rules.allow(left, right) || rules.allow(right, left)) {
                Ok(Type::BOOL)
            } else {
                Err(Misfit::Operands)
            }
        }
        BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => {
            if *left == Type::BOOL && *right == Type::BOOL {
                Ok(Type::BOOL)
            } else {
                Err(Misfit::Logic)
            }
        }
    }
}

fn arithmetic(op: BinaryOp, left: &Type, right: &Type, rules: Conversions) -> Result<Type, Misfit> {
    let (Some(a), Some(b)) = (left.scalar(), right.scalar()) else { return Err(Misfit::Operands) };
    if a == ScalarType::Bool || b == ScalarType::Bool {
        return Err(Misfit::Operands);
    }
    let scalar = common(a, b, rules).ok_or(Misfit::Operands)?;
    let product = op == BinaryOp::Mul;
    match (left, right) {
        (Type::Scalar(_), other) | (other, Type::Scalar(_)) => {
            // Matrices are floating-point already; integers beside them convert.
            if matches!(other, Type::Matrix(..)) && !scalar.is_floating() {
                return Err(Misfit::Operands);
            }
            Ok(other.with_scalar(scalar))
        }
        (Type::Vector(_, n), Type::Vector(_, m)) if n == m => Ok(Type::Vector(scalar, *n)),
        (Type::Matrix(_, c, r), Type::Matrix(_, d, s)) if product => {
            if c == s {
                Ok(Type::Matrix(scalar, *d, *r))
            } else {
                Err(Misfit::MatrixSize)
            }
        }
        (Type::Matrix(_, c, r), Type::Vector(_, n)) if product => {
            if c == n {
                Ok(Type::Vector(scalar, *r))
            } else {
                Err(Misfit::MatrixSize)
            }
        }
        (Type::Vector(_, n), Type::Matrix(_, c, r)) if product => {
            if r == n {
                Ok(Type::Vector(scalar, *c))
            } else {
                Err(Misfit::MatrixSize)
            }
        }
        (Type::Matrix(_, c, r), Type::Matrix(_, d, s)) if (c, r) == (d, s) => Ok(Type::Matrix(scalar, *c, *r)),
        _ => Err(Misfit::Operands),
    }
}

fn integers(left: &Type, right: &Type, rules: Conversions) -> Result<Type, Misfit> {
    let (Some(a), Some(b)) = (left.scalar(), right.scalar()) else { return Err(Misfit::Operands) };
    if !a.is_integer() || !b.is_integer() {
        return Err(Misfit::Operands);
    }
    let scalar = common(a, b, rules).ok_or(Misfit::Operands)?;
    match (left, right) {
        (Type::Scalar(_), other) | (other, Type::Scalar(_)) => Ok(other.with_scalar(scalar)),
        (Type::Vector(_, n), Type::Vector(_, m)) if n == m => Ok(Type::Vector(scalar, *n)),
        _ => Err(Misfit::Operands),
    }
}

/// Type of `op operand`.
pub(super) fn unary(op: UnaryOp, operand: &Type) -> Result<Type, Misfit> {
    if operand.is_error() {
        return Ok(Type::Error);
    }
    match op {
        UnaryOp::Not if *operand == Type::BOOL => Ok(Type::BOOL),
        UnaryOp::Not => Err(Misfit::Logic),
        UnaryOp::Complement if operand.scalar().is_some_and(ScalarType::is_integer) => Ok(operand.clone()),
        UnaryOp::Complement => Err(Misfit::Operands),
        UnaryOp::Plus | UnaryOp::Minus | UnaryOp::Increment | UnaryOp::Decrement => match operand.scalar() {
            Some(s) if s != ScalarType::Bool => Ok(operand.clone()),
            _ => Err(Misfit::Operands),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(left: &str, op: BinaryOp, right: &str) -> Result<String, Misfit> {
        let rules = Conversions { int_to_uint: false, to_double: false };
        let (l, r) = (Type::from_name(left).unwrap(), Type::from_name(right).unwrap());
        binary(op, &l, &r, rules).map(|t| t.to_string())
    }

    #[test]
    fn matrix_products_have_the_sizes_of_linear_algebra() {
        // mat2x3 has 2 columns and 3 rows.
        assert_eq!(of("mat2x3", BinaryOp::Mul, "vec2").as_deref(), Ok("vec3"));
        assert_eq!(of("vec3", BinaryOp::Mul, "mat2x3").as_deref(), Ok("vec2"));
        assert_eq!(of("mat2x3", BinaryOp::Mul, "mat4x2").as_deref(), Ok("mat4x3"));
        assert_eq!(of("float", BinaryOp::Mul, "mat4").as_deref(), Ok("mat4"));
        assert_eq!(of("mat4", BinaryOp::Mul, "vec3"), Err(Misfit::MatrixSize));
        assert_eq!(of("mat2x3", BinaryOp::Mul, "mat2x3"), Err(Misfit::MatrixSize));
        assert_eq!(of("mat2x3", BinaryOp::Add, "mat2x3").as_deref(), Ok("mat2x3"));
        assert_eq!(of("mat4", BinaryOp::Div, "mat4").as_deref(), Ok("mat4"));
        assert_eq!(of("mat4", BinaryOp::Add, "vec4"), Err(Misfit::Operands));
    }

    #[test]
    fn scalars_spread_and_convert() {
        assert_eq!(of("int", BinaryOp::Div, "float").as_deref(), Ok("float"));
        assert_eq!(of("vec3", BinaryOp::Mul, "int").as_deref(), Ok("vec3"));
        assert_eq!(of("ivec2", BinaryOp::Add, "float").as_deref(), Ok("vec2"));
        assert_eq!(of("mat3", BinaryOp::Mul, "int").as_deref(), Ok("mat3"));
        assert_eq!(of("int", BinaryOp::Add, "uint"), Err(Misfit::Operands));
        assert_eq!(of("vec3", BinaryOp::Add, "vec4"), Err(Misfit::Operands));
        assert_eq!(of("bool", BinaryOp::Add, "int"), Err(Misfit::Operands));
    }

    #[test]
    fn integer_and_logical_operators_are_strict() {
        assert_eq!(of("float", BinaryOp::Rem, "float"), Err(Misfit::FloatRemainder));
        assert_eq!(of("ivec2", BinaryOp::Rem, "int").as_deref(), Ok("ivec2"));
        assert_eq!(of("uint", BinaryOp::Shl, "int").as_deref(), Ok("uint"));
        assert_eq!(of("int", BinaryOp::Shl, "ivec2"), Err(Misfit::Operands));
        assert_eq!(of("vec2", BinaryOp::Less, "vec2"), Err(Misfit::VectorRelation));
        assert_eq!(of("vec2", BinaryOp::Equal, "vec2").as_deref(), Ok("bool"));
        assert_eq!(of("vec2", BinaryOp::Equal, "vec3"), Err(Misfit::Operands));
        assert_eq!(of("int", BinaryOp::And, "bool"), Err(Misfit::Logic));
        assert_eq!(unary(UnaryOp::Not, &Type::INT), Err(Misfit::Logic));
        assert_eq!(unary(UnaryOp::Minus, &Type::BOOL), Err(Misfit::Operands));
    }
}
