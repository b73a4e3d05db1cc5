//! V011: `gl_PerVertex` is declared where the version has no such declaration.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Profile;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V011"),
    name: "per-vertex-redeclared",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let version = shader.version();
    let separate =
        shader.extensions().iter().any(|e| ["GL_ARB_separate_shader_objects", "all"].contains(&e.name.as_str()));
    if version.span.is_none() || version.profile == Profile::Es || version.number >= 410 || separate {
        return;
    }
    for block in shader.interface().blocks.iter().filter(|b| b.name.name == "gl_PerVertex") {
        findings.push(
            findings
                .at(
                    &file.file,
                    block.name.span,
                    message!(
                        "`gl_PerVertex` can be declared from GLSL 4.10 on",
                        "`gl_PerVertex` を宣言できるのは GLSL 4.10 からです"
                    ),
                )
                .with_label(message!("a built-in block", "組み込みのブロック"))
                .with_why(message!(
                    "earlier versions have the block and no way to declare it again; compilers that follow the \
                     specification refuse the text",
                    "それより前のバージョンではこのブロックを宣言し直せず、仕様に従うコンパイラはエラーにします"
                ))
                .with_help(message!(
                    "declare version 410, enable `GL_ARB_separate_shader_objects`, or leave the block out",
                    "バージョン 410 を宣言するか、`GL_ARB_separate_shader_objects` を有効にするか、ブロックを消してください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn the_block_belongs_to_later_versions() {
        let reported = |head: &str| {
            let text = format!(
                "{head}\nout gl_PerVertex {{ vec4 gl_Position; }};\nvoid main() {{ gl_Position = vec4(0.0); }}\n"
            );
            messages("V011", "a.vert", &text).len()
        };
        assert_eq!(reported("#version 330 core"), 1);
        assert_eq!(reported("#version 410 core"), 0);
        assert_eq!(reported("#version 330 core\n#extension GL_ARB_separate_shader_objects : enable"), 0);
    }
}
