//! The bound of a loop moved by one, both ways.

use super::becomes;
use crate::mutate::{Code, Draft};
use syntax::ast::{BinaryOp, ExprKind, Literal};
use syntax::types::{ScalarType, Type};

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for &condition in &code.loops {
        let ExprKind::Binary {
            op: BinaryOp::Less | BinaryOp::LessEqual | BinaryOp::Greater | BinaryOp::GreaterEqual | BinaryOp::NotEqual,
            right,
            ..
        } = code.shader.expr(condition).kind
        else {
            continue;
        };
        if !code.is_plain(right) {
            continue;
        }
        let one = match code.shader.type_of(right) {
            Type::Scalar(ScalarType::Int) => "1",
            Type::Scalar(ScalarType::Uint) => "1u",
            Type::Scalar(ScalarType::Float) => "1.0",
            _ => continue,
        };
        let from = code.shader.text_of(right);
        for (sign, step) in [('-', -1), ('+', 1)] {
            let to = match code.shader.expr(right).kind {
                ExprKind::Literal(Literal::Int(n)) => n.wrapping_add(step).to_string(),
                _ => format!("{} {sign} {one}", code.operand(right)),
            };
            drafts
                .push(Draft::new(code.replace(right, &*to), format!("the bound of the loop: {}", becomes(from, &to))));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::changes;

    #[test]
    fn bounds_move_both_ways() {
        assert_eq!(
            changes("loop-bound", "float f(float a, int n) {\n  for (int i = 0; i < n; ++i) a += 1.0;\n  return a;\n}"),
            ["for (int i = 0; i < n - 1; ++i) a += 1.0;", "for (int i = 0; i < n + 1; ++i) a += 1.0;"]
        );
    }

    #[test]
    fn a_literal_bound_stays_a_literal_and_a_branch_has_no_bound() {
        let text =
            "float f(float a) {\n  for (int i = 0; i <= 4; ++i) a += 1.0;\n  if (a < 3.0) a = 3.0;\n  return a;\n}";
        assert_eq!(
            changes("loop-bound", text),
            ["for (int i = 0; i <= 3; ++i) a += 1.0;", "for (int i = 0; i <= 5; ++i) a += 1.0;"]
        );
    }
}
