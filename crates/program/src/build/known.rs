//! Values of constant expressions that are no single number: sizes of arrays may be computed from
//! vectors, matrices and built-in functions (GLSL 4.60, 4.3.3).

use super::Build;
use super::texture::argument_of;
use syntax::ast::{ArrayDim, ExprId, ExprKind, Literal};
use syntax::known::{self, Known};
use syntax::symbols::CallTarget;
use syntax::types::{ArraySize, ScalarType, Type};

/// Operands that are looked into, at most.
const DEPTH: u32 = 64;

impl Build<'_> {
    /// The type with the sizes that the dimensions give, outermost first.
    pub(super) fn with_dims(&self, ty: &Type, dims: &[&ArrayDim]) -> Type {
        let Type::Array(element, size) = ty else { return ty.clone() };
        let element = self.with_dims(element, dims.get(1..).unwrap_or_default());
        let size = match (size, dims.first().and_then(|d| d.size)) {
            (ArraySize::Unknown, Some(written)) => {
                let value = self.known(written, 0).filter(|k| k.parts.len() == 1);
                value.and_then(|k| whole(k.parts[0])).map_or(*size, ArraySize::Known)
            }
            _ => *size,
        };
        Type::Array(std::sync::Arc::new(element), size)
    }

    /// The value of a constant expression that is a whole number of at least 0.
    pub(super) fn known_number(&self, id: ExprId) -> Option<u32> {
        let known = self.known(id, 0).filter(|k| k.parts.len() == 1)?;
        if known.parts[0] == 0.0 { Some(0) } else { whole(known.parts[0]) }
    }

    /// The value of a constant expression, if it can be told here. `float` is rounded to binary32 after every operation.
    fn known(&self, id: ExprId, depth: u32) -> Option<Known> {
        if depth > DEPTH {
            return None;
        }
        if let Some(value) = self.shader.fold(id) {
            let number = match value {
                syntax::Const::Bool(v) => f64::from(u8::from(v)),
                other => other.as_f64()?,
            };
            return Some(Known { ty: value.ty(), parts: vec![number] });
        }
        let of = |id: ExprId| self.known(id, depth + 1);
        let value = match &self.shader.expr(id).kind {
            ExprKind::Literal(Literal::Float(v)) => Some(Known { ty: Type::FLOAT, parts: vec![*v] }),
            ExprKind::Name(name) => {
                if name == "gl_WorkGroupSize" {
                    let parts = self.workgroup.iter().map(|&n| f64::from(n)).collect();
                    return Some(Known { ty: Type::Vector(ScalarType::Uint, 3), parts });
                }
                if let Some(n) = self.limit(name) {
                    return Some(Known { ty: Type::INT, parts: vec![f64::from(n)] });
                }
                let symbol = self.shader.symbol_of(id)?;
                let value = of(self.initializer(symbol)?)?;
                known::converted(value, &self.shader.symbol(symbol).ty)
            }
            ExprKind::Paren(inner) => of(*inner),
            ExprKind::Unary { op, operand, .. } => known::unary(*op, of(*operand)?),
            ExprKind::Binary { op, left, right, .. } => known::binary(*op, of(*left)?, of(*right)?),
            ExprKind::Ternary { condition, yes, no } => {
                if of(*condition)?.parts == [0.0] {
                    of(*no)
                } else {
                    of(*yes)
                }
            }
            ExprKind::Index { base, index } => {
                known::element(&of(*base)?, usize::try_from(self.constant_number(*index)?).ok()?)
            }
            ExprKind::Field { base, field } => known::field(&of(*base)?, &field.name),
            ExprKind::Call { args, .. } => {
                let values: Option<Vec<Known>> = args.iter().map(|&a| of(a)).collect();
                match self.shader.callee(id)? {
                    CallTarget::Constructor(ty) => known::constructed(ty, &values?),
                    CallTarget::Builtin(call) => known::function(call.function, values?),
                    CallTarget::User(_) => None,
                }
            }
            ExprKind::Method { base, .. } => {
                let n = argument_of(self, *base)?.index_count()?;
                Some(Known { ty: Type::INT, parts: vec![f64::from(n)] })
            }
            ExprKind::Literal(_)
            | ExprKind::Postfix { .. }
            | ExprKind::Assign { .. }
            | ExprKind::Comma { .. }
            | ExprKind::List(_)
            | ExprKind::Error => None,
        };
        value.map(known::rounded)
    }

    fn constant_number(&self, id: ExprId) -> Option<u32> {
        self.shader.fold(id)?.as_integer().and_then(|n| u32::try_from(n).ok())
    }
}

fn whole(value: f64) -> Option<u32> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the range is checked before")]
    (value >= 1.0 && value <= f64::from(1_u32 << 20) && value.fract() == 0.0).then_some(value as u32)
}
