//! N037: a divisor kept from 0 by a number that is too small to help.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Message, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::types::ScalarType;

use super::division_by_zero::divisions;
use analysis::forms::Forms;
use analysis::numeric::{bare, constant, number};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N037"),
    name: "epsilon-without-effect",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Quotients of numerators above 3.4e8 overflow behind a smaller divisor.
const TOO_SMALL: f64 = 1e-30;

/// The greatest number of binary32.
const GREATEST: f64 = f32::MAX as f64;

/// The constant that a sum adds, and the other term.
fn added(shader: &Shader, sum: ExprId) -> Option<(f64, ExprId, ExprId)> {
    let ExprKind::Binary { op: BinaryOp::Add, op_span: _, left, right } = shader.expr(bare(shader, sum)).kind else {
        return None;
    };
    let term = |small: ExprId, other: ExprId| {
        let value = constant(shader, small).filter(|v| *v > 0.0 && *v < TOO_SMALL)?;
        constant(shader, other).is_none().then_some((value, small, other))
    };
    term(right, left).or_else(|| term(left, right))
}

/// A constant of a sum that the constant beside it swallows in binary32, and that constant.
fn swallowed(shader: &Shader, sum: ExprId) -> Option<(ExprId, ExprId)> {
    let ExprKind::Binary { op: op @ (BinaryOp::Add | BinaryOp::Sub), op_span: _, left, right } =
        shader.expr(bare(shader, sum)).kind
    else {
        return None;
    };
    let single = |term: ExprId| constant(shader, term).map(|value| value as f32);
    let (Some(a), Some(b)) = (single(left), single(right)) else {
        return swallowed(shader, left).or_else(|| swallowed(shader, right));
    };
    let whole = if op == BinaryOp::Add { a + b } else { a - b };
    let vanishes = |small: f32, large: f32| small != 0.0 && small.abs() < large.abs() && whole.abs() == large.abs();
    vanishes(b, a).then_some((right, left)).or_else(|| vanishes(a, b).then_some((left, right)))
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let forms = Forms::new(shader);
    for (id, divisor) in divisions(shader) {
        let single = shader.type_of(divisor).scalar() == Some(ScalarType::Float);
        if !single || shader.expr(id).from_macro {
            continue;
        }
        let sum = forms.value(divisor);
        let beside = || swallowed(shader, sum).filter(|_| constant(shader, sum).is_none());
        let Some((small, reasons)) = beside()
            .map(|(small, large)| (small, vanishing(shader.text_of(small), shader.text_of(large))))
            .or_else(|| added(shader, sum).map(|(value, small, other)| (small, tiny(value, shader.text_of(other)))))
        else {
            continue;
        };
        let text = shader.text_of(small);
        let message =
            message!("adding `{text}` does not protect the division", "`{text}` を足しても除算は守られません");
        let [label, why, help] = reasons;
        let found = findings.at(&file.file, shader.expr(small).span, message);
        findings.push(found.with_label(label).with_why(why).with_help(help));
    }
}

/// Label, reason and help for a constant that another one swallows.
fn vanishing(text: &str, beside: &str) -> [Message; 3] {
    [
        message!("lost beside `{beside}`", "`{beside}` の横で失われる"),
        message!(
            "in binary32 the sum of both is `{beside}`: where the rest takes that away, the divisor is 0",
            "binary32 では両者の和は `{beside}` です。残りの項がそれを打ち消すところで除数は 0 になります"
        ),
        message!(
            "add it last, to the difference that may be 0: `({beside} - …) + {text}`",
            "0 になりうる差に、最後に足してください: `({beside} - …) + {text}`"
        ),
    ]
}

/// Label, reason and help for a constant that is too small beside anything.
fn tiny(value: f64, kept: &str) -> [Message; 3] {
    let limit = number(value * GREATEST);
    [
        message!("too small", "小さすぎる"),
        message!(
            "where `{kept}` is 0, a numerator above {limit} gives infinity; elsewhere the sum is rounded to `{kept}`",
            "`{kept}` が 0 のところでは分子が {limit} を超えると無限大になり、他では和が `{kept}` に丸められます"
        ),
        message!(
            "divide by `max({kept}, …)` with the least value that makes sense, or branch on 0",
            "意味のある最小値を使って `max({kept}, …)` で割るか、0 のときを分けてください"
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{rings, silent};
    use crate::Level;

    #[test]
    fn numbers_that_vanish_are_reported() {
        rings(
            "N037",
            Level::Default,
            &["r = s / (t + 1e-32);", "v = p / (1e-37 + length(q));", "float d = t + 1e-31; r = s / d;"],
        );
    }

    #[test]
    fn numbers_that_another_one_swallows_are_reported() {
        rings(
            "N037",
            Level::Default,
            &["r = s / (1e-10 + 1.0 - t);", "r = s / (1.0 + 1e-10 - t);", "v = p / (2.0 - 1e-9 - length(q));"],
        );
        silent(
            "N037",
            Level::Heuristic,
            &[
                "r = s / (1.0 - t + 1e-10);",
                "r = s / (1e-6 + 1.0 - t);",
                "r = s / (1.0 + 1e-10);",
                "r = s * (1e-10 + 1.0 - t);",
            ],
        );
    }

    #[test]
    fn numbers_that_help_are_not() {
        silent(
            "N037",
            Level::Heuristic,
            &["r = s / (t + 1e-6);", "r = s / max(t, 1e-32);", "r = s + 1e-32;", "r = s / (t * 1e-32);"],
        );
        let wgsl =
            |line: &str| crate::wgsl::testing::count("N037", &format!("fn f(a: f32, b: f32) -> f32 {{ {line} }}"));
        assert_eq!((wgsl("return a / (b + 1e-32);"), wgsl("return a / (b + 1e-9);")), (1, 0));
    }
}
