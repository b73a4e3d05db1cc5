//! T003: a vector or scalar is assigned to one of another size.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use syntax::types::{ScalarType, Type};

use super::compile::{destination, expression_at, fourth};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T003"),
    name: "assign-size-mismatch",
    severity: Severity::Error,
    level: Level::Default,
    summary: "a vector or scalar is assigned to one of another size",
    page: Page {
        what: "Reports assignments, initialisers and `return` values where vectors or scalars have different numbers of components, as in `vec4 q = p.xyz;`.",
        why: "GLSL neither cuts nor fills a vector in an assignment: the shader does not compile.",
        bad: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin vec3 position;\nuniform mat4 mvp;\nvoid main(void)\n{\n  gl_Position = position;\n}\n",
        }],
        good: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin vec3 position;\nuniform mat4 mvp;\nvoid main(void)\n{\n  gl_Position = vec4(position, 1.0);\n}\n",
        }],
        fix: "A vector of floats that is one component short is wrapped with `0.0` (directions, by name) or `1.0`, and one that is too long gets a swizzle. Unsafe, because what is meant is a guess.",
        references: &["GLSL 4.60 specification, section 5.8 \"Assignments\""],
        ja: Japanese {
            summary: "大きさの違うベクトルやスカラを代入しています",
            what: "代入・初期化で、ベクトルやスカラの成分数が合わないもの（`vec4 q = p.xyz;` など）を報告します。",
            why: "代入でベクトルが切り詰められたり補われたりすることはなく、コンパイルできません。",
            fix: "一成分足りない浮動小数点ベクトルは `0.0`（方向らしい名前）か `1.0` を補って包み、長すぎるものはスウィズルで切ります。意図は推測なので unsafe です。",
        },
    },
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
