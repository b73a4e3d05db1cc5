//! Text to tokens (WGSL, section 3 "Textual structure"), with the lines that engines put between them.

use logos::{Lexer, Logos};

use super::super::{Comment, Token, TokenKind, TokenPlace};
use base::text::Span;

/// What the text is made of.
#[derive(Logos, Clone, Copy, Debug, PartialEq, Eq)]
enum Lex {
    #[regex(r"[ \t\x0b\x0c\u{85}\u{200E}\u{200F}\u{2028}\u{2029}]+")]
    Blank,
    #[regex(r"\r\n|\n|\r")]
    Newline,
    #[regex(r"//[^\r\n]*", allow_greedy = true)]
    LineComment,
    #[token("/*", block_comment)]
    BlockComment,
    /// `#{NAME}` is a name that an engine fills in.
    #[regex(r"[\p{XID_Start}_][\p{XID_Continue}]*")]
    #[regex(r"#\{[A-Za-z0-9_]*\}")]
    Word,
    #[regex(r"0[xX][0-9a-fA-F.]*([pP][+-]?[0-9]*)?(l?[iuf]|h)?")]
    #[regex(r"[0-9]+(\.[0-9]*)?([eE][+-]?[0-9]+)?(l?[iuf]|h)?")]
    #[regex(r"\.[0-9]+([eE][+-]?[0-9]+)?(l?f|h)?")]
    Number,
    #[regex(r"->|&&|\|\||==|!=|<=|>=|\+=|-=|\*=|/=|%=|&=|\|=|\^=|<<=|>>=|<<|>>|\+\+|--|::")]
    #[regex(r"[-+*/%&|^<>=!~(){}\[\];:,.@]")]
    Punctuation,
    #[token("#")]
    Hash,
}

/// Block comments nest. One without an end goes to the end of the text.
fn block_comment(lexer: &mut Lexer<'_, Lex>) {
    let text = lexer.remainder().as_bytes();
    let (mut depth, mut at) = (1, 0);
    while depth > 0 && at < text.len() {
        match &text[at..text.len().min(at + 2)] {
            b"/*" => (depth, at) = (depth + 1, at + 2),
            b"*/" => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
    }
    // What is bumped over ends at a character: `*/` does, and so does the text.
    lexer.bump(at.min(text.len()));
}

/// Tokens and comments of a text.
#[derive(Debug, Default)]
pub(super) struct Pieces {
    /// Tokens that are read: no directives, and of alternatives the first.
    pub active: Vec<Token>,
    /// All tokens.
    pub all: Vec<Token>,
    pub comments: Vec<Comment>,
    /// The words behind the `#` of directives.
    pub directives: Vec<Span>,
    /// True when lines that begin with `#`, or marks of templates, say that an engine makes the text.
    pub composed: bool,
    /// True when an engine leaves parts of the text out or fills them in.
    pub varies: bool,
    /// True when parts are filled in that are not seen here.
    pub filled: bool,
}

/// True where a token and the one before it are a mark of a template, which WGSL does not have. `rest` is the text from
/// the token on.
fn is_template(before: &str, token: &str, adjacent: bool, rest: &str) -> bool {
    let mark = |c| matches!((before, c), ("{", "{" | "%") | ("<", "%"));
    // No block opens behind an operator, and none is one name.
    let inner = |rest: &str| rest.chars().all(|c| c.is_alphanumeric() || "_. ".contains(c));
    // A name is short; what is behind it may be long.
    let rest = rest.char_indices().nth(64).map_or(rest, |(end, _)| &rest[..end]);
    let value = matches!(before, "(" | "," | "[" | "=" | "+" | "-" | "*" | "/" | "<")
        && rest.strip_prefix('{').and_then(|r| r.split_once('}')).is_some_and(|(name, _)| inner(name));
    token.starts_with("#{") || token.starts_with(['`', '$']) || value || (adjacent && mark(token))
}

/// Reads a text into tokens.
pub(super) fn read(text: &str) -> Pieces {
    let mut pieces = Pieces::default();
    let mut lexer = Lex::lexer(text);
    // Whether each open `#if` is in its first branch; nothing is read in the others.
    let mut branches: Vec<bool> = Vec::new();
    let (mut at_start, mut directive, mut braces) = (true, false, 0usize);
    // Inside of an `import` of WESL, which ends with a semicolon; and how many brackets are open around the token.
    let (mut importing, mut depth) = (false, 0usize);
    while let Some(lex) = lexer.next() {
        let span = Span::new(lexer.span().start, lexer.span().end);
        let kind = match lex {
            Ok(Lex::Blank) => continue,
            Ok(Lex::Newline) => {
                at_start = true;
                directive &= braces > 0;
                continue;
            }
            Ok(lex @ (Lex::LineComment | Lex::BlockComment)) => {
                pieces.comments.push(Comment { span, block: lex == Lex::BlockComment });
                continue;
            }
            Ok(Lex::Hash) if at_start => {
                (directive, braces, pieces.composed) = (true, 0, true);
                let line = lexer.remainder().lines().next().unwrap_or("");
                let start = span.end + (line.len() - line.trim_start().len());
                let line = line.trim_start();
                let word = line.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(line.len());
                pieces.directives.push(Span::new(start, start + word));
                let is = |word: &str| line.starts_with(word);
                pieces.filled |= is("include");
                pieces.varies |= ["if", "for"].iter().any(|w| is(w));
                if is("if") {
                    branches.push(true);
                } else if is("endif") {
                    branches.pop();
                } else if is("el")
                    && let Some(first) = branches.last_mut()
                {
                    *first = false;
                }
                TokenKind::Punctuation
            }
            Ok(Lex::Word) => TokenKind::Word,
            Ok(Lex::Number) => TokenKind::Number,
            Ok(Lex::Punctuation) => TokenKind::Punctuation,
            Ok(Lex::Hash) | Err(()) => TokenKind::Unknown,
        };
        at_start = false;
        let last = pieces.all.last().map_or(Span::at(0), |t| t.span);
        if !directive
            && is_template(&text[last.range()], &text[span.range()], last.end == span.start, &text[span.start..])
        {
            (pieces.composed, pieces.varies) = (true, true);
            // What naga_oil fills in is a number, and uses no variable.
            pieces.filled |= !text[span.range()].starts_with("#{");
        }
        let last = &text[last.range()];
        match &text[span.range()] {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth = depth.saturating_sub(1),
            "import" if depth == 0 && !directive && matches!(last, "" | ";" | "}" | ")") => {
                (importing, pieces.composed) = (true, true);
            }
            "if" | "elif" | "else" if last == "@" => {
                // Both branches are read, and what they declare has one name.
                (pieces.composed, pieces.varies, pieces.filled) = (true, true, true);
            }
            _ => {}
        }
        if directive {
            match &text[span.range()] {
                "{" => braces += 1,
                "}" => braces = braces.saturating_sub(1),
                _ => {}
            }
        }
        let place = if directive || importing {
            TokenPlace::Directive
        } else if branches.iter().all(|first| *first) {
            TokenPlace::Text
        } else {
            TokenPlace::Inactive
        };
        importing &= &text[span.range()] != ";";
        let token = Token { kind, span, place };
        pieces.all.push(token);
        if place == TokenPlace::Text {
            pieces.active.push(token);
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    fn active(text: &str) -> Vec<&str> {
        read(text).active.iter().map(|t| &text[t.span.range()]).collect()
    }

    #[test]
    fn numbers_words_and_operators_are_told_apart() {
        assert_eq!(active("a.x>>=1.5e-3f-0x1p4h.5"), ["a", ".", "x", ">>=", "1.5e-3f", "-", "0x1p4h", ".5"]);
        assert_eq!(active("größe /* a /* b */ c */ = 1u; // d"), ["größe", "=", "1u", ";"]);
        assert_eq!(active("1lu+31li-2.5lf*0x7lu"), ["1lu", "+", "31li", "-", "2.5lf", "*", "0x7lu"]);
        assert_eq!(active("/* open"), [""; 0]);
        assert_eq!(active("a /* b /* c */ d */ e // f\ng"), ["a", "e", "g"]);
        assert_eq!((active("a /* b"), active("a //")), (vec!["a"], vec!["a"]));
        assert_eq!(active("1.5e-3f+.5-0x1.8p+3-2"), ["1.5e-3f", "+", ".5", "-", "0x1.8p+3", "-", "2"]);
    }

    #[test]
    fn lines_of_engines_are_no_tokens_and_the_first_branch_is_read() {
        let text = "#import a::{\n  b,\n  c,\n}\n#ifdef X\nlet a = 1;\n#else\nlet b = 2;\n#endif\nlet c = #{N};\n";
        assert_eq!(active(text), ["let", "a", "=", "1", ";", "let", "c", "=", "#{N}", ";"]);
        assert!(read(text).composed && !read("let a = 1;").composed);
        assert!(read("@workgroup_size({size})").filled && !read("fn f( { let").composed);
    }
}
