//! The lint tool: rules over shaders and over the C and C++ code that feeds them.
//!
//! [`run`] is pure: it takes texts and gives diagnostics. Reading files, writing repaired ones and
//! drawing messages is the work of `cli` and `report`.

mod config;
pub mod fix;
mod flow;
mod glsl;
mod host;
mod project;
mod registry;
mod rule;
mod select;
#[cfg(test)]
mod tests;

pub use config::{Config, ProgramEntry, Range, Wrapped, Wrapper};
pub use project::{HOST_EXTENSIONS, Input, Language, SHADER_EXTENSIONS, companions, language_of};
pub use registry::{RULES, by_code, nearest_codes};
pub use rule::{Example, Japanese, Level, Page, Rule};
pub use select::{SelectError, Selection};

use crate::diagnostic::Diagnostic;
use project::Project;

/// Lints `files` with every rule. The diagnostics of inputs that are only context are left out.
///
/// Sorted by file (in the order of their names), place and code; each defect is told once.
pub fn run(files: &[Input]) -> Vec<Diagnostic> {
    run_with(files, &Settings::default())
}

/// What a run is told besides the files.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Which rules run.
    pub selection: Selection,
    /// What the project says about itself.
    pub config: Config,
}

/// Lints `files` with the rules that the settings keep. Errors of the front end (`E` codes) obey the
/// selection like rules do.
pub fn run_with(files: &[Input], settings: &Settings) -> Vec<Diagnostic> {
    run_rules(files, settings, RULES)
}

/// As [`run_with`], with the rules given: tests plant rules of their own.
fn run_rules(files: &[Input], settings: &Settings, rules: &[&'static Rule]) -> Vec<Diagnostic> {
    let project = Project::new(files, &settings.config);
    // What the front end tells with the code of a rule goes through that rule.
    let plain = |d: &&Diagnostic| !rules.iter().any(|r| r.code == d.code);
    let mut found: Vec<Diagnostic> =
        project.shaders().filter(|s| s.reported).flat_map(|s| s.front_end.iter().filter(plain).cloned()).collect();
    for rule in rules {
        rule.check(&project, &mut found);
    }
    found.retain(|d| settings.selection.keeps(d.code.0, level_of(rules, d)));
    found.sort_by(|a, b| {
        let key = |d: &Diagnostic| (d.file.name().to_owned(), d.span, d.code);
        key(a).cmp(&key(b)).then_with(|| a.message.cmp(&b.message))
    });
    found.dedup_by(|a, b| a.code == b.code && a.span == b.span && a.file.name() == b.file.name());
    found
}

fn level_of(rules: &[&'static Rule], diagnostic: &Diagnostic) -> Level {
    rules.iter().find(|r| r.code == diagnostic.code).map_or(Level::Default, |r| r.level)
}
