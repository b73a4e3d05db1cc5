//! N029: a guard against 0 that looks at all components together, before a division of each.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind};
use syntax::symbols::SymbolId;
use syntax::types::Type;

use super::walk::expressions;
use analysis::forms::Forms;
use analysis::numeric::{bare, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N029"),
    name: "whole-vector-guard",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

/// True for a vector of zeros.
fn is_zero(shader: &Shader, id: ExprId) -> bool {
    match &shader.expr(bare(shader, id)).kind {
        ExprKind::Call { callee: Callee::Type(_), args } => args.iter().all(|a| constant(shader, *a) == Some(0.0)),
        _ => false,
    }
}

/// The vector that a comparison holds against zero, and whether it holds where the vector is zero.
fn guarded(shader: &Shader, condition: ExprId) -> Option<(SymbolId, bool)> {
    let ExprKind::Binary { op: op @ (BinaryOp::Equal | BinaryOp::NotEqual), op_span: _, left, right } =
        shader.expr(bare(shader, condition)).kind
    else {
        return None;
    };
    let vector = match (is_zero(shader, left), is_zero(shader, right)) {
        (false, true) => left,
        (true, false) => right,
        _ => return None,
    };
    let vector = bare(shader, vector);
    matches!(shader.type_of(vector), Type::Vector(..)).then_some(())?;
    Some((shader.symbol_of(vector)?, op == BinaryOp::Equal))
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let choices: Vec<(ExprId, ExprId, SymbolId)> = shader
        .arena()
        .iter()
        .filter_map(|(_, expr)| match expr.kind {
            ExprKind::Ternary { condition, yes, no } => {
                let (symbol, where_zero) = guarded(shader, condition)?;
                Some((condition, if where_zero { no } else { yes }, symbol))
            }
            _ => None,
        })
        .collect();
    if choices.is_empty() {
        return;
    }
    let forms = Forms::new(shader);
    for (condition, arm, symbol) in choices {
        let divides = |id: &ExprId| match shader.expr(*id).kind {
            ExprKind::Binary { op: BinaryOp::Div, op_span: _, left: _, right } => {
                matches!(shader.type_of(right), Type::Vector(..)) && forms.symbols(right).contains(&symbol)
            }
            _ => false,
        };
        let Some(division) = expressions(shader, arm).into_iter().find(divides) else { continue };
        let name = &shader.symbol(symbol).name;
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(condition).span,
                    message!(
                        "this guards against 0 in all components of `{name}` at once, and each is divided by",
                        "`{name}` の全成分が同時に 0 の場合しか防げませんが、除算は成分ごとです"
                    ),
                )
                .with_related(&file.file, shader.expr(division).span, message!("divides by each", "成分ごとの除算"))
                .with_label(message!("false where a single component is 0", "1 つの成分だけが 0 のとき偽です"))
                .with_why(message!(
                    "comparisons of whole vectors ask for all components, so that one 0 passes and gives infinity or NaN",
                    "ベクトル全体の比較は全成分を調べるので、1 つの 0 は通り抜けて無限大や NaN になります"
                ))
                .with_help(message!(
                    "decide for each component: `mix(b, a, equal(v, vec4(0.0)))`",
                    "成分ごとに判定してください: `mix(b, a, equal(v, vec4(0.0)))`"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{rings, silent};
    use super::*;

    #[test]
    fn guards_of_whole_vectors_are_reported_before_divisions_of_components() {
        rings(
            "N029",
            Level::Default,
            &["v = p == vec3(0.0) ? q : q / p;", "v = (v != vec3(0.0, 0.0, 0.0)) ? sin(v) / (v * v) : q;"],
        );
    }

    #[test]
    fn guards_of_lengths_and_of_numbers_are_not() {
        silent(
            "N029",
            Level::Heuristic,
            &[
                "v = p == vec3(0.0) ? q : p / length(p);",
                "v = p == vec3(0.0) ? q / 2.0 : normalize(p);",
                "r = p.x == 0.0 ? 0.0 : s / p.x;",
                "v = p == vec3(1.0) ? q : q / p;",
            ],
        );
    }
}
