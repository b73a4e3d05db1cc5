//! D020: a loop that adds the same element in each round, beside one that goes on.

use std::collections::BTreeSet;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use base::text::Span;
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, Expr, ExprId, ExprKind, StmtKind};
use syntax::symbols::SymbolId;
use syntax::types::Type;

use super::walk::{expressions, statements};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D020"),
    name: "same-element-each-round",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// An element that is added to something.
struct Added {
    id: ExprId,
    array: SymbolId,
    /// The variables of its index.
    index: BTreeSet<SymbolId>,
    /// The variables of all that is added.
    whole: BTreeSet<SymbolId>,
}

/// The elements in a sum that goes on over the rounds: `sum += data[i]`. Elements of vectors are none.
fn added(shader: &Shader, sums: &[(ExprId, ExprId)], body: Span) -> Vec<Added> {
    let mut found = Vec::new();
    for &(id, value) in sums.iter().filter(|(id, _)| body.contains(shader.expr(*id).span.start)) {
        let parts = expressions(shader, value);
        let whole: BTreeSet<SymbolId> = parts.iter().filter_map(|part| shader.symbol_of(*part)).collect();
        for part in parts {
            let ExprKind::Index { base, index } = shader.expr(part).kind else { continue };
            let array = matches!(shader.type_of(base), Type::Array(..));
            let Some(array) = shader.symbol_of(base).filter(|_| array && !shader.expr(id).from_macro) else { continue };
            let index = expressions(shader, index).into_iter().filter_map(|e| shader.symbol_of(e)).collect();
            found.push(Added { id: part, array, index, whole: whole.clone() });
        }
    }
    found
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut bodies: Vec<(Span, Span)> = Vec::new();
    statements(shader, |stmt| match &stmt.kind {
        StmtKind::For { body, .. } | StmtKind::While { body, .. } => bodies.push((stmt.span, body.span)),
        _ => {}
    });
    // The innermost loop that an element stands in.
    bodies.sort_by_key(|(whole, _)| whole.end - whole.start);
    let sum = |(id, e): (ExprId, &Expr)| match e.kind {
        ExprKind::Assign { op: Some(BinaryOp::Add | BinaryOp::Sub), value, .. } => Some((id, value)),
        _ => None,
    };
    let sums: Vec<(ExprId, ExprId)> = shader.arena().iter().filter_map(sum).collect();
    let mut seen = BTreeSet::new();
    for (whole, body) in bodies {
        let fresh: Vec<Added> = added(shader, &sums, body).into_iter().filter(|a| seen.insert(a.id)).collect();
        let written: BTreeSet<SymbolId> = shader
            .uses()
            .iter()
            .filter(|u| u.access.writes() && whole.contains(shader.expr(u.expr).span.start))
            .map(|u| u.symbol)
            .collect();
        let declared = |symbol: &SymbolId| shader.symbol(*symbol).span.is_some_and(|span| whole.contains(span.start));
        let varies = |all: &BTreeSet<SymbolId>| all.iter().any(|s| written.contains(s) || declared(s));
        let moves = |added: &Added| varies(&added.index);
        let mut told = BTreeSet::new();
        // A factor beside it may go on.
        for still in fresh.iter().filter(|a| !varies(&a.whole) && !a.index.is_empty()) {
            // Beside it, another element of the same array goes on.
            let Some(other) = fresh.iter().find(|a| a.array == still.array && moves(a)) else { continue };
            if !told.insert(still.index.clone()) {
                continue;
            }
            let (text, beside) = (shader.text_of(still.id), shader.text_of(other.id));
            findings.push(
                findings
                    .at(
                        &file.file,
                        shader.expr(still.id).span,
                        message!(
                            "each round of the loop adds the same element `{text}`",
                            "ループの毎回、同じ要素 `{text}` を足しています"
                        ),
                    )
                    .with_related(
                        &file.file,
                        shader.expr(other.id).span,
                        message!("`{beside}` goes on", "`{beside}` は進みます"),
                    )
                    .with_why(message!(
                        "nothing in the loop changes its index, so that the sum is one element times the number of rounds",
                        "ループの中で添字が変わらないので、和は一つの要素の回数倍になります"
                    ))
                    .with_help(message!(
                        "let its index go on as the other one does",
                        "もう一方と同じように添字を進めてください"
                    )),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::strict_count;
    use super::*;

    fn count(body: &str) -> usize {
        let text = format!(
            "#version 450\nlayout(local_size_x = 8) in;\nlayout(std430, binding = 0) buffer D {{ float d[]; }};\n\
             void main()\n{{\n int a = int(gl_GlobalInvocationID.x);\n int b = a + 4;\n float s = 0.0;\n float t = 0.0;\n \
             {body}\n d[a] = s + t;\n}}\n"
        );
        strict_count(RULE.code, "a.comp", &text)
    }

    #[test]
    fn sums_of_one_element_beside_another_are_reported() {
        assert_eq!(count("for (int k = 0; k < 9; ++k) { s += d[a]; t += d[b]; a += 8; }"), 1);
        assert_eq!(count("for (int k = 0; k < 9; ++k) { s += d[a + k]; t += 2.0 * d[b]; }"), 1);
        assert_eq!(count("int k = 0; while (k < 9) { s += d[a + k]; t += d[b]; ++k; }"), 1);
    }

    #[test]
    fn sums_that_go_on_are_not() {
        assert_eq!(count("for (int k = 0; k < 9; ++k) { s += d[a]; t += d[b]; a += 8; b += 8; }"), 0);
        assert_eq!(count("for (int k = 0; k < 9; ++k) { s += d[a + k] - d[3]; }"), 0, "a constant index");
        assert_eq!(count("for (int k = 0; k < 9; ++k) { int c = b + k; s += d[a + k]; t += d[c]; }"), 0);
        assert_eq!(count("for (int k = 0; k < 9; ++k) { s += d[b]; }"), 0, "nothing goes on beside it");
        assert_eq!(count("for (int k = 0; k < 9; ++k) { s += d[a + k] * d[b]; }"), 0, "a weight");
        assert_eq!(count("for (int k = 0; k < 9; ++k) { for (int j = 0; j < 9; ++j) s += d[j]; t += d[b + k]; }"), 0);
    }
}
