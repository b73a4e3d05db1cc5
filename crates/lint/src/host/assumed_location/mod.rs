//! H015: a location that nothing fixes.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use hosts::HostFile;
use hosts::cpp::index::Index;
use hosts::cpp::program::{ProgramSource, whole};
use hosts::cpp::tree::{arguments, bare, callee, span};
use hosts::setter::Setter;
use hosts::suggest::{list, list_in_japanese};
use reading::Project;
use reading::program::resolve;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H015"),
    name: "assumed-location",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    if !host.file.text().contains("glUniform") {
        return;
    }
    let Some(index) = Index::new(host) else { return };
    let source = whole(&index);
    if !matches!(source, ProgramSource::Named(_)) {
        return;
    }
    let Some(program) = resolve(host, project, &source).filter(|p| p.is_complete()) else { return };
    let uniforms = || program.shaders().iter().flat_map(|s| &s.shader.interface().uniforms);
    if uniforms().any(|u| u.qualifiers.layout_entry("location").is_some()) {
        return;
    }
    for &call in &index.calls {
        let sets = callee(call, &host.file)
            .is_some_and(|(f, _)| f.starts_with("glUniform") && Setter::of_function(f).is_some());
        let Some(place) = arguments(call).first().map(|a| span(bare(*a))).filter(|_| sets) else { continue };
        let number = host.file.slice(place);
        if number.parse::<u32>().is_err() {
            continue;
        }
        let mut names: Vec<&str> = program.uniforms().collect();
        names.sort_unstable();
        names.dedup();
        let (en, ja) = (list(&names), list_in_japanese(&names));
        findings.push(
            findings
                .at(
                    &host.file,
                    place,
                    message!(
                        "nothing says which uniform has the location {number}",
                        "位置 {number} がどの uniform のものかは定められていません"
                    ),
                )
                .with_label(message!("assumed", "仮定した位置"))
                .with_why(message!(
                    "the linker gives the locations, and another driver gives others",
                    "位置はリンク時に決まり、ドライバが違えば番号も違います"
                ))
                .with_help(message!(
                    "ask glGetUniformLocation for one of {en}",
                    "{ja} のどれかの位置を glGetUniformLocation で求めてください"
                )),
        );
    }
}
