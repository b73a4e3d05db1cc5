//! N030: `%` with a left operand that is negative.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::{Evidence, Range};
use base::diagnostic::{Code, Severity, message};
use reading::{Project, ShaderFile};
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::types::ScalarType;

use analysis::numeric::{bare, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N030"),
    name: "remainder-of-negative",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

/// True for `x - 1`, which is meant to go round.
fn goes_back(shader: &Shader, id: ExprId) -> bool {
    match shader.expr(bare(shader, id)).kind {
        ExprKind::Binary { op: BinaryOp::Sub, op_span: _, left, right } => {
            constant(shader, left).is_none() && constant(shader, right).is_some_and(|c| c > 0.0)
        }
        _ => false,
    }
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    for (id, expr) in shader.arena().iter() {
        let (left, right) = match expr.kind {
            ExprKind::Binary { op: BinaryOp::Rem, op_span: _, left, right } => (left, right),
            ExprKind::Assign { op: Some(BinaryOp::Rem), op_span: _, target, value } => (target, value),
            _ => continue,
        };
        let scalar = shader.type_of(left).scalar();
        // WGSL has `%` for floats, too.
        let floats = scalar == Some(ScalarType::Float) && file.is_wgsl();
        if !(scalar == Some(ScalarType::Int) || floats) || shader.fold(id).is_some() {
            continue;
        }
        let negative = |r: &Range| r.goes_below(0.0, Evidence::Nature);
        let possible = |r: &Range| r.lo < 0.0;
        let ranges: Vec<Range> =
            observed.visits(id).iter().filter_map(|v| v.operands.first()).flat_map(|v| v.parts.clone()).collect();
        let level = if ranges.iter().any(negative) {
            Level::Default
        } else if (goes_back(shader, left) || floats) && ranges.iter().any(possible) {
            Level::Strict
        } else {
            continue;
        };
        let (a, b) = (shader.text_of(left), shader.text_of(right));
        let why = if file.is_wgsl() {
            message!(
                "`%` takes the sign of its left operand: `-1 % 4` is -1 and not 3",
                "`%` の結果は左辺の符号になります。`-1 % 4` は 3 ではなく -1 です"
            )
        } else {
            message!(
                "`%` of a negative number is undefined; devices give negative and positive results",
                "負の数の `%` は未定義で、装置によって負にも正にもなります"
            )
        };
        findings.push_at(
            level,
            findings
                .at(&file.file, shader.expr(left).span, message!("`{a}` can be negative", "`{a}` が負になりえます"))
                .with_label(message!("left of `%`", "`%` の左辺"))
                .with_why(why)
                .with_help(message!(
                    "add the divisor first: `({a} + {b}) % {b}`",
                    "先に除数を足してください: `({a} + {b}) % {b}`"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{rings, silent};
    use super::*;

    #[test]
    fn negative_operands_are_reported() {
        rings(
            "N030",
            Level::Default,
            &[
                "int i = -3; r = float(i % 4);",
                "for (int i = 0; i < 4; ++i) r += float((i - 1) % 4);",
                "for (int k = -2; k <= 2; ++k) r += float(k % 3);",
            ],
        );
        rings("N030", Level::Strict, &["int i = int(s); r = float((i - 1) % 4);"]);
    }

    #[test]
    fn others_are_not() {
        silent(
            "N030",
            Level::Heuristic,
            &[
                "for (int i = 0; i < 4; ++i) r += float((i + 3) % 4);",
                "for (int i = 1; i < 4; ++i) r += float((i - 1) % 4);",
                "int i = int(s); r = float(i % 4);",
                "uint i = uint(s); r = float((i - 1u) % 4u);",
            ],
        );
    }
}
