//! Operands of `-`, `/` and of products of matrices exchanged.

use super::becomes;
use crate::mutate::{Code, Draft};
use syntax::ast::{BinaryOp, ExprKind};
use syntax::types::Type;

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for &id in &code.exprs {
        let ExprKind::Binary { op, left, right, .. } = code.shader.expr(id).kind else { continue };
        let (a, b) = (code.shader.type_of(left), code.shader.type_of(right));
        let fits = match op {
            BinaryOp::Sub => true,
            // A matrix cannot be a divisor of everything that it can be divided by.
            BinaryOp::Div => !matches!(a, Type::Matrix(..)) && !matches!(b, Type::Matrix(..)),
            BinaryOp::Mul => a == b && matches!(a, Type::Matrix(_, columns, rows) if columns == rows),
            _ => false,
        };
        if fits && code.is_plain(id) {
            let to = format!("{} {} {}", code.operand(right), op.text(), code.operand(left));
            drafts.push(Draft::new(code.replace(id, &*to), becomes(code.shader.text_of(id), &to)));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::changes;

    #[test]
    fn differences_and_quotients_are_turned_around() {
        assert_eq!(
            changes("operand-order", "float f(float a, float b) {\n  return a - b - a / b;\n}"),
            ["return (a / b) - (a - b);", "return b - a - a / b;", "return a - b - b / a;"]
        );
    }

    #[test]
    fn products_of_matrices_are_turned_around_and_of_numbers_are_not() {
        assert_eq!(changes("operand-order", "mat4 f(mat4 m, mat4 n) {\n  return m * n;\n}"), ["return n * m;"]);
        assert!(changes("operand-order", "float f(float m, float n) {\n  return m * n;\n}").is_empty());
    }
}
