//! D010: an assignment without effect, or a statement that nothing reaches.

use crate::project::ShaderFile;
use base::diagnostic::{Code, Severity, message};
use base::text::Span;
use syntax::ast::{ItemKind, Stmt, StmtKind};
use syntax::symbols::SymbolKind;

use super::variable::part;
use super::walk::statements;
use crate::rule::{Check, Findings, Level, Pages, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D010"),
    name: "dead-store",
    severity: Severity::Info,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for dead in &file.flow().dead {
        let symbol = shader.symbol(dead.symbol);
        let read = shader.uses_of(dead.symbol).any(|u| u.access.reads());
        let inside = matches!(symbol.kind, SymbolKind::Local | SymbolKind::Param(_));
        if (inside && !read) || shader.expr(dead.expr).from_macro {
            continue;
        }
        let name = part(shader, dead.symbol, u64::MAX);
        findings.push(
            findings
                .at(
                    &file.file,
                    dead.span,
                    message!("the value assigned to `{name}` is never used", "`{name}` に代入した値が使われていません"),
                )
                .with_label(message!("no effect", "効果がない"))
                .with_why(message!(
                    "on every path the value is overwritten or dropped before it is read",
                    "どの経路でも、読まれる前に上書きされるか捨てられます"
                ))
                .with_help(message!("remove the assignment, or use its value", "代入を削除するか、値を使ってください")),
        );
    }
    if !file.is_sound() {
        return;
    }
    let mut unreached: Vec<Span> = Vec::new();
    for item in &shader.unit().items {
        if let ItemKind::Function(function) = &item.kind {
            unreached.extend(function.body.as_ref().and_then(|b| behind_jump(&b.statements)));
        }
    }
    statements(shader, |statement| match &statement.kind {
        StmtKind::Block(block) | StmtKind::Switch { selector: _, body: block } => {
            unreached.extend(behind_jump(&block.statements));
        }
        _ => {}
    });
    for span in unreached {
        findings.push(
            findings
                .at(&file.file, span, message!("this statement is never reached", "この文は実行されることがありません"))
                .with_label(message!("unreachable", "到達しない"))
                .with_why(message!(
                    "the statement before it goes elsewhere on every path",
                    "直前の文で必ず別の場所に移ります"
                ))
                .with_help(message!(
                    "remove it, or make the jump before it conditional",
                    "削除するか、前のジャンプを条件付きにしてください"
                )),
        );
    }
}

/// The first statement behind a jump of the same block. A `break` there only closes a `case`.
fn behind_jump(list: &[Stmt]) -> Option<Span> {
    let jump =
        |s: &Stmt| matches!(s.kind, StmtKind::Return(_) | StmtKind::Break | StmtKind::Continue | StmtKind::Discard);
    let at = list.iter().position(jump)?;
    let idle = |s: &&Stmt| {
        matches!(s.kind, StmtKind::Break | StmtKind::Return(None) | StmtKind::Empty | StmtKind::Declaration(_))
    };
    let next = list[at + 1..].iter().find(|s| !idle(s))?;
    match next.kind {
        StmtKind::Case(_) | StmtKind::Default => behind_jump(&list[at + 2..]),
        _ => Some(next.span),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn reported(body: &str) -> usize {
        let text = format!(
            "#version 150 core\nuniform int n;\nin vec4 q;\nout vec4 c;\nvoid set(out float a) {{ a = 1.0; }}\nvoid add(inout float a) {{ a += 1.0; }}\nvoid main(void)\n{{\n  float x = q.x;\n  {body}\n}}\n"
        );
        messages("D010", "a.frag", &text).len()
    }

    #[test]
    fn what_has_no_effect_is_reported() {
        for body in [
            "x = 1.0; x = 2.0; c = q * x;",
            "c = q; c = -q * x;",
            "c = q * x; x = 1.0;",
            "c = q * x; x += 1.0;",
            "c = q * x; return; c = -q;",
            "for (int i = 0; i < n; ++i) { break; c = q * x; }",
            "vec2 v; v.x = 1.0; v.y = x; v.x = 2.0; c = v.xyxy;",
            "x = 1.0; set(x); c = q * x;",
            "switch (n) { case 0: c = q; break; c = q * x; }",
        ] {
            assert_eq!(reported(body), 1, "{body}");
        }
    }

    #[test]
    fn what_has_an_effect_is_not() {
        for body in [
            "x = 1.0; if (n > 0) x = 2.0; c = q * x;",
            "c = q * x;",
            "float y = 0.0; y = x; c = q * y;",
            "c = q; if (n > 0) c = -q * x;",
            "for (int i = 0; i < n; ++i) { c = q * x; x += 1.0; }",
            "c.x = x; c.yzw = q.yzw;",
            "add(x); c = q * x;",
            "float f[2]; f[0] = x; f[1] = 1.0; c = q * f[n];",
            "switch (n) { case 0: c = q; break; case 1: c = q * x; break; default: c = -q; return; }",
            "if (n > 0) { c = q * x; return; } c = -q;",
            "c = q * x; if (n > 0) discard;",
            "vec4 v = q; v[n] = x; c = v;",
        ] {
            assert_eq!(reported(body), 0, "{body}");
        }
    }
}
