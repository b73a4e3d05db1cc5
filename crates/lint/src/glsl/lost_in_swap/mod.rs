//! D019: a swap that loses one of the values.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{Block, ExprId, ExprKind, ItemKind, Stmt, StmtKind};

use super::walk::statements;
use analysis::numeric::bare;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D019"),
    name: "lost-in-swap",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Target and value of an assignment that a statement is, without blanks; none for one with calls, which may do more.
fn assigned(shader: &Shader, statement: &Stmt) -> Option<(ExprId, [String; 2])> {
    let StmtKind::Expr(expr) = statement.kind else { return None };
    let expr = bare(shader, expr);
    let ExprKind::Assign { op: None, op_span: _, target, value } = shader.expr(expr).kind else { return None };
    let plain = |id: ExprId| {
        let id = bare(shader, id);
        let text: String = shader.text_of(id).split_whitespace().collect();
        let simple = !shader.expr(id).from_macro && !text.contains(['(', '{']) && !text.contains("++");
        (simple && !text.contains("--")).then_some(text)
    };
    Some((expr, [plain(target)?, plain(value)?]))
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut blocks: Vec<&Block> = Vec::new();
    for item in &shader.unit().items {
        if let ItemKind::Function(function) = &item.kind {
            blocks.extend(&function.body);
        }
    }
    statements(shader, |statement| match &statement.kind {
        StmtKind::Block(block) | StmtKind::Switch { selector: _, body: block } => blocks.push(block),
        _ => {}
    });
    for pair in blocks.iter().flat_map(|b| b.statements.windows(2)) {
        let [first, second] = pair else { continue };
        let (Some((first, [a, b])), Some((second, [c, d]))) = (assigned(shader, first), assigned(shader, second))
        else {
            continue;
        };
        if a != d || b != c || a == b {
            continue;
        }
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(second).span,
                    message!("`{c}` gets its own value here", "`{c}` に自分の値を代入しています"),
                )
                .with_related(
                    &file.file,
                    shader.expr(first).span,
                    message!("both are the same from here on", "ここから両者は同じ"),
                )
                .with_why(message!(
                    "the value that `{a}` had is lost: this is no swap",
                    "`{a}` の元の値は失われ、入れ替えになりません"
                ))
                .with_help(message!(
                    "keep the value of `{a}` in a third variable first",
                    "先に `{a}` の値を別の変数に取っておいてください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::wgsl::testing::count;

    fn swapped(lines: &str) -> usize {
        count("D019", &format!("fn f(p: ptr<function, array<u32, 8>>, i: u32, j: u32) {{\n{lines}\n}}\n"))
    }

    #[test]
    fn swaps_that_lose_a_value_are_reported() {
        assert_eq!(swapped("(*p)[0] = 1u; var a = array<u32, 8>(); a[i] = a[j]; a[j] = a[ i ];"), 1);
        assert_eq!(swapped("var a = i; var b = j; if i > j { a = b; b = a; } (*p)[a] = b;"), 1);
    }

    #[test]
    fn swaps_with_a_third_variable_are_not() {
        assert_eq!(swapped("var a = i; var b = j; let t = a; a = b; b = t; (*p)[a] = b;"), 0);
        assert_eq!(swapped("var a = i; var b = j; a = b; b = a + 1u; (*p)[a] = b;"), 0);
        assert_eq!(swapped("var a = i; var b = j; a = b; a += 1u; b = a; (*p)[a] = b;"), 0);
    }
}
