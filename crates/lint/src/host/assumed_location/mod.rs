//! H015: a location that nothing fixes.

use super::HostFile;
use super::index::Index;
use super::program::{ProgramSource, resolve, whole};
use super::setter::Setter;
use super::suggest::{list, list_in_japanese};
use super::syntax::{arguments, bare, callee, span};
use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H015"),
    name: "assumed-location",
    severity: Severity::Warning,
    level: Level::Strict,
    summary: "the location of a uniform is written as a number that nothing fixes",
    page: Page {
        what: "Reports `glUniform` functions with a plain number as location in a file about one program none of whose uniforms has `layout(location = …)`.",
        why: "The linker gives the numbers, and each driver in its own way: on another one the value goes to another uniform, or the call fails.",
        bad: &[
            Example {
                name: "lamp.vert",
                text: "#version 150 core\nin vec4 position;\nuniform mat4 mc;\nuniform vec4 color;\nout vec4 c;\nvoid main(void)\n{\n  c = color;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 150 core\nin vec4 c;\nout vec4 fc;\nvoid main(void)\n{\n  fc = c;\n}\n",
            },
            Example {
                name: "lamp.cpp",
                text: "void setUp(const GLfloat *m)\n{\n  GLuint program = load(\"lamp.vert\", \"lamp.frag\");\n  glUniform4f(0, 1.0f, 0.0f, 0.0f, 1.0f);\n}\n",
            },
        ],
        good: &[
            Example {
                name: "lamp.vert",
                text: "#version 150 core\nin vec4 position;\nuniform mat4 mc;\nuniform vec4 color;\nout vec4 c;\nvoid main(void)\n{\n  c = color;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 150 core\nin vec4 c;\nout vec4 fc;\nvoid main(void)\n{\n  fc = c;\n}\n",
            },
            Example {
                name: "lamp.cpp",
                text: "void setUp(const GLfloat *m)\n{\n  GLuint program = load(\"lamp.vert\", \"lamp.frag\");\n  GLint place = glGetUniformLocation(program, \"color\");\n  glUniform4f(place, 1.0f, 0.0f, 0.0f, 1.0f);\n}\n",
            },
        ],
        fix: "There is no fix: which uniform is meant is not known.",
        references: &[
            "OpenGL 3.2 core specification, section 2.11.4: locations are assigned when the program is linked",
        ],
        ja: Japanese {
            summary: "uniform の位置を、どこにも定められていない数で書いています",
            what: "`layout(location = …)` のある uniform がないプログラム一つだけを扱うファイルで、位置をただの数で渡している `glUniform` 系の関数を報告します。",
            why: "番号はリンク時に決まり、その順はドライバごとに違います。別のドライバでは値が別の uniform に届くか、呼び出しが失敗します。",
            fix: "no fix（修正なし）: どの uniform のつもりか分かりません。",
        },
    },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    if !host.file.text().contains("glUniform") {
        return;
    }
    let Some(index) = Index::new(host) else { return };
    let source = whole(&index);
    if !matches!(source, ProgramSource::Named(_)) {
        return;
    }
    let Some(program) = resolve(host, project, &source).filter(|p| p.is_complete()) else { return };
    let uniforms = || program.shaders().iter().flat_map(|s| &s.shader.interface().uniforms);
    if uniforms().any(|u| u.qualifiers.layout_entry("location").is_some()) {
        return;
    }
    for &call in &index.calls {
        let sets = callee(call, &host.file)
            .is_some_and(|(f, _)| f.starts_with("glUniform") && Setter::of_function(f).is_some());
        let Some(place) = arguments(call).first().map(|a| span(bare(*a))).filter(|_| sets) else { continue };
        let number = host.file.slice(place);
        if number.parse::<u32>().is_err() {
            continue;
        }
        let mut names: Vec<&str> = program.uniforms().collect();
        names.sort_unstable();
        names.dedup();
        let (en, ja) = (list(&names), list_in_japanese(&names));
        findings.push(
            findings
                .at(
                    &host.file,
                    place,
                    message!(
                        "nothing says which uniform has the location {number}",
                        "位置 {number} がどの uniform のものかは定められていません"
                    ),
                )
                .with_label(message!("assumed", "仮定した位置"))
                .with_why(message!(
                    "the linker gives the locations, and another driver gives others",
                    "位置はリンク時に決まり、ドライバが違えば番号も違います"
                ))
                .with_help(message!(
                    "ask glGetUniformLocation for one of {en}",
                    "{ja} のどれかの位置を glGetUniformLocation で求めてください"
                )),
        );
    }
}
