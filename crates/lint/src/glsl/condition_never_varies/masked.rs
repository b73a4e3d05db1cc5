//! Comparisons of a number of which some bits are known: `(x & 4) == 1`.

use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::types::ScalarType;
use syntax::{Shader, walk};

use analysis::numeric::{bare, bits};
use analysis::range::specialized;

/// What a comparison with a constant always is: one of its bits is another than the mask in front leaves.
pub fn decided(shader: &Shader, id: ExprId) -> Option<bool> {
    let ExprKind::Binary { op, op_span: _, left, right } = shader.expr(id).kind else { return None };
    let always = match op {
        BinaryOp::Equal => false,
        BinaryOp::NotEqual => true,
        _ => return None,
    };
    let (value, constant) = match (bits(shader, left), bits(shader, right)) {
        (None, Some(constant)) => (left, constant),
        (Some(constant), None) => (right, constant),
        _ => return None,
    };
    let whole = matches!(shader.type_of(value).scalar(), Some(ScalarType::Int | ScalarType::Uint));
    let ExprKind::Binary { op, op_span: _, left, right } = shader.expr(bare(shader, value)).kind else { return None };
    // A mask without bits switches something off.
    let mask = bits(shader, left).xor(bits(shader, right)).filter(|mask| whole && *mask != 0)?;
    let other = match op {
        BinaryOp::BitAnd => constant & !mask != 0,
        BinaryOp::BitOr => !constant & mask != 0,
        _ => return None,
    };
    (other && !is_set(shader, id)).then_some(always)
}

/// True where a constant takes part that a host may set, or one that follows from it.
fn is_set(shader: &Shader, id: ExprId) -> bool {
    let set = specialized(shader);
    walk::expressions(shader, id).into_iter().filter_map(|e| shader.symbol_of(e)).any(|symbol| set.contains(&symbol))
}
