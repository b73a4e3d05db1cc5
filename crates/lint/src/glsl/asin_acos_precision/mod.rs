//! N007: `acos` and `asin` near their ends.

use crate::project::{Project, ShaderFile};
use crate::range::Visit;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};

use super::acos_asin_domain;
use super::numeric::calls;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N007"),
    name: "asin-acos-precision",
    severity: Severity::Info,
    level: Level::Strict,
    summary: "`acos` or `asin` is used up to -1 or 1, where it loses half of its digits",
    page: Page {
        what: "Reports `acos(x)` and `asin(x)` when the range of `x` reaches -1 or 1, or is not known. What goes \
               beyond is left to N006 (`acos-asin-domain`). A range that stays away from both ends is not reported.",
        why: "Near 1 the arc cosine falls with infinite slope: a rounding error of 6e-8 in the argument is an error \
              of 3.5e-4 in the angle, and small angles cannot be told apart. Devices may be off by another 4e-3 \
              there. `atan(y, x)` is exact to a few digits for all angles.",
        bad: &[Example {
            name: "angle.frag",
            text: "#version 330 core\nin vec3 a;\nin vec3 b;\nout vec4 color;\nvoid main()\n{\n  \
                   float angle = acos(clamp(dot(a, b), -1.0, 1.0));\n  color = vec4(angle);\n}\n",
        }],
        good: &[Example {
            name: "angle.frag",
            text: "#version 330 core\nin vec3 a;\nin vec3 b;\nout vec4 color;\nvoid main()\n{\n  \
                   float angle = atan(length(cross(a, b)), dot(a, b));\n  color = vec4(angle);\n}\n",
        }],
        fix: "No fix: the other side of the triangle must be computed.",
        references: &[
            "Vulkan specification, appendix \"Precision and Operation of SPIR-V Instructions\": asin and acos inherit \
             from atan2(x, sqrt(1.0 - x * x))",
            "W. Kahan, \"How Futile are Mindless Assessments of Roundoff in Floating-Point Computation?\", section 12: \
             angles between vectors",
        ],
        ja: Japanese {
            summary: "桁の半分が失われる -1 や 1 の近くまで `acos`・`asin` を使っています",
            what: "`x` の範囲が -1 や 1 に達する、または範囲が分からない `acos(x)`・`asin(x)` を報告します。範囲を超えるものは N006（`acos-asin-domain`）が報告します。両端から離れた範囲は報告しません。",
            why: "逆余弦は 1 の近くで傾きが無限大になります。引数の 6e-8 の丸め誤差が、角度では 3.5e-4 の誤差になり、小さい角度を区別できません。装置の誤差がさらに 4e-3 加わることもあります。`atan(y, x)` なら、どの角度でも末尾の数桁まで正確です。",
            fix: "自動修正（fix）はありません。三角形のもう一辺を計算する必要があるためです。",
        },
    },
    check: Check::ShaderWith(check),
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
    fn arguments_up_to_the_ends_are_told() {
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
