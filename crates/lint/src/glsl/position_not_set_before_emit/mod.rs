//! G010: a vertex is emitted before its position is set.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G010"),
    name: "position-not-set-before-emit",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "`EmitVertex` is called before `gl_Position` is set",
    page: Page {
        what: "Reports the first `EmitVertex` of a geometry stage to which no path sets `gl_Position`. A \
            position that is not set again after an earlier `EmitVertex` is told by G005.",
        why: "The position that `main` of the vertex stage wrote is in `gl_in`, and is not passed on by itself: the \
            vertex has an undefined position.",
        bad: &[Example {
            name: "pass.geom",
            text: "#version 150 core\nlayout (points) in;\nlayout (points, \
            max_vertices = 1) out;\nvoid main(void)\n{\n  EmitVertex();\n  gl_Position = gl_in[0].gl_Position;\n\
            }\n",
        }],
        good: &[Example {
            name: "pass.geom",
            text: "#version 150 core\nlayout (points) in;\nlayout (points, \
            max_vertices = 1) out;\nvoid main(void)\n{\n  gl_Position = gl_in[0].gl_Position;\n  EmitVertex();\n\
            }\n",
        }],
        fix: "No fix: the position is not known.",
        references: &["GLSL 1.50 specification, section 7.2 \"Geometry Shader Special Variables\""],
        ja: Japanese {
            summary: "`gl_Position` を設定する前に `EmitVertex` を呼んでいます",
            what: "ジオメトリシェーダで、どの経路でも `gl_Position` が設定されないまま到達する最初の `EmitVertex` を報告します。前の `EmitVertex` の後で設定し直していないものは G005 が報告します。",
            why: "バーテックスシェーダが書いた位置は `gl_in` にあり、自動では引き継がれません。頂点の位置が未定義になります。",
            fix: "修正はありません。設定すべき位置は分かりません。",
        },
    },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let Some((emit, set)) = file.flow().unplaced else { return };
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
    fn a_vertex_without_a_position_is_told() {
        let told = |body: &str| {
            let text = format!(
                "#version 150 core\nlayout (triangles) in;\nlayout (triangle_strip, max_vertices = 9) out;\nuniform bool b;\nout vec3 c;\nvoid at(int i) {{ gl_Position = gl_in[i].gl_Position; EmitVertex(); }}\nvoid main(void)\n{{\n  {body}\n}}\n"
            );
            messages("G010", "a.geom", &text).len()
        };
        assert_eq!(told("c = vec3(1.0); EmitVertex();"), 1);
        assert_eq!(told("EmitVertex(); at(0); at(1);"), 1);
        for body in
            ["at(0);", "gl_Position.xy = vec2(0.0); EmitVertex();", "if (b) gl_Position = vec4(0.0); EmitVertex();"]
        {
            assert_eq!(told(body), 0, "{body}");
        }
    }
}
