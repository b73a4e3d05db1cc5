//! I007: a value that does not pass the geometry stage.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::Project;
use syntax::Stage;
use syntax::interface::Storage;

use reading::program::link::{in_block, is_built_in, is_used, producer};
use reading::program::{Known, Program};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I007"),
    name: "geometry-bypass",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
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
