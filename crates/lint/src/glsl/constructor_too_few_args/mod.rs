//! T002: a constructor gets fewer components than its type has.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::ast::{Callee, ExprKind};
use syntax::types::{ScalarType, Type};
use syntax::{Constructor, Fit};

use super::compile::fourth;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T002"),
    name: "constructor-too-few-args",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let shader = &file.shader;
    let call = shader.arena().iter().find_map(|(id, e)| match &e.kind {
        ExprKind::Call { callee: Callee::Type(ty), args } if ty.span == found.span && !e.from_macro => {
            Some((id, e, args))
        }
        _ => None,
    });
    let Some((id, expr, args)) = call else { return Some(found) };
    let (Some(Constructor { ty: Type::Vector(ScalarType::Float, n), fit: Fit::TooFew { given }, .. }), Some(last)) =
        (shader.constructor(id), args.last())
    else {
        return Some(found);
    };
    if given + 1 != usize::from(n) {
        return Some(found);
    }
    let value = fourth(shader, *last);
    let edit = Edit::insert(expr.span.end - 1, format!(", {value}"));
    Some(found.with_fix(message!("append `{value}`", "`{value}` を補う"), Safety::Unsafe, vec![edit]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired_but_flow as lint;

    #[test]
    fn one_missing_component_is_appended() {
        let shader =
            |e: &str| format!("#version 150\nin vec3 p;\nin vec3 normal;\nvoid main() {{ gl_Position = {e}; }}\n");
        let (codes, fixed) = lint("a.vert", &shader("vec4(p)"));
        assert_eq!((codes.as_slice(), fixed), (["T002"].as_slice(), Some((Safety::Unsafe, shader("vec4(p, 1.0)")))));
        assert_eq!(lint("a.vert", &shader("vec4(normal)")).1.unwrap().1, shader("vec4(normal, 0.0)"));
        // Two are missing: what is meant is not known.
        assert_eq!(lint("a.vert", &shader("vec4(1.0, 1.0)")), (vec!["T002"], None));
        for right in ["vec4(1.0)", "vec4(p.xy, p.xy)", "mat4(2.0)[0]", "mat4(mat3(1.0))[0]"] {
            assert!(lint("a.vert", &shader(right)).0.is_empty(), "{right}");
        }
    }
}
