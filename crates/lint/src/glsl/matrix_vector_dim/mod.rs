//! T004: the sizes of a matrix product do not fit.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use syntax::ast::ExprKind;
use syntax::types::Type;

use super::compile::fourth;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T004"),
    name: "matrix-vector-dim",
    severity: Severity::Error,
    level: Level::Default,
    summary: "the sizes of a product with a matrix do not fit",
    page: Page {
        what: "Reports products of a matrix with a matrix or vector whose sizes do not fit by the rules of linear algebra, as in `mat4 * vec3`.",
        why: "A matrix takes vectors with as many components as it has columns: the shader does not compile.",
        bad: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin vec3 position;\nuniform mat4 mvp;\nvoid main(void)\n{\n  gl_Position = mvp * position;\n}\n",
        }],
        good: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin vec3 position;\nuniform mat4 mvp;\nvoid main(void)\n{\n  gl_Position = mvp * vec4(position, 1.0);\n}\n",
        }],
        fix: "A vector on the right that is one component short is wrapped with `0.0` (directions, by name) or `1.0`. Unsafe, because points and directions differ in it.",
        references: &["GLSL 4.60 specification, section 5.11 \"Vector and Matrix Operations\""],
        ja: Japanese {
            summary: "行列の積の大きさが合いません",
            what: "行列と行列・ベクトルの積で、線形代数の規則に合わないもの（`mat4 * vec3` など）を報告します。",
            why: "行列に掛けられるのは列数と同じ成分数のベクトルだけで、コンパイルできません。",
            fix: "右側のベクトルが一成分足りないとき、`0.0`（方向らしい名前）か `1.0` を補って包みます。点と方向で値が違うため unsafe です。",
        },
    },
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
