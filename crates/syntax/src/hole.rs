//! Holes: `${x}`, `#{x}`, `{{ x }}`, `{% … %}`, `@name`, `%NAME%`, `%1`, `[[X]]`, `<hook>`. No version of the language has them; a template
//! engine, or another preprocessor, puts something in their place. Each is one token, which stands for whatever is needed there.

use std::cell::OnceCell;
use std::collections::HashSet;

use super::is_macro;
use super::lexer::{Lex, Piece};
use super::parser::{HINTS, words};
use base::text::Span;

/// A hole of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hole {
    /// Its place.
    pub span: Span,
    /// It stands for declarations or statements, or decides which of them are there, and not for a name, a type or a value.
    pub whole: bool,
}

/// Makes one piece of each hole, with the parts of a name beside it: `vec%N%`, `input_${n}`, `${n}.0`.
pub(crate) fn join(text: &str, pieces: Vec<Piece>) -> Vec<Piece> {
    let mut out: Vec<Piece> = Vec::with_capacity(pieces.len());
    let names = OnceCell::new();
    let (mut at, mut end, mut directive, mut quoted) = (0, 0, false, false);
    while let Some(&piece) = pieces.get(at) {
        if piece.first || at >= end {
            end = pieces.iter().skip(at + 1).position(|p| p.first).map_or(pieces.len(), |n| at + 1 + n);
            directive = piece.lex == Lex::Hash;
            quoted = false;
        }
        let reader = Reader { text, pieces: &pieces, names: &names, at, line: end - at, directive };
        let Some(len) = reader.length().filter(|_| !quoted) else {
            quoted ^= piece.lex == Lex::Unknown && text[piece.span.range()].matches('"').count() % 2 == 1;
            out.push(piece);
            at += 1;
            continue;
        };
        at += len;
        let mut hole = Piece { lex: Lex::Hole, span: piece.span.to(pieces[at - 1].span), ..piece };
        if !is_control(&text[hole.span.range()]) {
            let part = |p: &Piece| matches!(p.lex, Lex::Word | Lex::Number | Lex::Hole);
            if let Some(before) = out.pop_if(|p| part(p) && !hole.spaced) {
                hole = Piece { span: before.span.to(hole.span), ..before };
                hole.lex = Lex::Hole;
            }
            while let Some(behind) = pieces.get(at).filter(|p| part(p) && !p.spaced) {
                hole.span = hole.span.to(behind.span);
                at += 1;
            }
        }
        out.push(hole);
    }
    out
}

/// True for what an engine reads as a statement of its own: it stands for no name and no value.
pub(crate) fn is_control(hole: &str) -> bool {
    ["{%", "{#", "{{#", "{{/", "{{^", "{{>", "{{else"].iter().any(|mark| hole.starts_with(mark))
}

/// True for a name that is none: a hole stands for it.
pub(crate) fn stands_for(name: &str) -> bool {
    super::words::identifier(name) != name
}

/// Pieces that a hole has at most, unless it goes on to the end of its line.
const LONGEST: usize = 256;

struct Reader<'t> {
    text: &'t str,
    pieces: &'t [Piece],
    /// Names of the text that stand between no marks.
    names: &'t OnceCell<HashSet<&'t str>>,
    at: usize,
    /// Pieces up to the end of the line.
    line: usize,
    /// The line is a directive.
    directive: bool,
}

impl<'t> Reader<'t> {
    fn slice(&self, k: usize) -> &'t str {
        self.pieces.get(self.at + k).map_or("", |p| &self.text[p.span.range()])
    }

    /// What stands right behind the piece before, on the same line.
    fn glued(&self, k: usize) -> Option<Lex> {
        self.pieces.get(self.at + k).filter(|p| k < self.line && !p.spaced).map(|p| p.lex)
    }

    /// The piece behind the bracket that closes the one at `open`.
    fn bracketed(&self, open: usize) -> Option<usize> {
        let mut depth = 0_usize;
        for k in open..self.line.min(LONGEST) {
            match self.pieces[self.at + k].lex {
                Lex::LParen | Lex::LBrace | Lex::LBracket => depth += 1,
                Lex::RParen | Lex::RBrace | Lex::RBracket => depth = depth.saturating_sub(1),
                _ => {}
            }
            if depth == 0 {
                return Some(k + 1);
            }
        }
        None
    }

    /// The pieces up to a mark of an engine, which may stand on another line.
    fn up_to(&self, mark: &str) -> Option<usize> {
        let rest = &self.pieces[self.at..];
        let end = rest.iter().take(LONGEST).position(|p| self.text[p.span.start..].starts_with(mark))?;
        Some(end + mark.len())
    }

    /// True for a name of the text itself.
    fn is_name(&self, name: &str) -> bool {
        let names = self.names.get_or_init(|| {
            let marked = |k: usize| matches!(self.pieces[k].lex, Lex::LBrace | Lex::Percent);
            let own = |k: &usize| self.pieces[*k].lex == Lex::Word && k.checked_sub(1).is_none_or(|k| !marked(k));
            (0..self.pieces.len()).filter(own).map(|k| &self.text[self.pieces[k].span.range()]).collect()
        });
        names.contains(name)
    }

    /// The pieces of the hole that begins here; none where the language goes on.
    fn length(&self) -> Option<usize> {
        let first = self.pieces[self.at];
        let before = self.at.checked_sub(1).map(|k| &self.pieces[k]);
        // No operator can stand where none of these stands before.
        let operand = before.is_some_and(|p| match p.lex {
            Lex::Word => !words::is_statement_word(&self.text[p.span.range()]),
            lex => matches!(lex, Lex::Number | Lex::RParen | Lex::RBracket),
        });
        let before = before.map(|p| p.lex);
        match first.lex {
            Lex::Unknown => self.foreign(first.first),
            Lex::LBrace => match self.glued(1)? {
                Lex::Percent => self.up_to("%}"),
                Lex::Hash => self.up_to("#}"),
                Lex::LBrace => self.braces(before),
                // `{BODY}` on a line of its own: a block of one name has a `;`.
                Lex::Word if first.first && self.line == 3 && self.glued(2) == Some(Lex::RBrace) => {
                    let name = self.slice(1);
                    (is_macro(name) && !self.text.contains(&format!("define {name}"))).then_some(3)
                }
                // `{decode}(raw)`: no list and no block is called.
                Lex::Word if (self.glued(2), self.glued(3)) == (Some(Lex::RBrace), Some(Lex::LParen)) => Some(3),
                // `float w[{COUNT}];`
                Lex::Word if matches!(before?, Lex::LBracket | Lex::LParen | Lex::Less | Lex::LessEqual) => {
                    (self.glued(2) == Some(Lex::RBrace) && is_macro(self.slice(1))).then_some(3)
                }
                _ => None,
            },
            Lex::LBracket if (self.glued(1), self.glued(2)) == (Some(Lex::LBracket), Some(Lex::Word)) => {
                let closed = (self.glued(3), self.glued(4)) == (Some(Lex::RBracket), Some(Lex::RBracket));
                (closed && !HINTS.contains(&self.slice(2))).then_some(5)
            }
            // `#define N #{count}`: no directive begins within a line, and none is called `{`.
            Lex::Hash if self.glued(1) == Some(Lex::LBrace) => self.bracketed(1),
            // `#version NAME`
            Lex::Word if self.directive && before == Some(Lex::Word) => {
                let of_version = |k: usize| self.at.checked_sub(k).map(|k| &self.text[self.pieces[k].span.range()]);
                ((of_version(2), of_version(1)) == (Some("#"), Some("version"))).then_some(1)
            }
            // `%1` of Qt: where no operand stands before, no remainder is taken.
            Lex::Percent if !operand && self.glued(1) == Some(Lex::Number) => Some(2),
            Lex::Percent if (self.glued(1), self.glued(2)) == (Some(Lex::Word), Some(Lex::Percent)) => {
                let goes_on = matches!(self.glued(3), Some(Lex::Word | Lex::Number | Lex::LParen));
                let remainder = operand && !first.spaced && goes_on;
                (!remainder && !self.is_name(self.slice(1))).then_some(3)
            }
            // `%ws`, `%d`: no remainder is taken of nothing.
            Lex::Percent if !operand && self.glued(1) == Some(Lex::Word) => Some(2),
            Lex::HashHash if !self.directive => {
                ((self.glued(1), self.glued(2)) == (Some(Lex::Word), Some(Lex::HashHash))).then_some(3)
            }
            // Behind an operand, `arrow_<kind>(p)`: in an expression a `bool` would be compared.
            Lex::Less if !self.directive && (!operand || !first.spaced) && self.glued(1) == Some(Lex::Word) => {
                let path = (2..self.line).find(|k| !matches!(self.glued(*k), Some(Lex::Dot | Lex::Word)))?;
                let end = if self.glued(path) == Some(Lex::LParen) { self.bracketed(path)? } else { path };
                let called = !operand || (end == path && self.glued(end + 1) == Some(Lex::LParen));
                (called && self.glued(end) == Some(Lex::Greater)).then_some(end + 1)
            }
            _ => None,
        }
    }

    /// What begins with a character that the language does not have.
    fn foreign(&self, first: bool) -> Option<usize> {
        match self.slice(0).chars().next()? {
            '@' if self.glued(1) == Some(Lex::Word) => Some(match self.slice(2) {
                _ if first => self.line,
                "@" => 3,
                _ => 2,
            }),
            '$' => {
                let len = match self.glued(1)? {
                    Lex::LBrace => self.bracketed(1).unwrap_or(self.line),
                    Lex::Word => 2,
                    _ => return None,
                };
                // `$if X:`, `$X = Y` and `$declare(a, b)`, each on a line of its own.
                let second = self.pieces.get(self.at + len).map(|p| p.lex);
                let controls = len == 2
                    && match self.pieces[self.at + self.line - 1].lex {
                        Lex::Colon => true,
                        Lex::Semicolon => false,
                        _ => second == Some(Lex::Assign),
                    };
                let calls = || self.glued(len) == Some(Lex::LParen) && self.bracketed(len) == Some(self.line);
                // `$constant NAME VALUE`: words alone, on a line of their own, are no declaration.
                let line = || &self.pieces[self.at + len..self.at + self.line];
                let words = || self.line > len + 1 && line().iter().all(|p| matches!(p.lex, Lex::Word | Lex::Number));
                Some(if first && (controls || calls() || words()) { self.line } else { len })
            }
            // A line of a fence is no directive.
            '`' if first && self.glued(1) == Some(Lex::Word) => Some(self.line),
            _ => None,
        }
    }

    /// `{{ x }}`, unless it is a block in a block, or initialises something: `{{a, b}}`, and `{{a}}` where the text has an `a`.
    fn braces(&self, before: Option<Lex>) -> Option<usize> {
        let closed = |k: &usize| self.pieces[self.at + k].lex == Lex::RBrace && self.glued(k + 1) == Some(Lex::RBrace);
        let end = (2..self.line.min(LONGEST)).find(closed)? + 2;
        let triple = self.glued(2) == Some(Lex::LBrace);
        let from = if triple { 3 } else { 2 };
        let inside = self.pieces.get(self.at + from..self.at + end - 2).filter(|inside| !inside.is_empty())?;
        let has = |lex: Lex| inside.iter().any(|p| p.lex == lex);
        let initialises = matches!(before, Some(Lex::Assign | Lex::Comma | Lex::LBrace))
            && (has(Lex::Comma) || inside[0].lex != Lex::Word || self.is_name(self.slice(from)));
        let end = if triple { self.glued(end).filter(|lex| *lex == Lex::RBrace).map(|_| end + 1)? } else { end };
        (!has(Lex::Semicolon) && !has(Lex::LBrace) && !initialises).then_some(end)
    }
}
