//! G006: a strip that has no primitive.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::flow::vertices_needed;
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G006"),
    name: "too-few-vertices-for-primitive",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
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

    fn reported(primitive: &str, body: &str) -> usize {
        let text = format!(
            "#version 150 core\nlayout (points) in;\nlayout ({primitive}, max_vertices = 20) out;\nuniform int n;\nvoid v() {{ gl_Position = gl_in[0].gl_Position; EmitVertex(); }}\nvoid main(void)\n{{\n  {body}\n}}\n"
        );
        messages("G006", "a.geom", &text).len()
    }

    #[test]
    fn strips_without_a_primitive_are_reported() {
        for (primitive, body) in [
            ("triangle_strip", "v(); v();"),
            ("triangle_strip", "v(); v(); EndPrimitive(); v(); v(); v();"),
            ("line_strip", "for (int i = 0; i < 4; ++i) { v(); EndPrimitive(); }"),
            ("line_strip", "if (n > 2) v(); EndPrimitive();"),
        ] {
            assert_eq!(reported(primitive, body), 1, "{body}");
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
            assert_eq!(reported(primitive, body), 0, "{body}");
        }
    }
}
