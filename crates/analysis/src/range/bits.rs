//! Numbers that are put together from bits.

use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::symbols::CallTarget;
use syntax::types::Type;

use super::start::{unknown_of, within};
use super::value::{Evidence, Sources, Value};
use crate::numeric::bits;

/// The sign, exponent and mantissa of 1 in binary32.
const ONE: u32 = 0x3f80_0000;

/// The bits of a mantissa in binary32.
const MANTISSA: u32 = 0x007f_ffff;

/// True for a call that takes the bits of a number for those of another type.
pub fn takes_bits(name: &str, target: Option<&CallTarget>) -> bool {
    !matches!(target, Some(CallTarget::User(_))) && ["bitcast", "uintBitsToFloat", "intBitsToFloat"].contains(&name)
}

/// What such a call gives: random bits behind the exponent of 1 are a number from 1 to below 2.
pub fn taken(shader: &Shader, ty: &Type, args: &[ExprId], sources: Sources) -> Value {
    match args {
        [bits] if *ty == Type::FLOAT && is_mantissa_of_one(shader, *bits) => {
            within(ty, 1.0, 2.0 - f64::from(f32::EPSILON), Evidence::Nature, sources)
        }
        _ => unknown_of(ty, sources),
    }
}

/// True for `0x3f800000 | (n & 0x007fffff)` and `0x3f800000 | (n >> 9)`, also as a sum.
fn is_mantissa_of_one(shader: &Shader, id: ExprId) -> bool {
    let bare = |id: ExprId| crate::numeric::bare(shader, id);
    let ExprKind::Binary { op: BinaryOp::BitOr | BinaryOp::Add, op_span: _, left, right } = shader.expr(bare(id)).kind
    else {
        return false;
    };
    let is_mantissa = |id: ExprId| match shader.expr(bare(id)).kind {
        ExprKind::Binary { op: BinaryOp::BitAnd, op_span: _, left, right } => {
            [left, right].into_iter().any(|mask| bits(shader, mask).is_some_and(|m| m & !MANTISSA == 0))
        }
        ExprKind::Binary { op: BinaryOp::Shr, op_span: _, left: _, right } => bits(shader, right) == Some(9),
        _ => false,
    };
    [(left, right), (right, left)].into_iter().any(|(one, rest)| bits(shader, one) == Some(ONE) && is_mantissa(rest))
}
