//! Every variant that a text states of itself: what is wrong only where one of its options is set otherwise.
//!
//! An option is a line that defines a macro and that the author, or whoever plays with the shader, is meant to change: one
//! with the list of its values in a comment (`#define QUALITY 1 // [0 1 2]`), one that is commented out (`//#define GLOW`),
//! and one without a value that conditions ask for. A text that compiles as it stands is read with the options in rows
//! such that each value, and each pair of options that stand in one condition, occurs together; for an error the smallest
//! set of changed lines that shows it is looked for.

mod row;
mod smallest;
mod switch;
#[cfg(test)]
mod tests;

use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, Ordering};

use base::diagnostic::{Code, Diagnostic, Lang, Message, message};
use base::text::Span;
use rayon::prelude::*;
use syntax::errors::{self, Around};
use syntax::{Parsed, Readings, Seen, Setting, TokenPlace};

use crate::conditions::{self, Conditions};
use crate::open::{self, Surroundings};
use crate::{Config, Level, ShaderFile};
use hosts::sections::says_the_stage;
use switch::Switch;

/// Readings of one text at most.
const MOST_READINGS: usize = 200;

/// Errors that are told of one set of options: they have one cause.
const MOST_TOLD: usize = 3;

/// Macros that are tried in the place of one that is taken away.
const MOST_OTHERS: usize = 40;

/// Bytes of the longest text that is read in variants.
const LONGEST: usize = 1 << 18;

/// Errors of texts that have none as they stand, with their options set otherwise: each with the smallest set that shows it,
/// once. Gives up soon after `stop` has become true.
pub fn errors<'a>(
    files: impl Iterator<Item = &'a ShaderFile>,
    config: &'a Config,
    stop: &AtomicBool,
) -> Vec<(Level, Diagnostic)> {
    let files: Vec<&ShaderFile> = files.collect();
    let mut run = Run {
        config,
        in_order: Seen::default(),
        together: HashSet::new(),
        found: Vec::new(),
        told: HashSet::new(),
        defined: defined(&files),
    };
    for file in files.into_iter().take_while(|_| !stop.load(Ordering::Relaxed)) {
        run.file(file);
    }
    run.found
}

/// What the texts of a project have shown: most of them share what they include.
struct Run<'a> {
    /// What the project says of its options.
    config: &'a Config,
    /// What is compiled of readings in which nothing is wrong.
    in_order: Seen,
    /// Pairs of values that have stood together where a condition asks for both.
    together: HashSet<Vec<Setting>>,
    found: Vec<(Level, Diagnostic)>,
    /// Codes and places of what is found.
    told: HashSet<(Code, String, Span)>,
    /// Macros without a value that lines of texts define.
    defined: HashSet<&'a str>,
}

/// Macros that a line of a text defines without a value, and no comment: where another text has that line in a comment, what it
/// includes is told so which of the two it is in.
fn defined<'a>(files: &[&'a ShaderFile]) -> HashSet<&'a str> {
    let text = |file: &&'a ShaderFile| file.author.as_ref().unwrap_or(&file.file).text();
    let line = |line: &'a str| {
        let rest = line.trim_start().strip_prefix('#')?.trim_start().strip_prefix("define")?;
        rest.split("//").next().map(str::trim).filter(|name| !name.is_empty() && !name.contains([' ', '(', '\t']))
    };
    files.iter().flat_map(|file| text(file).lines().filter_map(line)).collect()
}

impl Run<'_> {
    fn file(&mut self, file: &ShaderFile) {
        let shader = &file.shader;
        let whole =
            shader.function("main").is_some() && !file.partial && file.front_end.iter().all(open::leaves_in_order);
        if !file.conditional || !whole || file.is_wgsl() || shader.file().text().len() > LONGEST {
            return;
        }
        let conditions = Conditions::of(shader);
        let mut switches = switch::of(shader, &conditions, &self.config.variants);
        // What a reader puts in front says the stage; what decides whether a program is compiled at all, the host asks first.
        let written = |switch: &Switch| switch.span.is_none_or(|span| file.is_written(span));
        let decides = |name: &str| self.config.asks_before(shader.file().name(), name);
        switches.retain(|switch| written(switch) && !says_the_stage(&switch.name) && !decides(&switch.name));
        if switches.is_empty() {
            return;
        }
        let rows = row::rows(&switches, &switch::pairs(shader, &switches), &mut self.together);
        let readings = Readings::of(shader);
        let read = |row: &Vec<Setting>| readings.read(row, &self.in_order);
        let first: Vec<Option<(u64, Parsed)>> = rows.par_iter().map(read).collect();
        let mut search = Search { file, readings, conditions, switches: &switches, left: MOST_READINGS, run: self };
        for (row, parsed) in rows.into_iter().zip(first) {
            search.row(row, parsed);
        }
    }

    /// True for an error that is new to the project, and that no macro of the host takes away.
    fn is_new(&self, error: &Diagnostic) -> bool {
        !open::leaves_in_order(error) && !self.told.contains(&key(error))
    }
}

/// What an error is, and where.
fn key(error: &Diagnostic) -> (Code, String, Span) {
    let (file, span) = error.file.origin(error.span);
    (error.code, file.name().to_owned(), span)
}

/// Readings of one text, and what they have shown.
struct Search<'a, 'r> {
    file: &'a ShaderFile,
    readings: Readings<'a>,
    conditions: Conditions,
    switches: &'a [Switch],
    left: usize,
    run: &'a mut Run<'r>,
}

impl Search<'_, '_> {
    /// The text with these settings, where something is wrong with it that is new; none where nothing is, and behind the last
    /// reading.
    fn read(&mut self, settings: &[Setting]) -> Option<Parsed> {
        self.left = self.left.checked_sub(1)?;
        let read = self.readings.read(settings, &self.run.in_order);
        self.judged(read)
    }

    fn judged(&self, read: Option<(u64, Parsed)>) -> Option<Parsed> {
        let (compiled, parsed) = read?;
        if parsed.diagnostics.iter().any(|d| is_refusal(d) || self.run.is_new(d)) {
            return Some(parsed);
        }
        // What is told already may stand at another place in a text that compiles to the same.
        if parsed.diagnostics.iter().all(open::leaves_in_order) {
            self.run.in_order.add(compiled);
        }
        None
    }

    /// Tells what a row of settings shows. Settings that the text refuses by itself are left out of it.
    fn row(&mut self, mut row: Vec<Setting>, read: Option<(u64, Parsed)>) {
        let mut parsed = self.judged(read);
        while let Some(Parsed { diagnostics, .. }) = parsed {
            let refused = diagnostics.iter().find(|d| is_refusal(d));
            let Some(error) = refused.or_else(|| diagnostics.iter().find(|d| self.run.is_new(d))) else { return };
            let Some(smallest) = self.smallest(&row, error) else { return };
            if refused.is_none() {
                self.tell(&smallest);
            }
            // What stays in order without them is looked at without them.
            row.retain(|setting| !smallest.contains(setting));
            parsed = self.read(&row);
        }
    }

    fn smallest(&mut self, row: &[Setting], error: &Diagnostic) -> Option<Vec<Setting>> {
        smallest::smallest(row, &mut |settings| {
            (self.left > 0).then_some(())?;
            Some(self.read(settings).is_some_and(|parsed| open::stands_in(&parsed.diagnostics, error)))
        })
    }

    /// Tells all errors of a reading with these settings.
    fn tell(&mut self, settings: &[Setting]) {
        let Some(parsed) = self.read(settings) else { return };
        if parsed.diagnostics.iter().any(is_refusal) {
            return;
        }
        let surroundings = Surroundings::of_whole(&parsed.shader, &self.conditions, &parsed.diagnostics);
        // Who puts the version in front may put a later one there.
        let of_version = if parsed.shader.version().span.is_none() { Around::TYPES } else { Around::empty() };
        let new: Vec<&Diagnostic> = parsed.diagnostics.iter().filter(|error| self.run.is_new(error)).collect();
        for (index, error) in new.iter().enumerate() {
            self.run.told.insert(key(error));
            let more = new.len().saturating_sub(MOST_TOLD);
            if index < MOST_TOLD {
                let of_host = !self.are_stated(settings)
                    || self.file.may_be_of_another_host(error)
                    || surroundings.leave_open(error, of_version)
                    || self.is_of_a_choice(settings, error, &parsed.diagnostics);
                let mut told = self.with_settings((*error).clone(), settings);
                if more > 0 && index + 1 == MOST_TOLD {
                    told = told.with_why(message!(
                        "{more} more errors follow from this",
                        "これによるエラーはほかに {more} 個"
                    ));
                }
                self.run.found.push((if of_host { Level::Strict } else { Level::Default }, told));
            }
        }
    }

    /// True where somebody says of each setting that it may be made: a line that defines a macro, in a file without options,
    /// may be there for good.
    fn are_stated(&self, settings: &[Setting]) -> bool {
        let stated = |name: &str| self.switches.iter().any(|switch| switch.name == name && switch.stated);
        let of_others = |setting: &Setting| setting.value.is_some() && self.run.defined.contains(setting.name.as_str());
        settings.iter().all(|setting| stated(&setting.name) && !of_others(setting))
    }

    /// True for an error that tells of a choice, of which the author takes one: what is declared twice, and what another macro
    /// in the place of one that is taken away brings back. Each value of a list has to do.
    fn is_of_a_choice(&self, settings: &[Setting], error: &Diagnostic, found: &[Diagnostic]) -> bool {
        let switch = |name: &str| self.switches.iter().find(|switch| switch.name == name);
        if settings.iter().all(|setting| switch(&setting.name).is_some_and(|switch| switch.listed)) {
            return false;
        }
        let instead = |name: &str| {
            let at = match switch(name) {
                Some(switch) if switch.others.iter().any(Option::is_none) => return None,
                Some(switch) => switch.at,
                None => None,
            };
            (!settings.iter().any(|setting| setting.name == name)).then(|| Setting {
                at,
                name: name.to_owned(),
                value: Some("1".to_owned()),
            })
        };
        let brought_back = |other: Setting| {
            let mut all = [settings, &[other]].concat();
            all.sort();
            let read = self.readings.read(&all, &Seen::default());
            let compiled = |p: &Parsed| conditions::place_of(&p.shader, error.span) == Some(TokenPlace::Text);
            let same = |d: &Diagnostic| open::stands_in(found, d) && !open::stands_in(std::slice::from_ref(error), d);
            let stays = |d: &Diagnostic| open::leaves_in_order(d) || same(d);
            read.is_some_and(|(_, parsed)| compiled(&parsed) && parsed.diagnostics.iter().all(stays))
        };
        let taken = settings.iter().any(|setting| setting.value.is_none());
        let open = self.conditions.undefined(false);
        let others = open.iter().map(String::as_str).chain(self.switches.iter().map(|switch| switch.name.as_str()));
        error.code == errors::REDEFINITION || (taken && others.filter_map(instead).take(MOST_OTHERS).any(brought_back))
    }

    /// The error, with the lines that have to say something else for it.
    fn with_settings(&self, error: Diagnostic, settings: &[Setting]) -> Diagnostic {
        let file = error.file.clone();
        let said: Vec<Message> = settings.iter().map(said).collect();
        let joined = |lang, and: &str| said.iter().map(|m| m.in_lang(lang)).collect::<Vec<_>>().join(and);
        let en = joined(Lang::En, " and ");
        let ja = joined(Lang::Ja, "、");
        let own = |lang| error.message.in_lang(lang);
        let message = Message::new(format!("where {en}: {}", own(Lang::En)), format!("{ja}場合：{}", own(Lang::Ja)));
        let mut told = Diagnostic { message, fix: None, ..error };
        for setting in settings {
            let line = self.switches.iter().find(|switch| switch.name == setting.name).and_then(|switch| switch.span);
            if let Some(line) = line {
                told = told.with_related(&file, line, label(setting));
            }
        }
        let told = at_home(told);
        let root = file.name();
        if told.file.name() == root || told.why.is_some() {
            return told;
        }
        told.with_why(message!("`{root}` includes this", "`{root}` がこれを取り込みます"))
    }
}

/// True for an error by which a text refuses settings, or says that nothing of it is compiled with them.
fn is_refusal(error: &Diagnostic) -> bool {
    [errors::ERROR_DIRECTIVE, errors::MISSING_MAIN].contains(&error.code)
}

fn said(setting: &Setting) -> Message {
    let name = &setting.name;
    match setting.value.as_deref() {
        None => message!("`{name}` is not defined", "`{name}` が未定義の"),
        Some("") => message!("`{name}` is defined", "`{name}` が定義されている"),
        Some(value) => message!("`{name}` is {value}", "`{name}` が {value} の"),
    }
}

fn label(setting: &Setting) -> Message {
    match setting.value.as_deref() {
        None => message!("without this line", "この行がない場合"),
        Some("") => message!("with this line", "この行がある場合"),
        Some(value) => message!("with `{value}` here", "ここが `{value}` の場合"),
    }
}

/// The error in the file that its place comes from: what is included is told there. What a macro stands for is told later.
fn at_home(mut error: Diagnostic) -> Diagnostic {
    (error.file, error.span) = error.file.origin(error.span);
    for label in &mut error.related {
        (label.file, label.span) = label.file.origin(label.span);
    }
    error
}
