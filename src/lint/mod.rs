//! The lint tool: rules over shaders and over the C and C++ code that feeds them.
//!
//! [`run`] is pure: it takes texts and gives diagnostics. Reading files, writing repaired ones and
//! drawing messages is the work of `cli` and `report`.

pub mod fix;
mod glsl;
mod host;
mod project;
mod registry;
mod rule;
mod select;
#[cfg(test)]
mod tests;

pub use project::{HOST_EXTENSIONS, Input, Language, SHADER_EXTENSIONS, companions, language_of};
pub use registry::{RULES, by_code, nearest_codes};
pub use rule::{Example, Page, Rule};
pub use select::{SelectError, Selection};

use crate::diagnostic::Diagnostic;
use project::Project;

/// Lints `files` with every rule. The diagnostics of inputs that are only context are left out.
///
/// Sorted by file (in the order of their names), place and code; each defect is told once.
pub fn run(files: &[Input]) -> Vec<Diagnostic> {
    run_selected(files, &Selection::default())
}

/// Lints `files` with the rules that `selection` keeps. Errors of the front end (`E` codes) obey the
/// selection like rules do.
pub fn run_selected(files: &[Input], selection: &Selection) -> Vec<Diagnostic> {
    run_rules(files, selection, RULES)
}

/// As [`run_selected`], with the rules given: tests plant rules of their own.
fn run_rules(files: &[Input], selection: &Selection, rules: &[&'static Rule]) -> Vec<Diagnostic> {
    let project = Project::new(files);
    let mut found: Vec<Diagnostic> =
        project.shaders().filter(|s| s.reported).flat_map(|s| s.front_end.iter().cloned()).collect();
    for rule in rules {
        rule.check(&project, &mut found);
    }
    found.retain(|d| selection.keeps(d.code.0));
    found.sort_by(|a, b| {
        let key = |d: &Diagnostic| (d.file.name().to_owned(), d.span, d.code);
        key(a).cmp(&key(b)).then_with(|| a.message.cmp(&b.message))
    });
    found.dedup_by(|a, b| a.code == b.code && a.span == b.span && a.file.name() == b.file.name());
    found
}
