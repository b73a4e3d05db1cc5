//! G010: a vertex is emitted before its position is set.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::interface::OutputPrimitive;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G010"),
    name: "position-not-set-before-emit",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let Some((emit, set)) = file.flow().unplaced else { return };
    // Points that are nowhere are captured, and not drawn.
    let interface = file.shader.interface();
    let points = interface.geometry.output.as_ref().is_some_and(|o| o.value == OutputPrimitive::Points);
    if !set && points && !interface.outputs.is_empty() {
        return;
    }
    let label = if set {
        message!("it is set only later", "設定はこれより後")
    } else {
        message!("it is set nowhere", "どこでも設定されていない")
    };
    findings.push(
        findings
            .at(
                &file.file,
                emit,
                message!(
                    "a vertex is emitted before `gl_Position` is set",
                    "`gl_Position` を設定する前に頂点が出力されています"
                ),
            )
            .with_label(label)
            .with_why(message!(
                "the position of the vertex before this stage is not passed on by itself",
                "前のステージの頂点の位置は、自動では引き継がれません"
            ))
            .with_help(message!(
                "set `gl_Position` before each `EmitVertex`, for instance from `gl_in[i].gl_Position`",
                "`EmitVertex` の前ごとに、`gl_in[i].gl_Position` などから `gl_Position` を設定してください"
            )),
    );
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn a_vertex_without_a_position_is_reported() {
        let reported = |body: &str| {
            let text = format!(
                "#version 150 core\nlayout (triangles) in;\nlayout (triangle_strip, max_vertices = 9) out;\nuniform bool b;\nout vec3 c;\nvoid at(int i) {{ gl_Position = gl_in[i].gl_Position; EmitVertex(); }}\nvoid main(void)\n{{\n  {body}\n}}\n"
            );
            messages("G010", "a.geom", &text).len()
        };
        assert_eq!(reported("c = vec3(1.0); EmitVertex();"), 1);
        assert_eq!(reported("EmitVertex(); at(0); at(1);"), 1);
        for body in
            ["at(0);", "gl_Position.xy = vec2(0.0); EmitVertex();", "if (b) gl_Position = vec4(0.0); EmitVertex();"]
        {
            assert_eq!(reported(body), 0, "{body}");
        }
    }

    #[test]
    fn points_without_a_position_are_captured() {
        let reported = |output: &str, body: &str| {
            let text = format!(
                "#version 150 core\nlayout (points) in;\nlayout ({output}, max_vertices = 2) out;\nout vec3 c;\nvoid main(void)\n{{\n  {body}\n}}\n"
            );
            messages("G010", "a.geom", &text).len()
        };
        assert_eq!(reported("points", "c = vec3(1.0); EmitVertex();"), 0);
        assert_eq!(reported("points", "c = vec3(1.0); EmitVertex(); gl_Position = vec4(c, 1.0); EmitVertex();"), 1);
        assert_eq!(reported("line_strip", "c = vec3(1.0); EmitVertex();"), 1);
    }
}
