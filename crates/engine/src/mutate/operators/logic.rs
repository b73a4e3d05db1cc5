//! `&&` ↔ `||`, and `!` dropped.

use super::becomes;
use crate::mutate::{Code, Draft};
use base::text::Edit;
use syntax::ast::{BinaryOp, ExprKind, UnaryOp};

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for &id in &code.exprs {
        let (op_span, from, to) = match &code.shader.expr(id).kind {
            ExprKind::Binary { op: BinaryOp::And, op_span, .. } => (*op_span, "&&", "||"),
            ExprKind::Binary { op: BinaryOp::Or, op_span, .. } => (*op_span, "||", "&&"),
            ExprKind::Unary { op: UnaryOp::Not, op_span, .. } => (*op_span, "!", ""),
            _ => continue,
        };
        let what = if to.is_empty() { "`!` is dropped".to_owned() } else { becomes(from, to) };
        drafts.push(Draft::new(Edit::replace(op_span, to), what));
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::changes;

    #[test]
    fn and_becomes_or_and_not_is_dropped() {
        assert_eq!(
            changes("logic", "float f(bool a, bool b) {\n  return a && !b ? 1.0 : 0.0;\n}"),
            ["return a || !b ? 1.0 : 0.0;", "return a && b ? 1.0 : 0.0;"]
        );
    }
}
