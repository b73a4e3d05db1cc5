//! Operators: operands are converted to one type first, as GLSL 4.60, 4.1.10 and 5.9 say.

use naga::{BinaryOperator, Expression, UnaryOperator};

use super::Result;
use super::function::{Fun, Val};
use super::types::size;
use syntax::ast::{BinaryOp, UnaryOp};
use syntax::types::{ScalarType, Type};

impl Fun<'_, '_> {
    pub(super) fn unary(&mut self, op: UnaryOp, value: Val) -> Result<Val> {
        let op = match op {
            UnaryOp::Plus | UnaryOp::Increment | UnaryOp::Decrement => return Ok(value),
            UnaryOp::Minus => UnaryOperator::Negate,
            UnaryOp::Not => UnaryOperator::LogicalNot,
            UnaryOp::Complement => UnaryOperator::BitwiseNot,
        };
        if let Type::Matrix(s, columns, rows) = value.ty {
            let mut parts = Vec::new();
            for k in 0..columns {
                let e = self.part(value.e, u32::from(k));
                let ty = Type::Vector(s, rows);
                parts.push(self.add_unary(op, Val { e, ty }).e);
            }
            return self.compose(&value.ty, parts);
        }
        if value.ty.scalar().is_some_and(ScalarType::is_unsigned) && op == UnaryOperator::Negate {
            // naga negates signed numbers alone.
            let zero = self.all(&value.ty, 0.0)?;
            let e = self.add(Expression::Binary { op: BinaryOperator::Subtract, left: zero.e, right: value.e });
            return self.wrapped(Val { e, ty: value.ty });
        }
        let value = self.add_unary(op, value);
        self.wrapped(value)
    }

    fn add_unary(&mut self, op: UnaryOperator, value: Val) -> Val {
        Val { e: self.add(Expression::Unary { op, expr: value.e }), ty: value.ty }
    }

    /// Both with the component type that the conversions lead to.
    pub(super) fn promoted(&mut self, left: Val, right: Val) -> Result<(Val, Val, ScalarType)> {
        let (Some(a), Some(b)) = (left.ty.scalar(), right.ty.scalar()) else {
            let message = format!("an operator between `{}` and `{}`", left.ty, right.ty);
            return Err(self.build.unsupported(self.at, message, "use numbers"));
        };
        // Each type converts to some of those behind it.
        let to = a.max(b);
        Ok((self.cast(left, a, to)?, self.cast(right, b, to)?, to))
    }

    /// A binary operator whose sides are both computed.
    pub(super) fn binary(&mut self, op: BinaryOp, left: Val, right: Val) -> Result<Val> {
        let value = self.operator(op, left, right)?;
        self.wrapped(value)
    }

    fn operator(&mut self, op: BinaryOp, left: Val, right: Val) -> Result<Val> {
        use BinaryOperator as B;
        match op {
            BinaryOp::Equal | BinaryOp::NotEqual => {
                let (left, right) = if left.ty.scalar().is_some() {
                    let (left, right, _) = self.promoted(left, right)?;
                    (left, right)
                } else {
                    (left, right)
                };
                let mut e = self.equal(&left, &right)?;
                if op == BinaryOp::NotEqual {
                    e = match left.ty {
                        Type::Scalar(_) => {
                            self.add(Expression::Binary { op: B::NotEqual, left: left.e, right: right.e })
                        }
                        _ => self.add(Expression::Unary { op: UnaryOperator::LogicalNot, expr: e }),
                    };
                }
                return Ok(Val { e, ty: Type::BOOL });
            }
            BinaryOp::Xor => {
                let e = self.add(Expression::Binary { op: B::NotEqual, left: left.e, right: right.e });
                return Ok(Val { e, ty: Type::BOOL });
            }
            BinaryOp::Shl | BinaryOp::Shr => return self.shift(op, left, right),
            _ => {}
        }
        let (left, right, scalar) = self.promoted(left, right)?;
        let (op, compares) = match op {
            BinaryOp::Add => (B::Add, false),
            BinaryOp::Sub => (B::Subtract, false),
            BinaryOp::Mul => return self.multiply(left, right),
            BinaryOp::Div => (B::Divide, false),
            BinaryOp::Rem => (B::Modulo, false),
            BinaryOp::Less => (B::Less, true),
            BinaryOp::Greater => (B::Greater, true),
            BinaryOp::LessEqual => (B::LessEqual, true),
            BinaryOp::GreaterEqual => (B::GreaterEqual, true),
            BinaryOp::BitAnd => (B::And, false),
            BinaryOp::BitXor => (B::ExclusiveOr, false),
            BinaryOp::BitOr => (B::InclusiveOr, false),
            BinaryOp::And => (B::LogicalAnd, false),
            BinaryOp::Or => (B::LogicalOr, false),
            BinaryOp::Equal | BinaryOp::NotEqual | BinaryOp::Xor | BinaryOp::Shl | BinaryOp::Shr => (B::Equal, true),
        };
        if compares {
            let e = self.add(Expression::Binary { op, left: left.e, right: right.e });
            return Ok(Val { e, ty: Type::BOOL });
        }
        self.by_component(op, left, right, scalar)
    }

    /// `vec ∘ vec`, `vec ∘ float`, `mat ∘ mat`, `mat ∘ float` and the other way round.
    fn by_component(&mut self, op: BinaryOperator, left: Val, right: Val, scalar: ScalarType) -> Result<Val> {
        let matrix = match (&left.ty, &right.ty) {
            (Type::Matrix(_, c, r), _) | (_, Type::Matrix(_, c, r)) => Some((*c, *r)),
            _ => None,
        };
        if let Some((columns, rows)) = matrix {
            let column = Type::Vector(scalar, rows);
            let part = |f: &mut Self, value: &Val, k: u8| match value.ty {
                Type::Matrix(..) => Val { e: f.part(value.e, u32::from(k)), ty: column.clone() },
                _ => value.clone(),
            };
            let mut parts = Vec::new();
            for k in 0..columns {
                let (l, r) = (part(self, &left, k), part(self, &right, k));
                parts.push(self.by_component(op, l, r, scalar)?.e);
            }
            return self.compose(&Type::Matrix(scalar, columns, rows), parts);
        }
        let ty = if left.ty.is_scalar() { right.ty.clone() } else { left.ty.clone() };
        let (left, right) = (self.widened(left, &ty), self.widened(right, &ty));
        if let (BinaryOperator::Modulo, &Type::Vector(_, n)) = (op, &ty) {
            // What naga writes as SPIR-V for a vector, its own reader refuses.
            let parts = (0..u32::from(n)).map(|k| {
                let (left, right) = (self.part(left.e, k), self.part(right.e, k));
                self.add(Expression::Binary { op, left, right })
            });
            let parts = parts.collect();
            return self.compose(&ty, parts);
        }
        Ok(Val { e: self.add(Expression::Binary { op, left: left.e, right: right.e }), ty })
    }

    /// A scalar in all components of a vector.
    pub(super) fn widened(&mut self, value: Val, ty: &Type) -> Val {
        match (&value.ty, ty) {
            (Type::Scalar(s), Type::Vector(_, n)) => {
                let ty = Type::Vector(*s, *n);
                Val { e: self.add(Expression::Splat { size: size(*n), value: value.e }), ty }
            }
            _ => value,
        }
    }

    /// `*` is algebra for matrices.
    fn multiply(&mut self, left: Val, right: Val) -> Result<Val> {
        let ty = match (&left.ty, &right.ty) {
            (Type::Matrix(s, _, rows), Type::Vector(..)) => Type::Vector(*s, *rows),
            (Type::Vector(..), Type::Matrix(s, columns, _)) => Type::Vector(*s, *columns),
            (Type::Matrix(s, _, rows), Type::Matrix(_, columns, _)) => Type::Matrix(*s, *columns, *rows),
            (Type::Scalar(_), other) | (other, Type::Scalar(_)) => {
                let scalar = other.scalar().unwrap_or(ScalarType::Float);
                if matches!(other, Type::Matrix(..)) && matches!(scalar, ScalarType::Double | ScalarType::Half) {
                    return self.by_component(BinaryOperator::Multiply, left, right, scalar);
                }
                other.clone()
            }
            (other, _) => other.clone(),
        };
        let op = BinaryOperator::Multiply;
        Ok(Val { e: self.add(Expression::Binary { op, left: left.e, right: right.e }), ty })
    }

    /// The number of places has no sign in naga.
    fn shift(&mut self, op: BinaryOp, left: Val, right: Val) -> Result<Val> {
        let from = right.ty.scalar().unwrap_or(ScalarType::Uint);
        let right = self.cast(right, from, ScalarType::Uint)?;
        let ty = if left.ty.is_scalar() { right.ty.with_scalar(scalar_of(&left)) } else { left.ty.clone() };
        let (left, right) = (self.widened(left, &ty), self.widened(right, &ty));
        let op = if op == BinaryOp::Shl { BinaryOperator::ShiftLeft } else { BinaryOperator::ShiftRight };
        Ok(Val { e: self.add(Expression::Binary { op, left: left.e, right: right.e }), ty })
    }
}

fn scalar_of(value: &Val) -> ScalarType {
    value.ty.scalar().unwrap_or(ScalarType::Int)
}
