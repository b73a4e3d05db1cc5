//! T012: `%` on floating-point operands.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::{Edit, Span};
use reading::ShaderFile;
use syntax::ast::{BinaryOp, ExprKind};

use super::compile::explained;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T012"),
    name: "float-modulo",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let shader = &file.shader;
    let found = explained(
        found,
        message!("`%` is defined for integers only", "`%` は整数だけに定義されています"),
        message!("use `mod(a, b)`", "`mod(a, b)` を使ってください"),
    );
    let operands = shader.arena().iter().find_map(|(_, e)| match &e.kind {
        ExprKind::Binary { op: BinaryOp::Rem, op_span, left, right } if *op_span == found.span && !e.from_macro => {
            Some((shader.expr(*left), shader.expr(*right)))
        }
        _ => None,
    });
    let Some((a, b)) = operands.filter(|(a, b)| !a.from_macro && !b.from_macro) else { return Some(found) };
    let edits = vec![
        Edit::insert(a.span.start, "mod("),
        Edit::replace(Span::new(a.span.end, b.span.start), ", "),
        Edit::insert(b.span.end, ")"),
    ];
    Some(found.with_fix(message!("use `mod`", "`mod` を使う"), Safety::Safe, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired_but_flow as lint;

    #[test]
    fn a_remainder_of_floats_becomes_mod() {
        let shader = |s: &str| format!("#version 150\nin vec4 p;\nvoid main() {{ {s} gl_Position = p; }}\n");
        let (codes, fixed) = lint("a.vert", &shader("float x = p.x % p.y + 0.5;"));
        assert_eq!(
            (codes.as_slice(), fixed),
            (["T012"].as_slice(), Some((Safety::Safe, shader("float x = mod(p.x, p.y) + 0.5;"))))
        );
        assert_eq!(lint("a.vert", &shader("float x = p.x; x %= p.y;")), (vec!["T012"], None));
        assert!(lint("a.vert", &shader("int i = 7 % 4;")).0.is_empty());
    }
}
