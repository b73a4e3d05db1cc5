//! A floating-point literal moved by 1e-4, by 1 % and by 10 %, both ways, made 0, and negated.

use super::becomes;
use crate::mutate::{Code, Draft};
use syntax::ast::{ExprId, ExprKind, Literal, UnaryOp};

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for (id, value) in literals(code) {
        let v = f64::from(value);
        let mut others = vec![
            ("-1e-4", v - 1e-4),
            ("+1e-4", v + 1e-4),
            ("-1 %", v * 0.99),
            ("+1 %", v * 1.01),
            ("-10 %", v * 0.9),
            ("+10 %", v * 1.1),
            ("0", 0.0),
        ];
        if !below_minus(code, id) {
            others.push(("negated", -v));
        }
        for (kind, other) in others {
            // Zeros of both signs are one number.
            if other as f32 != value {
                let to = text(other as f32);
                let what = format!("{} ({kind})", becomes(code.shader.text_of(id), &to));
                drafts.push(Draft::new(code.replace(id, to), what));
            }
        }
    }
}

/// Floating-point literals with their value in binary32.
pub(super) fn literals(code: &Code<'_>) -> Vec<(ExprId, f32)> {
    let value = |id: &ExprId| match code.shader.expr(*id).kind {
        ExprKind::Literal(Literal::Float(value)) if (value as f32).is_finite() => Some((*id, value as f32)),
        _ => None,
    };
    code.exprs.iter().filter_map(value).collect()
}

/// A literal of exactly this value: the shortest decimal that rounds to it.
pub(super) fn text(value: f32) -> String {
    if value.is_sign_negative() && value != 0.0 { format!("({value:?})") } else { format!("{:?}", value.abs()) }
}

/// True for the operand of a leading `-`: to negate it again is to drop the `-`.
fn below_minus(code: &Code<'_>, literal: ExprId) -> bool {
    code.exprs.iter().any(
        |&id| matches!(code.shader.expr(id).kind, ExprKind::Unary { op: UnaryOp::Minus, operand, .. } if operand == literal),
    )
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::changes;

    #[test]
    fn a_literal_moves_by_each_step() {
        assert_eq!(
            changes("constant", "float f(float a) {\n  return a + 2.0;\n}"),
            [
                "return a + 1.9999;",
                "return a + 2.0001;",
                "return a + 1.98;",
                "return a + 2.02;",
                "return a + 1.8;",
                "return a + 2.2;",
                "return a + 0.0;",
                "return a + (-2.0);",
            ]
        );
    }

    #[test]
    fn zero_only_moves_by_what_moves_it() {
        let made = changes("constant", "float f(float a) {\n  return a + 0.0;\n}");
        assert_eq!(made, ["return a + (-0.0001);", "return a + 0.0001;"]);
    }

    #[test]
    fn constants_of_the_file_move_and_those_that_nothing_reaches_stay() {
        let text = "const float K = 1.0;\nconst float L = 1.0;\nfloat f(float a) {\n  return a + K;\n}";
        let made = changes("constant", text);
        assert!(made.len() == 8 && made.iter().all(|line| line.starts_with("const float K")), "{made:?}");
    }

    #[test]
    fn text_of_macros_stays() {
        assert!(changes("constant", "#define K 1.0\nfloat f(float a) {\n  return a + K;\n}").is_empty());
    }
}
