//! N005: `normalize` of a vector that can be zero.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::Visit;
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::{Project, ShaderFile};
use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind};
use syntax::symbols::SymbolId;

use analysis::numeric::{bare, calls, in_place, is_plain, is_simple};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N005"),
    name: "normalize-maybe-zero",
    severity: Severity::Info,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

/// True when all components can be 0, and the text shows it.
fn shown(visit: &Visit) -> bool {
    visit.operands.first().is_some_and(|v| !v.parts.is_empty() && v.parts.iter().all(|p| p.shows_zero()))
}

fn possible(visit: &Visit) -> bool {
    visit.operands.first().is_some_and(|v| v.parts.iter().all(|p| !p.excludes_zero()))
}

/// From which level on the form of an argument is told.
fn suspicious(shader: &Shader, arg: ExprId) -> Option<Level> {
    match &shader.expr(bare(shader, arg)).kind {
        ExprKind::Call { callee: Callee::Name(name), args: _ } if name.name == "cross" => Some(Level::Strict),
        ExprKind::Binary { op: BinaryOp::Sub, op_span: _, left, right } => {
            let (a, b) = (root(shader, *left)?, root(shader, *right)?);
            (a == b).then_some(Level::Heuristic)
        }
        _ => None,
    }
}

/// The array of which an expression is an element, or a member of one.
fn root(shader: &Shader, id: ExprId) -> Option<SymbolId> {
    let mut id = bare(shader, id);
    let mut element = false;
    loop {
        id = match &shader.expr(id).kind {
            ExprKind::Index { base, index: _ } => {
                element = true;
                bare(shader, *base)
            }
            ExprKind::Field { base, field: _ } => bare(shader, *base),
            _ => return shader.symbol_of(id).filter(|_| element),
        };
    }
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    for call in calls(shader, &["normalize"]) {
        let (visits, [arg]) = (observed.visits(call.id), call.args) else { continue };
        let level = if visits.iter().any(shown) {
            Level::Default
        } else if visits.iter().any(possible)
            && let Some(level) = suspicious(shader, *arg)
        {
            level
        } else {
            continue;
        };
        let mut found = findings
            .at(&file.file, shader.expr(*arg).span, message!("this vector can be zero", "このベクトルは零になりえます"))
            .with_label(message!("has no direction where it is zero", "零のところでは向きがありません"))
            .with_why(message!(
                "`normalize` of the zero vector divides 0 by 0, which gives NaN",
                "零ベクトルを `normalize` すると 0 を 0 で割ることになり、NaN になります"
            ))
            .with_help(message!(
                "normalise only where the length is not 0",
                "長さが 0 でないところだけで正規化してください"
            ));
        let vector = bare(shader, *arg);
        if is_simple(shader, vector) && is_plain(shader, &[call.id, *arg]) {
            let v = shader.text_of(vector);
            let text = if file.is_wgsl() {
                format!("select({v}, normalize({v}), length({v}) > 0.0)")
            } else {
                in_place(shader, call.id, format!("length({v}) > 0.0 ? normalize({v}) : {v}"))
            };
            let edit = Edit::replace(shader.expr(call.id).span, text);
            found = found.with_fix(
                message!("keep the zero vector", "零ベクトルはそのまま残す"),
                Safety::Unsafe,
                vec![edit],
            );
        }
        findings.push_at(level, found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, macro_has_no_fix, rings, silent};
    use super::*;

    #[test]
    fn vectors_that_can_be_zero_are_reported() {
        rings(
            "N005",
            Level::Default,
            &[
                "v = normalize(vec3(0.0));",
                "v = normalize(clamp(p, 0.0, 1.0));",
                "v = normalize(step(0.5, p));",
                "v = normalize(vec3(declared, 0.0, 0.0));",
            ],
        );
        rings(
            "N005",
            Level::Strict,
            &["v = normalize(cross(p, q));", "v = normalize(cross(normalize(n), vec3(0.0, 1.0, 0.0)));"],
        );
        rings("N005", Level::Heuristic, &["vec3 k[2] = vec3[](p, q); v = normalize(k[1] - k[0]);"]);
    }

    #[test]
    fn others_are_not() {
        silent(
            "N005",
            Level::Heuristic,
            &[
                "v = normalize(p);",
                "v = normalize(vec3(0.0, 1.0, 0.0));",
                "v = normalize(vec3(p.xy, 1.0));",
                "v = normalize(max(p, 0.01));",
                "v = normalize(p + q);",
                "v = normalize(p - q);",
                "v = normalize(abs(p));",
            ],
        );
        silent("N005", Level::Strict, &["vec3 d = max(p, 0.0); if (length(d) > 0.0) v = normalize(d);"]);
    }

    #[test]
    fn the_fix_keeps_zero() {
        assert_eq!(
            fixed("N005", "v = max(p, 0.0); v = normalize(v);"),
            "v = max(p, 0.0); v = length(v) > 0.0 ? normalize(v) : v;"
        );
        macro_has_no_fix("N005", "normalize(vec3(a, 0.0, 0.0) * 0.0).x");
    }
}
