//! I006: a uniform with two types.

use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};

use super::Program;
use super::link::agree;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I006"),
    name: "uniform-type-conflict",
    severity: Severity::Error,
    level: Level::Default,
    summary: "a uniform has different types in two stages",
    page: Page {
        what: "Reports uniforms of one name that stages of one program declare with different types.",
        why: "All stages share one set of uniforms: one name is one variable. The program does not link.",
        bad: &[
            Example {
                name: "lamp.vert",
                text: "#version 150 core\nin vec4 position;\nin vec3 normal;\nuniform mat4 mc;\nuniform float gain;\nout vec3 n;\nvoid main(void)\n{\n  n = normal * gain;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 150 core\nin vec3 n;\nuniform vec3 gain;\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(normalize(n) * gain, 1.0);\n}\n",
            },
        ],
        good: &[
            Example {
                name: "lamp.vert",
                text: "#version 150 core\nin vec4 position;\nin vec3 normal;\nuniform mat4 mc;\nuniform float gain;\nout vec3 n;\nvoid main(void)\n{\n  n = normal * gain;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 150 core\nin vec3 n;\nuniform float gain;\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(normalize(n) * gain, 1.0);\n}\n",
            },
        ],
        fix: "There is no fix: which type is meant is not known.",
        references: &[
            "OpenGL Shading Language 1.50, section 4.3.5 (Uniform): all stages share one name space of uniforms",
        ],
        ja: Japanese {
            summary: "uniform の型が二つのステージで違います",
            what: "同じプログラムのステージが、同じ名前の uniform を違う型で宣言しているものを報告します。",
            why: "uniform はすべてのステージに共通で、一つの名前は一つの変数です。プログラムはリンクできません。",
            fix: "no fix（修正なし）: どちらの型のつもりか分かりません。",
        },
    },
    check: Check::Program(check),
};

fn check(program: &Program<'_>, _project: &Project, findings: &mut Findings<'_>) {
    let shaders = program.shaders();
    if !shaders.iter().all(|s| s.is_plain()) {
        return;
    }
    for (i, shader) in shaders.iter().enumerate() {
        for uniform in &shader.shader.interface().uniforms {
            let earlier = shaders[..i].iter().find_map(|s| s.shader.interface().uniform(&uniform.name).map(|u| (s, u)));
            let Some((other, first)) = earlier.filter(|(_, u)| !agree(&u.ty, &uniform.ty)) else { continue };
            let (name, here, there) = (&uniform.name, uniform.ty.to_string(), first.ty.to_string());
            let place = other.file.name();
            findings.push(
                findings
                    .at(
                        &shader.file,
                        uniform.name_span,
                        message!(
                            "the uniform `{name}` is `{here}` here, and `{there}` in {place}",
                            "uniform `{name}` はここでは `{here}`、{place} では `{there}` です"
                        ),
                    )
                    .with_label(message!("`{here}` here", "ここでは `{here}`"))
                    .with_related(&other.file, first.name_span, message!("`{there}` here", "ここでは `{there}`"))
                    .with_why(message!(
                        "stages share their uniforms; two types for one name do not link",
                        "uniform はステージの間で共有されるので、型が違うとリンクできません"
                    ))
                    .with_help(message!(
                        "declare `{name}` with one type, or give one of them another name",
                        "`{name}` を同じ型で宣言するか、一方の名前を変えてください"
                    )),
            );
        }
    }
}
