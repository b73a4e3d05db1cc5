//! I008: fragment outputs without locations.

use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use syntax::{Profile, Stage};

use super::link::is_built_in;
use super::{Known, Program};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I008"),
    name: "frag-output-locations",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "several fragment outputs, and nothing says which buffer each goes to",
    page: Page {
        what: "Reports fragment outputs without `layout(location = …)` in shaders that have several, when no host file of the run calls `glBindFragDataLocation`. Only programs that host code makes are looked at.",
        why: "The linker gives the numbers, in an order that the specification leaves open. On another driver the colours go to other buffers.",
        bad: &[
            Example {
                name: "lamp.vert",
                text: "#version 330 core\nin vec4 position;\nin vec3 normal;\nuniform mat4 mc;\nout vec3 n;\nvoid main(void)\n{\n  n = normal;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 330 core\nin vec3 n;\nout vec4 color;\nout vec4 facing;\nvoid main(void)\n{\n  color = vec4(1.0);\n  facing = vec4(normalize(n), 1.0);\n}\n",
            },
            Example {
                name: "draw.cpp",
                text: "void setUp()\n{\n  GLuint program = load(\"lamp.vert\", \"lamp.frag\");\n}\n",
            },
        ],
        good: &[
            Example {
                name: "lamp.vert",
                text: "#version 330 core\nin vec4 position;\nin vec3 normal;\nuniform mat4 mc;\nout vec3 n;\nvoid main(void)\n{\n  n = normal;\n  gl_Position = mc * position;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 330 core\nin vec3 n;\nlayout(location = 0) out vec4 color;\nlayout(location = 1) out vec4 facing;\nvoid main(void)\n{\n  color = vec4(1.0);\n  facing = vec4(normalize(n), 1.0);\n}\n",
            },
            Example {
                name: "draw.cpp",
                text: "void setUp()\n{\n  GLuint program = load(\"lamp.vert\", \"lamp.frag\");\n}\n",
            },
        ],
        fix: "Numbers the outputs in the order of the text, from version 3.30 on. Unsafe: another order may be meant.",
        references: &[
            "OpenGL 3.3 core specification, section 3.9.2 (Shader Execution, Shader Outputs): locations without binding are assigned by the linker",
        ],
        ja: Japanese {
            summary: "フラグメントの出力が複数あり、どのバッファに書くかが決まっていません",
            what: "出力が複数あるフラグメントシェーダのうち、`layout(location = …)` のない出力を報告します。ホストのファイルが `glBindFragDataLocation` を呼ばない場合に限ります。ホストのコードが作るプログラムだけを調べます。",
            why: "番号はリンク時に決まり、その順は仕様で定められていません。別のドライバでは色が別のバッファに書かれます。",
            fix: "3.30 以降では、書かれている順に番号を付けます。別の順のつもりかもしれないので unsafe です。",
        },
    },
    check: Check::Program(check),
};

fn check(program: &Program<'_>, project: &Project, findings: &mut Findings<'_>) {
    let Some(shader) = program.stage(Stage::Fragment).filter(|_| program.how_known() == Known::Host) else { return };
    let outputs: Vec<_> = shader.shader.interface().outputs.iter().filter(|v| !is_built_in(&v.name)).collect();
    let open: Vec<_> = outputs.iter().filter(|v| v.qualifiers.layout_entry("location").is_none()).collect();
    let bound = || project.hosts().any(|h| h.file.text().contains("FragDataLocation"));
    let [first, second, ..] = outputs.as_slice() else { return };
    if open.is_empty() || bound() {
        return;
    }
    let (a, b, count) = (&first.name, &second.name, outputs.len());
    let mut found = findings
        .at(
            &shader.file,
            open[0].name_span,
            message!(
                "{count} outputs, and nothing says which buffer each goes to",
                "出力が {count} 個ありますが、それぞれどのバッファに書くかが決まっていません"
            ),
        )
        .with_label(message!("has no location", "location がありません"))
        .with_why(message!(
            "the linker is free to give `{a}` the number 1 and `{b}` the number 0",
            "リンカは `{a}` を 1 番、`{b}` を 0 番にしてもかまいません"
        ))
        .with_help(message!(
            "write `layout(location = 0)` and so on, or call glBindFragDataLocation before linking",
            "`layout(location = 0)` のように書くか、リンクの前に glBindFragDataLocation を呼んでください"
        ));
    let whole = open.len() == outputs.len() && outputs.iter().all(|v| v.siblings == 1 && v.ty.components().is_some());
    let version = shader.shader.version();
    if whole && version.number >= 330 && version.profile != Profile::Es {
        let edits = outputs.iter().enumerate().filter_map(|(i, v)| {
            let start = v.qualifiers.span()?.start;
            Some(Edit::insert(start, format!("layout(location = {i}) ")))
        });
        found = found.with_fix(message!("number the outputs", "出力に番号を付ける"), Safety::Unsafe, edits.collect());
    }
    findings.push(found);
}
