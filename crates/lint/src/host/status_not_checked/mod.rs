//! H016: the status of compiling and linking is not checked.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use hosts::HostFile;
use hosts::cpp::tree::{callee, descendants, span};
use reading::Project;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H016"),
    name: "status-not-checked",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    let steps = [
        ("glCompileShader", ["GL_COMPILE_STATUS", "glGetShaderInfoLog"]),
        ("glLinkProgram", ["GL_LINK_STATUS", "glGetProgramInfoLog"]),
    ];
    for (function, asks) in steps {
        if !host.file.text().contains(function) {
            continue;
        }
        if project
            .hosts()
            .any(|h| asks.iter().any(|a| h.file.text().contains(a)) || h.file.text().contains("glDebugMessageCallback"))
        {
            continue;
        }
        let Some(root) = host.root() else { continue };
        let called = descendants(root).find_map(|n| callee(n, &host.file).filter(|(name, _)| *name == function));
        let Some((_, name)) = called else { continue };
        let status = asks[0];
        findings.push(
            findings
                .at(
                    &host.file,
                    span(name),
                    message!("nobody asks whether `{function}` went well", "`{function}` が成功したかを調べていません"),
                )
                .with_label(message!("may fail silently", "黙って失敗することがあります"))
                .with_why(message!(
                    "an error in a shader raises no GL error; only the status and the info log tell",
                    "シェーダの誤りは GL エラーにならず、状態と情報ログからしか分かりません"
                ))
                .with_help(message!(
                    "ask for `{status}` and print the info log",
                    "`{status}` を調べ、情報ログを表示してください"
                )),
        );
    }
}
