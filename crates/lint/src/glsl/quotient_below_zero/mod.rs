//! N035: a quotient of integers that is asked whether it is negative.

use std::collections::BTreeSet;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::types::ScalarType;

use analysis::forms::Forms;
use analysis::numeric::{bare, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N035"),
    name: "quotient-below-zero",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Dividend and divisor of `(a - b) / 4`, in signed integers.
fn quotient(shader: &Shader, id: ExprId) -> Option<(ExprId, f64)> {
    let ExprKind::Binary { op: BinaryOp::Div, left, right, .. } = shader.expr(id).kind else { return None };
    let signed = shader.type_of(id).scalar() == Some(ScalarType::Int) && shader.type_of(id).is_scalar();
    let by = constant(shader, right).filter(|by| signed && *by > 1.0)?;
    let dividend = bare(shader, left);
    matches!(shader.expr(dividend).kind, ExprKind::Binary { op: BinaryOp::Sub, .. }).then_some((dividend, by))
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    use BinaryOp as O;
    let shader = &file.shader;
    let mut compared: Vec<(ExprId, ExprId)> = Vec::new();
    let mut limited: BTreeSet<String> = BTreeSet::new();
    let text = |id: ExprId| -> String { shader.text_of(bare(shader, id)).split_whitespace().collect() };
    for (id, expr) in shader.arena().iter() {
        let ExprKind::Binary { op, left, right, .. } = expr.kind else { continue };
        let is = |id: ExprId, number: f64| constant(shader, id) == Some(number);
        match op {
            O::Less | O::GreaterEqual if is(right, 0.0) => compared.push((id, left)),
            O::Greater | O::LessEqual if is(left, 0.0) => compared.push((id, right)),
            O::Greater | O::LessEqual if is(right, -1.0) => compared.push((id, left)),
            _ => {}
        }
        if matches!(op, O::Less | O::Greater | O::LessEqual | O::GreaterEqual) {
            limited.extend([text(left), text(right)]);
        }
    }
    if compared.is_empty() {
        return;
    }
    let forms = Forms::new(shader);
    let mut told = BTreeSet::new();
    for (condition, operand) in compared {
        let value = forms.value(operand);
        let Some((dividend, by)) = quotient(shader, value) else { continue };
        // Whoever compares the dividend, or its two sides, knows.
        let sides = shader.expr(dividend).children();
        let known = limited.contains(&text(dividend))
            || matches!(sides.as_slice(), [a, b] if limited.contains(&text(*a)) && limited.contains(&text(*b)));
        if known || shader.expr(condition).from_macro || !told.insert(value) {
            continue;
        }
        let (quotient, asked) = (shader.text_of(value), shader.text_of(condition));
        let (whole, lowest) = (shader.text_of(dividend), 1.0 - by);
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(condition).span,
                    message!(
                        "`{asked}` does not see `{whole}` between {lowest} and -1",
                        "`{asked}` は `{whole}` が {lowest} から -1 の場合を見落とします"
                    ),
                )
                .with_related(&file.file, shader.expr(value).span, message!("gives 0 there", "そこで 0 になります"))
                .with_why(message!(
                    "division of integers rounds towards 0: `{quotient}` is 0 for these, and not -1",
                    "整数の除算は 0 の方へ丸めるため、`{quotient}` は -1 ではなく 0 になります"
                ))
                .with_help(message!(
                    "ask whether the dividend is negative, or shift right, which rounds down",
                    "割る前の値が負かどうかを調べるか、切り捨てになる右シフトを使ってください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::strict_count;
    use super::*;

    fn count(body: &str) -> usize {
        let text = format!(
            "#version 450\nlayout(local_size_x = 8) in;\nlayout(std430, binding = 0) buffer D {{ float d[]; }};\n\
             layout(binding = 1) uniform P {{ int pad, n; }};\nvoid main()\n{{\n int x = int(gl_GlobalInvocationID.x);\n \
             float r = 0.0;\n {body}\n d[x] = r;\n}}\n"
        );
        strict_count(RULE.code, "a.comp", &text)
    }

    #[test]
    fn rounded_quotients_are_reported() {
        assert_eq!(count("int z = (x - pad) / 4; if (z >= 0 && z < n) r = d[z];"), 1);
        assert_eq!(count("int z = (x - pad) / 2; if (z < 0) r = 1.0; else r = d[z];"), 1);
        assert_eq!(count("if ((x - pad) / 8 > -1) r = 1.0;"), 1);
    }

    #[test]
    fn others_are_not() {
        assert_eq!(count("int z = (x + pad) / 4; if (z >= 0 && z < n) r = d[z];"), 0);
        assert_eq!(count("int z = (x - pad) >> 2; if (z >= 0 && z < n) r = d[z];"), 0);
        assert_eq!(count("int z = (x - pad) / 4; if (x - pad >= 0 && z >= 0) r = d[z];"), 0);
        assert_eq!(count("int z = (x - pad) / 4; if (z < n) r = d[z];"), 0);
        assert_eq!(count("uint z = (uint(x) - uint(pad)) / 4u; if (z >= 0u) r = d[z];"), 0);
    }
}
