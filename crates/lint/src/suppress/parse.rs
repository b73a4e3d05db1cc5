//! The text of one comment that silences.

use crate::registry::nearest;
use crate::rule::Rule;
use base::text::{SourceFile, Span};
use syntax::errors;

use super::{Entry, MARK};

/// What is wrong with a comment that should silence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Fault {
    /// Place of the part of the comment that is wrong.
    pub span: Span,
    pub cause: Cause,
}

/// What is wrong with a comment that should silence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Cause {
    /// The word behind `shadercheck:` is neither `ignore` nor `ignore-file`.
    UnknownWord(String),
    /// No code in brackets follows.
    NoCodes(String),
    /// The bracket is not closed.
    Unclosed,
    /// No rule has this code or name.
    UnknownRule {
        /// As written.
        given: String,
        /// Rules that look like it.
        nearest: Vec<String>,
    },
}

/// A comment, read.
pub(super) struct Read {
    pub entries: Vec<Entry>,
    pub faults: Vec<Fault>,
    /// The text between the brackets.
    pub list: Span,
    pub whole_file: bool,
}

impl Read {
    fn fault(span: Span, cause: Cause) -> Self {
        Self { entries: Vec::new(), faults: vec![Fault { span, cause }], list: span, whole_file: false }
    }
}

/// Reads a comment; none when it does not speak to this tool.
pub(super) fn read(file: &SourceFile, comment: Span, rules: &[&'static Rule]) -> Option<Read> {
    let text = file.slice(comment);
    let (opening, inner) = match text.strip_prefix("/*") {
        Some(rest) => (2, rest.strip_suffix("*/").unwrap_or(rest)),
        None => (0, text),
    };
    let body = inner.trim_start_matches(|c: char| c.is_whitespace() || "/*!".contains(c)).strip_prefix(MARK)?;
    let end_of_inner = comment.start + opening + inner.len();
    let at = |rest: &str| end_of_inner - rest.len();
    let body = body.trim_start();
    if states_domain(body) {
        return None;
    }
    let word_length = body.find(|c: char| !(c.is_alphanumeric() || c == '-' || c == '_')).unwrap_or(body.len());
    let (word, behind) = body.split_at(word_length);
    let word_span = Span::new(at(body), at(body) + word.len());
    let whole_file = match word {
        "ignore" => false,
        "ignore-file" => true,
        _ => return Some(Read::fault(word_span, Cause::UnknownWord(word.to_owned()))),
    };
    let no_codes = |span| Some(Read::fault(span, Cause::NoCodes(word.to_owned())));
    let Some(list) = behind.trim_start().strip_prefix('[') else { return no_codes(word_span) };
    let Some(length) = list.find([']', '\n', '\r']).filter(|&i| list[i..].starts_with(']')) else {
        return Some(Read::fault(Span::new(at(list) - 1, at(list)), Cause::Unclosed));
    };
    let start = at(list);
    let list = &list[..length];
    let list_span = Span::new(start, start + length);
    if list.trim().is_empty() {
        return no_codes(Span::new(start - 1, start + length + 1));
    }
    let mut read = Read { entries: Vec::new(), faults: Vec::new(), list: list_span, whole_file };
    let mut offset = start;
    for part in list.split(',') {
        let given = part.trim();
        let begin = offset + (part.len() - part.trim_start().len());
        let span = Span::new(begin, begin + given.len());
        offset += part.len() + 1;
        match known(given, rules) {
            Ok(code) if read.entries.iter().any(|e| e.code == code) => {}
            Ok(code) => read.entries.push(Entry { code, span, used: false, judged: false }),
            // An empty part of a list is a comma too many, which does no harm.
            Err(_) if given.is_empty() => {}
            Err(cause) => read.faults.push(Fault { span, cause }),
        }
    }
    Some(read)
}

/// True for a comment that says which values inputs take, which is for `shadercheck fuzz` to read:
/// `x in [0, 1]`, `t > 0`, `normalised n`.
fn states_domain(body: &str) -> bool {
    const LAWS: [&str; 9] =
        ["normalised", "normalized", "unit", "nonzero", "rotation", "orthonormal", "whole", "integer", "in"];
    let first = body.split([',', ';', '\n']).next().unwrap_or_default();
    let mut words = first.split_whitespace().filter(|w| !w.starts_with("ignore"));
    words.any(|word| LAWS.contains(&word) || word.starts_with(['<', '>'])) && !body.starts_with("ignore")
}

/// The code, as the registry has it, of what is given by its code or name.
fn known(given: &str, rules: &[&'static Rule]) -> Result<&'static str, Cause> {
    let rule = rules.iter().find(|r| r.is_called(given)).map(|r| r.code.0);
    let front_end = || errors::all().map(|(code, _)| code.0).find(|c| c.eq_ignore_ascii_case(given));
    let unknown = || Cause::UnknownRule { given: given.to_owned(), nearest: nearest(given) };
    rule.or_else(front_end).ok_or_else(unknown)
}
