//! Text to tokens (GLSL 4.60 specification, sections 3.1 to 3.8).

use logos::{Lexer, Logos};

use super::Comment;
use base::text::Span;

/// How comments are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum CommentStyle {
    /// As in C: `/* */` ends with the first `*/`, and a backslash joins the next line to a `//`.
    #[default]
    C,
    /// As in WGSL (section 3.2): `/* */` may hold others, and a backslash means nothing.
    Wgsl,
}

/// What the text is made of.
#[derive(Logos, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[logos(extras = CommentStyle)]
pub(crate) enum Lex {
    #[regex(r"[ \t\x0b\x0c]+")]
    Blank,
    #[regex(r"\r\n|\n|\r")]
    Newline,
    #[regex(r"\\(\r\n|\n|\r)")]
    Splice,
    #[token("//", line_comment)]
    LineComment,
    /// The flag is false when `*/` is missing.
    #[token("/*", block_comment)]
    BlockComment(bool),
    #[regex(r"[A-Za-z_][A-Za-z0-9_]*")]
    Word,
    /// Everything that starts like a number, good or bad; read by `number`.
    #[regex(r"0[xX][0-9A-Za-z_]*")]
    #[token("0")]
    #[regex(r"0([0-9A-WYZa-wyz_.]|[eE][+-])([0-9A-Za-z_.]|[eE][+-])*")]
    #[regex(r"(\.[0-9]|[1-9])([0-9A-Za-z_.]|[eE][+-])*")]
    Number,
    #[token("(")]
    LParen,
    #[token(")")]
    RParen,
    #[token("[")]
    LBracket,
    #[token("]")]
    RBracket,
    #[token("{")]
    LBrace,
    #[token("}")]
    RBrace,
    #[token(".")]
    Dot,
    #[token(",")]
    Comma,
    #[token(";")]
    Semicolon,
    #[token(":")]
    Colon,
    #[token("?")]
    Question,
    #[token("=")]
    Assign,
    #[token("+=")]
    AddAssign,
    #[token("-=")]
    SubAssign,
    #[token("*=")]
    MulAssign,
    #[token("/=")]
    DivAssign,
    #[token("%=")]
    RemAssign,
    #[token("<<=")]
    ShlAssign,
    #[token(">>=")]
    ShrAssign,
    #[token("&=")]
    AndAssign,
    #[token("^=")]
    XorAssign,
    #[token("|=")]
    OrAssign,
    #[token("++")]
    Increment,
    #[token("--")]
    Decrement,
    #[token("+")]
    Plus,
    #[token("-")]
    Minus,
    #[token("*")]
    Star,
    #[token("/")]
    Slash,
    #[token("%")]
    Percent,
    #[token("<<")]
    Shl,
    #[token(">>")]
    Shr,
    #[token("<")]
    Less,
    #[token(">")]
    Greater,
    #[token("<=")]
    LessEqual,
    #[token(">=")]
    GreaterEqual,
    #[token("==")]
    EqualEqual,
    #[token("!=")]
    NotEqual,
    #[token("&")]
    Amp,
    #[token("^")]
    Caret,
    #[token("|")]
    Pipe,
    #[token("&&")]
    AndAnd,
    #[token("^^")]
    XorXor,
    #[token("||")]
    OrOr,
    #[token("!")]
    Bang,
    #[token("~")]
    Tilde,
    #[token("#")]
    Hash,
    #[token("##")]
    HashHash,
    /// One or more characters that start no token.
    Unknown,
    /// What a template engine replaces; made by `hole`.
    Hole,
    /// A text in quotes; made by the preprocessor where an extension brings them.
    Quoted,
    /// Behind the last token; made by the parser.
    End,
}

fn line_comment(lexer: &mut Lexer<'_, Lex>) {
    let rest = lexer.remainder().as_bytes();
    let mut end = rest.len();
    for (i, &b) in rest.iter().enumerate() {
        // A backslash before the line break joins the next line to the comment.
        let joined = match i {
            _ if lexer.extras == CommentStyle::Wgsl => false,
            0 => false,
            _ => rest[i - 1] == b'\\' || (b == b'\n' && i > 1 && rest[i - 1] == b'\r' && rest[i - 2] == b'\\'),
        };
        if (b == b'\n' || b == b'\r') && !joined {
            end = i;
            break;
        }
    }
    lexer.bump(end);
}

fn block_comment(lexer: &mut Lexer<'_, Lex>) -> bool {
    let rest = lexer.remainder();
    let end = match lexer.extras {
        CommentStyle::C => rest.find("*/").map(|at| at + 2),
        CommentStyle::Wgsl => nested_end(rest.as_bytes()),
    };
    lexer.bump(end.unwrap_or(rest.len()));
    end.is_some()
}

/// Where a comment ends that has begun before the text and may hold others.
fn nested_end(text: &[u8]) -> Option<usize> {
    let (mut depth, mut at) = (1_usize, 0);
    while depth > 0 {
        match text.get(at..at + 2)? {
            b"/*" => (depth, at) = (depth + 1, at + 2),
            b"*/" => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
    }
    Some(at)
}

/// A token of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Piece {
    pub lex: Lex,
    pub span: Span,
    /// First token of its logical line (continued lines are one).
    pub first: bool,
    /// White space or a comment stands before it.
    pub spaced: bool,
}

/// A text cut into tokens.
#[derive(Debug, Default)]
pub(crate) struct Pieces {
    pub pieces: Vec<Piece>,
    pub comments: Vec<Comment>,
    /// Place of a `/*` that is never closed.
    pub open_comment: Option<Span>,
}

/// Cuts a text into tokens. Never fails: what is no token becomes [`Lex::Unknown`].
pub(crate) fn lex(text: &str) -> Pieces {
    lex_with(text, CommentStyle::C)
}

/// The same for a text whose comments are written in a certain way.
pub(crate) fn lex_with(text: &str, comments: CommentStyle) -> Pieces {
    let mut out = Pieces::default();
    let (mut first, mut spaced) = (true, true);
    // A byte order mark at the start is no part of the text.
    let mark = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    let inside = in_raw_string(&text[mark..]).unwrap_or(&text[mark..]);
    let skip = inside.as_ptr().addr() - text.as_ptr().addr();
    for (token, range) in Lex::lexer_with_extras(inside, comments).spanned() {
        let span = Span::new(range.start + skip, range.end + skip);
        let lex = token.unwrap_or(Lex::Unknown);
        match lex {
            Lex::Blank | Lex::Splice => spaced = true,
            Lex::Newline => (first, spaced) = (true, true),
            Lex::LineComment if comments == CommentStyle::C && is_hook(&text[span.range()]) => {
                out.pieces.push(Piece { lex: Lex::Hole, span, first, spaced: true });
                (first, spaced) = (false, true);
            }
            Lex::LineComment | Lex::BlockComment(_) => {
                spaced = true;
                if lex == Lex::BlockComment(false) {
                    out.open_comment = Some(Span::new(span.start, span.start + 2));
                }
                out.comments.push(Comment { span, block: lex != Lex::LineComment });
            }
            Lex::Unknown => {
                match out.pieces.last_mut() {
                    // Neighbours are one thing to tell.
                    Some(last) if last.lex == Lex::Unknown && last.span.end == span.start => last.span.end = span.end,
                    _ => out.pieces.push(Piece { lex, span, first, spaced }),
                }
                (first, spaced) = (false, false);
            }
            Lex::Number if let Some(at) = swizzled(&text[span.range()]) => {
                let [point, word] = [span.start + at, span.start + at + 1];
                out.pieces.push(Piece { lex, span: Span::new(span.start, point), first, spaced });
                (first, spaced) = (false, false);
                out.pieces.push(Piece { lex: Lex::Dot, span: Span::new(point, word), first, spaced });
                out.pieces.push(Piece { lex: Lex::Word, span: Span::new(word, span.end), first, spaced });
            }
            _ => {
                out.pieces.push(Piece { lex, span, first, spaced });
                (first, spaced) = (false, false);
            }
        }
    }
    out
}

/// The inside of a text that is a raw string of C++ as a whole, which a host includes: `R"glsl(…)glsl"`.
fn in_raw_string(text: &str) -> Option<&str> {
    let (delimiter, rest) = text.trim_start().strip_prefix("R\"")?.split_once('(')?;
    let is_name = delimiter.len() <= 16 && delimiter.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let rest = rest.trim_end().trim_end_matches(';').trim_end();
    rest.strip_suffix('"')?.strip_suffix(delimiter)?.strip_suffix(')').filter(|_| is_name)
}

/// True for a comment that is a path and nothing else, `//VTK::Light::Impl`: a host puts something in its place.
fn is_hook(comment: &str) -> bool {
    let mut parts = comment.trim_start_matches('/').trim().split("::").peekable();
    let is_name = |part: &str| !part.is_empty() && super::words::identifier(part) == part;
    parts.next().is_some_and(is_name) && parts.peek().is_some() && parts.all(is_name)
}

/// The last point of what starts like a number and is one with a swizzle: `0.25f.xxxx`, `1u.xx`.
fn swizzled(text: &str) -> Option<usize> {
    let at = text.rfind('.')?;
    let (number, swizzle) = (&text[..at], &text[at + 1..]);
    let letters = |set: &str| !swizzle.is_empty() && swizzle.chars().all(|c| set.contains(c));
    let complete = match number.contains('.') {
        true => number.ends_with(|c: char| c.is_ascii_digit() || ".fF".contains(c)),
        false => number.ends_with(['u', 'U']),
    };
    (complete && ["xyzw", "rgba", "stpq"].iter().any(|set| letters(set))).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<&str> {
        lex(text).pieces.iter().map(|p| &text[p.span.range()]).collect()
    }

    #[test]
    fn the_longest_operator_wins() {
        assert_eq!(words("a<<=b>>c^^d^=e++ +f--"), "a <<= b >> c ^^ d ^= e ++ + f --".split(' ').collect::<Vec<_>>());
    }

    #[test]
    fn numbers_stay_in_one_piece() {
        assert_eq!(words("1.0e-5f+.5-0x1Fu*3.lf"), ["1.0e-5f", "+", ".5", "-", "0x1Fu", "*", "3.lf"]);
        assert_eq!(words("0xE+1 1e+2"), ["0xE", "+", "1", "1e+2"]);
        assert_eq!(words("0.25f.xxxx 1.0.x 1.5.2 .5.f"), ["0.25f", ".", "xxxx", "1.0", ".", "x", "1.5.2", ".5.f"]);
        assert_eq!(words("1u.xx 0x1FU.r 1u.5"), ["1u", ".", "xx", "0x1FU", ".", "r", "1u.5"]);
    }

    #[test]
    fn spans_behind_multi_byte_comments_are_exact() {
        let text = "/* 頂点 */ a // 球\nb";
        let out = lex(text);
        assert_eq!(words(text), ["a", "b"]);
        assert_eq!(out.comments.iter().map(|c| &text[c.span.range()]).collect::<Vec<_>>(), ["/* 頂点 */", "// 球"]);
        assert!(out.pieces.iter().all(|p| p.first), "the block comment leaves `a` first on its line");
    }

    #[test]
    fn a_backslash_joins_lines_and_comments() {
        assert_eq!(words("a // x \\\n still\nb"), ["a", "b"]);
        assert_eq!(words("a // x \\\r\n still\r\nb"), ["a", "b"]);
        let out = lex("#define A \\\n 1\nb");
        assert_eq!(out.pieces.iter().map(|p| p.first).collect::<Vec<_>>(), [true, false, false, false, true]);
    }

    #[test]
    fn unknown_characters_are_joined_and_a_bom_is_skipped() {
        assert_eq!(words("\u{feff}a\u{3000}\u{3000}@b"), ["a", "\u{3000}\u{3000}@", "b"]);
    }

    #[test]
    fn comments_of_wgsl_hold_others_and_end_with_their_line() {
        let text = "a /* /* b */ c */ d // \\\n e";
        let words = |style| lex_with(text, style).pieces.iter().map(|p| &text[p.span.range()]).collect::<Vec<_>>();
        assert_eq!(words(CommentStyle::Wgsl), ["a", "d", "e"]);
        assert_eq!(words(CommentStyle::C), ["a", "c", "*", "/", "d"]);
        assert!(lex_with("/* /* */", CommentStyle::Wgsl).open_comment.is_some());
    }

    #[test]
    fn an_open_comment_is_noticed() {
        assert_eq!(lex("a /* b").open_comment, Some(Span::new(2, 4)));
        assert_eq!(lex("a /* b */").open_comment, None);
    }

    #[test]
    fn a_raw_string_is_read_inside() {
        for text in ["R\"(\nint a;\n)\"", "\u{feff}R\"glsl(int a;)glsl\"\n", "  R\"(int a;)\";\n"] {
            assert_eq!(words(text), ["int", "a", ";"], "{text}");
        }
        assert_eq!(words("R\"(int a;")[..2], ["R", "\""]);
        assert_eq!(words("R(a) + \"b\"")[..2], ["R", "("]);
    }
}
