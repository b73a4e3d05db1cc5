//! N027: a logarithm that is divided by the base instead of its logarithm.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::ast::{BinaryOp, ExprKind};
use syntax::words::words;

use analysis::forms::{Forms, builtin};
use analysis::names;
use analysis::numeric::is_plain;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N027"),
    name: "logarithm-base",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut forms = None;
    for (_, expr) in shader.arena().iter() {
        let ExprKind::Binary { op: BinaryOp::Div, op_span: _, left, right } = expr.kind else { continue };
        let Some((log, _)) = builtin(shader, left, &["log", "log2"]) else { continue };
        let Some(name) = names::of(shader, right).filter(|n| words(n).last().is_some_and(|w| w == "base")) else {
            continue;
        };
        // A variable of that name may hold the logarithm already.
        let forms = forms.get_or_insert_with(|| Forms::new(shader));
        let is_logarithm = words(name).iter().rev().nth(1).is_some_and(|w| w == "log" || w == "ln");
        if is_logarithm || builtin(shader, forms.value(right), &["log", "log2"]).is_some() {
            continue;
        }
        let base = shader.text_of(right);
        let mut found = findings
            .at(
                &file.file,
                expr.span,
                message!(
                    "the logarithm to `{base}` is `{log}(x) / {log}({base})`",
                    "`{base}` を底とする対数は `{log}(x) / {log}({base})` です"
                ),
            )
            .with_label(message!("divided by the base itself", "底そのもので割っています"))
            .with_why(message!(
                "a change of the base divides by the logarithm of the base",
                "底の変換では、底の対数で割ります"
            ))
            .with_help(message!("take the logarithm of the base", "底の対数を取ってください"));
        if is_plain(shader, &[left, right]) {
            let edit = Edit::replace(shader.expr(right).span, format!("{log}({base})"));
            found = found.with_fix(
                message!("divide by `{log}({base})`", "`{log}({base})` で割る"),
                Safety::Unsafe,
                vec![edit],
            );
        }
        findings.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, lint, shader};
    use super::*;

    fn count(body: &str) -> usize {
        lint("N027", Level::Default, &shader("uniform float base;\nuniform float logBase;", body)).len()
    }

    #[test]
    fn the_base_is_not_its_logarithm() {
        assert_eq!(count("r = log(s) / base;"), 1);
        assert_eq!(count("v = log2(p) / base;"), 1);
        for body in [
            "r = log(s) / log(base);",
            "r = log(s) / logBase;",
            "float base = log(t); r = log(s) / base;",
            "r = s / base;",
        ] {
            assert_eq!(count(body), 0, "{body}");
        }
    }

    #[test]
    fn the_fix_takes_the_logarithm() {
        assert_eq!(fixed("N027", "float base = s; r = log(t) / base;"), "float base = s; r = log(t) / log(base);");
    }
}
