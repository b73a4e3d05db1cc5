//! T012: `%` on floating-point operands.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::{Edit, Span};
use syntax::ast::{BinaryOp, ExprKind};

use super::compile::explained;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T012"),
    name: "float-modulo",
    severity: Severity::Error,
    level: Level::Default,
    summary: "% is used on floating-point operands",
    page: Page {
        what: "Reports `%` with a floating-point operand.",
        why: "The operator takes integers only: the shader does not compile. Some translators, naga among them, accept it.",
        bad: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin vec3 position;\nuniform mat4 mvp;\nvoid main(void)\n{\n  float phase = position.x % 2.0;\n  gl_Position = mvp * vec4(position.xy, phase, 1.0);\n}\n",
        }],
        good: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin vec3 position;\nuniform mat4 mvp;\nvoid main(void)\n{\n  float phase = mod(position.x, 2.0);\n  gl_Position = mvp * vec4(position.xy, phase, 1.0);\n}\n",
        }],
        fix: "`mod(a, b)` is written. Safe: the text did not compile, and this is what it means. `%=` has no fix.",
        references: &[
            "GLSL 4.60 specification, section 5.9 \"Expressions\"",
            "GLSL 4.60 specification, section 8.3 \"Common Functions\"",
        ],
        ja: Japanese {
            summary: "浮動小数点数に % を使っています",
            what: "浮動小数点の項に使われた `%` を報告します。",
            why: "この演算子は整数専用で、コンパイルできません。naga など一部の変換器は受け付けてしまいます。",
            fix: "`mod(a, b)` と書き換えます。元はコンパイルできず意味も一つなので safe です。`%=` は自動修正しません。",
        },
    },
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
