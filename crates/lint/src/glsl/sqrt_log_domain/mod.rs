//! N008: `sqrt`, `inversesqrt`, `log` or `log2` outside their domain.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::{Evidence, Range};
use base::diagnostic::{Code, Safety, Severity, message};
use reading::{Project, ShaderFile};

use analysis::forms::{Forms, is_square};
use analysis::numeric::{around, bare, calls, constant, ends};
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N008"),
    name: "sqrt-log-domain",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

fn level(range: &Range, zero_is_inside: bool) -> Option<Level> {
    let outside = range.lo < 0.0 || (!zero_is_inside && range.lo == 0.0 && !range.nonzero);
    if range.goes_below(0.0, Evidence::Nature) || (!zero_is_inside && range.shows_zero()) {
        Some(Level::Default)
    } else {
        (outside && range.lo.is_finite()).then_some(Level::Strict)
    }
}

/// True for `1 - x * x` and `1 - dot(v, v)`, which are negative beyond 1.
fn is_leg(shader: &Shader, forms: &Forms<'_>, arg: ExprId) -> bool {
    match shader.expr(bare(shader, arg)).kind {
        ExprKind::Binary { op: BinaryOp::Sub, op_span: _, left, right } => {
            constant(shader, left).is_some() && is_square(shader, forms.value(right))
        }
        _ => false,
    }
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    let mut forms = None;
    for call in calls(shader, &["sqrt", "inversesqrt", "log", "log2"]) {
        let [arg] = call.args else { continue };
        let root = call.name == "sqrt";
        let all = observed.visits(call.id).iter().filter_map(|v| v.operands.first()).flat_map(|v| &v.parts);
        let mut worst = all.clone().filter_map(|r| Some((level(r, root)?, *r))).min_by_key(|(level, _)| *level);
        if let (None, Some(range), true) = (worst, all.clone().find(|r| r.lo == f64::NEG_INFINITY), root) {
            let forms = forms.get_or_insert_with(|| Forms::new(shader));
            worst = is_leg(shader, forms, *arg).then_some((Level::Strict, *range));
        }
        let Some((level, range)) = worst else { continue };
        let (name, (lo, hi)) = (call.name, ends(&range));
        let message = if range.lo < 0.0 {
            message!("the argument of `{name}` can be negative", "`{name}` の引数が負になりえます")
        } else {
            message!("the argument of `{name}` can be 0", "`{name}` の引数が 0 になりえます")
        };
        let mut found = findings
            .at(&file.file, shader.expr(*arg).span, message)
            .with_label(message!("from {lo} to {hi}", "{lo} から {hi} まで"))
            .with_why(message!(
                "`{name}` is undefined there: devices give NaN or infinity",
                "そこでは `{name}` は未定義で、装置は NaN や無限大を返します"
            ))
            .with_help(message!("keep the argument in the domain", "引数を定義域に収めてください"));
        let after = if root { ", 0.0)" } else { ", 1.17549435e-38)" };
        if let Some(edits) = around(shader, call.id, *arg, "max(", after) {
            found = found.with_fix(message!("cut the argument off", "引数を下から制限する"), Safety::Unsafe, edits);
        }
        findings.push_at(level, found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, macro_has_no_fix, rings, silent};
    use super::*;

    #[test]
    fn arguments_outside_the_domain_are_reported() {
        rings(
            "N008",
            Level::Default,
            &[
                "r = sqrt(sin(s));",
                "float c = dot(normalize(p), normalize(q)); r = sqrt(1.0 - c * c);",
                "r = log(max(s, 0.0));",
                "r = inversesqrt(clamp(s, 0.0, 1.0));",
                "r = log2(declared);",
                "r = sqrt(declared - 1.0);",
            ],
        );
        rings("N008", Level::Strict, &["r = log(length(p));", "r = sqrt(sin(s) + cos(s));", "r = log(fract(s));"]);
        rings("N008", Level::Strict, &["r = sqrt(1.0 - dot(p.xy, p.xy));", "r = sqrt(1.0 - s * s);"]);
    }

    #[test]
    fn random_numbers_from_bits_can_be_0() {
        let random = "fn random(n: u32) -> f32 { return bitcast<f32>((n & 0x007fffffu) | 0x3f800000u) - 1.0; }\n";
        let count = |line: &str| {
            let text = format!("{random}fn f(n: u32) -> f32 {{ let u = random(n); return {line}; }}\n");
            crate::wgsl::testing::count("N008", &text)
        };
        assert_eq!(count("sqrt(-2.0 * log(u))"), 1);
        assert_eq!(count("sqrt(-2.0 * log(1.0 - u))"), 0);
        assert_eq!(count("log(bitcast<f32>(n | 0x3f800000u) - 1.0)"), 0, "any exponent");
    }

    #[test]
    fn others_are_not() {
        silent(
            "N008",
            Level::Heuristic,
            &[
                "r = sqrt(s);",
                "r = sqrt(s - t);",
                "if (s * s <= 1.0) r = sqrt(1.0 - s * s);",
                "r = log(s);",
                "r = sqrt(dot(p, p));",
                "r = sqrt(p.x * p.x + p.y * p.y);",
                "r = sqrt(max(sin(s), 0.0));",
                "r = sqrt(declared); r += log(declared + 1.0);",
                "r = log(exp(s) + 1.0);",
                "r = sqrt(1.0 - pow(clamp(s, 0.0, 1.0), 2.0));",
                "float d = t * t - 4.0 * s; if (d < 0.0) discard; r = sqrt(d);",
                "float a = sin(s); float b = sin(t); if (a > b) r = sqrt(a - b);",
                "float a = sin(s); float b = a * 2.0; if (a > 0.0) r = 1.0;",
                "float c = sin(s); r = sqrt(1.0 - c * c);",
                "r = sqrt(-2.0 * log(clamp(s, 0.01, 1.0)));",
            ],
        );
    }

    #[test]
    fn the_fix_cuts_off() {
        assert_eq!(fixed("N008", "r = sqrt(sin(s));"), "r = sqrt(max(sin(s), 0.0));");
        assert_eq!(fixed("N008", "r = log(max(s, 0.0));"), "r = log(max(max(s, 0.0), 1.17549435e-38));");
        macro_has_no_fix("N008", "sqrt(sin(a))");
    }
}
