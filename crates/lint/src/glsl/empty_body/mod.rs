//! T015: a `;` right behind `if` or the head of a loop.

use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};
use reading::ShaderFile;
use syntax::ast::{ItemKind, Stmt, StmtKind};

use super::walk::statements;
use crate::rule::{Check, Findings, Level, Pages, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T015"),
    name: "empty-body",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut empty: Vec<(Span, bool)> = Vec::new();
    let mut look = |list: &[Stmt]| {
        for (index, statement) in list.iter().enumerate() {
            let block = list.get(index + 1).is_some_and(|next| matches!(next.kind, StmtKind::Block(_)));
            let is_loop = matches!(statement.kind, StmtKind::For { .. } | StmtKind::While { .. });
            if let Some(span) = empty_body(statement).filter(|_| block || !is_loop) {
                empty.push((span, index + 1 < list.len()));
            }
        }
    };
    for item in &shader.unit().items {
        if let ItemKind::Function(function) = &item.kind {
            function.body.iter().for_each(|b| look(&b.statements));
        }
    }
    statements(shader, |statement| match &statement.kind {
        StmtKind::Block(block) | StmtKind::Switch { selector: _, body: block } => look(&block.statements),
        _ => {}
    });
    for (span, followed) in empty {
        // A macro that stands for nothing may have been the body.
        if file.file.slice(span) != ";" {
            continue;
        }
        let mut found = findings
            .at(&file.file, span, message!("the body is empty", "本体が空です"))
            .with_label(message!("the whole body", "これが本体のすべて"))
            .with_why(message!(
                "what stands behind the `;` does not belong to the condition",
                "`;` の後ろの文は条件とは関係なく実行されます"
            ))
            .with_help(message!(
                "remove the `;`, or write the body as `{{}}`",
                "`;` を削除するか、本体を `{{}}` と書いてください"
            ));
        if followed {
            found =
                found.with_fix(message!("remove the `;`", "`;` を削除する"), Safety::Unsafe, vec![Edit::delete(span)]);
        }
        findings.push(found);
    }
}

/// The `;` that is the body of an `if` without `else`, or of a loop.
fn empty_body(statement: &Stmt) -> Option<Span> {
    let body = match &statement.kind {
        StmtKind::If { condition: _, then, otherwise: None } => then,
        StmtKind::If { condition: _, then: _, otherwise: Some(otherwise) } => otherwise,
        StmtKind::For { body, .. } | StmtKind::While { body, .. } => body,
        _ => return None,
    };
    (body.kind == StmtKind::Empty).then_some(body.span)
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn empty_bodies_are_reported() {
        let reported = |body: &str| {
            let text = format!(
                "#version 150 core\nuniform int n;\nout vec4 c;\nvoid main(void)\n{{\n  int i = 0; c = vec4(0.0);\n  {body}\n}}\n"
            );
            messages("T015", "a.frag", &text).len()
        };
        for body in [
            "if (n > 0); { c = vec4(1.0); }",
            "if (n > 0); c = vec4(1.0);",
            "if (n > 0) c = vec4(1.0); else; c = vec4(0.5);",
            "for (i = 0; i < n; ++i); { c = vec4(1.0); }",
            "while (++i < n); { c = vec4(1.0); }",
        ] {
            assert_eq!(reported(body), 1, "{body}");
        }
        for body in [
            "if (n > 0) { c = vec4(1.0); }",
            "while (++i < n);",
            "for (i = 0; i < n; ++i); c = vec4(float(i));",
            "if (n > 0) {} c = vec4(1.0);",
            ";",
            "do ; while (++i < n);",
        ] {
            assert_eq!(reported(body), 0, "{body}");
        }
    }
}
