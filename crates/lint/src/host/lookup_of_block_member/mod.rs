//! H006: a member of a uniform block set as a plain uniform.

use super::HostFile;
use super::lookup::LookupKind;
use super::program::resolve;
use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};
use syntax::interface::Storage;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H006"),
    name: "lookup-of-block-member",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "a member of a uniform block, or the block itself, is set as a plain uniform",
    page: Page {
        what: "Reports names of uniform blocks and of their members that are given to `glGetUniformLocation` when the location is used by a `glUniform` function, and to setters by name. A look-up whose result is only compared stays silent.",
        why: "Members of a block have no location: the look-up gives -1 without a GL error, and `glUniform` functions ignore it. Their values come from the buffer that is bound to the block.",
        bad: &[
            Example {
                name: "lamp.vert",
                text: "#version 150 core\nin vec4 position;\nuniform mat4 mc;\nlayout(std140) uniform Material { vec4 color; };\nout vec4 c;\nvoid main(void)\n{\n  c = color;\n  gl_Position = mc * position;\n}\n",
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
        fix: "There is no fix: the value has to be written to the buffer of the block.",
        references: &[
            "OpenGL 3.1 core specification, section 2.11.3 (GetUniformLocation): -1 for a member of a named uniform block",
        ],
        ja: Japanese {
            summary: "uniform ブロックのメンバやブロックそのものを、ふつうの uniform として設定しています",
            what: "uniform ブロックやそのメンバの名前を渡した `glGetUniformLocation` のうち、得た位置を `glUniform` 系の関数に渡しているもの、および名前で値を設定する関数に渡しているものを報告します。結果を比較するだけの問い合わせは報告しません。",
            why: "ブロックのメンバには位置がありません。問い合わせは GL エラーなしに -1 を返し、`glUniform` 系の関数はそれを無視します。値はブロックに結び付けたバッファから読まれます。",
            fix: "no fix（修正なし）: 値をブロックのバッファに書く必要があります。",
        },
    },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for lookup in host.lookups().iter().filter(|l| l.kind == LookupKind::Uniform) {
        let set = lookup.feeds.uniform || (lookup.wrapped && lookup.sets.is_some());
        let Some(program) = resolve(host, project, &lookup.source).filter(|_| set) else { continue };
        let name = lookup.base_name();
        if program.uniform(name).is_some() {
            continue;
        }
        let block = program.shaders().iter().find_map(|s| {
            let blocks = s.shader.interface().blocks.iter().filter(|b| b.storage == Storage::Uniform);
            let mut named = blocks.filter(|b| {
                let instance = b.instance.as_ref();
                b.name.name == name
                    || instance.is_some_and(|i| i.name == name)
                    || (instance.is_none() && b.members.iter().any(|m| m.name.name == name))
            });
            named.next().map(|b| (s, b))
        });
        let Some((shader, block)) = block else { continue };
        let called = &block.name.name;
        findings.push(
            findings
                .at(
                    &host.file,
                    lookup.literal_span(),
                    message!(
                        "`{name}` belongs to the uniform block `{called}` and has no location",
                        "`{name}` は uniform ブロック `{called}` のもので、位置がありません"
                    ),
                )
                .with_label(message!("gives -1", "-1 になります"))
                .with_related(&shader.file, block.name.span, message!("the block", "このブロック"))
                .with_why(message!(
                    "members of a block get their values from a buffer, and glUniform functions ignore the location -1",
                    "ブロックのメンバの値はバッファから読まれ、glUniform 系の関数は位置 -1 を無視します"
                ))
                .with_help(message!(
                    "write the value to the buffer that is bound to `{called}`",
                    "`{called}` に結び付けたバッファに値を書いてください"
                )),
        );
    }
}
