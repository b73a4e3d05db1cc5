//! D010: an assignment without effect, or a statement that nothing reaches.

use analysis::range::key;
use base::diagnostic::{Code, Severity, message};
use base::text::Span;
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{ExprId, ExprKind, ItemKind, Stmt, StmtKind};
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, SymbolId, SymbolKind};
use syntax::types::Type;

use super::variable::part;
use super::walk::{expressions, statements};
use crate::rule::{Check, Findings, Level, Pages, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D010"),
    name: "dead-store",
    severity: Severity::Info,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
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
        let mut found = findings
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
            .with_help(message!("remove the assignment, or use its value", "代入を削除するか、値を使ってください"));
        // What was worked out for an output was to be seen.
        if symbol.kind == SymbolKind::Global(Storage::Out) && is_lost_at_once(shader, dead.symbol, dead.expr) {
            found.severity = Severity::Warning;
        }
        findings.push(found);
    }
    if !file.is_sound() {
        return;
    }
    for (first, second) in overwritten(shader) {
        let text = shader.text_of(first);
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(first).span,
                    message!("`{text}` is overwritten by the next statement", "`{text}` は次の文で上書きされます"),
                )
                .with_label(message!("no effect", "効果がない"))
                .with_related(&file.file, shader.expr(second).span, message!("written again", "再び書き込まれる"))
                .with_why(message!("nothing reads the value in between", "間に値を読むものがありません"))
                .with_help(message!("remove one of the two", "どちらかを削除してください")),
        );
    }
    let wgsl = file.is_wgsl();
    let mut unreached: Vec<Span> = Vec::new();
    for item in &shader.unit().items {
        if let ItemKind::Function(function) = &item.kind {
            unreached.extend(function.body.as_ref().and_then(|b| behind_jump(&b.statements, wgsl)));
        }
    }
    statements(shader, |statement| match &statement.kind {
        StmtKind::Block(block) | StmtKind::Switch { selector: _, body: block } => {
            unreached.extend(behind_jump(&block.statements, wgsl));
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

/// True for an assignment of something that is worked out, where the next statement assigns the same variable as a whole.
fn is_lost_at_once(shader: &Shader, symbol: SymbolId, assignment: ExprId) -> bool {
    let assigned = |id: ExprId| match shader.expr(id).kind {
        ExprKind::Assign { op: None, op_span: _, target, value } if shader.symbol_of(target) == Some(symbol) => {
            Some(value)
        }
        _ => None,
    };
    let worked_out = |value: ExprId| {
        let is_name = |id: ExprId| matches!(shader.expr(id).kind, ExprKind::Name(_));
        expressions(shader, value).into_iter().any(is_name)
    };
    let lost = |pair: &[Stmt]| match (&pair[0].kind, &pair[1].kind) {
        (StmtKind::Expr(first), StmtKind::Expr(second)) => *first == assignment && assigned(*second).is_some(),
        _ => false,
    };
    assigned(assignment).is_some_and(worked_out) && lists(shader).iter().any(|list| list.windows(2).any(lost))
}

/// The statements of each function and block.
fn lists(shader: &Shader) -> Vec<&[Stmt]> {
    let mut lists: Vec<&[Stmt]> = Vec::new();
    for item in &shader.unit().items {
        if let ItemKind::Function(function) = &item.kind {
            lists.extend(function.body.as_ref().map(|b| b.statements.as_slice()));
        }
    }
    statements(shader, |statement| {
        if let StmtKind::Block(block) = &statement.kind {
            lists.push(&block.statements);
        }
    });
    lists
}

/// Members of structures that two statements write one after the other, and the second does not read; variables are
/// followed by their flow.
fn overwritten(shader: &Shader) -> Vec<(ExprId, ExprId)> {
    let stored = |s: &Stmt| match s.kind {
        StmtKind::Expr(id) => match shader.expr(id).kind {
            ExprKind::Assign { op: None, op_span: _, target, value } => Some((target, value)),
            _ => None,
        },
        _ => None,
    };
    let member = |id: ExprId| matches!(shader.expr(id).kind, ExprKind::Field { base, .. } if matches!(shader.type_of(base), Type::Struct(_)));
    let mut found = Vec::new();
    for pair in lists(shader).into_iter().flat_map(|list| list.windows(2)) {
        let (Some((first, _)), Some((second, value))) = (stored(&pair[0]), stored(&pair[1])) else { continue };
        let same = key(shader, first).is_some_and(|k| Some(k) == key(shader, second));
        // A call may read what was written.
        let reads = expressions(shader, value).into_iter().any(|e| {
            matches!(shader.expr(e).kind, ExprKind::Call { .. } if matches!(shader.callee(e), Some(CallTarget::User(_)) | None))
                || shader.text_of(second).starts_with(shader.text_of(e))
        });
        if same && member(first) && !reads {
            found.push((first, second));
        }
    }
    found
}

/// The first statement behind a jump of the same block. A `break` there only closes a `case`.
fn behind_jump(list: &[Stmt], wgsl: bool) -> Option<Span> {
    // In WGSL an invocation goes on behind `discard`, as a helper.
    let jump = |s: &Stmt| match s.kind {
        StmtKind::Return(_) | StmtKind::Break | StmtKind::Continue => true,
        StmtKind::Discard => !wgsl,
        _ => false,
    };
    let at = list.iter().position(jump)?;
    let idle = |s: &&Stmt| {
        matches!(s.kind, StmtKind::Break | StmtKind::Return(None) | StmtKind::Empty | StmtKind::Declaration(_))
    };
    let next = list[at + 1..].iter().find(|s| !idle(s))?;
    match next.kind {
        StmtKind::Case(_) | StmtKind::Default => behind_jump(&list[at + 2..], wgsl),
        _ => Some(next.span),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;
    use base::diagnostic::Severity;

    #[test]
    fn members_that_the_next_statement_overwrites_are_reported() {
        let count = |body: &str| {
            crate::wgsl::testing::count(
                "D010",
                &format!("struct S {{ a: f32, b: f32, }}\nfn f(x: f32) -> S {{ var s: S; {body} return s; }}\n"),
            )
        };
        assert_eq!(count("s.a = x; s.a = 1.0; s.b = x;"), 1);
        assert_eq!(count("s.a = x; s.a = s.a + 1.0; s.b = x;"), 0);
        assert_eq!(count("s.a = x; s.b = 1.0;"), 0);
    }

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
    fn an_output_that_is_lost_at_once_is_a_warning() {
        let of = |body: &str| {
            let text = format!("#version 150 core\nin vec4 q;\nout vec4 c;\nvoid main(void)\n{{\n  {body}\n}}\n");
            let found = crate::run(&[crate::Input::new(base::text::SourceFile::new("a.frag", text))]);
            found.into_iter().filter(|d| d.code.0 == "D010").map(|d| d.severity).collect::<Vec<_>>()
        };
        assert_eq!(of("c = q * 2.0; c = q;"), [Severity::Warning]);
        assert_eq!(of("c = vec4(0.0); c = q;"), [Severity::Info]);
        assert_eq!(of("c = q * 2.0; vec4 d = q; c = d;"), [Severity::Info]);
        assert_eq!(of("c = q * 2.0; c = c * q;"), []);
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
