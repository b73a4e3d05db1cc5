//! G006: a strip that has no primitive.

use crate::flow::vertices_needed;
use crate::project::ShaderFile;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G006"),
    name: "too-few-vertices-for-primitive",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "a strip ends before it has the vertices of one primitive",
    page: Page {
        what: "Reports strips of a geometry stage that end, by `EndPrimitive` or with `main`, after at least one \
            vertex and on every path before the second vertex of a line or the third of a triangle.",
        why: "An incomplete primitive is dropped without a message: nothing is drawn.",
        bad: &[Example {
            name: "edge.geom",
            text: "#version 150 core\nlayout (lines) in;\nlayout (line_strip, \
            max_vertices = 3) out;\nvoid main(void)\n{\n  gl_Position = \
            gl_in[0].gl_Position;\n  EmitVertex();\n  EndPrimitive();\n  gl_Position = \
            gl_in[1].gl_Position;\n  EmitVertex();\n  gl_Position = gl_in[0].gl_Position;\n  EmitVertex();\n}\n",
        }],
        good: &[Example {
            name: "edge.geom",
            text: "#version 150 core\nlayout (lines) in;\nlayout (line_strip, \
            max_vertices = 2) out;\nvoid main(void)\n{\n  gl_Position = \
            gl_in[0].gl_Position;\n  EmitVertex();\n  gl_Position = \
            gl_in[1].gl_Position;\n  EmitVertex();\n  EndPrimitive();\n}\n",
        }],
        fix: "No fix: the missing vertices are not known.",
        references: &["GLSL 1.50 specification, section 8.10 \"Geometry Shader Functions\""],
        ja: Japanese {
            summary: "プリミティブ 1 個分の頂点がそろう前にストリップが終わっています",
            what: "ジオメトリシェーダのストリップのうち、少なくとも 1 頂点を出力した後、どの経路でも線の 2 頂点目、三角形の 3 頂点目より前に `EndPrimitive` または `main` の終わりに至るものを報告します。",
            why: "頂点の足りないプリミティブは何の通知もなく捨てられ、何も描画されません。",
            fix: "修正はありません。足りない頂点は分かりません。",
        },
    },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let Some(needed) = vertices_needed(&file.shader) else { return };
    let main = file.shader.function("main").map(|m| m.name.span);
    for &(end, most) in &file.flow().short {
        let Some(span) = end.or(main) else { continue };
        let primitive = if needed == 2 { ("a line", "線") } else { ("a triangle", "三角形") };
        let (en, ja) = primitive;
        let vertices = if most == 1 { "1 vertex".to_owned() } else { format!("{most} vertices") };
        findings.push(
            findings
                .at(
                    &file.file,
                    span,
                    message!(
                        "a strip ends after at most {vertices}, and {en} has {needed}",
                        "ストリップが最大 {most} 頂点で終わりますが、{ja}には {needed} 頂点が必要です"
                    ),
                )
                .with_label(message!("nothing is drawn", "何も描画されない"))
                .with_why(message!(
                    "a primitive that lacks a vertex is dropped",
                    "頂点の足りないプリミティブは捨てられます"
                ))
                .with_help(message!("emit {needed} vertices or more", "{needed} 頂点以上を出力してください")),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn told(primitive: &str, body: &str) -> usize {
        let text = format!(
            "#version 150 core\nlayout (points) in;\nlayout ({primitive}, max_vertices = 20) out;\nuniform int n;\nvoid v() {{ gl_Position = gl_in[0].gl_Position; EmitVertex(); }}\nvoid main(void)\n{{\n  {body}\n}}\n"
        );
        messages("G006", "a.geom", &text).len()
    }

    #[test]
    fn strips_without_a_primitive_are_told() {
        for (primitive, body) in [
            ("triangle_strip", "v(); v();"),
            ("triangle_strip", "v(); v(); EndPrimitive(); v(); v(); v();"),
            ("line_strip", "for (int i = 0; i < 4; ++i) { v(); EndPrimitive(); }"),
            ("line_strip", "if (n > 2) v(); EndPrimitive();"),
        ] {
            assert_eq!(told(primitive, body), 1, "{body}");
        }
    }

    #[test]
    fn strips_with_one_and_empty_ones_are_not() {
        for (primitive, body) in [
            ("triangle_strip", "v(); v(); v();"),
            ("triangle_strip", "for (int i = 0; i < 3; ++i) v(); EndPrimitive();"),
            ("triangle_strip", "for (int i = 0; i < n; ++i) v(); EndPrimitive();"),
            ("triangle_strip", "v(); v(); if (n > 2) v(); EndPrimitive();"),
            ("line_strip", "EndPrimitive(); v(); v(); EndPrimitive();"),
            ("points", "v(); EndPrimitive();"),
        ] {
            assert_eq!(told(primitive, body), 0, "{body}");
        }
    }
}
