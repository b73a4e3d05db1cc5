//! T014: an assignment where a condition is tested.

use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::ast::{Condition, ExprId, ExprKind, StmtKind};

use super::walk::statements;
use crate::rule::{Check, Findings, Level, Pages, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T014"),
    name: "assignment-in-condition",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut conditions: Vec<ExprId> = Vec::new();
    statements(shader, |statement| match &statement.kind {
        StmtKind::If { condition, .. }
        | StmtKind::DoWhile { condition, .. }
        | StmtKind::While { condition: Condition::Expr(condition), .. }
        | StmtKind::For { condition: Some(Condition::Expr(condition)), .. } => conditions.push(*condition),
        _ => {}
    });
    conditions.extend(shader.arena().iter().filter_map(|(_, e)| match e.kind {
        ExprKind::Ternary { condition, .. } => Some(condition),
        _ => None,
    }));
    for condition in conditions {
        let expr = shader.expr(condition);
        let ExprKind::Assign { op: None, op_span, target: _, value: _ } = expr.kind else { continue };
        let mut found = findings
            .at(&file.file, expr.span, message!("the condition is an assignment", "条件式が代入になっています"))
            .with_label(message!("`=` and not `==`", "`==` ではなく `=`"))
            .with_why(message!(
                "the variable is overwritten, and the condition is the value that it gets",
                "変数が書き換えられ、代入した値が条件になります"
            ))
            .with_help(message!(
                "compare with `==`, or put the assignment into parentheses of its own",
                "`==` で比較するか、意図した代入なら括弧を重ねてください"
            ));
        if !expr.from_macro {
            let edit = Edit::replace(op_span, "==");
            found = found.with_fix(message!("write `==`", "`==` と書く"), Safety::Unsafe, vec![edit]);
        }
        findings.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn assignments_in_conditions_are_reported() {
        let reported = |body: &str| {
            let text = format!(
                "#version 150 core\nuniform bool u;\nout vec4 c;\nvoid main(void)\n{{\n  bool b = u; c = vec4(0.0);\n  {body}\n}}\n"
            );
            messages("T014", "a.frag", &text).len()
        };
        for body in ["if (b = true) c = vec4(1.0);", "while (b = u) break;", "for (; b = u; ) break;"] {
            assert_eq!(reported(body), 1, "{body}");
        }
        for body in [
            "if (b == true) c = vec4(1.0);",
            "while ((b = u)) break;",
            "c.x = (b = u) ? 1.0 : 0.0;",
            "b = u; if (b) c = vec4(1.0);",
        ] {
            assert_eq!(reported(body), 0, "{body}");
        }
    }
}
