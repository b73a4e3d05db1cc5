//! N012: `mix` with a weight beyond 0 or 1.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::{Evidence, Range, UNIT_SLACK};
use base::diagnostic::{Code, Safety, Severity, message};
use reading::{Project, ShaderFile};
use syntax::types::ScalarType;

use analysis::numeric::{around, calls, constant, ends};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N012"),
    name: "mix-t-range",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

fn beyond(weight: &Range) -> bool {
    let slack = 4.0 * UNIT_SLACK;
    weight.goes_below(-slack, Evidence::Nature) || weight.goes_above(1.0 + slack, Evidence::Nature)
}

/// At one of the ends or beyond, whatever comes.
fn never(weight: &Range) -> bool {
    (weight.lo >= 1.0 && weight.hi > 1.0) || (weight.hi <= 0.0 && weight.lo < 0.0)
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    for call in calls(shader, &["mix"]) {
        let [_, _, weight] = call.args else { continue };
        if shader.type_of(*weight).scalar() == Some(ScalarType::Bool) {
            continue;
        }
        let weights = || observed.visits(call.id).iter().filter_map(|v| v.operands.get(2)).flat_map(|v| &v.parts);
        // A number that is written there is meant.
        let never = weights().next().is_some() && weights().all(never) && constant(shader, *weight).is_none();
        let Some(range) = weights().find(|r| never || beyond(r)) else { continue };
        let (lo, hi) = ends(range);
        let message = if never {
            message!("this weight of `mix` is never between 0 and 1", "この `mix` の重みは 0 と 1 の間になりません")
        } else {
            message!("this weight of `mix` goes beyond 0 or 1", "この `mix` の重みは 0 から 1 の範囲を超えます")
        };
        let mut found = findings
            .at(&file.file, shader.expr(*weight).span, message)
            .with_label(message!("from {lo} to {hi}", "{lo} から {hi} まで"))
            .with_why(message!(
                "`mix` does not clamp: it extrapolates beyond its first two arguments",
                "`mix` は重みを制限しないので、最初の二つの引数の外へ外挿します"
            ))
            .with_help(message!("bring the weight to between 0 and 1", "重みを 0 から 1 の間に収めてください"));
        // One that never lies between would be the same at all times.
        let edits = || around(shader, call.id, *weight, "clamp(", ", 0.0, 1.0)");
        if let Some(edits) = (!never).then(edits).flatten() {
            found = found.with_fix(message!("clamp the weight", "重みを制限する"), Safety::Unsafe, edits);
        }
        if !never {
            found.severity = Severity::Info;
        }
        findings.push_at(if never { Level::Default } else { Level::Strict }, found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, macro_has_no_fix, rings, silent};
    use super::*;

    #[test]
    fn weights_beyond_the_ends_are_reported() {
        rings(
            "N012",
            Level::Strict,
            &[
                "v = mix(p, q, sin(s));",
                "v = mix(p, q, 1.5);",
                "v = mix(p, q, declared);",
                "v = mix(p, q, normalize(n));",
            ],
        );
    }

    #[test]
    fn a_weight_that_never_lies_between_is_told_without_being_asked_for() {
        rings("N012", Level::Default, &["v = mix(p, q, pow(2.0, pow(2.0, s)));", "v = mix(p, q, 1.0 + s * s);"]);
        silent(
            "N012",
            Level::Default,
            &["v = mix(p, q, sin(s));", "v = mix(p, q, 1.5);", "v = mix(p, q, 1.0 - s * s);"],
        );
    }

    #[test]
    fn others_are_not() {
        silent(
            "N012",
            Level::Heuristic,
            &[
                "v = mix(p, q, s);",
                "v = mix(p, q, 0.5 + 0.5 * sin(s));",
                "v = mix(p, q, clamp(s, 0.0, 1.0));",
                "v = mix(p, q, max(dot(normalize(p), normalize(n)), 0.0));",
                "v = mix(p, q, bvec3(true, false, s > 0.0));",
                "v = mix(p, q, smoothstep(0.0, 1.0, s));",
            ],
        );
    }

    #[test]
    fn the_fix_clamps() {
        assert_eq!(fixed("N012", "v = mix(p, q, sin(s));"), "v = mix(p, q, clamp(sin(s), 0.0, 1.0));");
        macro_has_no_fix("N012", "mix(0.1, 0.2, sin(a))");
    }
}
