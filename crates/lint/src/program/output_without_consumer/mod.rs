//! I003: an output that nobody reads.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::Project;
use syntax::interface::Storage;

use super::stage_in_japanese;
use reading::program::link::{consumer, in_block, input_type, is_built_in, is_patch, output_type, producer};
use reading::program::{Known, Program};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I003"),
    name: "output-without-consumer",
    severity: Severity::Info,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
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
