//! N007: `acos` and `asin` near their ends.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::Visit;
use base::diagnostic::{Code, Severity, message};
use reading::{Project, ShaderFile};

use super::acos_asin_domain;
use analysis::numeric::calls;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N007"),
    name: "asin-acos-precision",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

/// Arguments from here on are near the end.
const NEAR: f64 = 0.999;

fn reaches_an_end(visit: &Visit) -> bool {
    visit.operands.first().is_some_and(|v| v.parts.iter().any(|r| r.lo < r.hi && (r.hi >= NEAR || r.lo <= -NEAR)))
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    for call in calls(shader, &["acos", "asin"]) {
        if acos_asin_domain::hazard(&observed, call.id).is_some()
            || !observed.visits(call.id).iter().any(reaches_an_end)
        {
            continue;
        }
        let name = call.name;
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(call.id).span,
                    message!(
                        "`{name}` loses half of its digits near -1 and 1",
                        "`{name}` は -1 と 1 の近くで桁の半分を失います"
                    ),
                )
                .with_label(message!("inexact for angles near the ends", "端に近い角度では不正確です"))
                .with_why(message!(
                    "its slope is infinite there: the last digit of the argument changes the angle by 3.5e-4",
                    "そこでは傾きが無限大になり、引数の最後の桁で角度が 3.5e-4 変わります"
                ))
                .with_help(message!(
                    "compute both sides of the triangle and use `atan(y, x)`",
                    "三角形の二辺を計算し、`atan(y, x)` を使ってください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{rings, silent};
    use super::*;

    #[test]
    fn arguments_up_to_the_ends_are_reported() {
        rings("N007", Level::Strict, &["r = acos(s);", "r = asin(clamp(s, -1.0, 1.0));", "r = acos(sin(s));"]);
    }

    #[test]
    fn others_are_not() {
        silent(
            "N007",
            Level::Heuristic,
            &[
                "r = acos(clamp(s, -0.9, 0.9));",
                "r = acos(0.5 * sin(s));",
                "r = acos(-1.0);",
                "r = acos(dot(normalize(p), normalize(q)));",
                "r = atan(s, t);",
            ],
        );
    }
}
