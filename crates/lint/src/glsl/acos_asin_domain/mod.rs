//! N006: `acos` or `asin` of a number that can be beyond 1.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::{Evidence, Observed, Range};
use base::diagnostic::{Code, Safety, Severity, message};
use reading::{Project, ShaderFile};
use syntax::ast::ExprId;

use super::numeric::cosine;
use analysis::numeric::{around, calls, ends};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N006"),
    name: "acos-asin-domain",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

/// From which level on an argument counts as possibly outside, with its range.
pub fn hazard(observed: &Observed, call: ExprId) -> Option<(Level, Range)> {
    let args = observed.visits(call).iter().filter_map(|v| v.operands.first()).flat_map(|v| &v.parts);
    let level = |r: &Range| {
        if r.goes_below(-1.0, Evidence::Nature) || r.goes_above(1.0, Evidence::Nature) {
            Some(Level::Default)
        } else {
            let outside = (r.lo < -1.0 && r.lo.is_finite()) || (r.hi > 1.0 && r.hi.is_finite());
            outside.then_some(Level::Strict)
        }
    };
    args.filter_map(|r| Some((level(r)?, *r))).min_by_key(|(level, _)| *level)
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    let mut forms = None;
    for call in calls(shader, &["acos", "asin"]) {
        let [arg] = call.args else { continue };
        let unknown = || cosine(shader, &observed, &call, &mut forms);
        let Some((level, range)) = hazard(&observed, call.id).or_else(unknown) else { continue };
        let (name, (lo, hi)) = (call.name, ends(&range));
        let mut found = findings
            .at(
                &file.file,
                shader.expr(*arg).span,
                message!(
                    "the argument of `{name}` can be beyond -1 or 1",
                    "`{name}` の引数が -1 から 1 の範囲を超えることがあります"
                ),
            )
            .with_label(message!("from {lo} to {hi}", "{lo} から {hi} まで"))
            .with_why(message!(
                "`{name}` is undefined there, and most devices give NaN",
                "そこでは `{name}` は未定義で、多くの装置では NaN になります"
            ))
            .with_help(message!("clamp the argument to -1 and 1", "引数を -1 から 1 に制限してください"));
        if let Some(edits) = around(shader, call.id, *arg, "clamp(", ", -1.0, 1.0)") {
            found = found.with_fix(message!("clamp the argument", "引数を制限する"), Safety::Unsafe, edits);
        }
        findings.push_at(level, found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, macro_has_no_fix, rings, silent};
    use super::*;

    #[test]
    fn arguments_beyond_one_are_reported() {
        rings(
            "N006",
            Level::Default,
            &[
                "r = acos(dot(normalize(p), normalize(q)));",
                "vec3 d = normalize(p); r = asin(d.y);",
                "r = acos(declared);",
                "r = acos(2.0 * sin(s));",
                "float c = dot(normalize(p), normalize(q)); if (t > 0.0) r = acos(c);",
            ],
        );
        rings(
            "N006",
            Level::Strict,
            &["r = asin(sin(s) + cos(s));", "r = acos(dot(p, q));", "float c = dot(p, q); r = acos(c);"],
        );
    }

    #[test]
    fn others_are_not() {
        silent(
            "N006",
            Level::Heuristic,
            &[
                "r = acos(s);",
                "float c = dot(p, q); c = clamp(c, -1.0, 1.0); r = acos(c);",
                "r = acos(clamp(dot(normalize(p), normalize(q)), -1.0, 1.0));",
                "r = acos(min(max(s, -1.0), 1.0));",
                "r = asin(sin(s));",
                "r = acos(0.5);",
                "r = acos(2.0 * fract(s) - 1.0);",
                "r = acos(texture(image, p.xy).r);",
                "float c = dot(normalize(p), normalize(q)); if (c < 1.0 && c > -1.0) r = acos(c);",
                "float c = dot(normalize(p), normalize(q)); if (abs(c) >= 1.0) { v = q; } else { r = acos(c * s); }",
            ],
        );
    }

    #[test]
    fn the_fix_clamps() {
        assert_eq!(fixed("N006", "r = acos(sin(s) * 2.0);"), "r = acos(clamp(sin(s) * 2.0, -1.0, 1.0));");
        macro_has_no_fix("N006", "acos(2.0 * sin(a))");
    }
}
