//! Tokens of WGSL (section 3 of its specification), as far as composing needs them: names, brackets, and what ends
//! a declaration. An operator of several characters is several tokens here.

use base::text::Span;
use logos::{Lexer, Logos};

/// What a token is.
#[derive(Logos, Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    #[regex(r"[\p{XID_Start}_]\p{XID_Continue}*")]
    Word,
    #[regex(r"0[xX][0-9a-fA-F.]+([pP][+-]?[0-9]+)?(l?[iuf]|h)?")]
    #[regex(r"[0-9]+(\.[0-9]*)?([eE][+-]?[0-9]+)?(l?[iuf]|h)?")]
    #[regex(r"\.[0-9]+([eE][+-]?[0-9]+)?(l?f|h)?")]
    Number,
    #[token("{")]
    OpenBrace,
    #[token("}")]
    CloseBrace,
    #[token("(")]
    OpenParen,
    #[token(")")]
    CloseParen,
    #[token("[")]
    OpenBracket,
    #[token("]")]
    CloseBracket,
    #[token("<")]
    Less,
    #[token(">")]
    Greater,
    #[token("->")]
    Arrow,
    #[token("::")]
    Path,
    #[token(":")]
    Colon,
    #[token(";")]
    Semicolon,
    #[token(",")]
    Comma,
    #[token(".")]
    Dot,
    #[token("@")]
    At,
    #[token("!")]
    Not,
    #[token("&&")]
    And,
    #[token("||")]
    Or,
    #[regex(r#""[^"\n]*""#)]
    Quoted,
    #[regex(r"[\s\u{200e}\u{200f}\u{85}\u{2028}\u{2029}\u{feff}]+")]
    #[token("//", line_comment)]
    #[token("/*", block_comment)]
    Blank,
    /// Any other character.
    Other,
}

/// A token and its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Token {
    pub kind: Kind,
    pub span: Span,
}

/// The tokens of a text, without blanks and comments.
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let all = Kind::lexer(text).spanned();
    let all =
        all.map(|(kind, range)| Token { kind: kind.unwrap_or(Kind::Other), span: Span::new(range.start, range.end) });
    all.filter(|token| token.kind != Kind::Blank).collect()
}

/// For each token the one behind its bracket: for an opening bracket the token behind the one that closes it, or the
/// number of tokens where none does; the next token for all others.
pub(crate) fn brackets(tokens: &[Token]) -> Vec<usize> {
    let mut behind: Vec<usize> = (1..=tokens.len()).collect();
    let mut open = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        match token.kind {
            Kind::OpenBrace | Kind::OpenParen | Kind::OpenBracket => open.push(at),
            Kind::CloseBrace | Kind::CloseParen | Kind::CloseBracket => {
                if let Some(begin) = open.pop() {
                    behind[begin] = at + 1;
                }
            }
            _ => {}
        }
    }
    open.into_iter().for_each(|begin| behind[begin] = tokens.len());
    behind
}

/// The token behind `<…>` at `open`, or `open` itself where no template stands there.
pub(crate) fn behind_template(tokens: &[Token], open: usize) -> usize {
    if tokens.get(open).is_none_or(|token| token.kind != Kind::Less) {
        return open;
    }
    // Angle brackets in each other, and the parentheses inside of them.
    let (mut depth, mut inside) = (0_usize, 0_usize);
    for (at, token) in tokens.iter().enumerate().skip(open) {
        match token.kind {
            Kind::OpenParen | Kind::OpenBracket => inside += 1,
            Kind::CloseParen | Kind::CloseBracket if inside == 0 => return open,
            Kind::CloseParen | Kind::CloseBracket => inside -= 1,
            Kind::Less if inside == 0 => depth += 1,
            Kind::Greater if inside == 0 => depth -= 1,
            Kind::Semicolon | Kind::OpenBrace | Kind::And | Kind::Or => return open,
            _ => {}
        }
        if depth == 0 {
            return at + 1;
        }
    }
    open
}

/// Bytes of line breaks (section 3.3 of the specification has more of them, which no editor writes).
fn line_comment(lexer: &mut Lexer<'_, Kind>) {
    let rest = lexer.remainder();
    lexer.bump(rest.find(['\n', '\r']).unwrap_or(rest.len()));
}

/// Comments hold others (section 3.2).
fn block_comment(lexer: &mut Lexer<'_, Kind>) {
    let rest = lexer.remainder().as_bytes();
    let (mut depth, mut at) = (1_usize, 0);
    while depth > 0 && at < rest.len() {
        match rest.get(at..at + 2) {
            Some(b"/*") => (depth, at) = (depth + 1, at + 2),
            Some(b"*/") => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
    }
    lexer.bump(at);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_numbers_and_comments_are_told_apart() {
        let text = "a::b /* x /* y */ z */ 0x1p3f 1.5.x // c\nÄé_1 .5h->array<f32>";
        let words: Vec<&str> = tokens(text).iter().map(|t| &text[t.span.range()]).collect();
        assert_eq!(words, ["a", "::", "b", "0x1p3f", "1.5", ".", "x", "Äé_1", ".5h", "->", "array", "<", "f32", ">"]);
        // Naga has numbers of 64 bits.
        let text = "1lu+31li-2.5lf*0x7lu";
        let words: Vec<&str> = tokens(text).iter().map(|t| &text[t.span.range()]).collect();
        assert_eq!(words, ["1lu", "+", "31li", "-", "2.5lf", "*", "0x7lu"]);
    }

    #[test]
    fn brackets_and_templates_end_where_they_are_closed() {
        let text = "f(a[1], {b}) var<storage, read> x: array<vec4<f32>, 4>; a < b";
        let all = tokens(text);
        let at = |needle: &str| all.iter().position(|t| text[t.span.start..].starts_with(needle)).unwrap();
        assert_eq!(brackets(&all)[1], at("var"));
        assert_eq!(brackets(&all)[0], 1);
        assert_eq!(behind_template(&all, at("var") + 1), at("x:"));
        let last = all.len() - 2;
        assert_eq!(behind_template(&all, last), last, "a comparison is no template");
        let shifts = tokens("(x << b) | (x >> (32u - b))");
        assert_eq!(behind_template(&shifts, 2), 2, "nor is a shift");
    }
}
