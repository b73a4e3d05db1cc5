//! N002: `pow` of zero with an exponent that may be zero.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::{Evidence, Visit};
use base::diagnostic::{Code, Safety, Severity, message};
use reading::{Project, ShaderFile};

use analysis::numeric::{around, calls, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N002"),
    name: "pow-zero-exponent-zero",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

fn hazard(visit: &Visit) -> Option<Level> {
    let [x, y] = visit.operands.as_slice() else { return None };
    let n = x.parts.len().max(y.parts.len());
    let level = |i: usize| {
        let (x, y) = (x.part(i)?, y.part(i)?);
        let zero = x.shows_zero() && y.lo <= 0.0 && !(y.lo == 0.0 && y.nonzero);
        match () {
            () if zero && y.lo_by == Evidence::Stated => Some(Level::Default),
            () if zero && y.lo.is_infinite() => Some(Level::Heuristic),
            () => None,
        }
    };
    (0..n).filter_map(level).min()
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    for call in calls(shader, &["pow"]) {
        let Some(level) = observed.visits(call.id).iter().filter_map(hazard).min() else { continue };
        let [base, exponent] = call.args else { continue };
        let mut found = findings
            .at(
                &file.file,
                shader.expr(*exponent).span,
                message!(
                    "this exponent can be 0 or less while the base of `pow` is 0",
                    "`pow` の底が 0 のとき、この指数が 0 以下になりえます"
                ),
            )
            .with_label(message!("0 or less", "0 以下"))
            .with_related(&file.file, shader.expr(*base).span, message!("this can be 0", "ここが 0 になりえます"))
            .with_why(message!(
                "0 to the power of 0 or less is undefined; devices give NaN or infinity",
                "0 の 0 乗や負のべき乗は未定義です。装置は NaN や無限大を返します"
            ))
            .with_help(message!(
                "keep the base or the exponent away from 0",
                "底または指数が 0 にならないようにしてください"
            ));
        if constant(shader, *exponent).is_none()
            && let Some(edits) = around(shader, call.id, *exponent, "max(", ", 1e-4)")
        {
            found =
                found.with_fix(message!("keep the exponent above 0", "指数を 0 より大きく保つ"), Safety::Unsafe, edits);
        }
        findings.push_at(level, found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, macro_has_no_fix, rings, silent};
    use super::*;

    #[test]
    fn a_zero_base_with_a_zero_exponent_is_reported() {
        rings(
            "N002",
            Level::Default,
            &[
                "r = pow(max(s, 0.0), declared);",
                "r = pow(clamp(s, 0.0, 1.0), -2.0);",
                "r = pow(0.0, 0.0);",
                "v = pow(max(p, 0.0), vec3(declared));",
            ],
        );
        rings("N002", Level::Heuristic, &["r = pow(max(s, 0.0), t);"]);
    }

    #[test]
    fn positive_bases_and_exponents_are_not() {
        silent(
            "N002",
            Level::Heuristic,
            &[
                "r = pow(max(s, 0.0), 32.0);",
                "r = pow(max(s, 0.001), t);",
                "r = pow(max(s, 0.0), declared + 1.0);",
                "r = pow(max(s, 0.0), max(t, 1.0));",
                "if (t > 0.0) r = pow(max(s, 0.0), t);",
                "r = pow(s, -1.0);",
            ],
        );
    }

    #[test]
    fn the_fix_lifts_the_exponent() {
        assert_eq!(fixed("N002", "r = pow(max(s, 0.0), declared);"), "r = pow(max(s, 0.0), max(declared, 1e-4));");
        macro_has_no_fix("N002", "pow(max(a, 0.0), -1.0)");
    }
}
