//! G008: a geometry shader without the layout of its input or output.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;

use super::compile::behind_directives;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G008"),
    name: "missing-layout",
    severity: Severity::Error,
    level: Level::Default,
    summary: "a geometry shader does not declare its input primitive, output primitive or max_vertices",
    page: Page {
        what: "Reports geometry shaders with `main` that lack the input primitive, the output primitive or `max_vertices`. A shader that enables an extension that is not known here is not reported.",
        why: "Without them the program does not link.",
        bad: &[Example {
            name: "a.geom",
            text: "#version 150 core\nlayout(triangle_strip, max_vertices = 3) out;\nvoid main(void)\n{\n  for (int i = 0; i < 3; i++) {\n    gl_Position = gl_in[i].gl_Position;\n    EmitVertex();\n  }\n  EndPrimitive();\n}\n",
        }],
        good: &[Example {
            name: "a.geom",
            text: "#version 150 core\nlayout(triangles) in;\nlayout(triangle_strip, max_vertices = 3) out;\nvoid main(void)\n{\n  for (int i = 0; i < 3; i++) {\n    gl_Position = gl_in[i].gl_Position;\n    EmitVertex();\n  }\n  EndPrimitive();\n}\n",
        }],
        fix: "The missing layout is declared for triangles behind the directives. Unsafe, because the primitives are a guess.",
        references: &[
            "GLSL 4.60 specification, section 4.4.1.2 \"Geometry Shader Inputs\"",
            "GLSL 4.60 specification, section 4.4.2.2 \"Geometry Outputs\"",
        ],
        ja: Japanese {
            summary: "ジオメトリシェーダに入出力の layout 宣言がありません",
            what: "`main` を持ち、入力プリミティブ・出力プリミティブ・`max_vertices` のいずれかの宣言がないジオメトリシェーダを報告します。未知の拡張を有効にしているものは報告しません。",
            why: "宣言がないとプログラムをリンクできません。",
            fix: "足りない宣言を三角形としてディレクティブの後に書きます。プリミティブは推測なので unsafe です。",
        },
    },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let geometry = &file.shader.interface().geometry;
    let mut lines = String::new();
    if geometry.input.is_none() {
        lines.push_str("layout(triangles) in;\n");
    }
    match (geometry.output.is_none(), geometry.max_vertices.is_none()) {
        (true, true) => lines.push_str("layout(triangle_strip, max_vertices = 3) out;\n"),
        (true, false) => lines.push_str("layout(triangle_strip) out;\n"),
        (false, true) => lines.push_str("layout(max_vertices = 3) out;\n"),
        (false, false) => {}
    }
    let edits = vec![Edit::insert(behind_directives(file), lines)];
    Some(found.with_fix(message!("declare it for triangles", "三角形として宣言する"), Safety::Unsafe, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired as lint;

    #[test]
    fn what_is_missing_is_declared() {
        let text = |l: &str| format!("#version 150\n{l}void main() {{ gl_Position = vec4(1.0); EmitVertex(); }}\n");
        for missing in ["", "layout(lines) in;\n", "layout(lines) in;\nlayout(line_strip) out;\n"] {
            let (codes, fixed) = lint("a.geom", &text(missing));
            assert!(codes.contains(&"G008"), "{missing}");
            let (safety, fixed) = fixed.unwrap();
            assert_eq!(safety, Safety::Unsafe);
            assert!(!lint("a.geom", &fixed).0.contains(&"G008"), "{fixed}");
        }
        // Functions for another file need no layout.
        assert!(!lint("a.geom", "#version 150\nvoid f() { EmitVertex(); }\n").0.contains(&"G008"));
    }
}
