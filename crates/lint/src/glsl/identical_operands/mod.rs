//! T030: two operands that are one expression.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::key;
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};

use analysis::forms::builtin;
use analysis::numeric::bare;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T030"),
    name: "identical-operands",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// The two operands of something that makes no sense with equal ones.
fn operands(shader: &Shader, id: ExprId) -> Option<(ExprId, ExprId)> {
    match &shader.expr(id).kind {
        ExprKind::Binary { op, op_span: _, left, right } => {
            let floats = shader.type_of(*left).scalar().is_none_or(|s| s.is_floating());
            let pointless = match op {
                BinaryOp::Equal | BinaryOp::NotEqual => !floats,
                BinaryOp::Sub
                | BinaryOp::Div
                | BinaryOp::Less
                | BinaryOp::Greater
                | BinaryOp::LessEqual
                | BinaryOp::GreaterEqual
                | BinaryOp::And
                | BinaryOp::Or => true,
                _ => false,
            };
            pointless.then_some((*left, *right))
        }
        ExprKind::Ternary { condition: _, yes, no } => Some((*yes, *no)),
        _ => match builtin(shader, id, &["min", "max"])?.1 {
            [a, b] => Some((*a, *b)),
            _ => None,
        },
    }
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for (id, expr) in shader.arena().iter() {
        let parenthesis = matches!(expr.kind, ExprKind::Paren(_));
        let Some((a, b)) = operands(shader, id).filter(|_| !parenthesis && !expr.from_macro) else { continue };
        // Constants have names and values of their own, and a macro may give one text for two names.
        let (a, b) = (bare(shader, a), bare(shader, b));
        let plain = [a, b].iter().all(|e| shader.fold(*e).is_none() && !shader.expr(*e).from_macro);
        if !plain || shader.text_of(a) != shader.text_of(b) || key(shader, a).is_none_or(|k| Some(k) != key(shader, b))
        {
            continue;
        }
        let text = shader.text_of(a);
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(b).span,
                    message!("both operands are `{text}`", "両方のオペランドが `{text}` です"),
                )
                .with_label(message!("the same once more", "同じ式"))
                .with_related(&file.file, shader.expr(a).span, message!("the other one", "もう一方"))
                .with_why(message!("the result does not depend on the operation", "結果は演算によりません"))
                .with_help(message!("write the operand that is meant", "意図したオペランドを書いてください")),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{rings, silent};
    use crate::Level;

    #[test]
    fn one_expression_twice_is_reported() {
        rings(
            "T030",
            Level::Default,
            &["r = min(p.x, p.x);", "r = p.x - (p.x);", "if (s < t || s < t) r = 1.0;", "r = s > 0.0 ? t : t;"],
        );
    }

    #[test]
    fn others_are_not() {
        silent(
            "T030",
            Level::Heuristic,
            &["r = min(p.x, p.y);", "r = s * s + s + s;", "if (s != s) r = 1.0;", "r = s > 0.0 ? 1.0 : 1.0;"],
        );
    }
}
