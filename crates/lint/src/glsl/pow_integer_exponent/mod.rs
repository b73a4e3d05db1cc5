//! N004: `pow` with a small whole exponent.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::{Project, ShaderFile};

use super::pow_negative_base::{factors, hazard};
use analysis::numeric::{bare, calls, constant, in_place, is_plain, is_simple};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N004"),
    name: "pow-integer-exponent",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    for call in calls(shader, &["pow"]) {
        let [base, exponent] = call.args else { continue };
        let Some(n) = constant(shader, *exponent).and_then(factors) else { continue };
        if constant(shader, *base).is_some() || hazard(&observed, call.id).is_some() {
            continue;
        }
        let factor = bare(shader, *base);
        let text = shader.text_of(*exponent);
        let mut found = findings
            .at(
                &file.file,
                shader.expr(call.id).span,
                message!("`pow` with the exponent {text} is a product", "指数が {text} の `pow` は積で書けます"),
            )
            .with_label(message!("{n} factors", "{n} 個の積"))
            .with_why(message!(
                "`pow` is computed by a logarithm and is less exact; for a negative base it is undefined",
                "`pow` は対数を使って計算されるので精度が低く、底が負だと未定義です"
            ))
            .with_help(message!("multiply the base by itself", "底どうしを掛けてください"));
        if is_simple(shader, factor) && is_plain(shader, &[call.id, *base, *exponent]) {
            let product = vec![shader.text_of(factor); n].join(" * ");
            let edit = Edit::replace(shader.expr(call.id).span, in_place(shader, call.id, product));
            found = found.with_fix(message!("write a product", "積で書く"), Safety::Unsafe, vec![edit]);
        }
        findings.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, lint, macro_has_no_fix, rings, shader, silent};
    use super::*;

    #[test]
    fn small_whole_exponents_are_reported() {
        rings(
            "N004",
            Level::Strict,
            &["r = pow(s, 2.0);", "r = pow(length(p), 3.0);", "const float k = 4.0; r = pow(s, k);"],
        );
    }

    #[test]
    fn others_are_not() {
        silent(
            "N004",
            Level::Heuristic,
            &[
                "r = pow(s, 2.5);",
                "r = pow(s, 5.0);",
                "r = pow(s, t);",
                "r = pow(2.0, 3.0);",
                "r = pow(2.0, s);",
                "r = pow(sin(s), 2.0);",
            ],
        );
    }

    #[test]
    fn the_fix_is_a_product() {
        assert_eq!(fixed("N004", "r = 2.0 / pow(s, 2.0);"), "r = 2.0 / (s * s);");
        let found = lint("N004", Level::Strict, &shader("", "r = pow(length(p), 2.0);"));
        assert!(found[0].fix.is_none(), "a call is not repeated");
        macro_has_no_fix("N004", "pow(a, 2.0)");
    }
}
