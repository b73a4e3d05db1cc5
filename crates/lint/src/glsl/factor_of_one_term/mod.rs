//! N038: a half that applies to one of two terms of a mean.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::key;
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};

use analysis::forms::builtin;
use analysis::numeric::{bare, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N038"),
    name: "factor-of-one-term",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Functions whose values are averaged; sums of others with a weight of a half are common.
const AVERAGED: [&str; 3] = ["length", "distance", "sqrt"];

/// The function that half of a term is.
fn halved(shader: &Shader, id: ExprId) -> Option<(&str, ExprId)> {
    let called = |id: ExprId| builtin(shader, id, &AVERAGED).map(|(name, _)| (name, bare(shader, id)));
    // In parentheses, the half belongs to the term by the author's word.
    match shader.expr(id).kind {
        ExprKind::Binary { op: BinaryOp::Mul, op_span: _, left, right } => {
            let half = |factor: ExprId, term: ExprId| called(term).filter(|_| constant(shader, factor) == Some(0.5));
            half(left, right).or_else(|| half(right, left))
        }
        ExprKind::Binary { op: BinaryOp::Div, op_span: _, left, right } => {
            called(left).filter(|_| constant(shader, right) == Some(2.0))
        }
        _ => None,
    }
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for (_, expr) in shader.arena().iter().filter(|(_, e)| !e.from_macro) {
        let ExprKind::Binary { op: BinaryOp::Add, op_span: _, left, right } = expr.kind else { continue };
        let whole = |id: ExprId| builtin(shader, id, &AVERAGED).map(|(name, _)| name);
        let mean = |half: ExprId, other: ExprId| {
            let (name, term) = halved(shader, half)?;
            let differs = key(shader, term).is_none_or(|k| Some(k) != key(shader, bare(shader, other)));
            (whole(other) == Some(name) && differs).then_some((name, half, term, other))
        };
        let Some((name, half, term, other)) = mean(left, right).or_else(|| mean(right, left)) else { continue };
        let (a, b) = (shader.text_of(term), shader.text_of(bare(shader, other)));
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(half).span,
                    message!(
                        "the half applies to one `{name}` of this sum",
                        "この和で半分になるのは一方の `{name}` だけです"
                    ),
                )
                .with_label(message!("half of this term alone", "この項だけの半分"))
                .with_related(&file.file, shader.expr(other).span, message!("counts as a whole", "そのまま足される"))
                .with_why(message!(
                    "a product binds more tightly than a sum: this is no mean of the two",
                    "積は和より強く結び付くので、二つの平均になりません"
                ))
                .with_help(message!(
                    "for the mean write `0.5 * ({a} + {b})`",
                    "平均なら `0.5 * ({a} + {b})` と書いてください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{rings, silent};
    use crate::Level;

    #[test]
    fn halves_of_one_term_are_reported() {
        rings(
            "N038",
            Level::Default,
            &[
                "r = 0.5 * length(p) + length(q);",
                "r = length(p) + length(q) / 2.0;",
                "r = distance(p, q) * 0.5 + distance(q, n);",
            ],
        );
    }

    #[test]
    fn means_and_weights_are_not() {
        silent(
            "N038",
            Level::Heuristic,
            &[
                "r = 0.5 * (length(p) + length(q));",
                "r = 0.5 * length(p) + 0.5 * length(q);",
                "r = (0.5 * length(p)) + length(q);",
                "r = length(p) + 0.5 * length(p);",
                "r = 0.3 * length(p) + length(q);",
                "r = 0.5 * length(p) + s;",
                "r = 0.5 * sin(s) + sin(t);",
            ],
        );
    }
}
