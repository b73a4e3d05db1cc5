//! G007: an input of a geometry shader that is no array.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use syntax::ast::ExprKind;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G007"),
    name: "geom-input-not-array",
    severity: Severity::Error,
    level: Level::Default,
    summary: "an input of a geometry shader is no array",
    page: Page {
        what: "Reports inputs and input blocks of a geometry shader that are declared without `[]`.",
        why: "A geometry shader gets the values of all vertices of a primitive, one element for each: the shader does not compile.",
        bad: &[Example {
            name: "a.geom",
            text: "#version 150 core\nlayout(triangles) in;\nlayout(triangle_strip, max_vertices = 3) out;\nin vec3 normal;\nout float n;\nvoid main(void)\n{\n  for (int i = 0; i < 3; i++) {\n    gl_Position = gl_in[i].gl_Position;\n    n = dot(normal[i], normal[i]);\n    EmitVertex();\n  }\n  EndPrimitive();\n}\n",
        }],
        good: &[Example {
            name: "a.geom",
            text: "#version 150 core\nlayout(triangles) in;\nlayout(triangle_strip, max_vertices = 3) out;\nin vec3 normal[];\nout float n;\nvoid main(void)\n{\n  for (int i = 0; i < 3; i++) {\n    gl_Position = gl_in[i].gl_Position;\n    n = dot(normal[i], normal[i]);\n    EmitVertex();\n  }\n  EndPrimitive();\n}\n",
        }],
        fix: "`[]` is put behind the name. Safe when every use has an index already; otherwise unsafe, because the uses need an index then.",
        references: &["GLSL 4.60 specification, section 4.3.4 \"Input Variables\""],
        ja: Japanese {
            summary: "ジオメトリシェーダの入力が配列ではありません",
            what: "`[]` なしに宣言されたジオメトリシェーダの入力変数・入力ブロックを報告します。",
            why: "ジオメトリシェーダはプリミティブの全頂点の値を、頂点ごとに一要素で受け取るため、コンパイルできません。",
            fix: "名前の後に `[]` を付けます。全ての使用に既に添字があれば safe、そうでなければ使用にも添字が必要になるので unsafe です。",
        },
    },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let shader = &file.shader;
    let name = file.file.slice(found.span).to_owned();
    let Some((id, _)) = shader.symbols().find(|(_, s)| s.span == Some(found.span)) else { return Some(found) };
    let indexed = shader.uses_of(id).all(|u| {
        shader.arena().iter().any(|(_, e)| matches!(&e.kind, ExprKind::Index { base, index: _ } if *base == u.expr))
    });
    let safety = if indexed { Safety::Safe } else { Safety::Unsafe };
    let edits = vec![Edit::insert(found.span.end, "[]")];
    Some(found.with_fix(message!("write `{name}[]`", "`{name}[]` と書く"), safety, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired as lint;

    #[test]
    fn brackets_are_added() {
        let text = |d: &str, u: &str| {
            format!(
                "#version 150\nlayout(points) in;\nlayout(points, max_vertices = 1) out;\nin vec3 {d};\nvoid main() {{ gl_Position = vec4({u}); EmitVertex(); }}\n"
            )
        };
        assert_eq!(lint("a.geom", &text("n", "n, 1.0")), (vec!["G007"], Some((Safety::Unsafe, text("n[]", "n, 1.0")))));
        assert_eq!(lint("a.geom", &text("n", "n[0]")).1.unwrap().0, Safety::Safe);
        assert!(!lint("a.geom", &text("n[]", "n[0], 1.0")).0.contains(&"G007"));
    }
}
