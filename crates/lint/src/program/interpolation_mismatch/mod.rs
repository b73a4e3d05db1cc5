//! I004: an output and its input with different interpolation.

use crate::project::Project;
use crate::project::ShaderFile;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use syntax::Stage;

use super::Program;
use super::link::{interpolation, is_built_in, keyword, producer};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I004"),
    name: "interpolation-mismatch",
    severity: Severity::Error,
    level: Level::Default,
    summary: "an output and its input are interpolated in different ways",
    page: Page {
        what: "Reports outputs whose interpolation (`smooth`, `flat`, `noperspective`) is not that of the fragment input that they go to, in versions before 4.40. Without a qualifier a variable is `smooth`.",
        why: "Before GLSL 4.40 the qualifiers have to be the same, and the program does not link. From 4.40 on that of the fragment stage counts.",
        bad: &[
            Example {
                name: "lamp.vert",
                text: "#version 150 core\nin vec4 position;\nin vec3 normal;\nuniform mat4 mc;\nout vec3 n;\nvoid main(void)\n{\n  n = normal;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 150 core\nflat in vec3 n;\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(normalize(n), 1.0);\n}\n",
            },
        ],
        good: &[
            Example {
                name: "lamp.vert",
                text: "#version 150 core\nin vec4 position;\nin vec3 normal;\nuniform mat4 mc;\nflat out vec3 n;\nvoid main(void)\n{\n  n = normal;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 150 core\nflat in vec3 n;\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(normalize(n), 1.0);\n}\n",
            },
        ],
        fix: "Gives the output the qualifier of the input, which alone counts in later versions. Unsafe: the other qualifier may be meant.",
        references: &[
            "OpenGL Shading Language 4.30, section 4.5 (Interpolation Qualifiers): qualifiers have to match",
            "OpenGL Shading Language 4.40, section 4.5: the qualifier of the fragment stage counts",
        ],
        ja: Japanese {
            summary: "出力と入力の補間方法が違います",
            what: "補間の修飾子（`smooth`, `flat`, `noperspective`）が、受け取るフラグメントシェーダの入力と違う出力を報告します。4.40 より前の版が対象です。修飾子がなければ `smooth` です。",
            why: "GLSL 4.40 より前では修飾子が一致しなければならず、プログラムはリンクできません。4.40 以降ではフラグメントシェーダの修飾子が使われます。",
            fix: "出力に入力の修飾子を付けます。後の版ではこれだけが効きます。もう一方のつもりかもしれないので unsafe です。",
        },
    },
    check: Check::Program(check),
};

fn check(program: &Program<'_>, _project: &Project, findings: &mut Findings<'_>) {
    for (from, to) in program.links() {
        let old = |s: &ShaderFile| (130..440).contains(&s.shader.version().number);
        if to.shader.stage() != Stage::Fragment || !old(from) || !old(to) {
            continue;
        }
        for input in to.shader.interface().inputs.iter().filter(|v| !is_built_in(&v.name)) {
            let Some(output) = producer(from, to, input) else { continue };
            let (has, had) = (interpolation(&input.qualifiers), interpolation(&output.qualifiers));
            if has == had {
                continue;
            }
            let (name, has, had) = (&output.name, keyword(has), keyword(had));
            let mut found = findings
                .at(
                    &from.file,
                    output.name_span,
                    message!(
                        "`{name}` is `{had}` here, and `{has}` in the fragment stage",
                        "`{name}` はここでは `{had}`、フラグメントシェーダでは `{has}` です"
                    ),
                )
                .with_label(message!("written as `{had}`", "`{had}` として書かれます"))
                .with_related(
                    &to.file,
                    input.name_span,
                    message!("read as `{has}` here", "ここで `{has}` として読まれます"),
                )
                .with_why(message!(
                    "before GLSL 4.40 both have to be the same, or the program does not link",
                    "GLSL 4.40 より前では両方が同じでなければ、プログラムはリンクできません"
                ))
                .with_help(message!("write `{has}` in both stages", "両方のステージに `{has}` と書いてください"));
            if output.siblings == 1 {
                let edit = match (output.qualifiers.interpolation(), output.qualifiers.storage()) {
                    (Some((_, span)), _) => Some(Edit::replace(span, has)),
                    (None, Some((_, span))) => Some(Edit::insert(span.start, format!("{has} "))),
                    (None, None) => None,
                };
                let edits: Vec<Edit> = edit.into_iter().collect();
                found = found.with_fix(message!("write `{has}`", "`{has}` と書く"), Safety::Unsafe, edits);
            }
            findings.push(found);
        }
    }
}
