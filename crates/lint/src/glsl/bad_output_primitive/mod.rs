//! G009: an input primitive stands where an output primitive is needed.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G009"),
    name: "bad-output-primitive",
    severity: Severity::Error,
    level: Level::Default,
    summary: "a geometry shader names an input primitive as its output",
    page: Page {
        what: "Reports `lines`, `triangles` and their forms with adjacency in `layout(…) out` of a geometry shader.",
        why: "A geometry shader gives `points`, `line_strip` or `triangle_strip`: the shader does not compile.",
        bad: &[Example {
            name: "a.geom",
            text: "#version 150 core\nlayout(triangles) in;\nlayout(triangles, max_vertices = 3) out;\nvoid main(void)\n{\n  for (int i = 0; i < 3; i++) {\n    gl_Position = gl_in[i].gl_Position;\n    EmitVertex();\n  }\n  EndPrimitive();\n}\n",
        }],
        good: &[Example {
            name: "a.geom",
            text: "#version 150 core\nlayout(triangles) in;\nlayout(triangle_strip, max_vertices = 3) out;\nvoid main(void)\n{\n  for (int i = 0; i < 3; i++) {\n    gl_Position = gl_in[i].gl_Position;\n    EmitVertex();\n  }\n  EndPrimitive();\n}\n",
        }],
        fix: "The strip of the same primitive is written. Safe: the text did not compile, and only this strip fits.",
        references: &["GLSL 4.60 specification, section 4.4.2.2 \"Geometry Outputs\""],
        ja: Japanese {
            summary: "ジオメトリシェーダの出力に入力プリミティブの名前が書かれています",
            what: "ジオメトリシェーダの `layout(…) out` に書かれた `lines`・`triangles` とその隣接付きの名前を報告します。",
            why: "ジオメトリシェーダの出力は `points`・`line_strip`・`triangle_strip` のいずれかで、コンパイルできません。",
            fix: "同じ種類のストリップに書き換えます。元はコンパイルできず、当てはまるストリップは一つなので safe です。",
        },
    },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let strip = if file.file.slice(found.span).starts_with("line") { "line_strip" } else { "triangle_strip" };
    let edits = vec![Edit::replace(found.span, strip)];
    Some(found.with_fix(message!("write `{strip}`", "`{strip}` と書く"), Safety::Safe, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired as lint;

    #[test]
    fn the_strip_is_written() {
        let text = |i: &str, o: &str| {
            format!(
                "#version 150\nlayout({i}) in;\nlayout({o}, max_vertices = 1) out;\nvoid main() {{ gl_Position = gl_in[0].gl_Position; EmitVertex(); }}\n"
            )
        };
        for (wrong, right) in [("triangles", "triangle_strip"), ("lines_adjacency", "line_strip")] {
            let (codes, fixed) = lint("a.geom", &text("points", wrong));
            assert!(codes.contains(&"G009"));
            assert_eq!(fixed, Some((Safety::Safe, text("points", right))));
        }
        assert!(!lint("a.geom", &text("points", "points")).0.contains(&"G009"));
    }
}
