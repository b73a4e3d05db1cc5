//! T003: a vector or scalar is assigned to one of another size.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::types::{ScalarType, Type};

use super::compile::{destination, expression_at, fourth};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T003"),
    name: "assign-size-mismatch",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let shader = &file.shader;
    let Some(value) = expression_at(shader, found.span) else { return Some(found) };
    let (Type::Vector(a, given), Some(Type::Vector(b, wanted))) =
        (shader.type_of(value).clone(), destination(shader, value))
    else {
        return Some(found);
    };
    if a != ScalarType::Float || b != ScalarType::Float {
        return Some(found);
    }
    let span = found.span;
    if given + 1 == wanted {
        let last = fourth(shader, value);
        let edits =
            vec![Edit::insert(span.start, format!("vec{wanted}(")), Edit::insert(span.end, format!(", {last})"))];
        return Some(found.with_fix(message!("append `{last}`", "`{last}` を補う"), Safety::Unsafe, edits));
    }
    if given > wanted {
        let swizzle = &"xyzw"[..usize::from(wanted)];
        let edits = vec![Edit::insert(span.start, "("), Edit::insert(span.end, format!(").{swizzle}"))];
        return Some(found.with_fix(message!("take `.{swizzle}`", "`.{swizzle}` を取る"), Safety::Unsafe, edits));
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired_but_flow as lint;

    #[test]
    fn sizes_are_made_to_fit() {
        let shader =
            |s: &str| format!("#version 150\nin vec3 p;\nin vec4 q;\nvoid main() {{ {s} gl_Position = q; }}\n");
        let (codes, fixed) = lint("a.vert", &shader("vec4 a = p;"));
        assert_eq!(
            (codes.as_slice(), fixed),
            (["T003"].as_slice(), Some((Safety::Unsafe, shader("vec4 a = vec4(p, 1.0);"))))
        );
        assert_eq!(lint("a.vert", &shader("vec3 a; a = q + q;")).1.unwrap().1, shader("vec3 a; a = (q + q).xyz;"));
        assert_eq!(lint("a.vert", &shader("float a = q;")), (vec!["T003"], None));
        for right in ["vec4 a = vec4(p, 1.0);", "vec3 a = q.xyz;", "vec3 a; a.xy = q.xy; a *= 2.0;"] {
            assert!(lint("a.vert", &shader(right)).0.is_empty(), "{right}");
        }
    }
}
