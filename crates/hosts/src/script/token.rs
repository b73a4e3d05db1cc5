//! The tokens of languages that hosts are written in: words, strings and single characters.

use base::text::Span;

use super::language::{Form, Language};

/// A token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Token<'t> {
    /// A name, a keyword or a number.
    Word(&'t str),
    /// Any other character.
    Mark(char),
    /// A string: with its quotation marks, and what stands between them.
    String { place: Span, inner: Span, form: Form },
}

/// The tokens of a file, with their places.
pub fn tokens(text: &str, language: Language) -> (Vec<Token<'_>>, Vec<Span>) {
    let mut found: Vec<Token<'_>> = Vec::new();
    let mut places = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let before = text[..at].chars().next_back();
        if c.is_whitespace() {
            at += c.len_utf8();
        } else if rest.starts_with(language.comment()) {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if language.has_block_comments() && rest.starts_with("/*") {
            at += rest.find("*/").map_or(rest.len(), |end| end + 2);
        } else if let Some(opening) = language.opening(rest, before) {
            let inner = at + opening.length;
            match end_of(text, inner, opening.close, opening.form) {
                Some(end) => {
                    let after = end + opening.close.len();
                    if opening.form != Form::Character {
                        let (place, inner) = (Span::new(at, after), Span::new(inner, end));
                        found.push(Token::String { place, inner, form: opening.form });
                        places.push(place);
                    }
                    at = after;
                }
                None => at += opening.length,
            }
        } else if c.is_alphanumeric() || c == '_' {
            let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            found.push(Token::Word(&rest[..length]));
            places.push(Span::new(at, at + length));
            at += length;
        } else if language == Language::JavaScript && c == '/' && begins_pattern(found.last()) {
            at += pattern(rest);
        } else {
            found.push(Token::Mark(c));
            places.push(Span::new(at, at + c.len_utf8()));
            at += c.len_utf8();
        }
    }
    (found, places)
}

/// Where a string ends whose text begins at `start`; none for one that does not.
fn end_of(text: &str, start: usize, close: &str, form: Form) -> Option<usize> {
    let mut at = start;
    loop {
        let rest = text.get(at..)?;
        let c = rest.chars().next()?;
        if rest.starts_with(close) {
            return Some(at);
        }
        let escapes = !matches!(form, Form::Raw | Form::RawTemplate);
        match c {
            '\\' if escapes => at += 1 + rest[1..].chars().next().map_or(0, char::len_utf8),
            '\n' if matches!(form, Form::Line | Form::Character) => return None,
            // `'a'` and no more: else it is a lifetime, or a word in prose.
            _ if form == Form::Character && at > start => return None,
            '$' if form == Form::Template && rest.starts_with("${") => at = closing(text, at + 2),
            _ => at += c.len_utf8(),
        }
    }
}

/// True when a `/` behind this token begins a regular expression.
fn begins_pattern(before: Option<&Token<'_>>) -> bool {
    match before {
        None => true,
        Some(Token::Mark(mark)) => !matches!(mark, ')' | ']' | '}'),
        Some(Token::Word(word)) => matches!(*word, "return" | "typeof" | "case"),
        Some(Token::String { .. }) => false,
    }
}

/// Bytes of the regular expression at the start; one for a `/` that begins none.
fn pattern(text: &str) -> usize {
    let (mut class, mut escaped) = (false, false);
    for (i, c) in text.char_indices().skip(1) {
        match c {
            '\n' => return 1,
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '[' => class = true,
            ']' => class = false,
            '/' if !class => return i + 1,
            _ => {}
        }
    }
    1
}

/// Behind the brace that ends what is filled in.
pub fn closing(text: &str, start: usize) -> usize {
    let mut depth = 1;
    for (i, c) in text[start..].char_indices() {
        depth = match c {
            '{' => depth + 1,
            '}' => depth - 1,
            _ => depth,
        };
        if depth == 0 {
            return start + i + 1;
        }
    }
    text.len()
}
