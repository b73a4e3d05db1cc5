//! An integer literal moved by one, both ways. A literal that is an index stays inside what it
//! indexes.

use super::becomes;
use crate::mutate::{Code, Draft};
use syntax::ast::{ExprId, ExprKind, Literal};

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for &id in &code.exprs {
        let value = match code.shader.expr(id).kind {
            ExprKind::Literal(Literal::Int(n)) => i64::from(n),
            ExprKind::Literal(Literal::Uint(n)) => i64::from(n),
            _ => continue,
        };
        let unsigned = matches!(code.shader.expr(id).kind, ExprKind::Literal(Literal::Uint(_)));
        let count = indexed(code, id);
        let least = if count.is_some() || unsigned { 0 } else { i64::from(i32::MIN) + 1 };
        let most = count.map_or(i64::from(i32::MAX), |n| i64::from(n) - 1);
        for moved in [value - 1, value + 1] {
            if moved < least || moved > most {
                continue;
            }
            let suffix = if unsigned { "u" } else { "" };
            let to = if moved < 0 { format!("({moved})") } else { format!("{moved}{suffix}") };
            drafts.push(Draft::new(code.replace(id, &*to), becomes(code.shader.text_of(id), &to)));
        }
    }
}

/// Number of elements of what this literal indexes.
fn indexed(code: &Code<'_>, literal: ExprId) -> Option<u32> {
    code.exprs.iter().find_map(|&id| match code.shader.expr(id).kind {
        ExprKind::Index { base, index } if index == literal => {
            // Of what has no known size nothing but its first element is sure to exist.
            Some(code.shader.type_of(base).index_count().unwrap_or(1))
        }
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::changes;

    #[test]
    fn integers_move_both_ways() {
        assert_eq!(
            changes("integer", "float f(float a) {\n  return a + float(1) * 0.0 + float(0);\n}"),
            [
                "return a + float(0) * 0.0 + float(0);",
                "return a + float(2) * 0.0 + float(0);",
                "return a + float(1) * 0.0 + float((-1));",
                "return a + float(1) * 0.0 + float(1);",
            ]
        );
    }

    #[test]
    fn an_index_stays_inside() {
        assert_eq!(changes("integer", "float f(vec2 a) {\n  return a[1];\n}"), ["return a[0];"]);
    }

    #[test]
    fn sizes_of_arrays_and_constants_in_them_stay() {
        let text = "const int N = 2;\nfloat f(float a) {\n  float b[N];\n  float c[2];\n  b[0] = a;\n  c[0] = a;\n  return b[0] + c[0];\n}";
        assert!(changes("integer", text).iter().all(|line| line.contains("[1]")), "{:?}", changes("integer", text));
    }
}
