//! I002: an input whose type is not that of its output.

use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};

use super::Program;
use super::link::{agree, input_type, is_built_in, output_type, producer};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I002"),
    name: "interface-type-mismatch",
    severity: Severity::Error,
    level: Level::Default,
    summary: "an input has another type than the output that it gets its value from",
    page: Page {
        what: "Reports inputs whose type differs from that of the output that they meet. In a geometry or tessellation stage the type of one element counts: a `vec3` of the vertex stage meets a `vec3[]`.",
        why: "The program does not link: the types of an output and its input have to be the same.",
        bad: &[
            Example {
                name: "lamp.vert",
                text: "#version 150 core\nin vec4 position;\nin vec3 normal;\nuniform mat4 mc;\nout vec3 n;\nvoid main(void)\n{\n  n = normal;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 150 core\nin vec4 n;\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(normalize(n.xyz), 1.0);\n}\n",
            },
        ],
        good: &[
            Example {
                name: "lamp.vert",
                text: "#version 150 core\nin vec4 position;\nin vec3 normal;\nuniform mat4 mc;\nout vec3 n;\nvoid main(void)\n{\n  n = normal;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 150 core\nin vec3 n;\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(normalize(n), 1.0);\n}\n",
            },
        ],
        fix: "There is no fix: which of the two types is meant is not known.",
        references: &["OpenGL Shading Language 1.50, section 4.3.4 (Inputs)"],
        ja: Japanese {
            summary: "入力の型が、値を受け取る出力の型と違います",
            what: "対応する出力と型が違う入力を報告します。ジオメトリシェーダとテッセレーションシェーダでは要素の型を比べます。頂点シェーダの `vec3` は `vec3[]` に対応します。",
            why: "出力と入力の型は同じでなければならないので、プログラムはリンクできません。",
            fix: "no fix（修正なし）: どちらの型のつもりか分かりません。",
        },
    },
    check: Check::Program(check),
};

fn check(program: &Program<'_>, _project: &Project, findings: &mut Findings<'_>) {
    for (from, to) in program.links() {
        for input in to.shader.interface().inputs.iter().filter(|v| !is_built_in(&v.name)) {
            let Some(output) = producer(from, to, input) else { continue };
            let wanted = output_type(from, &output.ty, &output.qualifiers);
            let (Some(wanted), Some(got)) = (wanted, input_type(to, &input.ty, &input.qualifiers)) else { continue };
            if agree(wanted, got) {
                continue;
            }
            let (name, had, has, place) = (&input.name, output.ty.to_string(), input.ty.to_string(), from.file.name());
            findings.push(
                findings
                    .at(
                        &to.file,
                        input.name_span,
                        message!(
                            "`{name}` is `{has}` here, and `{had}` in the stage before",
                            "`{name}` はここでは `{has}`、前のステージでは `{had}` です"
                        ),
                    )
                    .with_label(message!("read as `{has}`", "`{has}` として読まれます"))
                    .with_related(
                        &from.file,
                        output.name_span,
                        message!("written as `{had}` here", "ここで `{had}` として書かれます"),
                    )
                    .with_why(message!(
                        "an output and the input that it goes to have to be of one type; the program does not link",
                        "出力とそれを受け取る入力は同じ型でなければならず、プログラムはリンクできません"
                    ))
                    .with_help(message!(
                        "declare `{name}` with the same type here and in {place}",
                        "`{name}` をここと {place} で同じ型に宣言してください"
                    )),
            );
        }
    }
}
