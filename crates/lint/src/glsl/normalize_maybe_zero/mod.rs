//! N005: `normalize` of a vector that can be zero.

use crate::project::{Project, ShaderFile};
use crate::range::Visit;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind};
use syntax::symbols::SymbolId;

use super::numeric::{bare, calls, in_place, is_plain, is_simple};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N005"),
    name: "normalize-maybe-zero",
    severity: Severity::Info,
    level: Level::Default,
    summary: "`normalize` can get the zero vector",
    page: Page {
        what: "Reports `normalize(v)` when the text shows that all components of `v` can be 0: constants, results of \
               `max`, `clamp` or `step` that end at 0, declared ranges, a vector less itself. With `--level strict`, \
               `normalize(cross(a, b))` is reported, which is 0 for parallel vectors; with `--level heuristic`, \
               the difference of two elements of one array, such as neighbours on a \
               curve, which is 0 where both are equal.",
        why: "The zero vector has no direction: `normalize` divides by its length, and the result is NaN.",
        bad: &[Example {
            name: "edge.frag",
            text: "#version 330 core\nin vec2 slope;\nout vec4 color;\nvoid main()\n{\n  \
                   vec2 uphill = normalize(max(slope, 0.0));\n  color = vec4(uphill, 0.0, 1.0);\n}\n",
        }],
        good: &[Example {
            name: "edge.frag",
            text: "#version 330 core\nin vec2 slope;\nout vec4 color;\nvoid main()\n{\n  \
                   vec2 uphill = normalize(max(slope, 1e-6));\n  color = vec4(uphill, 0.0, 1.0);\n}\n",
        }],
        fix: "For a variable or a member of one, keeps the zero vector as it is. Unsafe: results change where the \
              length is 0.",
        references: &["GLSL 4.60 specification, section 8.5 \"Geometric Functions\""],
        ja: Japanese {
            summary: "`normalize` に零ベクトルが渡されることがあります",
            what: "`v` のすべての成分が 0 になりうることが本文から分かる `normalize(v)` を報告します。定数、0 で止まる `max`・`clamp`・`step` の結果、宣言した範囲、自分自身を引いたベクトルなどです。`--level strict` では、平行なベクトルで 0 になる `normalize(cross(a, b))` も、`--level heuristic` では、曲線上の隣り合う点のように同じ配列の 2 つの要素の差も、両者が等しいと 0 になるので報告します。",
            why: "零ベクトルには向きがありません。`normalize` は長さで割るので、結果は NaN になります。",
            fix: "変数またはその成分であれば、零ベクトルをそのまま残すようにします。unsafe: 長さが 0 のところで結果が変わります。",
        },
    },
    check: Check::ShaderWith(check),
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
            let edit = Edit::replace(
                shader.expr(call.id).span,
                in_place(shader, call.id, format!("length({v}) > 0.0 ? normalize({v}) : {v}")),
            );
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
    fn vectors_that_can_be_zero_are_told() {
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
