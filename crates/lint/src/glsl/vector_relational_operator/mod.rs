//! T010: `<` and the like on vectors.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::{Edit, Span};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind};
use syntax::types::{ScalarType, Type};

use super::compile::{destination, explained};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T010"),
    name: "vector-relational-operator",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let shader = &file.shader;
    let found = explained(
        found,
        message!("relational operators compare two scalars", "大小比較の演算子はスカラ同士だけを比べます"),
        message!("use `lessThan` and its kin", "`lessThan` などを使ってください"),
    );
    let relation = shader.arena().iter().find_map(|(id, e)| match &e.kind {
        ExprKind::Binary { op, op_span, left, right } if *op_span == found.span && !e.from_macro => {
            Some((id, *op, *left, *right))
        }
        _ => None,
    });
    let Some((id, op, left, right)) = relation else { return Some(found) };
    let (a, b) = (shader.expr(left), shader.expr(right));
    let same = shader.type_of(left) == shader.type_of(right);
    if !same || a.from_macro || b.from_macro || !takes_components(shader, id) {
        return Some(found);
    }
    let name = match op {
        BinaryOp::Less => "lessThan",
        BinaryOp::Greater => "greaterThan",
        BinaryOp::LessEqual => "lessThanEqual",
        _ => "greaterThanEqual",
    };
    let edits = vec![
        Edit::insert(a.span.start, format!("{name}(")),
        Edit::replace(Span::new(a.span.end, b.span.start), ", "),
        Edit::insert(b.span.end, ")"),
    ];
    Some(found.with_fix(message!("call `{name}`", "`{name}` を呼ぶ"), Safety::Safe, edits))
}

/// True where a `bvec` is wanted.
fn takes_components(shader: &Shader, id: ExprId) -> bool {
    let argument = shader.arena().iter().any(|(_, e)| match &e.kind {
        ExprKind::Call { callee: Callee::Name(name), args } => {
            matches!(name.name.as_str(), "any" | "all" | "not") && args.as_slice() == [id]
        }
        _ => false,
    });
    argument || matches!(destination(shader, id), Some(Type::Vector(ScalarType::Bool, _)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired_but_flow as lint;

    #[test]
    fn a_relation_becomes_a_call_where_a_bvec_is_wanted() {
        let shader = |s: &str| format!("#version 150\nin vec3 p;\nvoid main() {{ {s} gl_Position = vec4(p, 1.0); }}\n");
        let (codes, fixed) = lint("a.vert", &shader("bvec3 b = p >= p.zyx;"));
        let want = shader("bvec3 b = greaterThanEqual(p, p.zyx);");
        assert_eq!((codes.as_slice(), fixed), (["T010"].as_slice(), Some((Safety::Safe, want))));
        assert_eq!(lint("a.vert", &shader("if (p < p.zyx) return;")), (vec!["T010"], None));
        assert!(lint("a.vert", &shader("if (p == p.zyx && p.x < p.y) return;")).0.is_empty());
    }
}
