//! I008: fragment outputs without locations.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::Project;
use syntax::{Profile, Stage};

use reading::program::link::is_built_in;
use reading::program::{Known, Program};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I008"),
    name: "frag-output-locations",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
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
