//! `#if` to `#endif`: which lines are compiled (GLSL 4.60 specification, section 3.3).

use std::sync::Arc;

use super::super::lexer::{Lex, Piece};
use super::macros::{Spelling, Tok};
use super::{Preprocessor, condition, errors, macros};
use base::text::Span;

/// One `#if` that is still open.
pub(super) struct Conditional {
    pub(super) span: Span,
    /// Lines are compiled now.
    pub(super) active: bool,
    /// A branch was taken, or the whole lies in a part that is left out.
    pub(super) done: bool,
    pub(super) seen_else: bool,
    /// The macro for want of which the first branch is compiled: `#ifndef NAME`.
    pub(super) wants: Option<String>,
}

impl Preprocessor<'_> {
    pub(super) fn stray(&mut self, name: &str, span: Span) {
        self.sink.error(errors::CONDITIONAL, span, format!("`#{name}` without `#if`"), "belongs to no `#if`");
    }

    pub(super) fn open(&mut self, word: &str, name: &Piece, rest: &[Piece], span: Span) {
        let outer = self.active();
        let value = outer
            && match (word, rest) {
                ("if", _) => self.condition(rest, span),
                (_, [one]) if one.lex == Lex::Word => self.is_defined(&self.slice(one)) == (word == "ifdef"),
                // `#ifdef 0` leaves out what follows in preprocessors of WGSL.
                (_, [one]) if one.lex == Lex::Number && self.plain.is_some() => word == "ifndef",
                _ => {
                    self.malformed(span, &format!("`#{word}` takes one name"));
                    false
                }
            };
        let wants = match (word, rest) {
            ("ifndef", [name]) => Some(name),
            ("if", [not, defined, name] | [not, defined, _, name, _])
                if not.lex == Lex::Bang && self.slice(defined) == "defined" =>
            {
                Some(name)
            }
            _ => None,
        };
        let wants = wants.filter(|name| name.lex == Lex::Word).map(|name| self.slice(name));
        let span = Span::new(span.start, name.span.end);
        self.conditionals.push(Conditional { span, active: value, done: value || !outer, seen_else: false, wants });
    }

    pub(super) fn elif(&mut self, rest: &[Piece], span: Span) {
        let Some(top) = self.conditionals.last() else { return self.stray("elif", span) };
        let (done, seen_else) = (top.done, top.seen_else);
        if seen_else {
            self.sink.error(errors::CONDITIONAL, span, "`#elif` behind `#else`", "must come before `#else`");
        }
        let value = !done && !seen_else && self.condition(rest, span);
        if let Some(top) = self.conditionals.last_mut() {
            top.active = value;
            top.done |= value;
            top.wants = None;
        }
    }

    pub(super) fn otherwise(&mut self, rest: &[Piece], span: Span) {
        self.extra(rest, "else");
        let Some(top) = self.conditionals.last_mut() else { return self.stray("else", span) };
        let again = std::mem::replace(&mut top.seen_else, true);
        top.active = !top.done && !again;
        top.done = true;
        top.wants = None;
        if again {
            self.sink.error(errors::CONDITIONAL, span, "a second `#else` for one `#if`", "second `#else`");
        }
    }

    pub(super) fn is_defined(&self, name: &str) -> bool {
        self.macros.contains_key(name) || matches!(name, "__LINE__" | "__FILE__")
    }

    pub(super) fn condition(&mut self, rest: &[Piece], span: Span) -> bool {
        // `defined` must see names before they are expanded.
        let mut tokens = Vec::with_capacity(rest.len());
        let mut at = 0;
        while let Some(piece) = rest.get(at) {
            at += 1;
            if piece.lex == Lex::Unknown {
                return self.condition_failed(piece.span, "this is not part of a condition");
            }
            if piece.lex != Lex::Word || self.slice(piece) != "defined" {
                tokens.push(Tok::new(piece));
                continue;
            }
            let (name, used) = match &rest[at..] {
                [l, name, r, ..] if (l.lex, name.lex, r.lex) == (Lex::LParen, Lex::Word, Lex::RParen) => (name, 3),
                [name, ..] if name.lex == Lex::Word => (name, 1),
                _ => return self.condition_failed(piece.span, "`defined` takes a name, as in `defined(NAME)`"),
            };
            at += used;
            let value: Arc<str> = if self.is_defined(&self.slice(name)) { "1".into() } else { "0".into() };
            let number = Piece { lex: Lex::Number, span: piece.span.to(name.span), ..*piece };
            tokens.push(Tok { spelling: Spelling::Made(value), ..Tok::new(&number) });
        }
        let mut tokens = macros::expand(tokens, &self.macros, self.line_shift, self.sink);
        if self.plain.is_some() && !self.plain_condition(&mut tokens) {
            return false;
        }
        if tokens.iter().any(|tok| tok.lex == Lex::Hole) {
            self.holes.push(span);
            return false;
        }
        match condition::evaluate(&tokens, &self.sink.file, span) {
            Ok(value) => value,
            Err(error) => self.condition_failed(error.span, &error.message),
        }
    }

    pub(super) fn condition_failed(&mut self, span: Span, message: &str) -> bool {
        self.sink.error(errors::DIRECTIVE, span, message, "in this condition");
        false
    }
}
