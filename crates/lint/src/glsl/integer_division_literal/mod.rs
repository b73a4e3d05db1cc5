//! T005: a division of integer literals whose fraction is lost.

use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::Const;
use syntax::ast::{BinaryOp, ExprKind, Literal};

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::context::Contexts;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T005"),
    name: "integer-division-literal",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !file.is_sound() {
        return;
    }
    let contexts = Contexts::new(shader);
    for (id, expr) in shader.arena().iter() {
        let ExprKind::Binary { op: BinaryOp::Div, op_span: _, left, right } = expr.kind else { continue };
        let value = |id| shader.fold(id).and_then(Const::as_integer);
        let (Some(a), Some(b)) = (value(left), value(right)) else { continue };
        if b == 0 || a % b == 0 || !contexts.becomes_float(id) {
            continue;
        }
        let (text, quotient) = (shader.text_of(id), a / b);
        let mut found = findings
            .at(
                &file.file,
                expr.span,
                message!(
                    "`{text}` is {quotient}: the fraction is lost",
                    "`{text}` は {quotient} で、小数部が失われます"
                ),
            )
            .with_label(message!("divides integers", "整数の除算"))
            .with_why(message!(
                "both operands are integers, and the quotient is made a float only afterwards",
                "両辺とも整数なので、商を求めた後で浮動小数点数になります"
            ))
            .with_help(message!("divide floats", "浮動小数点数で割ってください"));
        let literal = |id| {
            let expr = shader.expr(id);
            let decimal = shader.text_of(id).bytes().all(|b| b.is_ascii_digit());
            (matches!(expr.kind, ExprKind::Literal(Literal::Int(_))) && !expr.from_macro && decimal)
                .then_some(expr.span)
        };
        if let (Some(left), Some(right), false) = (literal(left), literal(right), expr.from_macro) {
            let edits = vec![Edit::insert(left.end, ".0"), Edit::insert(right.end, ".0")];
            found = found.with_fix(
                message!("write the literals as floats", "リテラルに `.0` を付ける"),
                Safety::Unsafe,
                edits,
            );
        }
        findings.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn reported(statement: &str) -> usize {
        let text = format!(
            "#version 150 core\nuniform int n;\nconst int k = 3;\nout vec4 c;\nfloat f(float x) {{ return x; }}\nvoid main(void)\n{{\n  float x = 1.0; int i = 0; c = vec4(0.0);\n  {statement}\n}}\n"
        );
        messages("T005", "a.frag", &text).len()
    }

    #[test]
    fn lost_fractions_are_reported() {
        for statement in [
            "x = 1/2;",
            "x *= (1 / k);",
            "x = -(3 / 2) * x;",
            "x = 2 * (1 / 3) + x;",
            "c = vec4(1/2);",
            "c.x = f(1/2);",
            "c.x = pow(x, 1/2);",
            "c.x = float(5 / 2);",
            "c.x = n > 0 ? 1/2 : x;",
        ] {
            assert_eq!(reported(statement), 1, "{statement}");
        }
    }

    #[test]
    fn integers_and_exact_quotients_are_not() {
        for statement in [
            "i = 1/2;",
            "x = 4/2;",
            "x = 1.0/2;",
            "i = 7 / k * 2;",
            "x = float(n / 2);",
            "c[1/2] = x;",
            "if (n > 7 / 2) x = 1.0;",
        ] {
            assert_eq!(reported(statement), 0, "{statement}");
        }
    }
}
