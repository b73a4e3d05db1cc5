//! H005: a name that the shaders do not use.

use super::HostFile;
use super::lookup::LookupKind;
use super::program::resolve;
use crate::program::Program;
use crate::project::Project;
use crate::project::ShaderFile;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};
use syntax::interface::Variable;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H005"),
    name: "inactive-name",
    severity: Severity::Warning,
    level: Level::Strict,
    summary: "a uniform or attribute is looked up that the shaders declare and never use",
    page: Page {
        what: "Reports look-ups of names that are declared in the program, but used in none of its stages. It stays silent when a stage is not known.",
        why: "A variable that is not used is not active: the look-up gives -1 without a GL error. What is set there has no effect.",
        bad: &[
            Example {
                name: "lamp.vert",
                text: "#version 150 core\nin vec4 position;\nuniform mat4 mc;\nuniform vec4 color;\nuniform float gain;\nout vec4 c;\nvoid main(void)\n{\n  c = color;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 150 core\nin vec4 c;\nout vec4 fc;\nvoid main(void)\n{\n  fc = c;\n}\n",
            },
            Example {
                name: "lamp.cpp",
                text: "void setUp(const GLfloat *m)\n{\n  GLuint program = load(\"lamp.vert\", \"lamp.frag\");\n  GLint place = glGetUniformLocation(program, \"gain\");\n  glUniform1f(place, 1.0f);\n}\n",
            },
        ],
        good: &[
            Example {
                name: "lamp.vert",
                text: "#version 150 core\nin vec4 position;\nuniform mat4 mc;\nuniform vec4 color;\nuniform float gain;\nout vec4 c;\nvoid main(void)\n{\n  c = color * gain;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 150 core\nin vec4 c;\nout vec4 fc;\nvoid main(void)\n{\n  fc = c;\n}\n",
            },
            Example {
                name: "lamp.cpp",
                text: "void setUp(const GLfloat *m)\n{\n  GLuint program = load(\"lamp.vert\", \"lamp.frag\");\n  GLint place = glGetUniformLocation(program, \"gain\");\n  glUniform1f(place, 1.0f);\n}\n",
            },
        ],
        fix: "There is no fix: the use in the shader may be missing, or the look-up may be left over.",
        references: &[
            "OpenGL 3.2 core specification, section 2.11.4: a uniform is active when it is accessed in the program",
        ],
        ja: Japanese {
            summary: "シェーダが宣言するだけで使わない uniform や頂点属性の位置を求めています",
            what: "プログラムで宣言されているものの、どのステージでも使われない名前の問い合わせを報告します。不明なステージがあるときは報告しません。",
            why: "使われない変数は有効でないので、問い合わせは GL エラーなしに -1 を返します。そこに設定した値には効果がありません。",
            fix: "no fix（修正なし）: シェーダで使い忘れているのか、問い合わせの消し忘れなのか分かりません。",
        },
    },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for lookup in host.lookups().iter().filter(|l| !l.is_reserved() && l.kind != LookupKind::BindAttribute) {
        let Some(program) = resolve(host, project, &lookup.source).filter(Program::is_complete) else { continue };
        let name = lookup.base_name();
        let declared: Vec<(&ShaderFile, &Variable)> = match lookup.kind {
            LookupKind::Uniform => {
                program.shaders().iter().filter_map(|s| s.shader.interface().uniform(name).map(|v| (*s, v))).collect()
            }
            LookupKind::Attribute | LookupKind::BindAttribute => program.attribute(name).into_iter().collect(),
        };
        let used = declared.iter().any(|(s, v)| s.shader.uses_of(v.symbol).next().is_some());
        let Some((shader, variable)) = declared.first().filter(|_| !used) else { continue };
        findings.push(
            findings
                .at(
                    &host.file,
                    lookup.literal_span(),
                    message!(
                        "`{name}` is declared, but no stage uses it",
                        "`{name}` は宣言されていますが、どのステージでも使われません"
                    ),
                )
                .with_label(message!("gives -1", "-1 になります"))
                .with_related(&shader.file, variable.name_span, message!("declared here", "ここで宣言されています"))
                .with_why(message!(
                    "a variable that is not used is not active and has no location; this raises no GL error",
                    "使われない変数は有効でなく、位置がありません。GL エラーにもなりません"
                ))
                .with_help(message!(
                    "use `{name}` in a shader, or remove the look-up",
                    "シェーダで `{name}` を使うか、この問い合わせを消してください"
                )),
        );
    }
}
