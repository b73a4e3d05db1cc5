//! The fix engine: applies fixes until nothing is left to fix. Pure, as the rest of `lint`.

use std::collections::BTreeSet;

use base::diagnostic::{Diagnostic, Safety};
use base::text::{EditList, SourceFile};

use super::registry::{RULES, with_name};
use super::rule::Rule;
use super::{Settings, run_rules};
use hosts::Embedded;
use hosts::script::Script;
use hosts::sections::sections;
use hosts::{HostFile, Literal};
use hosts::{Language, language_of_file};
use reading::Input;
use syntax::Stage;

/// Rounds after which the engine gives up: fixes that undo each other would go on for ever.
pub const MOST_ROUNDS: usize = 20;

/// A file that fixes changed.
#[derive(Clone, Debug)]
pub struct FixedFile {
    /// The text before.
    pub before: SourceFile,
    /// The text after.
    pub after: SourceFile,
}

/// A fix that was not applied.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// Code of the rule.
    pub code: &'static str,
    /// Place of the diagnostic, as `file:line:column`, in the text that was to be changed.
    pub place: String,
    /// What the fix would have done.
    pub title: String,
    /// Why it was refused.
    pub reason: String,
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: fix of {} not applied ({}): {}", self.place, with_name(self.code), self.title, self.reason)
    }
}

/// What the engine did.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The files that changed, in the order of the inputs.
    pub files: Vec<FixedFile>,
    /// Number of fixes applied.
    pub applied: usize,
    /// Fixes that were refused.
    pub refused: Vec<Refusal>,
    /// What there is to tell about the texts after.
    pub remaining: Vec<Diagnostic>,
}

impl Outcome {
    /// How many of the remaining diagnostics have a fix of this safety.
    pub fn fixable(&self, safety: Safety) -> usize {
        self.remaining.iter().filter(|d| d.fix.as_ref().is_some_and(|f| f.safety == safety)).count()
    }
}

/// Applies the fixes of all diagnostics that `settings` keep, up to the given safety.
///
/// Each round applies fixes that do not overlap; what they uncover comes in the next round. A fix
/// after which its file parses worse than before is refused.
pub fn fix(files: &[Input], settings: &Settings, up_to: Safety) -> Outcome {
    fix_with(files, settings, up_to, RULES)
}

pub(super) fn fix_with(files: &[Input], settings: &Settings, up_to: Safety, rules: &[&'static Rule]) -> Outcome {
    let mut now: Vec<Input> = files.to_vec();
    let mut refused = Refused::default();
    let mut applied = 0;
    let mut remaining = run_rules(&now, settings, rules);
    for round in 1.. {
        let mut changed = 0;
        for input in now.iter_mut().filter(|i| i.reported) {
            let wanted: Vec<&Diagnostic> = remaining
                .iter()
                .filter(|d| d.file.name() == input.file.name())
                .filter(|d| d.fix.as_ref().is_some_and(|f| f.safety <= up_to && !f.edits.is_empty()))
                .filter(|d| !refused.knows(d))
                .collect();
            if round > MOST_ROUNDS {
                wanted.iter().for_each(|d| {
                    refused.add(d, format!("fixes did not come to an end in {MOST_ROUNDS} rounds"));
                });
                continue;
            }
            let (text, count) = apply(&input.file, &wanted, &mut refused);
            if count > 0 {
                *input = input.with_file(SourceFile::new(input.file.name(), text));
                changed += count;
            }
        }
        if changed == 0 {
            break;
        }
        applied += changed;
        remaining = run_rules(&now, settings, rules);
    }
    let files = files
        .iter()
        .zip(&now)
        .filter(|(before, after)| before.file.text() != after.file.text())
        .map(|(before, after)| FixedFile { before: before.file.clone(), after: after.file.clone() })
        .collect();
    Outcome { files, applied, refused: refused.list, remaining }
}

/// Applies as many of the fixes as go together; gives the text and their number.
fn apply(file: &SourceFile, wanted: &[&Diagnostic], refused: &mut Refused) -> (String, usize) {
    let mut edits = EditList::new();
    let mut taken: Vec<&Diagnostic> = Vec::new();
    let mut text = file.text().to_owned();
    for diagnostic in wanted {
        let Some(fix) = &diagnostic.fix else { continue };
        let mut alone = EditList::new();
        let mut together = edits.clone();
        let overlaps = fix.edits.iter().any(|e| edits.edits().iter().any(|t| touch(e.span, t.span)));
        for edit in &fix.edits {
            alone.push(edit.clone());
            together.push(edit.clone());
        }
        if let Err(conflict) = alone.apply(file.text()) {
            refused.add(diagnostic, conflict.to_string());
            continue;
        }
        // One that overlaps waits for the next round, when it is made anew for the new text.
        if overlaps {
            continue;
        }
        if let Ok(edited) = together.apply(file.text()) {
            edits = together;
            text = edited.text;
            taken.push(diagnostic);
        }
    }
    if taken.is_empty() || faults(file.name(), &text) <= faults(file.name(), file.text()) {
        return (text, taken.len());
    }
    one_by_one(file, &taken, refused)
}

/// Applies the fixes one after the other and refuses those that make the text parse worse.
fn one_by_one(file: &SourceFile, wanted: &[&Diagnostic], refused: &mut Refused) -> (String, usize) {
    let mut edits = EditList::new();
    let mut text = file.text().to_owned();
    let mut count = 0;
    for diagnostic in wanted {
        let mut together = edits.clone();
        diagnostic.fix.iter().flat_map(|f| &f.edits).for_each(|e| together.push(e.clone()));
        match together.apply(file.text()) {
            Ok(edited) if faults(file.name(), &edited.text) <= faults(file.name(), &text) => {
                (edits, text) = (together, edited.text);
                count += 1;
            }
            Ok(_) => refused.add(diagnostic, "the text would not parse any more".to_owned()),
            Err(conflict) => refused.add(diagnostic, conflict.to_string()),
        }
    }
    (text, count)
}

/// True when edits of these spans in one round could disturb each other.
fn touch(a: base::text::Span, b: base::text::Span) -> bool {
    a.start < b.end && b.start < a.end || a.start == b.start
}

/// How many faults the parser of a file's language finds.
fn faults(name: &str, text: &str) -> usize {
    let file = SourceFile::new(name, text);
    match language_of_file(&file) {
        Some(Language::Shader(stage)) => {
            let parts = sections(&file);
            if parts.is_empty() {
                return syntax::Shader::parse(&file, stage).diagnostics.len();
            }
            let faults = |(stage, part): (Stage, Literal)| {
                syntax::Shader::parse(&SourceFile::new(name, part.text), stage).diagnostics.len()
            };
            parts.into_iter().map(faults).sum()
        }
        Some(Language::Wgsl) => syntax::Shader::parse_wgsl(&file).diagnostics.len(),
        Some(Language::Host) => {
            let host = HostFile::new(&file, true);
            let shaders = host.embedded().iter().map(|e| {
                let text = SourceFile::new(e.name.as_str(), e.literal.text.as_str());
                syntax::Shader::parse(&text, e.stage).diagnostics.len()
            });
            host.error_count().saturating_add(shaders.sum())
        }
        Some(Language::Script) => {
            let faults =
                |f: Embedded| syntax::Shader::parse(&SourceFile::new(name, f.literal.text), f.stage).diagnostics.len();
            Script::read(&file).shaders.into_iter().map(faults).sum()
        }
        None => {
            let read = hosts::document::Document::read(&file).unwrap_or_default();
            let shader = |l: &hosts::document::Listing| {
                let text = SourceFile::new(l.name.as_str(), l.literal.text.as_str());
                syntax::Shader::parse(&text, l.stage).diagnostics.len()
            };
            let host = |l: &hosts::document::Listing| {
                HostFile::new(&SourceFile::new(l.name.as_str(), l.literal.text.as_str()), true).error_count()
            };
            read.shaders.iter().map(shader).sum::<usize>().saturating_add(read.hosts.iter().map(host).sum())
        }
    }
}

/// Refused fixes, each told once although it is found again in every round.
#[derive(Default)]
struct Refused {
    known: BTreeSet<(&'static str, String, String, String)>,
    list: Vec<Refusal>,
}

impl Refused {
    /// Places move when other fixes are applied: the text of the line stands for the place.
    fn key(diagnostic: &Diagnostic) -> (&'static str, String, String, String) {
        let file = &diagnostic.file;
        let line = file.line_text(file.position(diagnostic.span.start).line).to_owned();
        (diagnostic.code.0, file.name().to_owned(), line, diagnostic.message.to_string())
    }

    fn knows(&self, diagnostic: &Diagnostic) -> bool {
        self.known.contains(&Self::key(diagnostic))
    }

    fn add(&mut self, diagnostic: &Diagnostic, reason: String) {
        if self.known.insert(Self::key(diagnostic)) {
            self.list.push(Refusal {
                code: diagnostic.code.0,
                place: diagnostic.file.locate(diagnostic.span.start),
                title: diagnostic.fix.as_ref().map_or_else(String::new, |f| f.title.to_string()),
                reason,
            });
        }
    }
}
