//! H021: a missing line break in a shader text.

use super::HostFile;
use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H021"),
    name: "shader-source-line-break",
    severity: Severity::Error,
    level: Level::Default,
    summary: "a line break is missing behind `#version` in a shader text of several literals",
    page: Page {
        what: "Reports shader texts in string literals in which the line of `#version` goes on with other text, because a literal does not end with `\\n`. Other rules on shaders do not look at such a text.",
        why: "Literals that stand side by side become one text without anything between them: the rest of the line belongs to `#version`, and the shader does not compile.",
        bad: &[Example {
            name: "lamp.cpp",
            text: "const char *fragmentSource =\n  \"#version 150 core\"\n  \"out vec4 fc;\\n\"\n  \"void main() { fc = vec4(1.0); }\\n\";\n",
        }],
        good: &[Example {
            name: "lamp.cpp",
            text: "const char *fragmentSource =\n  \"#version 150 core\\n\"\n  \"out vec4 fc;\\n\"\n  \"void main() { fc = vec4(1.0); }\\n\";\n",
        }],
        fix: "Writes `\\n` at the end of the literal. Safe: the shader did not compile, and only a line break can follow.",
        references: &[
            "ISO C++, lex.string: adjacent string literals are concatenated",
            "OpenGL Shading Language 1.50, section 3.3 (Preprocessor): a directive ends with its line",
        ],
        ja: Japanese {
            summary: "複数のリテラルからなるシェーダの `#version` の後に改行がありません",
            what: "文字列リテラルの中のシェーダのうち、リテラルが `\\n` で終わらないために `#version` の行に別の文字列が続くものを報告します。このようなシェーダには、ほかの規則を適用しません。",
            why: "並んだリテラルは間に何も入らずにつながります。行の残りが `#version` の一部になり、シェーダはコンパイルできません。",
            fix: "リテラルの終わりに `\\n` を書きます。シェーダはコンパイルできず、続くのは改行しかないので safe です。",
        },
    },
    check: Check::Host(check),
};

fn check(host: &HostFile, _: &Project, findings: &mut Findings<'_>) {
    for embedded in host.embedded() {
        let Some(at) = embedded.run_on() else { continue };
        let name = &embedded.name;
        let place = embedded.literal.to_host(Span::new(at, at + 1));
        // The literal before ends where the text goes on: at its quotation mark.
        let before = embedded.literal.to_host(Span::new(at - 1, at)).end;
        if before >= place.start || !host.file.text()[before..].starts_with('"') {
            continue;
        }
        findings.push(
            findings
                .at(
                    &host.file,
                    Span::at(before),
                    message!(
                        "no line break behind `#version` in {name}",
                        "{name} の `#version` の後に改行がありません"
                    ),
                )
                .with_label(message!("the line goes on in the next literal", "行が次のリテラルに続きます"))
                .with_why(message!(
                    "adjacent literals are joined without anything between them, and the shader does not compile",
                    "並んだリテラルは間に何も入らずにつながり、シェーダはコンパイルできません"
                ))
                .with_fix(message!("write `\\n`", "`\\n` を書く"), Safety::Safe, vec![Edit::insert(before, "\\n")]),
        );
    }
}
