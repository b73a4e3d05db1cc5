//! What a rule is: its names, its page of the manual, and its check.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use base::diagnostic::{Code, Diagnostic, Message, Severity};
use base::text::{SourceFile, Span};

pub use super::page::Pages;
use super::suppress::Suppressions;
use hosts::HostFile;
pub use reading::Level;
use reading::program::Program;
use reading::{Project, ShaderFile};
use syntax::wgsl::Module;

/// Rules on numbers that are lost as a whole at lower precision.
const LOSING: [&str; 2] = ["mediump-epsilon", "mediump-square"];

/// Rules that look at a shader one after the other, at least.
const RULES_IN_A_ROW: usize = 16;

/// One rule of the lint tool.
pub struct Rule {
    /// Stable code, for machines.
    pub code: Code,
    /// Name in kebab-case, for people.
    pub name: &'static str,
    /// Severity of what it reports.
    pub severity: Severity,
    /// From which level on it runs.
    pub level: Level,
    /// Its page of the manual.
    pub pages: Pages,
    /// What the check looks at, and its function.
    pub(super) check: Check,
}

/// What a rule looks at.
#[derive(Clone, Copy)]
pub(super) enum Check {
    /// One shader in GLSL at a time, as far as the front end could read it.
    Shader(fn(&ShaderFile, &mut Findings<'_>)),
    /// One shader in GLSL at a time, with what the project says about itself.
    ShaderWith(fn(&ShaderFile, &Project, &mut Findings<'_>)),
    /// One shader in any language at a time.
    Any(fn(&ShaderFile, &mut Findings<'_>)),
    /// One shader in any language at a time, with what the project says about itself.
    AnyWith(fn(&ShaderFile, &Project, &mut Findings<'_>)),
    /// One module in WGSL at a time.
    Wgsl(fn(&ShaderFile, &Module, &mut Findings<'_>)),
    /// Errors that the front end finds and tells with the code of this rule: each is handed over to be
    /// completed with a fix, or dropped when nothing comes back.
    FrontEnd(fn(&ShaderFile, Diagnostic) -> Option<Diagnostic>),
    /// One host file at a time, with the shaders that belong to it.
    Host(fn(&HostFile, &Project, &mut Findings<'_>)),
    /// What is left to say when all other rules have run and comments have silenced some of it.
    After(fn(&Suppressions, &mut Findings<'_>)),
    /// One program at a time: shaders that are linked together, of which at least one is reported.
    Program(fn(&Program<'_>, &Project, &mut Findings<'_>)),
    /// All files together, once.
    Project(fn(&Project, &mut Findings<'_>)),
    /// One text at a time, whatever its language: planted rules in tests.
    #[cfg(test)]
    Text(fn(&SourceFile, &mut Findings<'_>)),
}

impl Check {
    /// Looks at one shader, if the check is one of shaders in its language.
    fn on_shader(&self, shader: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
        match (self, shader.shader.wgsl()) {
            (Self::Shader(check), None) | (Self::Any(check), _) => check(shader, findings),
            (Self::ShaderWith(check), None) | (Self::AnyWith(check), _) => check(shader, project, findings),
            (Self::Wgsl(check), Some(module)) => check(shader, module, findings),
            _ => {}
        }
    }
}

impl Rule {
    /// True for its code and for its name. Letters may be small or capital, and `_` counts as `-`.
    pub(super) fn is_called(&self, given: &str) -> bool {
        self.code.0.eq_ignore_ascii_case(given) || self.name.eq_ignore_ascii_case(&given.replace('_', "-"))
    }

    /// Runs rules over the reported files of a project, on all cores. One shader after the other goes through all
    /// rules on shaders, so that what they work out for it can be forgotten again; of one shader alone, as an editor has
    /// it, several rules look at it side by side. The rest is left out once `stop` is
    /// true.
    pub(super) fn check_all(
        rules: &[&'static Self],
        project: &Project,
        programs: &[Program<'_>],
        stop: &AtomicBool,
        into: &mut Vec<(Level, Diagnostic)>,
    ) {
        let shaders: Vec<&ShaderFile> = project.shaders().filter(|s| s.reported).collect();
        into.par_extend(shaders.par_iter().flat_map_iter(|shader| {
            // Precisions are those of a phone, where it reads another text than a desktop.
            let es = rules.iter().any(|rule| rule.is_about_precisions()).then(|| shader.on_es()).flatten();
            let holds = |rule: &&&Self| shader.template.is_none() || rule.holds_for_templates();
            let on_it = rules.par_iter().with_min_len(RULES_IN_A_ROW).filter(holds).flat_map_iter(|rule| {
                let mut found = Vec::new();
                if !stop.load(Ordering::Relaxed) {
                    let read = es.as_ref().filter(|_| rule.is_about_precisions()).unwrap_or(shader);
                    rule.check.on_shader(read, project, &mut Findings { rule, into: &mut found });
                }
                found
            });
            let mut found: Vec<(Level, Diagnostic)> = on_it.collect();
            shader.forget();
            if stop.load(Ordering::Relaxed) {
                return found;
            }
            let (of_phones, others): (Vec<_>, Vec<_>) = rules
                .iter()
                .copied()
                .filter(|rule| rule.code.0.starts_with('N'))
                .partition(|rule| es.is_some() && rule.is_about_precisions());
            numbers_of_variants(&others, shader, project, &mut found);
            es.iter().for_each(|es| numbers_of_variants(&of_phones, es, project, &mut found));
            lost_without_highp(rules, shader, project, &mut found);
            under_conditions(rules, shader, project, &mut found);
            found
        }));
        for rule in rules.iter().take_while(|_| !stop.load(Ordering::Relaxed)) {
            rule.check(project, programs, into);
        }
    }

    /// Runs a rule on anything but single shaders.
    fn check(&'static self, project: &Project, programs: &[Program<'_>], into: &mut Vec<(Level, Diagnostic)>) {
        match self.check {
            Check::Shader(_)
            | Check::ShaderWith(_)
            | Check::Any(_)
            | Check::AnyWith(_)
            | Check::Wgsl(_)
            | Check::After(_) => {}
            Check::Host(check) => {
                let hosts: Vec<&HostFile> = project.hosts().filter(|h| h.reported && h.concerns_shaders()).collect();
                self.gather(&hosts, into, |host, findings| check(host, project, findings));
            }
            Check::Program(check) => {
                let wanted: Vec<&Program<'_>> =
                    programs.iter().filter(|p| p.shaders().iter().any(|s| s.reported)).collect();
                let silent: BTreeSet<&str> = project.shaders().filter(|s| !s.reported).map(|s| s.file.name()).collect();
                let mut found = Vec::new();
                self.gather(&wanted, &mut found, |program, findings| check(program, project, findings));
                into.extend(found.into_iter().filter(|(_, d): &(Level, Diagnostic)| !silent.contains(d.file.name())));
            }
            Check::Project(check) => {
                let mut found = Vec::new();
                check(project, &mut Findings { rule: self, into: &mut found });
                let reported: BTreeSet<&str> =
                    project.shaders().filter(|s| s.reported).map(|s| s.file.name()).collect();
                into.extend(found.into_iter().filter(|(_, d)| reported.contains(d.file.name())));
            }
            Check::FrontEnd(complete) => {
                for shader in project.shaders().filter(|s| s.reported) {
                    let own = shader.front_end.iter().filter(|d| d.code == self.code);
                    into.extend(own.filter_map(|d| complete(shader, d.clone())).map(|d| (self.level, d)));
                }
            }
            #[cfg(test)]
            Check::Text(check) => {
                let mut findings = Findings { rule: self, into };
                project.shaders().filter(|s| s.reported).for_each(|s| check(&s.file, &mut findings));
                project.hosts().filter(|h| h.reported).for_each(|h| check(&h.file, &mut findings));
            }
        }
    }
}

/// Runs the rules about numbers on lines that only a definition from outside makes a part of the shader: what such a
/// line computes is its own, whatever else the definition changes.
fn numbers_of_variants(
    rules: &[&'static Rule],
    shader: &ShaderFile,
    project: &Project,
    into: &mut Vec<(Level, Diagnostic)>,
) {
    if rules.is_empty() {
        return;
    }
    for (variant, fresh) in shader.variants() {
        let mut found = Vec::new();
        for rule in rules {
            let mut findings = Findings { rule, into: &mut found };
            rule.check.on_shader(&variant, project, &mut findings);
        }
        let starts: BTreeSet<usize> = fresh.iter().map(|s| s.start).collect();
        into.extend(found.into_iter().filter(|(_, d)| starts.contains(&d.span.start)));
    }
}

/// What holds in a module of which an engine leaves parts out, whichever it leaves out: it is found in each text that has the
/// place, and in one at least that asks for no more than one macro. What is not used may be used in another part.
fn under_conditions(
    rules: &[&'static Rule],
    shader: &ShaderFile,
    project: &Project,
    into: &mut Vec<(Level, Diagnostic)>,
) {
    let texts = shader.settled();
    let found: Vec<Vec<(Level, Diagnostic)>> = texts
        .iter()
        .map(|text| {
            let mut found: Vec<(Level, Diagnostic)> =
                text.misfits().map(|error| (Level::Default, error.clone())).collect();
            for rule in rules.iter().filter(|rule| !rule.code.0.starts_with('D')) {
                rule.check.on_shader(&text.shader, project, &mut Findings { rule, into: &mut found });
            }
            text.shader.forget();
            found
        })
        .collect();
    let file = shader.author.as_ref().unwrap_or(&shader.file);
    for (own, _) in found.iter().zip(&texts).filter(|(_, text)| !text.all) {
        for (level, diagnostic) in own {
            let same = |(_, d): &(Level, Diagnostic)| d.code == diagnostic.code && d.span == diagnostic.span;
            let holds = found.iter().zip(&texts).all(|(all, text)| !text.has(diagnostic.span) || all.iter().any(same));
            if !holds || into.iter().any(same) {
                continue;
            }
            // A repair may be none of the text with other parts.
            let mut told = Diagnostic { file: file.clone(), fix: None, ..diagnostic.clone() };
            told.related
                .iter_mut()
                .filter(|label| label.file.name() == file.name())
                .for_each(|l| l.file = file.clone());
            into.push((*level, told));
        }
    }
}

/// What a device loses that has no `highp` in fragment stages, for who asks: digits are fewer there anyway, but what overflows or
/// is 0 leaves nothing.
fn lost_without_highp(
    rules: &[&'static Rule],
    shader: &ShaderFile,
    project: &Project,
    into: &mut Vec<(Level, Diagnostic)>,
) {
    let losing: Vec<&&'static Rule> = rules.iter().filter(|rule| LOSING.contains(&rule.name)).collect();
    if losing.is_empty() {
        return;
    }
    let Some(without) = shader.without_highp() else { return };
    let mut found = Vec::new();
    for rule in losing {
        rule.check.on_shader(&without, project, &mut Findings { rule, into: &mut found });
    }
    for (_, mut diagnostic) in found {
        let known = |(_, d): &(Level, Diagnostic)| d.code == diagnostic.code && d.span == diagnostic.span;
        if !into.iter().any(known) {
            diagnostic.file = shader.shader.file().clone();
            into.push((Level::Strict, diagnostic));
        }
    }
}

impl Rule {
    /// True for a rule of GLSL that runs on WGSL as well.
    #[cfg(test)]
    pub(super) fn holds_for_wgsl(&self) -> bool {
        matches!(self.check, Check::Any(_) | Check::AnyWith(_))
    }

    /// True for a rule on numbers of lower precision, which only OpenGL ES has.
    fn is_about_precisions(&self) -> bool {
        self.name.starts_with("mediump-")
    }

    /// True for a rule on what a text says, and neither on what it lacks nor on values: of a template, one text of many is
    /// read, with numbers that stand for others.
    fn holds_for_templates(&self) -> bool {
        (self.code.0.starts_with('K') && self.code.0 != "K010") || self.code.0 == "N036"
    }

    /// True when it takes its findings from the front end.
    pub(super) fn completes_the_front_end(&self) -> bool {
        matches!(self.check, Check::FrontEnd(_))
    }

    /// Checks files side by side; what they give stands in the order of the files.
    fn gather<T: Sync>(
        &'static self,
        files: &[&T],
        into: &mut Vec<(Level, Diagnostic)>,
        check: impl Fn(&T, &mut Findings<'_>) + Sync,
    ) {
        let found = files.par_iter().flat_map_iter(|file| {
            let mut found = Vec::new();
            check(file, &mut Findings { rule: self, into: &mut found });
            found
        });
        into.par_extend(found);
    }

    /// Runs a rule that speaks of comments which silence others.
    pub(super) fn check_after(&'static self, suppressions: &Suppressions, into: &mut Vec<(Level, Diagnostic)>) {
        if let Check::After(check) = self.check {
            check(suppressions, &mut Findings { rule: self, into });
        }
    }
}

/// Where a check puts what it finds.
pub(super) struct Findings<'a> {
    rule: &'static Rule,
    into: &'a mut Vec<(Level, Diagnostic)>,
}

impl Findings<'_> {
    /// A diagnostic of this rule, to be completed and given to [`Findings::push`].
    pub fn at(&self, file: &SourceFile, span: Span, message: impl Into<Message>) -> Diagnostic {
        Diagnostic::new(self.rule.code, self.rule.severity, file, span, message)
    }

    /// Reports at the level of the rule.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.push_at(self.rule.level, diagnostic);
    }

    /// Reports from this level on: the same rule may know some cases for certain and guess at others.
    pub fn push_at(&mut self, level: Level, diagnostic: Diagnostic) {
        self.into.push((level, diagnostic));
    }
}
