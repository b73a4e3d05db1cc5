//! D011: a declaration that hides another one.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use base::text::Span;
use reading::ShaderFile;
use syntax::ast::{Block, Condition, Declaration, Function, ItemKind, Stmt, StmtKind};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D011"),
    name: "shadowed-variable",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    if !file.is_sound() {
        return;
    }
    let globals: Vec<(&str, Span)> =
        file.shader.interface().variables().map(|v| (v.name.as_str(), v.name_span)).collect();
    for item in &file.shader.unit().items {
        let ItemKind::Function(function) = &item.kind else { continue };
        let Some(body) = &function.body else { continue };
        let mut scopes = Scopes { names: globals.clone(), found: Vec::new() };
        scopes.function(function, body);
        for (span, outer) in scopes.found {
            let name = file.file.slice(span);
            findings.push(
                findings
                    .at(
                        &file.file,
                        span,
                        message!("`{name}` hides an outer `{name}`", "`{name}` が外側の `{name}` を隠しています"),
                    )
                    .with_label(message!("another variable from here on", "ここから先は別の変数"))
                    .with_related(&file.file, outer, message!("the outer one", "外側の変数"))
                    .with_why(message!(
                        "what is written to the name in here does not reach the outer variable",
                        "この中での書き込みは外側の変数に届きません"
                    ))
                    .with_help(message!(
                        "choose another name, or use the outer variable",
                        "別の名前にするか、外側の変数を使ってください"
                    )),
            );
        }
    }
}

/// Names in scope, the innermost last.
struct Scopes<'s> {
    names: Vec<(&'s str, Span)>,
    found: Vec<(Span, Span)>,
}

impl<'s> Scopes<'s> {
    fn function(&mut self, function: &'s Function, body: &'s Block) {
        self.names.extend(function.params.iter().filter_map(|p| p.name.as_ref()).map(|n| (n.name.as_str(), n.span)));
        self.list(&body.statements);
    }

    fn list(&mut self, statements: &'s [Stmt]) {
        let outer = self.names.len();
        statements.iter().for_each(|s| self.statement(s));
        self.names.truncate(outer);
    }

    fn declaration(&mut self, declaration: &'s Declaration) {
        for name in declaration.declarators.iter().map(|d| &d.name) {
            let outer = self.names.iter().rev().find(|(n, _)| *n == name.name);
            if let Some((_, outer)) = outer.filter(|(_, s)| *s != name.span) {
                self.found.push((name.span, *outer));
            }
            self.names.push((&name.name, name.span));
        }
    }

    fn inside(&mut self, statement: &'s Stmt) {
        self.list(std::slice::from_ref(statement));
    }

    fn statement(&mut self, statement: &'s Stmt) {
        match &statement.kind {
            StmtKind::Declaration(declaration) => self.declaration(declaration),
            StmtKind::Block(block) | StmtKind::Switch { selector: _, body: block } => self.list(&block.statements),
            StmtKind::If { condition: _, then, otherwise } => {
                self.inside(then);
                otherwise.iter().for_each(|o| self.inside(o));
            }
            StmtKind::For { init, condition, step: _, body, head_span: _ } => {
                let outer = self.names.len();
                self.statement(init);
                if let Some(Condition::Declaration(declaration)) = condition {
                    self.declaration(declaration);
                }
                self.inside(body);
                self.names.truncate(outer);
            }
            StmtKind::While { condition: _, body } | StmtKind::DoWhile { body, condition: _ } => self.inside(body),
            StmtKind::Empty
            | StmtKind::Precision(_)
            | StmtKind::Qualified(_)
            | StmtKind::Expr(_)
            | StmtKind::Case(_)
            | StmtKind::Default
            | StmtKind::Return(_)
            | StmtKind::Break
            | StmtKind::Continue
            | StmtKind::Discard
            | StmtKind::Error => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn names_of_outer_scopes_are_reported() {
        let reported = |function: &str| {
            let text = format!(
                "#version 150 core\nuniform float u;\n{function}\nvoid main(void) {{ gl_Position = vec4(u); }}\n"
            );
            messages("D011", "a.vert", &text).len()
        };
        for function in [
            "float f() { float u = 1.0; return u; }",
            "float f(float x) { { float x = 2.0; return x; } }",
            "void f() { for (int i = 0; i < 3; ++i) for (int i = 0; i < 2; ++i) ; }",
            "float f() { float x = 1.0; if (x > 0.0) { float x = 2.0; return x; } return x; }",
        ] {
            assert_eq!(reported(function), 1, "{function}");
        }
        for function in [
            "void f() { for (int i = 0; i < 3; ++i) ; for (int i = 0; i < 2; ++i) ; }",
            "float f() { { float x = 2.0; } float x = 1.0; return x; }",
            "float f(float x) { return x; } float g(float x) { return x; }",
            "float f() { float main = 1.0; return main; }",
        ] {
            assert_eq!(reported(function), 0, "{function}");
        }
    }
}
