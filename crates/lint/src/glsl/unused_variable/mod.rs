//! D006: a local variable that nothing uses.

use std::collections::BTreeSet;

use base::diagnostic::{Code, Severity, message};
use base::text::Span;
use reading::ShaderFile;
use syntax::ast::StmtKind;
use syntax::symbols::{Access, SymbolKind};
use syntax::{Token, TokenKind, TokenPlace};

use super::walk::statements;
use crate::rule::{Check, Findings, Level, Pages, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D006"),
    name: "unused-variable",
    severity: Severity::Info,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !file.shows_all_uses() {
        return;
    }
    let hidden = hidden_words(file);
    let mut unused: Vec<(Span, &str, bool)> = Vec::new();
    for (id, symbol) in shader.symbols().filter(|(_, s)| s.kind == SymbolKind::Local) {
        let Some(span) = symbol.span else { continue };
        let read = shader.uses_of(id).any(|u| u.access == Access::Read || is_needed(file, u.expr));
        if !read {
            let written = shader.is_written(id);
            unused.push((span, &symbol.name, written));
        }
    }
    for (span, name, written) in unused {
        // As in Rust, a variable of WGSL that begins with an underscore is not to be used.
        if file.is_wgsl() && name.starts_with('_') {
            continue;
        }
        // A name that a macro wrote is no name of this text.
        if hidden.contains(name) || file.file.slice(span) != name {
            continue;
        }
        let message = if written {
            message!(
                "variable `{name}` is written and never read",
                "変数 `{name}` は書き込まれるだけで、読まれていません"
            )
        } else {
            message!("variable `{name}` is not used", "変数 `{name}` は使われていません")
        };
        findings.push(
            findings
                .at(&file.file, span, message)
                .with_label(message!("never used", "未使用"))
                .with_why(message!(
                    "a similar name may be meant somewhere, or it is left over",
                    "どこかで似た名前と取り違えているか、不要になったものです"
                ))
                .with_help(message!("use `{name}`, or remove it", "`{name}` を使うか、削除してください")),
        );
    }
}

/// Words in text that an `#if` leaves out, and in directives.
pub(super) fn hidden_words(file: &ShaderFile) -> BTreeSet<&str> {
    let tokens = file.shader.tokens().iter();
    let hidden = tokens.filter(|t| t.kind == TokenKind::Word && t.place != TokenPlace::Text);
    let hidden = hidden.map(|t| file.file.slice(t.span));
    let Some(author) = file.author.as_ref().filter(|_| file.is_wgsl()) else { return hidden.collect() };
    // Where a text is joined with its imports, what conditions leave out stands in the author's text alone.
    let seen =
        |t: &Token| file.file.copied(t.span).filter(|(own, _)| own.name() == author.name()).map(|(_, s)| s.start);
    let seen: BTreeSet<usize> = file.shader.tokens().iter().filter_map(seen).collect();
    let all = syntax::wgsl::tokens(author.text()).into_iter().filter(|t| t.kind == TokenKind::Word);
    hidden.chain(all.filter(|t| !seen.contains(&t.span.start)).map(|t| author.slice(t.span))).collect()
}

/// True when a name is not just what a statement of its own assigns to, increments or decrements.
fn is_needed(file: &ShaderFile, name: syntax::ast::ExprId) -> bool {
    let shader = &file.shader;
    let span = shader.expr(name).span;
    let mut alone = false;
    let mut look = |id| {
        use syntax::ast::ExprKind;
        let target = match shader.expr(id).kind {
            ExprKind::Assign { target, .. } => target,
            ExprKind::Postfix { operand, .. } | ExprKind::Unary { operand, .. } => operand,
            _ => return,
        };
        alone |= shader.expr(target).span.contains(span.start);
    };
    statements(shader, |statement| match &statement.kind {
        StmtKind::Expr(e) | StmtKind::For { step: Some(e), .. } => look(*e),
        _ => {}
    });
    !alone
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn reported(outer: &str, body: &str) -> Vec<String> {
        let text = format!(
            "#version 150 core\nuniform int n;\nout vec4 c;\n{outer}\nvoid main(void)\n{{\n  c = vec4(0.0);\n  {body}\n}}\n"
        );
        messages("D006", "a.frag", &text)
    }

    #[test]
    fn what_nothing_uses_is_reported() {
        assert_eq!(reported("", "float x = 1.0;"), ["variable `x` is not used"]);
        assert_eq!(reported("", "float x = 1.0; x = 2.0;"), ["variable `x` is written and never read"]);
        assert_eq!(reported("", "float x = 1.0; x += 2.0;"), ["variable `x` is written and never read"]);
    }

    #[test]
    fn what_something_uses_is_not() {
        for (outer, body) in [
            ("", "float x = 1.0; c.x = x;"),
            ("", "int i = 0; c.x = float(i++);"),
            ("", "bool b; if (b = n > 0) c.x = 1.0;"),
            ("void f(out float x) { x = 1.0; }", "float x; f(x);"),
            ("", "for (int i = 0; i < n; ++i) c.x += 1.0;"),
            ("", "vec3 v; v.x = 1.0; c.y = v.x;"),
            ("void f() { }", "f();"),
            ("struct S { float a; };", "S s = S(1.0); c.x = s.a;"),
            ("void f(float x) { }", "f(1.0);"),
            ("#define USE x", "float x = 1.0; c.x = USE;"),
            ("#ifdef A\nfloat f(float x) { return x; }\n#endif", "float x = 1.0;"),
        ] {
            assert_eq!(reported(outer, body), [""; 0], "{outer} {body}");
        }
        assert!(messages("D006", "a.glsl", "void f() { }\n").is_empty());
    }
}
