//! N010: `atan` of a quotient.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::{Project, ShaderFile};
use syntax::ast::{BinaryOp, ExprKind};

use analysis::numeric::{bare, calls, constant, is_plain};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N010"),
    name: "one-argument-atan",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    for call in calls(shader, &["atan"]) {
        let [arg] = call.args else { continue };
        let quotient = bare(shader, *arg);
        let ExprKind::Binary { op: BinaryOp::Div, op_span: _, left, right } = shader.expr(quotient).kind else {
            continue;
        };
        let mut divisors = observed.visits(quotient).iter().filter_map(|v| v.operands.get(1)).flat_map(|v| &v.parts);
        let positive = divisors.clone().next().is_some() && divisors.all(|r| r.lo > 0.0);
        if positive || constant(shader, right).is_some() {
            continue;
        }
        let mut found = findings
            .at(
                &file.file,
                shader.expr(call.id).span,
                message!("`atan` of a quotient does not know the quadrant", "商の `atan` では象限が分かりません"),
            )
            .with_label(message!("half a turn at most", "半周分だけです"))
            .with_why(message!(
                "opposite directions have the same quotient, and it does not exist where the divisor is 0",
                "反対の向きでも商は同じで、除数が 0 のところでは商がありません"
            ))
            .with_help(if file.is_wgsl() {
                message!("use `atan2`", "`atan2` を使ってください")
            } else {
                message!("use `atan` with two arguments", "引数が二つの `atan` を使ってください")
            });
        if is_plain(shader, &[call.id, *arg, quotient]) && shader.type_of(left) == shader.type_of(right) {
            let text = format!("{}, {}", shader.text_of(left), shader.text_of(right));
            let mut edits = vec![Edit::replace(shader.expr(*arg).span, text)];
            let name = base::text::Span::at(shader.expr(call.id).span.start + "atan".len());
            edits.extend(file.is_wgsl().then(|| Edit::replace(name, "2")));
            found = found.with_fix(message!("give both sides", "両辺を渡す"), Safety::Unsafe, edits);
        }
        findings.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, macro_has_no_fix, rings, silent};
    use super::*;

    #[test]
    fn quotients_are_reported() {
        rings("N010", Level::Strict, &["r = atan(p.y / p.x);", "r = atan((s / t));", "v = atan(p / q);"]);
    }

    #[test]
    fn others_are_not() {
        silent(
            "N010",
            Level::Heuristic,
            &[
                "r = atan(p.y, p.x);",
                "r = atan(s);",
                "r = atan(s / 2.0);",
                "r = atan(s / max(t, 0.1));",
                "r = atan(s * t);",
            ],
        );
    }

    #[test]
    fn the_fix_gives_two_arguments() {
        assert_eq!(fixed("N010", "r = atan((p.y / (p.x + 1.0)));"), "r = atan(p.y, (p.x + 1.0));");
        macro_has_no_fix("N010", "atan(a / t)");
    }
}
