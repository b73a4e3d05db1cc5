//! Rows taken for columns: `m * v` ↔ `v * m`, `m[i]` taken from the transposed matrix.

use super::becomes;
use crate::mutate::{Code, Draft};
use syntax::ast::{BinaryOp, ExprKind};
use syntax::types::Type;

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for &id in &code.exprs {
        if !code.is_plain(id) {
            continue;
        }
        let to = match code.shader.expr(id).kind {
            ExprKind::Binary { op: BinaryOp::Mul, left, right, .. } => {
                let (a, b) = (code.shader.type_of(left), code.shader.type_of(right));
                let with = |m: &Type, v: &Type| square(m) && matches!(v, Type::Vector(..));
                if !with(a, b) && !with(b, a) {
                    continue;
                }
                format!("{} * {}", code.operand(right), code.operand(left))
            }
            ExprKind::Index { base, index } if square(code.shader.type_of(base)) && !code.is_written(id) => {
                format!("transpose({})[{}]", code.shader.text_of(base), code.shader.text_of(index))
            }
            _ => continue,
        };
        drafts.push(Draft::new(code.replace(id, &*to), becomes(code.shader.text_of(id), &to)));
    }
}

fn square(ty: &Type) -> bool {
    matches!(ty, Type::Matrix(_, columns, rows) if columns == rows)
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::changes;

    #[test]
    fn a_product_with_a_vector_is_turned_around() {
        assert_eq!(
            changes("matrix", "vec4 f(mat4 m, vec4 v, float s) {\n  return s * m * (v + v);\n}"),
            ["return (v + v) * (s * m);"]
        );
    }

    #[test]
    fn a_column_becomes_a_row() {
        assert_eq!(changes("matrix", "vec4 f(mat4 m) {\n  return m[2];\n}"), ["return transpose(m)[2];"]);
    }
}
