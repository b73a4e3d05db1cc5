//! Modules in WGSL of which an engine leaves parts out (`#ifdef`): one text for each set of macros that is tried.
//!
//! The parser reads the first branch of each condition, whether or not one definition can lead to all of them, so that little
//! of what it finds is certain. Here a condition has one answer in the whole text. What stands in a branch that is left out is
//! blanks, and so are the directives: every place is the one that it has in the file.

use std::collections::BTreeSet;

use base::diagnostic::Diagnostic;
use base::text::{SourceFile, Span};
use syntax::{Shader, errors};

use super::project::{Input, ShaderFile};

/// Conditions of one text at most.
const MOST_ASKED: usize = 8;

/// Bytes of the longest text that is read again and again.
const LONGEST: usize = 1 << 18;

/// A text with answers for its conditions.
pub struct Settled {
    /// The text, read as a module.
    pub shader: ShaderFile,
    /// True where every condition that asks for a macro finds it: some of these may exclude each other.
    pub all: bool,
    /// Parts that are left out.
    blank: Vec<Span>,
}

impl Settled {
    /// True for a place that is compiled.
    pub fn has(&self, place: Span) -> bool {
        !self.blank.iter().any(|part| part.contains(place.start))
    }

    /// Values that do not fit: no macro that is not asked for changes that.
    pub fn misfits(&self) -> impl Iterator<Item = &Diagnostic> {
        self.shader.front_end.iter().filter(|error| errors::is_of_types(error.code))
    }
}

impl ShaderFile {
    /// The text with nothing defined that its conditions ask for, with each of that alone, and with all of it. None for a text
    /// without conditions, and for one in which an engine leaves out or fills in anything else.
    pub fn settled(&self) -> Vec<Settled> {
        let file = self.author.as_ref().unwrap_or(&self.file);
        let text = file.text();
        let varies = self.shader.wgsl().is_some_and(|module| module.varies);
        if !varies || self.template.is_some() || file.is_assembled() || text.len() > LONGEST {
            return Vec::new();
        }
        let Some(asked) = asked(text).filter(|asked| (1..=MOST_ASKED).contains(&asked.len())) else {
            return Vec::new();
        };
        let all: Vec<&str> = asked.iter().copied().collect();
        let mut sets: Vec<Vec<&str>> = vec![Vec::new()];
        sets.extend(all.iter().map(|one| vec![*one]));
        if all.len() > 1 {
            sets.push(all.clone());
        }
        let read = |set: Vec<&str>| {
            let (text, blank) = settle(text, &set)?;
            let input = Input::new(SourceFile::new(file.name(), text));
            let parsed = Shader::parse_wgsl(&input.file);
            let plain = parsed.shader.wgsl().is_some_and(|module| !module.varies);
            plain.then(|| Settled { shader: Self::read(&input, parsed), all: set.len() > 1, blank })
        };
        sets.into_iter().map(read).collect::<Option<Vec<Settled>>>().unwrap_or_default()
    }
}

/// A directive of a line: its word, and what it asks.
fn directive(line: &str) -> Option<(&str, &str)> {
    let rest = line.trim_start().strip_prefix('#')?.trim_start();
    let end = rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
    Some((&rest[..end], rest[end..].split("//").next().unwrap_or("").trim()))
}

/// What a condition asks, and whether it is true where that is so: `#ifndef` asks for the same as `#ifdef`.
fn question<'t>(word: &str, rest: &'t str) -> Option<(&'t str, bool)> {
    match word {
        "ifdef" => Some((rest, true)),
        "ifndef" => Some((rest, false)),
        "if" => Some((rest, true)),
        _ => None,
    }
}

/// The condition behind an `#else`, and that of an `#elif`.
fn otherwise<'t>(word: &str, rest: &'t str) -> Option<(&'t str, bool)> {
    match word {
        "elif" => Some((rest, true)),
        "elifdef" => Some((rest, true)),
        "elifndef" => Some((rest, false)),
        _ => {
            let (word, rest) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            question(word, rest.trim())
        }
    }
}

/// What the conditions of a text ask; none where they do not close.
fn asked(text: &str) -> Option<BTreeSet<&str>> {
    let (mut all, mut depth) = (BTreeSet::new(), 0_usize);
    for (word, rest) in text.lines().filter_map(directive) {
        let asks = match word {
            "if" | "ifdef" | "ifndef" => {
                depth += 1;
                Some(question(word, rest)?)
            }
            "else" | "elif" | "elifdef" | "elifndef" => otherwise(word, rest),
            "endif" => {
                depth = depth.checked_sub(1)?;
                None
            }
            _ => None,
        };
        all.extend(asks.map(|(asks, _)| asks));
    }
    (depth == 0).then_some(all)
}

/// The text where these conditions hold and no other one does, with blanks for what is left out.
fn settle(text: &str, holds: &[&str]) -> Option<(String, Vec<Span>)> {
    struct Branch {
        active: bool,
        /// A branch before this one was taken, or what is around is left out.
        done: bool,
    }
    let (mut out, mut blank) = (String::with_capacity(text.len()), Vec::new());
    let (mut branches, mut start): (Vec<Branch>, usize) = (Vec::new(), 0);
    let is_true = |(asks, when): (&str, bool)| holds.contains(&asks) == when;
    for line in text.split_inclusive('\n') {
        let around = |branches: &[Branch]| branches.iter().all(|branch| branch.active);
        let mut is_directive = true;
        match directive(line) {
            Some((word @ ("if" | "ifdef" | "ifndef"), rest)) => {
                let outside = around(&branches);
                let active = is_true(question(word, rest)?);
                branches.push(Branch { active: outside && active, done: active || !outside });
            }
            Some((word @ ("else" | "elif" | "elifdef" | "elifndef"), rest)) => {
                let branch = branches.last_mut()?;
                let active = !branch.done && otherwise(word, rest).is_none_or(is_true);
                (branch.active, branch.done) = (active, branch.done || active);
            }
            Some(("endif", _)) => {
                branches.pop()?;
            }
            _ => is_directive = false,
        }
        if is_directive || !around(&branches) {
            blank.push(Span::new(start, start + line.len()));
            out.extend(line.chars().flat_map(|c| match c {
                '\n' | '\r' => vec![c],
                c => vec![' '; c.len_utf8()],
            }));
        } else {
            out.push_str(line);
        }
        start += line.len();
    }
    Some((out, blank))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(text: &str, holds: &[&str]) -> String {
        let (settled, _) = settle(text, holds).unwrap();
        assert_eq!(settled.len(), text.len());
        settled.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn a_condition_has_one_answer_in_the_whole_text() {
        let text = "a\n#ifdef X\nb // é\n#else ifdef Y\nc\n#else\nd\n#endif\n#ifndef X\ne\n#endif\n";
        assert_eq!(asked(text).unwrap().into_iter().collect::<Vec<_>>(), ["X", "Y"]);
        assert_eq!(plain(text, &[]), "a d e");
        assert_eq!(plain(text, &["X"]), "a b // é");
        assert_eq!(plain(text, &["Y"]), "a c e");
        assert_eq!(plain(text, &["X", "Y"]), "a b // é");
        let inner = "#if A == 1\n#ifdef X\nb\n#else\nc\n#endif\n#endif\nd\n";
        assert_eq!(plain(inner, &[]), "d");
        assert_eq!(plain(inner, &["A == 1"]), "c d");
    }

    #[test]
    fn what_does_not_close_has_no_answers() {
        assert_eq!(asked("#ifdef X\n"), None);
        assert_eq!(asked("#endif\n"), None);
        assert!(asked("#import a::b\nfn f() { }\n").unwrap().is_empty());
    }
}
