//! Words, numbers and marks of a text in WGSL: as much of it as finding a declaration takes.
//!
//! naga reads the language; it keeps no place for the name of an entry point, and the literals of a module are rounded.

use base::text::Span;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A name or keyword.
    Word,
    /// A number with its suffix.
    Number,
    /// One character of anything else.
    Mark,
}

/// A token with its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Token {
    pub kind: Kind,
    pub span: Span,
}

fn in_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Bytes of a comment that `rest` begins with; comments in blocks nest (WGSL, 3.4).
fn comment(rest: &str) -> Option<usize> {
    if rest.starts_with("//") {
        return Some(rest.find('\n').unwrap_or(rest.len()));
    }
    if !rest.starts_with("/*") {
        return None;
    }
    let (mut depth, mut at) = (0_u32, 0);
    loop {
        let Some(next) = rest[at..].find(['/', '*']) else { return Some(rest.len()) };
        let next = next + at;
        (depth, at) = match rest.as_bytes().get(next..next + 2) {
            Some(b"/*") => (depth + 1, next + 2),
            Some(b"*/") => (depth - 1, next + 2),
            Some(_) => (depth, next + 1),
            None => return Some(rest.len()),
        };
        if depth == 0 {
            return Some(at);
        }
    }
}

/// Bytes of the number that `rest` begins with.
fn number(rest: &str) -> usize {
    let hex = rest.starts_with("0x") || rest.starts_with("0X");
    let mut before = ' ';
    let inside = |c: char| {
        let signed = if hex { matches!(before, 'p' | 'P') } else { matches!(before, 'e' | 'E') };
        let more = in_word(c) || c == '.' || (signed && matches!(c, '+' | '-'));
        before = c;
        !more
    };
    rest.find(inside).unwrap_or(rest.len())
}

/// The tokens of a text, without comments.
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let mut all = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
        let (kind, len) = if c.is_whitespace() || c == '\u{feff}' {
            at += c.len_utf8();
            continue;
        } else if let Some(len) = comment(rest) {
            at += len;
            continue;
        } else if c.is_ascii_digit() || (c == '.' && digit(rest.chars().nth(1))) {
            (Kind::Number, number(rest))
        } else if in_word(c) {
            (Kind::Word, rest.find(|c| !in_word(c)).unwrap_or(rest.len()))
        } else {
            (Kind::Mark, c.len_utf8())
        };
        all.push(Token { kind, span: Span::new(at, at + len) });
        at += len;
    }
    all
}

/// The name behind a keyword: of `fn main` the place of `main`.
pub(crate) fn declared(text: &str, keyword: &str, name: &str) -> Option<Span> {
    let all = tokens(text);
    let is = |token: &Token, wanted: &str| &text[token.span.range()] == wanted;
    all.windows(2).find(|pair| is(&pair[0], keyword) && is(&pair[1], name)).map(|pair| pair[1].span)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<&str> {
        tokens(text).iter().map(|token| &text[token.span.range()]).collect()
    }

    #[test]
    fn comments_nest_and_end() {
        assert_eq!(texts("a /* b /* c */ d */ e // f\ng"), ["a", "e", "g"]);
        assert_eq!(texts("a /* b"), ["a"]);
        assert_eq!(texts("a //"), ["a"]);
    }

    #[test]
    fn numbers_are_taken_whole() {
        assert_eq!(texts("1.5e-3f+.5-0x1.8p+3-2"), ["1.5e-3f", "+", ".5", "-", "0x1.8p+3", "-", "2"]);
        assert_eq!(texts("v.x"), ["v", ".", "x"]);
    }

    #[test]
    fn a_name_in_a_comment_is_no_declaration() {
        let text = "// fn main\nfn  main() {}";
        assert_eq!(declared(text, "fn", "main"), Some(Span::new(15, 19)));
        assert_eq!(declared(text, "fn", "mai"), None);
    }
}
