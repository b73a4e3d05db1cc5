//! I007: a value that does not pass the geometry stage.

use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};
use syntax::Stage;
use syntax::interface::Storage;

use super::link::{in_block, is_built_in, is_used, producer};
use super::{Known, Program};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I007"),
    name: "geometry-bypass",
    severity: Severity::Error,
    level: Level::Default,
    summary: "a fragment input is written by the vertex stage, but not by the geometry stage between them",
    page: Page {
        what: "Reports fragment inputs of programs with a geometry stage that the vertex stage writes, and the geometry stage does not hand on.",
        why: "A geometry stage makes new vertices: what it does not write does not reach the fragments. The program does not link, or the value is undefined.",
        bad: &[
            Example {
                name: "shell.vert",
                text: "#version 150 core\nin vec4 position;\nin vec3 normal;\nuniform mat4 mc;\nout vec3 n;\nvoid main(void)\n{\n  n = normal;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "shell.geom",
                text: "#version 150 core\nlayout(triangles) in;\nlayout(triangle_strip, max_vertices = 3) out;\nin vec3 n[];\nout vec3 facing;\nvoid main(void)\n{\n  for (int i = 0; i < 3; ++i)\n  {\n    gl_Position = gl_in[i].gl_Position;\n    facing = n[i];\n    EmitVertex();\n  }\n}\n",
            },
            Example {
                name: "shell.frag",
                text: "#version 150 core\nin vec3 n;\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(normalize(n), 1.0);\n}\n",
            },
            Example {
                name: "draw.cpp",
                text: "void setUp()\n{\n  GLuint program = load(\"shell.vert\", \"shell.geom\", \"shell.frag\");\n}\n",
            },
        ],
        good: &[
            Example {
                name: "shell.vert",
                text: "#version 150 core\nin vec4 position;\nin vec3 normal;\nuniform mat4 mc;\nout vec3 n;\nvoid main(void)\n{\n  n = normal;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "shell.geom",
                text: "#version 150 core\nlayout(triangles) in;\nlayout(triangle_strip, max_vertices = 3) out;\nin vec3 n[];\nout vec3 facing;\nvoid main(void)\n{\n  for (int i = 0; i < 3; ++i)\n  {\n    gl_Position = gl_in[i].gl_Position;\n    facing = n[i];\n    EmitVertex();\n  }\n}\n",
            },
            Example {
                name: "shell.frag",
                text: "#version 150 core\nin vec3 facing;\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(normalize(facing), 1.0);\n}\n",
            },
            Example {
                name: "draw.cpp",
                text: "void setUp()\n{\n  GLuint program = load(\"shell.vert\", \"shell.geom\", \"shell.frag\");\n}\n",
            },
        ],
        fix: "There is no fix: the geometry stage needs an input array and an output of another name, and the fragment stage that name.",
        references: &[
            "OpenGL Shading Language 1.50, section 4.3.4 (Inputs): inputs of a stage are outputs of the stage before",
        ],
        ja: Japanese {
            summary: "フラグメントシェーダの入力を頂点シェーダが書いていますが、間のジオメトリシェーダが書いていません",
            what: "ジオメトリシェーダのあるプログラムで、頂点シェーダは書くがジオメトリシェーダが渡していないフラグメントシェーダの入力を報告します。",
            why: "ジオメトリシェーダは新しい頂点を作ります。そこで書かれない値はフラグメントに届きません。プログラムはリンクできないか、値が不定になります。",
            fix: "no fix（修正なし）: ジオメトリシェーダに入力の配列と別の名前の出力が要り、フラグメントシェーダもその名前にする必要があります。",
        },
    },
    check: Check::Program(check),
};

fn check(program: &Program<'_>, _project: &Project, findings: &mut Findings<'_>) {
    if program.how_known() == Known::Name {
        return;
    }
    for (from, to) in program.links() {
        if from.shader.stage() != Stage::Geometry || to.shader.stage() != Stage::Fragment {
            continue;
        }
        let earlier =
            program.shaders().iter().filter(|s| !matches!(s.shader.stage(), Stage::Geometry | Stage::Fragment));
        let earlier: Vec<_> = earlier.collect();
        for input in &to.shader.interface().inputs {
            let handed_on = producer(from, to, input).is_some() || in_block(from, Storage::Out, &input.name);
            if handed_on || is_built_in(&input.name) || !is_used(to, input) {
                continue;
            }
            let Some((shader, output)) =
                earlier.iter().find_map(|s| s.shader.interface().output(&input.name).map(|o| (s, o)))
            else {
                continue;
            };
            let (name, place) = (&input.name, from.file.name());
            findings.push(
                findings
                    .at(
                        &to.file,
                        input.name_span,
                        message!(
                            "`{name}` does not pass the geometry stage",
                            "`{name}` はジオメトリシェーダを通りません"
                        ),
                    )
                    .with_label(message!("not written by {place}", "{place} が書いていません"))
                    .with_related(&shader.file, output.name_span, message!("written here", "ここで書かれます"))
                    .with_why(message!(
                        "a geometry stage makes new vertices, and only its own outputs reach the fragments",
                        "ジオメトリシェーダは新しい頂点を作り、その出力だけがフラグメントに届きます"
                    ))
                    .with_help(message!(
                        "read `{name}` as an array in {place}, and write it to an output of another name",
                        "{place} で `{name}` を配列として読み、別の名前の出力に書いてください"
                    )),
            );
        }
    }
}
