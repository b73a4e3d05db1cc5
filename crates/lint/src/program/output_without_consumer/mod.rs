//! I003: an output that nobody reads.

use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};
use syntax::interface::Storage;

use super::link::{consumer, in_block, input_type, is_built_in, is_patch, output_type, producer};
use super::{Known, Program, stage_in_japanese};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I003"),
    name: "output-without-consumer",
    severity: Severity::Info,
    level: Level::Default,
    summary: "an output that the next stage does not read",
    page: Page {
        what: "Reports outputs that the next stage does not declare as inputs. It stays silent where a shader belongs to several programs, where host code names the output (as for transform feedback), and where an input without output resembles it: that one is told by I001.",
        why: "The value is computed and never read. Often it is left over, or the line that should use it is missing.",
        bad: &[
            Example {
                name: "lamp.vert",
                text: "#version 150 core\nin vec4 position;\nin vec3 normal;\nuniform mat4 mc;\nout vec3 n;\nout vec3 light;\nvoid main(void)\n{\n  n = normal;\n  light = vec3(0.0, 4.0, 2.0) - position.xyz;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 150 core\nin vec3 n;\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(normalize(n), 1.0);\n}\n",
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
        fix: "There is no fix: what computes the value would have to be removed as well.",
        references: &["OpenGL Shading Language 1.50, section 4.3.6 (Outputs)"],
        ja: Japanese {
            summary: "次のステージが読まない出力です",
            what: "次のステージで入力として宣言されていない出力を報告します。シェーダが複数のプログラムに属するとき、ホストのコードがその名前を使うとき（トランスフォームフィードバックなど）、対応する出力のない似た名前の入力があるとき（I001 が報告します）は報告しません。",
            why: "値は計算されますが、読まれません。消し忘れか、使うはずの行が抜けていることが多いです。",
            fix: "no fix（修正なし）: 値を計算する部分も消す必要があります。",
        },
    },
    check: Check::Program(check),
};

fn check(program: &Program<'_>, project: &Project, findings: &mut Findings<'_>) {
    for (from, to) in program.links() {
        if program.shares(from) || (program.how_known() == Known::Name && program.shaders().len() > 2) {
            continue;
        }
        let interface = to.shader.interface();
        for output in from.shader.interface().outputs.iter().filter(|v| !is_built_in(&v.name)) {
            let read = consumer(from, to, output).is_some() || in_block(to, Storage::In, &output.name);
            let captured = || project.hosts().any(|h| h.file.text().contains(&format!("\"{}\"", output.name)));
            // An input that lacks its output was perhaps meant to read this one.
            let candidate = || {
                let mut lost =
                    interface.inputs.iter().filter(|i| !is_built_in(&i.name) && producer(from, to, i).is_none());
                lost.any(|i| {
                    let types =
                        (input_type(to, &i.ty, &i.qualifiers), output_type(from, &output.ty, &output.qualifiers));
                    types.0.is_some() && types.0 == types.1
                })
            };
            if read || is_patch(&output.qualifiers) || captured() || candidate() {
                continue;
            }
            let (name, stage, place) = (&output.name, to.shader.stage().name(), to.file.name());
            let ja_stage = stage_in_japanese(to.shader.stage());
            findings.push(
                findings
                    .at(
                        &from.file,
                        output.name_span,
                        message!("the {stage} stage does not read `{name}`", "{ja_stage}は `{name}` を読みません"),
                    )
                    .with_label(message!("goes nowhere", "どこにも渡りません"))
                    .with_why(message!(
                        "{place} has no input `{name}`; what is computed here is thrown away",
                        "{place} に入力 `{name}` がないので、ここで計算した値は捨てられます"
                    ))
                    .with_help(message!(
                        "remove `{name}`, or read it in {place}",
                        "`{name}` を消すか、{place} で読んでください"
                    )),
            );
        }
    }
}
