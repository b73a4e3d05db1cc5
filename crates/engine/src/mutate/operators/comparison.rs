//! `<` ↔ `<=`, `>` ↔ `>=`, `==` ↔ `!=`.

use super::becomes;
use crate::mutate::{Code, Draft};
use base::text::Edit;
use syntax::ast::{BinaryOp, ExprKind};

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for &id in &code.exprs {
        let ExprKind::Binary { op, op_span, .. } = &code.shader.expr(id).kind else { continue };
        let other = match op {
            BinaryOp::Less => BinaryOp::LessEqual,
            BinaryOp::LessEqual => BinaryOp::Less,
            BinaryOp::Greater => BinaryOp::GreaterEqual,
            BinaryOp::GreaterEqual => BinaryOp::Greater,
            BinaryOp::Equal => BinaryOp::NotEqual,
            BinaryOp::NotEqual => BinaryOp::Equal,
            _ => continue,
        };
        drafts.push(Draft::new(Edit::replace(*op_span, other.text()), becomes(op.text(), other.text())));
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::changes;

    #[test]
    fn comparisons_take_in_their_bound_or_leave_it_out() {
        assert_eq!(
            changes("comparison", "float f(float a, float b) {\n  if (a < b) return a;\n  return a >= b ? b : a;\n}"),
            ["if (a <= b) return a;", "return a > b ? b : a;"]
        );
    }

    #[test]
    fn equality_becomes_inequality() {
        assert_eq!(
            changes("comparison", "float f(int a) {\n  return a == 1 ? 0.0 : 1.0;\n}"),
            ["return a != 1 ? 0.0 : 1.0;"]
        );
    }
}
