//! D008: a function that returns a value can end without one.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::ast::{Condition, Stmt, StmtKind};
use syntax::is_macro;
use syntax::symbols::FunctionInfo;
use syntax::types::Type;
use syntax::{Shader, Token, TokenKind, TokenPlace};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D008"),
    name: "missing-return",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let known = file.flow();
    // Where names are missing, statements alone tell.
    let by_statements = || {
        let functions = file.shader.functions();
        functions.filter(|(_, info)| !file.is_sound() && can_end(file, info)).map(|(id, _)| id).collect::<Vec<_>>()
    };
    let unknown = if known.falls_off.is_empty() { by_statements() } else { Vec::new() };
    for &function in known.falls_off.iter().chain(&unknown) {
        let info = file.shader.function_info(function);
        let (name, ty) = (&info.name.name, &info.return_type);
        let body = file.shader.function_syntax(info).and_then(|f| f.body.as_ref());
        let found = findings
            .at(
                &file.file,
                info.name.span,
                message!(
                    "`{name}` can end without returning a `{ty}`",
                    "`{name}` は `{ty}` を返さずに終わることがあります"
                ),
            )
            .with_label(message!("returns a `{ty}`", "`{ty}` を返す関数"))
            .with_why(message!(
                "a path reaches the end of the body without `return`, and the result is undefined there",
                "`return` なしで本体の終わりに至る経路があり、その場合の戻り値は未定義です"
            ))
            .with_help(message!("return a value at the end", "最後に値を返してください"));
        findings.push(match body {
            Some(body) => {
                let end = base::text::Span::new(body.span.end.saturating_sub(1), body.span.end);
                found.with_related(&file.file, end, message!("reached without `return`", "`return` なしでここに来る"))
            }
            None => found,
        });
    }
}

/// True when the statements of a function that gives a value let it end without one, whatever their names mean.
fn can_end(file: &ShaderFile, info: &FunctionInfo) -> bool {
    let shader = &file.shader;
    let Some(body) = shader.function_syntax(info).and_then(|f| f.body.as_ref()) else { return false };
    if info.return_type == Type::Void || !has_return(&body.statements) || !ends(shader, &body.statements) {
        return false;
    }
    // Another branch of an `#if`, or a macro that is not seen, may return.
    let inside = |t: &&Token| body.span.contains(t.span.start);
    let hides =
        |t: &Token| t.place != TokenPlace::Text || (t.kind == TokenKind::Word && is_macro(file.file.slice(t.span)));
    !shader.tokens().iter().filter(inside).any(hides)
}

/// True when there is a `return` with a value: a body without any is an error of its own.
fn has_return(statements: &[Stmt]) -> bool {
    statements.iter().any(|s| match &s.kind {
        StmtKind::Return(value) => value.is_some(),
        StmtKind::Block(block) | StmtKind::Switch { body: block, .. } => has_return(&block.statements),
        StmtKind::If { then, otherwise, .. } => {
            let otherwise = otherwise.as_deref().into_iter();
            std::iter::once(then.as_ref()).chain(otherwise).any(|s| has_return(std::slice::from_ref(s)))
        }
        StmtKind::For { body, .. } | StmtKind::While { body, .. } | StmtKind::DoWhile { body, .. } => {
            has_return(std::slice::from_ref(body))
        }
        _ => false,
    })
}

/// True when the end of some statements can be reached.
fn ends(shader: &Shader, statements: &[Stmt]) -> bool {
    let runs_on = |condition: Option<&Condition>| match condition {
        None => true,
        Some(Condition::Expr(id)) => shader.fold(*id).is_some(),
        Some(Condition::Declaration(_)) => false,
    };
    statements.iter().all(|s| match &s.kind {
        StmtKind::Return(_) | StmtKind::Discard | StmtKind::Break | StmtKind::Continue | StmtKind::Error => false,
        StmtKind::Block(block) => ends(shader, &block.statements),
        StmtKind::If { then, otherwise: Some(otherwise), .. } => {
            ends(shader, std::slice::from_ref(then)) || ends(shader, std::slice::from_ref(otherwise))
        }
        StmtKind::For { condition, .. } => !runs_on(condition.as_ref()),
        StmtKind::While { condition, .. } => !runs_on(Some(condition)),
        StmtKind::DoWhile { .. } | StmtKind::Switch { .. } => false,
        _ => true,
    })
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn reported(body: &str) -> usize {
        let text = format!(
            "#version 150 core\nuniform int n;\nout vec4 c;\nfloat f(float x)\n{{\n  {body}\n}}\nvoid main(void)\n{{\n  c = vec4(f(1.0));\n}}\n"
        );
        messages("D008", "a.frag", &text).len()
    }

    #[test]
    fn a_path_without_return_is_reported() {
        for body in [
            "if (x > 0.0) return 1.0;",
            "for (int i = 0; i < n; ++i) if (x > 0.0) return x;",
            "if (x > 2.0) return x; while (true) { if (x > 0.0) break; }",
        ] {
            assert_eq!(reported(body), 1, "{body}");
        }
    }

    #[test]
    fn statements_tell_where_names_are_missing() {
        let reported = |body: &str| {
            let text = format!(
                "#version 150 core\n#include <layers>\nfloat f(int x)\n{{\n{body}\n}}\nvoid main(void) {{ shade(f(1)); }}\n"
            );
            messages("D008", "a.frag", &text).len()
        };
        assert_eq!(reported("for (int i = 0; i < 8; ++i) if (i == x) return layers[i];"), 1);
        assert_eq!(reported("for (int i = 0; i < 8; ++i) if (i == x) return layers[i];\nreturn 0.0;"), 0);
        assert_eq!(reported("if (x > 1) { return layers[0]; } else { return layers[1]; }"), 0);
        assert_eq!(reported("if (x > 1) return layers[0];\nRETURN_LAYER(1);"), 0, "a macro may return");
        assert_eq!(reported("if (x > 1) return layers[0];\n#ifdef ONE\nreturn layers[1];\n#endif"), 0);
    }

    #[test]
    fn paths_that_return_or_end_are_not() {
        for body in [
            "return x;",
            "if (x > 0.0) return 1.0; else return 0.0;",
            "if (x > 0.0) return 1.0; discard;",
            "while (true) { if (x > 0.0) return 1.0; x += 1.0; }",
            "for (;;) { return x; }",
            "switch (n) { case 0: return 1.0; default: return 2.0; }",
            "switch (n) { case 0: return 1.0; case 1: return 2.0; }",
            "if (n == 0) return 1.0; else if (n == 1) return 2.0;",
            "do { return x; } while (false);",
        ] {
            assert_eq!(reported(body), 0, "{body}");
        }
    }

    #[test]
    fn libraries_are_judged_too() {
        assert_eq!(messages("D008", "a.glsl", "float f(float x) { if (x > 0.0) return x; }\n").len(), 1);
    }
}
