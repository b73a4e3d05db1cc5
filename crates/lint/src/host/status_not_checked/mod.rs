//! H016: the status of compiling and linking is not checked.

use super::HostFile;
use super::syntax::{callee, descendants, span};
use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H016"),
    name: "status-not-checked",
    severity: Severity::Info,
    level: Level::Strict,
    summary: "shaders are compiled or programs linked, and no host file asks whether that went well",
    page: Page {
        what: "Reports `glCompileShader` where no host file of the run mentions `GL_COMPILE_STATUS` or an info log, and `glLinkProgram` where none mentions `GL_LINK_STATUS` or an info log; once for each file and function.",
        why: "Errors in shaders raise no GL error and no message of their own: the screen stays black, and nothing says why.",
        bad: &[Example { name: "build.cpp", text: "void build(GLuint shader)\n{\n  glCompileShader(shader);\n}\n" }],
        good: &[Example {
            name: "build.cpp",
            text: "void build(GLuint shader)\n{\n  glCompileShader(shader);\n  GLint ok;\n  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);\n}\n",
        }],
        fix: "There is no fix: what to do about an error is up to the program.",
        references: &[
            "OpenGL 3.2 core specification, section 2.11.1 (Shader Objects): COMPILE_STATUS and the info log",
        ],
        ja: Japanese {
            summary: "シェーダのコンパイルやプログラムのリンクの成否を、どのホストのファイルも調べていません",
            what: "どのホストのファイルにも `GL_COMPILE_STATUS` や情報ログがない `glCompileShader` と、`GL_LINK_STATUS` や情報ログがない `glLinkProgram` を、ファイルと関数ごとに一度報告します。",
            why: "シェーダの誤りは GL エラーにも表示にもなりません。画面が黒いままで、理由が分かりません。",
            fix: "no fix（修正なし）: 誤りのときに何をするかはプログラム次第です。",
        },
    },
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
