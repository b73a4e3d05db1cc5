//! N003: `pow` with a large exponent flushes to zero.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::{Evidence, Range, Visit};
use base::diagnostic::{Code, Severity, message};
use reading::{Project, ShaderFile};

use analysis::numeric::{calls, number};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N003"),
    name: "pow-underflow",
    severity: Severity::Info,
    level: Level::Heuristic,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

/// Exponents from here on are looked at.
const LARGE: f64 = 64.0;

/// The base below which the power is no normal number, when the range has such bases.
fn hazard(visit: &Visit) -> Option<(f64, f64)> {
    let [x, y] = visit.operands.as_slice() else { return None };
    let below = |x: Range, y: Range| {
        let least = f64::from(f32::MIN_POSITIVE).powf(1.0 / y.hi);
        let large = y.lo >= LARGE && y.lo_by == Evidence::Stated && y.hi.is_finite();
        (large && x.lo >= 0.0 && x.lo < least && x.hi > x.lo).then_some((least, y.hi))
    };
    (0..x.parts.len()).find_map(|i| below(x.part(i)?, y.part(i)?))
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    for call in calls(shader, &["pow"]) {
        let Some((least, exponent)) = observed.visits(call.id).iter().find_map(hazard) else { continue };
        let (least, exponent) = (number((least * 1000.0).round() / 1000.0), number(exponent));
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(call.id).span,
                    message!(
                        "with the exponent {exponent}, bases below {least} give no normal number",
                        "指数が {exponent} のとき、{least} より小さい底では結果が正規化数になりません"
                    ),
                )
                .with_label(message!("underflows", "アンダーフローします"))
                .with_why(message!(
                    "devices differ in whether they give 0 or a subnormal number there",
                    "そこで 0 を返すか非正規化数を返すかは、装置によって異なります"
                ))
                .with_help(message!(
                    "do not divide by the result, take its logarithm or compare it with 0",
                    "この結果で割ったり、対数を取ったり、0 と比べたりしないでください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{rings, silent};
    use super::*;

    #[test]
    fn large_exponents_of_small_bases_are_reported() {
        rings(
            "N003",
            Level::Heuristic,
            &["r = pow(max(s, 0.0), 128.0);", "r = pow(clamp(s, 0.0, 1.0), 64.0 + declared);"],
        );
    }

    #[test]
    fn others_are_not() {
        silent(
            "N003",
            Level::Heuristic,
            &[
                "r = pow(max(s, 0.0), 32.0);",
                "r = pow(clamp(s, 0.9, 1.0), 128.0);",
                "r = pow(max(s, 0.0), t);",
                "r = pow(max(s, 0.0), declared);",
            ],
        );
    }
}
