//! D017: a function or structure that nothing uses.

use base::diagnostic::{Code, Severity, message};
use base::text::Span;
use reading::ShaderFile;
use syntax::ast::{ItemKind, TypeKind};
use syntax::symbols::CallTarget;
use syntax::{Stage, TokenKind};

use super::unused_variable::hidden_words;
use crate::rule::{Check, Findings, Level, Pages, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D017"),
    name: "unused-function",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let flow = file.flow();
    let (Some(reached), false) = (&flow.reached, shader.stage() == Stage::Library) else { return };
    let hidden = hidden_words(file);
    let mut unused: Vec<(Span, String, [&str; 2])> = Vec::new();
    for (id, function) in shader.functions().filter(|(id, f)| f.definition.is_some() && !reached.contains(id)) {
        // Of functions that call each other, the one that nothing calls is told.
        let called = shader.arena().iter().any(|(e, _)| shader.callee(e) == Some(&CallTarget::User(id)));
        if !called {
            unused.push((function.name.span, function.name.name.clone(), ["function", "関数"]));
        }
    }
    for (span, name) in structures(file) {
        let words = shader.tokens().iter().filter(|t| t.kind == TokenKind::Word);
        if words.filter(|t| file.file.slice(t.span) == name).count() == 1 {
            unused.push((span, name, ["structure", "構造体"]));
        }
    }
    for (span, name, [en, ja]) in unused {
        // A name that a macro wrote is no name of this text.
        if hidden.contains(name.as_str()) || file.file.slice(span) != name {
            continue;
        }
        findings.push(
            findings
                .at(&file.file, span, message!("{en} `{name}` is not used", "{ja} `{name}` は使われていません"))
                .with_label(message!("never used", "未使用"))
                .with_why(message!(
                    "it may be left over, or a use of it is missing",
                    "不要になったか、使い忘れているものです"
                ))
                .with_help(message!("use `{name}`, or remove it", "`{name}` を使うか、削除してください")),
        );
    }
}

/// Names and places of the structures at file scope.
fn structures(file: &ShaderFile) -> Vec<(Span, String)> {
    let items = file.shader.unit().items.iter();
    let declared = items.filter_map(|item| match &item.kind {
        ItemKind::Declaration(d) if d.declarators.is_empty() => Some(&d.ty),
        _ => None,
    });
    let named = declared.filter_map(|ty| match &ty.kind {
        TypeKind::Struct(s) => s.name.as_ref(),
        TypeKind::Named(_) => None,
    });
    named.map(|n| (n.span, n.name.clone())).collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn reported(outer: &str, body: &str) -> Vec<String> {
        let text =
            format!("#version 150 core\nout vec4 c;\n{outer}\nvoid main(void)\n{{\n  c = vec4(0.0);\n  {body}\n}}\n");
        messages("D017", "a.frag", &text)
    }

    #[test]
    fn what_nothing_calls_or_names_is_reported() {
        assert_eq!(reported("void f() { } void g() { f(); }", ""), ["function `g` is not used"]);
        assert_eq!(reported("struct S { float a; };", ""), ["structure `S` is not used"]);
    }

    #[test]
    fn what_something_uses_is_not() {
        for (outer, body) in [
            ("void f() { }", "f();"),
            ("struct S { float a; };", "S s = S(1.0); c.x = s.a;"),
            ("#ifdef A\nvoid g() { f(); }\n#endif\nvoid f() { }", ""),
            ("void f() { }\n#define CALL f()", "CALL;"),
        ] {
            assert_eq!(reported(outer, body), [""; 0], "{outer} {body}");
        }
        assert!(messages("D017", "a.glsl", "void f() { }\n").is_empty());
    }
}
