//! H021: a missing line break in a shader text.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};
use hosts::HostFile;
use reading::Project;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H021"),
    name: "shader-source-line-break",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
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
