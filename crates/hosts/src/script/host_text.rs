//! Host code of any language as strings, words and marks, with the statement that each stands in.

use base::text::SourceFile;

use super::language::{Form, Language};
use super::token::{Token, tokens};

/// A part of host code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HostText {
    /// Strings side by side, as what they stand for.
    String {
        /// The text.
        text: String,
        /// Where it begins.
        at: usize,
        /// The number of its statement.
        statement: usize,
        /// False where something is filled in.
        complete: bool,
    },
    /// A name or a number.
    Word(String),
    /// Another character.
    Mark(char),
}

/// The parts of a file of host code; none for files of other languages.
pub fn host_texts(file: &SourceFile) -> Option<Vec<HostText>> {
    let language = Language::of(file.name()).or_else(|| Language::like_c(file.name()))?;
    let text = file.text();
    let (tokens, places) = tokens(text, language);
    let mut out: Vec<HostText> = Vec::with_capacity(tokens.len());
    let mut statement = 0;
    // For each open bracket, whether it is a block of statements.
    let mut open: Vec<bool> = Vec::new();
    let mut end = 0;
    for (token, place) in tokens.iter().zip(places) {
        let inside = open.last() == Some(&false);
        // A statement of Python ends with its line.
        if language == Language::Python && !inside && text[end..place.start.max(end)].contains('\n') {
            statement += 1;
        }
        end = place.end;
        match *token {
            Token::Word(word) => match &mut out[..] {
                // `1.5`
                [.., HostText::Word(whole), HostText::Mark('.')] if is_number(whole) && is_number(word) => {
                    *whole = format!("{whole}.{word}");
                    out.pop();
                }
                _ => out.push(HostText::Word(word.to_owned())),
            },
            Token::Mark(mark) => {
                match mark {
                    '{' if !inside && begins_block(out.last()) => {
                        statement += 1;
                        open.push(true);
                    }
                    '(' | '[' | '{' => open.push(false),
                    ')' | ']' | '}' => statement += usize::from(open.pop() == Some(true)),
                    ';' => statement += 1,
                    _ => {}
                }
                out.push(HostText::Mark(mark));
            }
            Token::String { inner, form, .. } => {
                let raw = file.slice(inner);
                let text = if matches!(form, Form::Raw | Form::RawTemplate) { raw.to_owned() } else { plain(raw) };
                let filled = match form {
                    Form::Template | Form::RawTemplate => raw.contains("${"),
                    Form::Braces => raw.contains('{'),
                    _ => false,
                };
                match out.last_mut() {
                    Some(HostText::String { text: before, complete, .. }) => {
                        before.push_str(&text);
                        *complete &= !filled;
                    }
                    _ => out.push(HostText::String { text, at: inner.start, statement, complete: !filled }),
                }
            }
        }
    }
    Some(out)
}

fn is_number(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_digit())
}

/// True where a brace behind this begins statements, and no list.
fn begins_block(before: Option<&HostText>) -> bool {
    match before {
        None | Some(HostText::Mark(')' | ';' | '{' | '}' | '>' | ':')) => true,
        Some(HostText::Word(word)) => word != "return",
        Some(HostText::Mark(_) | HostText::String { .. }) => false,
    }
}

/// What a string with escapes stands for.
fn plain(raw: &str) -> String {
    let mut out = String::with_capacity(raw.len());
    let mut chars = raw.chars();
    while let Some(c) = chars.next() {
        if c != '\\' {
            out.push(c);
            continue;
        }
        match chars.next() {
            Some('n') => out.push('\n'),
            Some('t') => out.push('\t'),
            Some('r') => {}
            // A line that goes on.
            Some('\n') => {}
            Some(other) => out.push(other),
            None => {}
        }
    }
    out
}
