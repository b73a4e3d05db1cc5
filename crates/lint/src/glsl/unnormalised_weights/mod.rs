//! N018: constant weights whose sum is nearly 1.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{ExprId, ExprKind};
use syntax::symbols::CallTarget;
use syntax::types::Type;

use analysis::numeric::{bare, calls, constant, number};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N018"),
    name: "unnormalised-weights",
    severity: Severity::Info,
    level: Level::Heuristic,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Sums so near to 1 are 1, up to the digits that people write.
const EXACT: f64 = 1e-3;

/// Sums so near to 1 are meant to be 1.
const NEAR: f64 = 0.1;

/// The sum that is meant to be 1 and is not.
fn off(weights: &[f64], may_be_half: bool) -> Option<f64> {
    let sum: f64 = weights.iter().sum();
    let half = 2.0 * sum - weights.first()?;
    let sums = if may_be_half { vec![sum, half] } else { vec![sum] };
    // The weights are rounded to binary32: a sum just at the limit is inside.
    if sums.iter().any(|s| (s - 1.0).abs() <= EXACT + 1e-6) {
        return None;
    }
    let nearest = sums.into_iter().min_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()))?;
    ((nearest - 1.0).abs() <= NEAR + 1e-6).then_some(nearest)
}

fn constants(shader: &Shader, args: &[ExprId]) -> Option<Vec<f64>> {
    args.iter().map(|a| constant(shader, *a)).collect()
}

/// Arguments of a constructor of `float` arrays.
fn array(shader: &Shader, id: ExprId) -> Option<Vec<f64>> {
    match &shader.expr(id).kind {
        ExprKind::Call { callee: _, args } => {
            let Some(CallTarget::Constructor(Type::Array(element, _))) = shader.callee(id) else { return None };
            if **element == Type::FLOAT { constants(shader, args) } else { None }
        }
        ExprKind::List(items) => {
            let floats = items.iter().all(|i| *shader.type_of(*i) == Type::FLOAT);
            if floats { constants(shader, items) } else { None }
        }
        _ => None,
    }
}

/// Arguments of a constant vector of at least three components.
fn vector(shader: &Shader, id: ExprId) -> Option<Vec<f64>> {
    let ExprKind::Call { callee: _, args } = &shader.expr(id).kind else { return None };
    let Some(CallTarget::Constructor(Type::Vector(..))) = shader.callee(id) else { return None };
    constants(shader, args).filter(|w| w.len() >= 3 && w.iter().all(|x| *x > 0.0))
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let arrays = shader.arena().iter().filter_map(|(id, _)| Some((id, array(shader, id)?, true)));
    let dots = calls(shader, &["dot"]).flat_map(|c| c.args);
    let vectors = dots.filter_map(|a| Some((*a, vector(shader, bare(shader, *a))?, false)));
    for (id, weights, may_be_half) in arrays.chain(vectors).collect::<Vec<_>>() {
        if weights.len() < 3 {
            continue;
        }
        let Some(sum) = off(&weights, may_be_half).map(number) else { continue };
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(id).span,
                    message!("these weights add up to {sum}", "この重みの和は {sum} です"),
                )
                .with_label(message!("nearly 1", "1 に近い値"))
                .with_why(message!(
                    "weights that do not add up to 1 change the brightness of the whole",
                    "重みの和が 1 でないと、全体の明るさが変わります"
                ))
                .with_help(message!(
                    "correct the weights, or divide each by the sum",
                    "重みを直すか、それぞれを和で割ってください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{lint, rings, shader, silent};
    use super::*;

    #[test]
    fn sums_near_one_are_reported() {
        rings(
            "N018",
            Level::Heuristic,
            &[
                "float w[3] = float[3](0.25, 0.5, 0.2); r = w[0];",
                "float w[3] = float[](0.2, 0.3, 0.06); r = w[1];",
                "r = dot(p, vec3(0.3, 0.6, 0.2));",
            ],
        );
        let found = lint("N018", Level::Heuristic, &shader("", "r = dot(p, vec3(0.3, 0.59, 0.12));"));
        assert_eq!(found[0].message, "these weights add up to 1.01");
    }

    #[test]
    fn others_are_not() {
        silent(
            "N018",
            Level::Heuristic,
            &[
                "float w[3] = float[3](0.25, 0.5, 0.25); r = w[0];",
                "float w[5] = float[](0.227027, 0.1945946, 0.1216216, 0.054054, 0.016216); r = w[0];",
                "float o[3] = float[](0.0, 1.3846153846, 3.2307692308); r = o[1];",
                "r = dot(p, vec3(0.2126, 0.7152, 0.0722));",
                "r = dot(p, vec3(12.9898, 78.233, 37.7));",
                "r = dot(p, normalize(vec3(1.0, 0.05, 0.01)));",
                "float w[2] = float[](0.5, 0.45); r = w[0];",
            ],
        );
    }
}
