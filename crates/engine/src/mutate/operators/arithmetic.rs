//! `+` ↔ `-` and `*` ↔ `/`, as operators and before `=`.

use super::becomes;
use crate::mutate::{Code, Draft};
use base::text::Edit;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::types::Type;

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for &id in &code.exprs {
        let (op, op_span, left, right, equals) = match &code.shader.expr(id).kind {
            ExprKind::Binary { op, op_span, left, right } => (*op, *op_span, *left, *right, ""),
            ExprKind::Assign { op: Some(op), op_span, target, value } => (*op, *op_span, *target, *value, "="),
            _ => continue,
        };
        let other = match op {
            BinaryOp::Add => BinaryOp::Sub,
            BinaryOp::Sub => BinaryOp::Add,
            BinaryOp::Mul if divides(code.shader.type_of(left), code.shader.type_of(right)) => BinaryOp::Div,
            BinaryOp::Div if divides(code.shader.type_of(left), code.shader.type_of(right)) => BinaryOp::Mul,
            _ => continue,
        };
        let (from, to) = (format!("{}{equals}", op.text()), format!("{}{equals}", other.text()));
        let mut draft = Draft::new(Edit::replace(op_span, &*to), becomes(&from, &to));
        draft.identity = identity(code, op, right);
        drafts.push(draft);
    }
}

/// True where product and quotient are both taken component by component. A matrix has its own
/// product with a vector or another matrix.
fn divides(left: &Type, right: &Type) -> bool {
    let matrix = |ty: &Type| matches!(ty, Type::Matrix(..));
    !matrix(right) && (!matrix(left) || right.is_scalar())
}

fn identity(code: &Code<'_>, op: BinaryOp, right: ExprId) -> Option<&'static str> {
    let value = code.value(right)?;
    match op {
        BinaryOp::Mul | BinaryOp::Div if value == 1.0 => Some("a product with 1 is a quotient by 1"),
        BinaryOp::Add | BinaryOp::Sub if value == 0.0 => Some("adding 0 is subtracting 0"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::{changes, identities};

    #[test]
    fn sums_and_products_are_exchanged_also_before_equals() {
        assert_eq!(
            changes("arithmetic", "float f(float a, float b) {\n  float c = a + b;\n  c *= a;\n  return c / b - a;\n}"),
            ["float c = a - b;", "c /= a;", "return c * b - a;", "return c / b + a;"]
        );
    }

    #[test]
    fn a_matrix_product_is_no_quotient() {
        assert!(changes("arithmetic", "vec4 f(mat4 m, vec4 v) {\n  return m * v;\n}").is_empty());
        assert_eq!(changes("arithmetic", "mat4 f(mat4 m, float a) {\n  return m * a;\n}"), ["return m / a;"]);
    }

    #[test]
    fn a_product_with_one_is_known_to_be_a_quotient() {
        assert_eq!(identities("arithmetic", "float f(float a) { return a * 1.0; }"), 1);
        assert_eq!(identities("arithmetic", "float f(float a) { return a * 2.0; }"), 0);
    }
}
