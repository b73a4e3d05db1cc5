//! T004: the sizes of a matrix product do not fit.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::ast::ExprKind;
use syntax::types::Type;

use super::compile::fourth;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T004"),
    name: "matrix-vector-dim",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let shader = &file.shader;
    let operands = shader.arena().iter().find_map(|(_, e)| match &e.kind {
        ExprKind::Binary { op: _, op_span, left, right } if *op_span == found.span => Some((*left, *right)),
        _ => None,
    });
    let Some((left, right)) = operands else { return Some(found) };
    let (Type::Matrix(_, columns, _), Type::Vector(_, n)) = (shader.type_of(left), shader.type_of(right)) else {
        return Some(found);
    };
    let expr = shader.expr(right);
    if n + 1 != *columns || expr.from_macro {
        return Some(found);
    }
    let last = fourth(shader, right);
    let edits = vec![
        Edit::insert(expr.span.start, format!("vec{columns}(")),
        Edit::insert(expr.span.end, format!(", {last})")),
    ];
    Some(found.with_fix(message!("append `{last}`", "`{last}` を補う"), Safety::Unsafe, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired_but_flow as lint;

    #[test]
    fn points_and_directions_are_told_apart() {
        let shader = |e: &str| {
            format!(
                "#version 150\nin vec3 p;\nin vec3 normal;\nuniform mat4 m;\nuniform mat3 k;\nvoid main() {{ gl_Position = {e}; }}\n"
            )
        };
        assert_eq!(
            lint("a.vert", &shader("m * p")),
            (vec!["T004"], Some((Safety::Unsafe, shader("m * vec4(p, 1.0)"))))
        );
        assert_eq!(lint("a.vert", &shader("m * normal")).1.unwrap().1, shader("m * vec4(normal, 0.0)"));
        assert_eq!(lint("a.vert", &shader("p * m")), (vec!["T004"], None));
        for right in ["m * vec4(p, 1.0)", "vec4(k * p, 1.0)", "vec4(p * k, 1.0)", "m * m * vec4(1.0)"] {
            assert!(lint("a.vert", &shader(right)).0.is_empty(), "{right}");
        }
    }
}
