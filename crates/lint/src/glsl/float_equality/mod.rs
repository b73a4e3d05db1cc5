//! T013: floats that are compared for equality.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::forms::builtin;
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};

use super::numeric::is_constant;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T013"),
    name: "float-equality",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for (_, expr) in shader.arena().iter() {
        let ExprKind::Binary { op: op @ (BinaryOp::Equal | BinaryOp::NotEqual), op_span, left, right } = expr.kind
        else {
            continue;
        };
        let floating = |id| shader.type_of(id).scalar().is_some_and(|s| s.is_floating());
        let same = shader.text_of(left) == shader.text_of(right);
        let exact = |id| is_constant(shader, id);
        let computed = [left, right].into_iter().any(|id| is_inexact(shader, id));
        if !(floating(left) && floating(right)) || same || ((exact(left) || exact(right)) && !computed) {
            continue;
        }
        let (op, ty) = (op.text(), shader.type_of(left).to_string());
        findings.push(
            findings
                .at(
                    &file.file,
                    expr.span,
                    message!("`{op}` compares values of type `{ty}`", "`{op}` で `{ty}` の値を比較しています"),
                )
                .with_related(&file.file, op_span, message!("exact comparison", "厳密な比較"))
                .with_label(message!("true only if all bits agree", "全ビットが一致したときだけ真"))
                .with_why(message!(
                    "rounding differs from one way to compute a value to another, and between devices",
                    "丸めは計算の仕方や装置によって異なります"
                ))
                .with_help(message!(
                    "compare the difference with a tolerance: `abs(a - b) < eps`",
                    "差を許容誤差と比べてください: `abs(a - b) < eps`"
                )),
        );
    }
}

/// True for remainders, which devices compute by a division that is rounded: they miss 0 by a little, or by the divisor.
fn is_inexact(shader: &Shader, id: ExprId) -> bool {
    builtin(shader, id, &["mod", "fract"]).is_some()
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn exact_comparisons_of_computed_floats_are_reported() {
        let reported = |condition: &str| {
            let text = format!(
                "#version 150 core\nin vec3 a;\nin vec3 b;\nuniform int n;\nout vec4 c;\nvoid main(void)\n{{\n  c = vec4({condition} ? 1.0 : 0.0);\n}}\n"
            );
            messages("T013", "a.frag", &text).len()
        };
        for condition in ["a == b", "a.x != b.x", "length(a) == length(b)", "mod(a.x, 2.0) == 0.0", "1.0 != fract(a.x)"]
        {
            assert_eq!(reported(condition), 1, "{condition}");
        }
        for condition in ["n == 1", "a.x == 0.0", "a.x != a.x", "a == vec3(0.0)", "a.x < b.x", "-1.0 == a.y"] {
            assert_eq!(reported(condition), 0, "{condition}");
        }
    }
}
