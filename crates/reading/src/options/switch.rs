//! The options of a text: lines that define a macro and are meant to be changed.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use base::text::{SourceFile, Span};
use syntax::{Setting, Shader};

use crate::Variant;
use crate::conditions::Conditions;

/// Values of one option that are tried instead of its own, at most.
const MOST_VALUES: usize = 6;

/// A line that defines a macro, and what it could say instead.
#[derive(Clone, Debug)]
pub(super) struct Switch {
    /// The macro.
    pub name: String,
    /// Where the directive begins, or the comment that holds it; none for a macro that no line of the text defines.
    pub at: Option<usize>,
    /// The line, without what is in front.
    pub span: Option<Span>,
    /// What the macro could stand for instead: none for "not defined".
    pub others: Vec<Option<String>>,
    /// The text, or the project, lists these values.
    pub listed: bool,
    /// The text, the project or the file says that it is an option; else conditions alone do.
    pub stated: bool,
}

impl Switch {
    /// The line with another of its values.
    pub fn set(&self, value: usize) -> Setting {
        Setting { at: self.at, name: self.name.clone(), value: self.others[value].clone() }
    }
}

/// A line with a `#define`.
struct Line<'t> {
    name: &'t str,
    at: usize,
    end: usize,
    /// What the macro stands for, without the comment behind it.
    value: &'t str,
    /// The values in brackets in the comment behind it.
    list: Vec<&'t str>,
    in_comment: bool,
    /// It stands right behind the `#ifndef` that asks for it.
    guards: bool,
    /// Another condition decides whether it counts.
    depends: bool,
    /// The file that it comes from, and where it stands there.
    file: SourceFile,
    place: usize,
}

impl Line<'_> {
    /// True where its file includes another one further down.
    fn stands_in_front_of_an_include(&self) -> bool {
        let directive =
            |line: &str| line.trim_start().strip_prefix('#').map(|rest| rest.trim_start().starts_with("include"));
        self.file.text()[self.place..].lines().any(|line| directive(line) == Some(true))
    }
}

/// The options of a text: macros that conditions ask for, that one line defines, and that none takes back; and those that the
/// project states.
pub(super) fn of(shader: &Shader, conditions: &Conditions, stated: &[Variant]) -> Vec<Switch> {
    let lines = lines(shader);
    let mut defined: HashMap<&str, usize> = HashMap::new();
    lines.iter().for_each(|line| *defined.entry(line.name).or_default() += 1);
    // A file in which authors list their options holds options.
    let of_options: BTreeSet<&str> =
        lines.iter().filter(|line| line.in_comment || !line.list.is_empty()).map(|line| line.file.name()).collect();
    let asked = asked(shader);
    let fixed = undefined(shader);
    let once = |line: &&Line<'_>| defined[line.name] == 1 && conditions.asks(line.name) && !fixed.contains(line.name);
    let switch = |line: &Line<'_>| {
        let own_file = line.file.name();
        let asks_itself = || asked.get(line.name).is_some_and(|asked| asked.files.contains(own_file));
        // What stands in front of an include is given to it.
        let is_option = || asks_itself() || (of_options.contains(own_file) && !line.stands_in_front_of_an_include());
        let values = stated.iter().find(|variant| variant.name == line.name).map(|variant| &variant.values);
        let own = (!line.in_comment).then_some(line.value);
        let others: Vec<Option<String>> = if let Some(values) = values {
            values.iter().filter(|value| value.as_deref() != own).cloned().collect()
        } else if line.in_comment && line.value.is_empty() && asked.get(line.name).is_some_and(|asked| asked.valued) {
            // The comment names what a host defines with a value.
            Vec::new()
        } else if line.in_comment {
            vec![Some(line.value.to_owned())]
        } else if !line.list.is_empty() {
            let others = line.list.iter().copied().filter(|value| *value != line.value);
            few(others.collect(), asked.get(line.name)).into_iter().map(|value| Some(value.to_owned())).collect()
        } else if line.value.is_empty() && !line.guards && !line.depends && is_option() {
            vec![None]
        } else {
            Vec::new()
        };
        let span = Some(Span::new(line.at, line.end));
        (!others.is_empty()).then(|| Switch {
            name: line.name.to_owned(),
            at: Some(line.at),
            span,
            others,
            listed: values.is_some() || !line.list.is_empty(),
            stated: values.is_some() || of_options.contains(own_file),
        })
    };
    let given = |variant: &&Variant| {
        let name = variant.name.as_str();
        conditions.asks(name) && !defined.contains_key(name) && !shader.defines().iter().any(|(own, _)| own == name)
    };
    let from_outside = |variant: &Variant| {
        let others = variant.values.iter().filter(|value| value.is_some()).cloned().collect();
        Switch { name: variant.name.clone(), at: None, span: None, others, listed: true, stated: true }
    };
    let of_project = stated.iter().filter(given).map(from_outside).filter(|switch| !switch.others.is_empty());
    of_project.chain(lines.iter().filter(once).filter_map(switch)).collect()
}

/// All lines of a text with a `#define` of a macro without parameters, those in line comments included.
fn lines<'t>(shader: &'t Shader) -> Vec<Line<'t>> {
    let file = shader.file();
    let blocks: Vec<Span> = shader.comments().iter().filter(|c| c.block).map(|c| c.span).collect();
    let mut found = Vec::new();
    let (mut start, mut before) = (0, "");
    // For each condition around a line, its file, and the macro whose `#ifndef` it is: it may be the guard of that file.
    let mut around: Vec<(String, Option<&str>)> = Vec::new();
    let home = |at: usize| file.origin(Span::at(at)).0.name().to_owned();
    let mut guarded: BTreeSet<&str> = BTreeSet::new();
    for whole in file.text().split_inclusive('\n') {
        let at = start + (whole.len() - whole.trim_start().len());
        start += whole.len();
        let line = whole.trim();
        let directive = line.trim_start_matches('/').trim_start();
        let in_comment = directive.len() < line.len();
        let Some(directive) = directive.strip_prefix('#').map(str::trim_start) else { continue };
        let last = std::mem::replace(&mut before, directive);
        if !in_comment {
            match directive.split_whitespace().next() {
                Some("ifndef") => around.push((home(at), words(&directive["ifndef".len()..]).next())),
                Some("if" | "ifdef") => around.push((home(at), None)),
                Some("endif") => drop(around.pop()),
                _ => {}
            }
        }
        let Some(rest) = directive.strip_prefix("define").filter(|rest| rest.starts_with([' ', '\t'])) else {
            continue;
        };
        let inside = blocks.partition_point(|block| block.end <= at);
        if blocks.get(inside).is_some_and(|block| block.contains(at)) || whole.trim_end().ends_with('\\') {
            continue;
        }
        let rest = rest.trim_start();
        let name = &rest[..rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len())];
        let body = &rest[name.len()..];
        if name.is_empty() || body.starts_with('(') {
            continue;
        }
        let (value, comment) = body.split_at(body.find("//").or_else(|| body.find("/*")).unwrap_or(body.len()));
        let guards = last.strip_prefix("ifndef").is_some_and(|asked| asked.trim() == name);
        let (home, place) = file.origin(Span::at(at));
        let is_guard = |asked: Option<&str>| asked.is_some_and(|asked| asked == name || guarded.contains(asked));
        let depends = around.iter().any(|(file, asked)| *file == *home.name() && !is_guard(*asked));
        let list = list(comment);
        // Prose that speaks of a directive is none.
        if in_comment && (value.trim().contains(' ') || !(comment.is_empty() || comment.starts_with("//"))) {
            continue;
        }
        let (end, value, place) = (at + line.len(), value.trim(), place.start);
        if guards {
            guarded.insert(name);
        }
        found.push(Line { name, at, end, value, list, in_comment, guards, depends, file: home, place });
    }
    found
}

/// The values in brackets in a comment; none where these are no words or numbers.
fn list(comment: &str) -> Vec<&str> {
    let Some(inside) = comment.split_once('[').and_then(|(_, rest)| rest.split_once(']')) else { return Vec::new() };
    let all: Vec<&str> = inside.0.split_whitespace().collect();
    let plain = |value: &&str| value.chars().all(|c| c.is_ascii_alphanumeric() || "_.-+".contains(c));
    if all.iter().all(plain) { all } else { Vec::new() }
}

/// The values that conditions can tell apart: those next to what they compare with, and the first and the last one.
fn few<'t>(all: Vec<&'t str>, asked: Option<&Asked>) -> Vec<&'t str> {
    if all.len() <= MOST_VALUES {
        return all;
    }
    let near = |value: &str| {
        value
            .parse::<i64>()
            .is_ok_and(|v| (v - 1..=v + 1).any(|v| asked.is_some_and(|asked| asked.numbers.contains(&v))))
    };
    let last = all.len() - 1;
    let of_use = all.iter().enumerate().filter(|(k, value)| *k == 0 || *k == last || near(value));
    of_use.map(|(_, value)| *value).take(MOST_VALUES).collect()
}

/// The conditions of a text, with the file that each comes from.
fn conditions_of(shader: &Shader) -> impl Iterator<Item = (usize, &str, &str)> {
    let mut start = 0;
    shader.file().text().split_inclusive('\n').filter_map(move |line| {
        let at = start;
        start += line.len();
        let directive = line.trim_start().strip_prefix('#')?.trim_start();
        let word = &directive[..directive.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(directive.len())];
        matches!(word, "if" | "ifdef" | "ifndef" | "elif" | "else" | "endif")
            .then(|| (at, word, directive[word.len()..].split("//").next().unwrap_or("")))
    })
}

fn words(condition: &str) -> impl Iterator<Item = &str> {
    condition.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

/// What conditions ask of a name.
#[derive(Default)]
struct Asked {
    /// The integers that stand in a condition with it.
    numbers: BTreeSet<i64>,
    /// The files of these conditions.
    files: BTreeSet<String>,
    /// A condition computes with it.
    valued: bool,
}

/// What the conditions of a text ask, by name.
fn asked(shader: &Shader) -> HashMap<&str, Asked> {
    let mut found: HashMap<&str, Asked> = HashMap::new();
    for (at, directive, condition) in conditions_of(shader) {
        let numbers: Vec<i64> = words(condition).filter_map(|word| word.parse().ok()).collect();
        let file = shader.file().origin(Span::at(at)).0;
        for word in words(condition) {
            let asked = found.entry(word).or_default();
            asked.numbers.extend(&numbers);
            let plain = condition.replace(' ', "");
            let defined = [format!("defined({word})"), format!("defined{word}")];
            let in_defined: usize = defined.iter().map(|defined| plain.matches(defined.as_str()).count()).sum();
            let only_defined = plain.matches(word).count() == in_defined;
            asked.valued |= matches!(directive, "if" | "elif") && !only_defined;
            if !asked.files.contains(file.name()) {
                asked.files.insert(file.name().to_owned());
            }
        }
    }
    found
}

/// Names that a line takes back: their value is worked out.
fn undefined(shader: &Shader) -> BTreeSet<&str> {
    let directives = shader.file().text().lines().filter_map(|line| line.trim_start().strip_prefix('#'));
    directives.filter_map(|rest| words(rest.trim_start().strip_prefix("undef")?).next()).collect()
}

/// Pairs of options that stand in one condition, those around it included.
pub(super) fn pairs(shader: &Shader, switches: &[Switch]) -> BTreeSet<(usize, usize)> {
    let by_name: BTreeMap<&str, usize> = switches.iter().enumerate().map(|(k, s)| (s.name.as_str(), k)).collect();
    let mut around: Vec<BTreeSet<usize>> = Vec::new();
    let mut found = BTreeSet::new();
    for (_, word, condition) in conditions_of(shader) {
        if word == "endif" {
            around.pop();
        }
        if matches!(word, "if" | "ifdef" | "ifndef" | "elif") {
            let mut all: BTreeSet<usize> = words(condition).filter_map(|word| by_name.get(word).copied()).collect();
            if word == "elif" {
                // The branches in front decide over this one.
                all.extend(around.pop().unwrap_or_default());
            }
            for a in &all {
                for b in all.iter().chain(around.iter().flatten()).filter(|b| *b != a) {
                    found.insert((*a.min(b), *a.max(b)));
                }
            }
            around.push(all);
        }
    }
    found
}
