//! A leading `-` dropped.

use crate::mutate::{Code, Draft};
use base::text::Edit;
use syntax::ast::{ExprKind, UnaryOp};

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for &id in &code.exprs {
        if let ExprKind::Unary { op: UnaryOp::Minus, op_span, .. } = &code.shader.expr(id).kind {
            drafts.push(Draft::new(Edit::delete(*op_span), "the leading `-` is dropped"));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::changes;

    #[test]
    fn a_minus_before_an_expression_is_dropped_and_one_between_two_is_not() {
        assert_eq!(changes("sign", "float f(float a) {\n  return a - -a;\n}"), ["return a - a;"]);
    }
}
