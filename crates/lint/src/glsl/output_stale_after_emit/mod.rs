//! G005: an output is emitted again without being set again.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G005"),
    name: "output-stale-after-emit",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    for stale in &file.flow().stale {
        let name = &file.shader.symbol(stale.symbol).name;
        findings.push(
            findings
                .at(
                    &file.file,
                    stale.emit,
                    message!(
                        "`{name}` is emitted again without being set again",
                        "`{name}` が設定し直されないまま、また出力されています"
                    ),
                )
                .with_label(message!("`{name}` is undefined here", "ここで `{name}` は未定義"))
                .with_related(&file.file, stale.set, message!("set here", "ここで設定"))
                .with_why(message!(
                    "after `EmitVertex` all outputs are undefined, and this one is not set between two calls",
                    "`EmitVertex` の後はすべての出力変数が未定義になりますが、次の呼び出しまでに設定されていません"
                ))
                .with_help(message!(
                    "set `{name}` before each `EmitVertex`",
                    "`EmitVertex` の前ごとに `{name}` を設定してください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn reported(body: &str) -> Vec<String> {
        let text = format!(
            "#version 150 core\nlayout (triangles) in;\nlayout (triangle_strip, max_vertices = 9) out;\nuniform bool b;\nout vec3 c;\nout vec3 n;\nvoid at(int i) {{ gl_Position = gl_in[i].gl_Position; EmitVertex(); }}\nvoid with(vec3 x, int i) {{ c = x; at(i); }}\nvoid main(void)\n{{\n  {body}\n}}\n"
        );
        messages("G005", "a.geom", &text)
    }

    #[test]
    fn outputs_that_are_not_set_again_are_reported() {
        let message = ["`c` is emitted again without being set again"];
        for body in [
            "c = vec3(1.0); at(0); at(1); at(2);",
            "c = vec3(1.0); for (int i = 0; i < 3; ++i) at(i);",
            "with(vec3(1.0), 0); at(1);",
            "for (int i = 0; i < 3; ++i) { at(i); if (i == 5) c = vec3(1.0); else c = vec3(0.5); at(i); }",
            "c = vec3(1.0); at(0); EndPrimitive(); at(1);",
            "for (int f = 0; f < 2; ++f) { c = vec3(1.0); for (int i = 0; i < 3; ++i) at(i); EndPrimitive(); }",
        ] {
            assert_eq!(reported(body), message, "{body}");
        }
        assert_eq!(reported("gl_Layer = 1; for (int i = 0; i < 3; ++i) at(i);").len(), 1);
    }

    #[test]
    fn outputs_that_are_set_for_each_vertex_are_not() {
        for body in [
            "for (int i = 0; i < 3; ++i) with(vec3(1.0), i);",
            "for (int i = 0; i < 3; ++i) { c = vec3(1.0); at(i); }",
            "c = vec3(1.0); at(0);",
            "at(0); at(1);",
            "for (int i = 0; i < 3; ++i) { if (b) c = vec3(1.0); at(i); }",
            "for (int f = 0; f < 2; ++f) { for (int i = 0; i < 3; ++i) { c = vec3(1.0); at(i); } EndPrimitive(); }",
            "for (int f = 0; f < 2; ++f) { c = vec3(1.0); at(f); for (int i = 0; i < 3; ++i) c = vec3(0.0); }",
            "if (b) { c = vec3(1.0); at(0); } else { c = vec3(0.0); at(0); }",
        ] {
            assert_eq!(reported(body), [""; 0], "{body}");
        }
    }
}
