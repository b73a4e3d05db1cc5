//! N001: `pow` of a base that can be negative.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::{Evidence, Observed, Range};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::{Project, ShaderFile};
use syntax::ast::ExprId;

use super::numeric::cosine;
use analysis::numeric::{around, bare, calls, constant, ends, in_place, is_plain, is_simple};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N001"),
    name: "pow-negative-base",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

/// From which level on a base counts as possibly negative, with its range.
pub fn hazard(observed: &Observed, call: ExprId) -> Option<(Level, Range)> {
    let bases = observed.visits(call).iter().filter_map(|v| v.operands.first()).flat_map(|v| &v.parts);
    let level = |r: &Range| {
        if r.goes_below(0.0, Evidence::Nature) {
            Some(Level::Default)
        } else {
            (r.lo < 0.0 && r.lo.is_finite()).then_some(Level::Strict)
        }
    };
    bases.filter_map(|r| Some((level(r)?, *r))).min_by_key(|(level, _)| *level)
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    let mut forms = None;
    for call in calls(shader, &["pow"]) {
        let [base, exponent] = call.args else { continue };
        let unknown = || cosine(shader, &observed, &call, &mut forms);
        let Some((level, range)) = hazard(&observed, call.id).or_else(unknown) else { continue };
        let (lo, hi) = ends(&range);
        let mut found = findings
            .at(
                &file.file,
                shader.expr(*base).span,
                message!("the base of `pow` can be negative", "`pow` の底が負になりえます"),
            )
            .with_label(message!("from {lo} to {hi}", "{lo} から {hi} まで"))
            .with_why(message!(
                "`pow` of a negative number is undefined, whatever the exponent is; most devices give NaN",
                "負の数の `pow` は、指数によらず未定義です。多くの装置では NaN になります"
            ))
            .with_help(message!("give `pow` a base that is not negative", "負にならない底を `pow` に渡してください"));
        let factor = bare(shader, *base);
        let whole = constant(shader, *exponent).and_then(factors).filter(|_| is_simple(shader, factor));
        if let (Some(n), true) = (whole, is_plain(shader, &[call.id, *exponent])) {
            let product = vec![shader.text_of(factor); n].join(" * ");
            let edit = Edit::replace(shader.expr(call.id).span, in_place(shader, call.id, product));
            found = found.with_fix(message!("write a product", "積で書く"), Safety::Unsafe, vec![edit]);
        } else if let Some(edits) = around(shader, call.id, *base, "max(", ", 0.0)") {
            found = found.with_fix(
                message!("keep the base from being negative", "底が負にならないようにする"),
                Safety::Unsafe,
                edits,
            );
        }
        findings.push_at(level, found);
    }
}

/// How many factors a small whole exponent stands for.
pub fn factors(exponent: f64) -> Option<usize> {
    [2u8, 3, 4].into_iter().find(|n| f64::from(*n) == exponent).map(usize::from)
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, lint, macro_has_no_fix, rings, shader, silent};
    use super::*;

    #[test]
    fn negative_bases_are_reported() {
        rings(
            "N001",
            Level::Default,
            &[
                "r = pow(sin(s), 2.5);",
                "r = pow(dot(normalize(p), normalize(n)), s);",
                "float d = dot(normalize(p), normalize(n)); r = pow(1.0 - abs(d), 5.0);",
                "r = pow(1.0 - max(dot(normalize(p), normalize(n)), 0.0), 5.0);",
                "v = pow(normalize(p), vec3(2.2));",
                "r = pow(declared - 1.0, 0.5);",
                "r = pow(dot(normalize(reflect(-normalize(q - p), normalize(n))), normalize(p)), s);",
                "float a = sin(s); if (a < 0.5) r = pow(a, 1.5);",
            ],
        );
        rings(
            "N001",
            Level::Strict,
            &[
                "vec3 h = normalize(normalize(q) + normalize(p)); r = pow(dot(h, normalize(p)), s);",
                "float a = sin(s); float b = cos(s); r = pow(a + b, 2.5);",
                "r = pow(dot(p, q), s);",
            ],
        );
    }

    #[test]
    fn guarded_and_unknown_bases_are_not() {
        silent(
            "N001",
            Level::Heuristic,
            &[
                "r = pow(s, t);",
                "r = pow(max(sin(s), 0.0), 2.5);",
                "r = pow(abs(sin(s)), 2.5);",
                "float a = sin(s); if (a > 0.0) r = pow(a, 2.5);",
                "float a = sin(s); if (a < 0.0) { v = q; } else { r = pow(a, 2.5); }",
                "float a = sin(s); r = a >= 0.0 ? pow(a, 2.5) : 0.0;",
                "float a = sin(s); if (a <= 0.0) discard; r = pow(a, 2.5);",
                "float a = sin(s); r = pow(a * a, 2.5);",
                "if (dot(p, q) > 0.0) r = pow(dot(p, q), 2.5);",
                "r = pow(texture(image, p.xy).r, 2.2);",
                "r = pow(clamp(1.0 - s, 0.0, 1.0), 5.0);",
                "r = pow(1.0 - clamp(s, 0.0, 1.0), 5.0);",
                "r = pow(0.5 + 0.5 * sin(s), 2.5);",
                "r = pow(declared, 0.5);",
                "float a = sin(s); if (a < 0.0) a = 0.0; r = pow(a, 2.5);",
                "vec3 a = normalize(p); if (a.y < 0.0) a.y = -a.y; r = pow(a.y, 2.5);",
                "r = pow(length(p), 0.5); r += pow(exp(s), 2.0); r += pow(fract(s), 2.0);",
                "float a = 0.0; for (int i = 0; i < 4; ++i) a += 0.25; r = pow(a, 2.5);",
                "float a = 2.0; while (a > 1.0) a *= 0.5; r = pow(a + 1.0, 0.5);",
            ],
        );
    }

    #[test]
    fn a_range_follows_its_argument_into_a_function() {
        let before = "float f(float x) { return pow(1.0 - x, 5.0); }";
        let call = |argument: &str| lint("N001", Level::Default, &shader(before, &format!("r = f({argument});"))).len();
        assert_eq!(call("max(dot(normalize(p), normalize(q)), 0.0)"), 1);
        assert_eq!(call("clamp(dot(normalize(p), normalize(q)), 0.0, 1.0)"), 0);
        assert_eq!(call("s"), 0);
    }

    #[test]
    fn the_fix_is_a_maximum_or_a_product() {
        assert_eq!(fixed("N001", "r = pow(sin(s), t);"), "r = pow(max(sin(s), 0.0), t);");
        assert_eq!(fixed("N001", "v.x = sin(s); r = pow(v.x, 3.0);"), "v.x = sin(s); r = v.x * v.x * v.x;");
        macro_has_no_fix("N001", "pow(sin(a), 2.5)");
    }
}
