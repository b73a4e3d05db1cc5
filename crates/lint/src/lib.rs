//! The lint tool: rules over shaders and over the C and C++ code that feeds them.
//!
//! [`run`] is pure: it takes texts and gives diagnostics. Reading files, writing repaired ones and
//! drawing messages is the work of `cli` and `report`.

pub mod baseline;
pub mod fix;
mod glsl;
mod host;
mod page;
mod program;
mod registry;
mod rule;
mod select;
mod suppress;
#[cfg(test)]
mod tests;
mod wgsl;

pub use page::{Example, Pages};
pub use reading::{Config, Input, Level};
pub use registry::{RULES, by_code, nearest, with_name};
pub use rule::Rule;
pub use select::{PerFile, SelectError, Selection};

use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::atomic::{AtomicBool, Ordering};

use base::diagnostic::{Code, Diagnostic, Fix, Severity};
use base::text::{SourceFile, Span};
use rayon::prelude::*;

use reading::in_front::Fronts;
use reading::{Project, ShaderFile};
use reading::{composed, included, open, options, relocate, variants};
use suppress::Suppressions;
use syntax::errors::{self, Around};

/// Lints `files` with every rule. The diagnostics of inputs that are only context are left out.
///
/// Sorted by file (in the order of their names), place and code; each defect is told once.
pub fn run(files: &[Input]) -> Vec<Diagnostic> {
    run_with(files, &Settings::default())
}

/// What a run is told besides the files.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Which rules run.
    pub selection: Selection,
    /// Rules that are left out for single files.
    pub per_file: PerFile,
    /// What the project says about itself.
    pub config: Config,
    /// Shaders are read with the options that they state set otherwise as well.
    pub options: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { selection: Selection::default(), per_file: PerFile::default(), config: Config::default(), options: true }
    }
}

impl Settings {
    /// True when diagnostics with `code`, of a rule of this level, are wanted for the file of this name.
    pub fn keeps(&self, file: &str, code: &str, level: Level) -> bool {
        self.selection.keeps(code, level) && !self.per_file.ignores(file, code)
    }
}

/// Lints `files` with the rules that the settings keep. Errors of the front end (`E` codes) obey the
/// selection like rules do.
pub fn run_with(files: &[Input], settings: &Settings) -> Vec<Diagnostic> {
    run_rules(files, settings, RULES)
}

/// As [`run_with`], and gives up soon after `stop` has become true: none then.
pub fn run_until(files: &[Input], settings: &Settings, stop: &AtomicBool) -> Option<Vec<Diagnostic>> {
    run_rules_until(files, settings, RULES, stop)
}

/// As [`run_with`], with the rules given: tests plant rules of their own.
fn run_rules(files: &[Input], settings: &Settings, rules: &[&'static Rule]) -> Vec<Diagnostic> {
    run_rules_until(files, settings, rules, &AtomicBool::new(false)).unwrap_or_default()
}

fn run_rules_until(
    files: &[Input],
    settings: &Settings,
    rules: &[&'static Rule],
    stop: &AtomicBool,
) -> Option<Vec<Diagnostic>> {
    let project = Project::new(files, &settings.config);
    // What the front end tells with the code of a rule of its own goes through that rule.
    let completed = |d: &Diagnostic| rules.iter().any(|r| r.code == d.code && r.completes_the_front_end());
    let plain = |d: &&Diagnostic| !rules.iter().any(|r| r.code == d.code);
    let mut all: Vec<(Level, Diagnostic)> = project
        .shaders()
        .filter(|s| s.reported)
        .flat_map(|s| {
            let own = s.front_end.iter().filter(plain).filter(|d| !(d.code == errors::INCLUDE && s.has_includes()));
            own.map(|d| (front_end_level(&project, s, d), d.clone()))
        })
        .collect();
    let asked = project.shaders().filter(|s| s.reported).flat_map(|s| &s.on_request);
    all.extend(asked.map(|d| (Level::Strict, d.clone())));
    let in_variants = |shader: &ShaderFile| {
        let found = if shader.conditional { variants::errors(&shader.shader) } else { Vec::new() };
        let level = |certain, d: &Diagnostic| match certain && !shader.may_be_of_another_host(d) {
            true => Level::Default,
            false => Level::Strict,
        };
        found.into_iter().map(|(certain, d)| (level(certain, &d), d)).collect::<Vec<_>>()
    };
    let reported: Vec<&ShaderFile> = project.shaders().filter(|s| s.reported).collect();
    all.par_extend(reported.par_iter().flat_map_iter(|shader| in_variants(shader)));
    if settings.options {
        all.extend(options::errors(reported.iter().copied(), &settings.config, stop));
    }
    let programs = project.programs();
    // A rule that is not asked for is of use only where the front end tells its code.
    let of_use = |rule: &&'static Rule| {
        settings.selection.keeps(rule.code.0, rule.level)
            || project.shaders().any(|s| s.front_end.iter().any(|d| d.code == rule.code))
    };
    let wanted: Vec<&'static Rule> = rules.iter().copied().filter(of_use).collect();
    Rule::check_all(&wanted, &project, &programs, stop, &mut all);
    // What a part of the rules found is no answer.
    if stop.load(Ordering::Relaxed) {
        return None;
    }
    // A rule that looks for itself may find at any level what some versions of the language refuse.
    for shader in project.shaders().filter(|s| s.reported) {
        for error in shader.front_end.iter().filter(|d| !plain(d) && !completed(d)) {
            let same = |d: &Diagnostic| d.code == error.code && d.file == error.file && d.span.touches(error.span);
            match all.iter_mut().find(|(_, d)| same(d)) {
                Some((level, found)) => (*level, found.severity) = (Level::Default, Severity::Error),
                None => all.push((Level::Default, error.clone())),
            }
        }
    }
    leave_doubtful_to_strict(&project, &mut all);
    for (_, diagnostic) in &mut all {
        let cut = |fix: &Fix| fix.edits.iter().any(|edit| diagnostic.file.cuts_expansion(edit.span));
        if diagnostic.fix.as_ref().is_some_and(cut) {
            diagnostic.fix = None;
        }
        *diagnostic = diagnostic.clone().in_expansion();
    }
    included::tell_in_included(&project, &mut all);
    composed::to_origin(&project, &mut all);
    composed::to_templates(&project, &mut all);
    composed::add_refused(&project, &mut all, &registry::LET_THROUGH);
    // What the host puts around a text is not the author's.
    let around: HashMap<&str, &ShaderFile> =
        project.shaders().filter(|s| s.has_prelude()).map(|s| (s.file.name(), s)).collect();
    let is_around = |file: &SourceFile, at: Span| around.get(file.name()).is_some_and(|s| s.is_in_front(at));
    all.retain(|(_, d)| !is_around(&d.file, d.span));
    for (_, diagnostic) in &mut all {
        diagnostic.related.retain(|label| !is_around(&label.file, label.span));
    }
    let partial: BTreeSet<&str> =
        project.shaders().filter(|s| s.partial && s.place.is_some()).map(|s| s.file.name()).collect();
    all.retain(|(_, d)| !partial.contains(d.file.name()) || open::holds_anywhere(d.code));
    relocate::relocate(&project, all.iter_mut().map(|(_, d)| d));
    all.retain(|(level, d)| settings.keeps(d.file.name(), d.code.0, *level));
    let mut found: Vec<Diagnostic> = all.into_iter().map(|(_, d)| d).collect();
    let mut suppressions = Suppressions::of(&project, rules);
    found.retain(|d| !suppressions.silences(d));
    suppressions.judge(|file, code| settings.keeps(file, code, level_of(rules, code)));
    let mut after = Vec::new();
    for rule in rules {
        rule.check_after(&suppressions, &mut after);
    }
    after.retain(|(level, d)| settings.keeps(d.file.name(), d.code.0, *level));
    found.extend(after.into_iter().map(|(_, d)| d));
    sort(&mut found);
    found.dedup_by(|a, b| a.code == b.code && a.span == b.span && a.file.name() == b.file.name());
    Some(found)
}

/// Errors that the host may take away by what it puts around a text are told on request.
fn leave_doubtful_to_strict(project: &Project, told: &mut [(Level, Diagnostic)]) {
    // Parts of one file for the same stage have one name.
    let mut shaders: HashMap<&str, Vec<&ShaderFile>> = HashMap::new();
    project.shaders().for_each(|s| shaders.entry(s.file.name()).or_default().push(s));
    let mut fronts: Option<Fronts> = None;
    let supplied = open::supplied(project);
    let marks = open::repeated_marks(project);
    let rewritten: HashSet<&str> = project.shaders().filter(|s| marks.are_in(s)).map(|s| s.file.name()).collect();
    let mut replaced: Option<HashSet<&str>> = None;
    let mut words: Option<HashSet<&str>> = None;
    for (level, error) in told.iter_mut().filter(|(level, _)| *level == Level::Default) {
        let rests = |s: &&ShaderFile| s.rests_on_what_is_taken(error.span);
        if shaders.get(error.file.name()).is_some_and(|all| all.iter().any(rests)) {
            *level = Level::Strict;
            continue;
        }
        let stands = |s: &&&ShaderFile| s.front_end.iter().any(|d| d.code == error.code && d.span == error.span);
        let Some(shader) = shaders.get(error.file.name()).and_then(|all| all.iter().find(stands)) else { continue };
        // Projects keep shaders of several languages under the endings of one.
        if error.code == errors::OTHER_LANGUAGE && !shader.named {
            *level = Level::Strict;
            continue;
        }
        let about_a_name = open::is_about_a_name(error);
        let may_be_supplied = || supplied.may_be(error);
        let doubtful = || shader.is_doubtful(error) || rewritten.contains(error.file.name());
        let of_host = || open::is_of_host(project, &shader.shader, error);
        let mut in_front =
            || Fronts::concern(error) && fronts.get_or_insert_with(|| Fronts::of(project)).may_take_away(shader, error);
        let mut in_replaced =
            || replaced.get_or_insert_with(|| open::with_replaced_comments(project)).contains(error.file.name());
        let mut at_word =
            || open::is_at_replaced_word(error, words.get_or_insert_with(|| open::replaced_words(project)));
        if at_word() || doubtful() || (about_a_name && (may_be_supplied() || of_host())) || in_front() || in_replaced()
        {
            *level = Level::Strict;
        }
    }
}

/// Hosts put macros in front of a text: a name in capitals that nothing declares is told on request, unless it is a slip.
fn front_end_level(project: &Project, shader: &ShaderFile, error: &Diagnostic) -> Level {
    let name = error.file.slice(error.span);
    // A shader in a literal is itself a part of its host file: only what stands beside it can be put in front.
    let count = |text: &str| text.matches(name).count();
    let beside = || project.hosts().any(|h| count(h.file.text()) > count(error.file.text()));
    let of_macro = open::rests(error).contains(Around::NAMES | Around::VALUES) && syntax::is_macro(name);
    if of_macro && (shader.origin.is_none() || beside()) && !open::is_slip_of_macro(&shader.shader, name) {
        Level::Strict
    } else {
        Level::Default
    }
}

/// Codes of the errors that the front end gives by itself, with what they are about.
pub fn front_end_errors() -> impl ExactSizeIterator<Item = (Code, &'static str)> {
    errors::all()
}

/// Brings diagnostics into the order of their files' names, places and codes.
pub fn sort(found: &mut [Diagnostic]) {
    found.sort_by(|a, b| {
        let key = |d: &Diagnostic| (d.span, d.code);
        a.file.name().cmp(b.file.name()).then_with(|| key(a).cmp(&key(b))).then_with(|| a.message.cmp(&b.message))
    });
}

fn level_of(rules: &[&'static Rule], code: &str) -> Level {
    rules.iter().find(|r| r.code.0 == code).map_or(Level::Default, |r| r.level)
}
