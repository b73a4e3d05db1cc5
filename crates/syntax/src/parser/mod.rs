//! Tokens to syntax tree, by recursive descent (GLSL 4.60 specification, chapter 9). An error is
//! told once; reading goes on behind the next `;` or `}`, or at a line that starts a statement.

mod declaration;
mod expression;
mod qualifier;
mod statement;
pub(super) mod words;

use super::ast::{Arena, Expr, ExprId, ExprKind, Ident, Unit};
use super::errors;
use super::language::Language;
use super::lexer::Lex;
use super::preprocess::Tok;
use super::sink::Sink;
use base::diagnostic::{Safety, message};
use base::text::{Edit, SourceFile, Span};
pub(crate) use statement::HINTS;
use words::Words;
pub(crate) use words::suggestions;

/// The error has been told; the caller recovers.
#[derive(Debug)]
pub(crate) struct Message;

pub(crate) type Read<T> = Result<T, Message>;

/// Levels of brackets, operators and statements within each other. Keeps the recursion, ours and
/// that of every walk over the tree, far from the end of the stack.
const DEEPEST: usize = 300;
/// Longest chain of operands below one expression, such as `a + a + …`.
const LONGEST_CHAIN: u32 = 1000;

pub(crate) struct Parser<'a> {
    file: SourceFile,
    sink: &'a mut Sink,
    tokens: Vec<Tok>,
    end: Tok,
    at: usize,
    depth: usize,
    words: Words,
    arena: Arena,
    /// An initialiser of the declaration at hand could not be read and was skipped.
    skipped: bool,
    /// Prototypes in the function at hand.
    prototypes: Vec<super::ast::Item>,
    /// Holes that stand for declarations and statements.
    holes: Vec<Span>,
}

pub(crate) fn parse(tokens: Vec<Tok>, language: &Language, sink: &mut Sink) -> (Unit, Arena, Vec<Span>) {
    let file = sink.file.clone();
    let end = Tok::end(tokens.last().map_or(file.text().len(), |t| t.span.end));
    let words = Words::new(language);
    let mut parser = Parser {
        file,
        sink,
        tokens,
        end,
        at: 0,
        depth: 0,
        words,
        arena: Arena::default(),
        skipped: false,
        prototypes: Vec::new(),
        holes: Vec::new(),
    };
    let unit = parser.unit();
    (unit, parser.arena, parser.holes)
}

impl Parser<'_> {
    fn tok(&self, ahead: usize) -> &Tok {
        self.tokens.get(self.at + ahead).unwrap_or(&self.end)
    }

    fn peek(&self) -> Lex {
        self.tok(0).lex
    }

    fn peek_at(&self, ahead: usize) -> Lex {
        self.tok(ahead).lex
    }

    /// Text of the token when it is a word, or stands for one, else empty.
    fn word_at(&self, ahead: usize) -> &str {
        let tok = self.tok(ahead);
        if tok.is_word() { tok.text(&self.file) } else { "" }
    }

    fn word(&self) -> &str {
        self.word_at(0)
    }

    fn span(&self) -> Span {
        self.tok(0).span
    }

    fn prev_span(&self) -> Span {
        self.at.checked_sub(1).map_or(Span::at(0), |i| self.tokens[i].span)
    }

    /// From `start` to the token read last.
    fn since(&self, start: Span) -> Span {
        start.to(self.prev_span())
    }

    fn advance(&mut self) -> Span {
        let span = self.span();
        if self.at < self.tokens.len() {
            self.at += 1;
        }
        span
    }

    fn eat(&mut self, lex: Lex) -> Option<Span> {
        (self.peek() == lex).then(|| self.advance())
    }

    fn eat_word(&mut self, word: &str) -> Option<Span> {
        (self.word() == word).then(|| self.advance())
    }

    fn at_end(&self) -> bool {
        self.at >= self.tokens.len()
    }

    /// What stands here, for messages.
    fn shown(&self) -> String {
        if self.at_end() { "the end of the file".to_owned() } else { format!("`{}`", self.tok(0).text(&self.file)) }
    }

    /// True where what stands here, or right before, is not known.
    fn is_unknown(&self) -> bool {
        let before = self.at.checked_sub(1).map(|i| self.tokens[i].lex);
        matches!(self.peek(), Lex::Unknown | Lex::Hole) || before == Some(Lex::Hole)
    }

    /// A hole that stands for whole declarations or statements.
    fn hole(&mut self) -> bool {
        if self.peek() != Lex::Hole {
            return false;
        }
        let ends = self.tok(1).first || matches!(self.peek_at(1), Lex::Semicolon | Lex::RBrace | Lex::End);
        let whole = ends || super::hole::is_control(self.word());
        if whole {
            self.holes.push(self.span());
            self.advance();
            self.eat(Lex::Semicolon);
        }
        whole
    }

    /// Skips what cannot be read. What has a hole in it is a hole, and nothing in it is told.
    fn skip(&mut self, from: usize, told: usize) {
        self.recover(from);
        if let Some(hole) = self.tokens[from..self.at].iter().find(|tok| tok.lex == Lex::Hole) {
            self.holes.push(hole.span);
            self.sink.truncate(told);
        }
    }

    /// Tells that `what` is expected here; a token that is none has been told already.
    fn expected<T>(&mut self, what: &str) -> Read<T> {
        if self.is_unknown() {
            return Err(Message);
        }
        let shown = self.shown();
        let span = if self.at_end() { Span::at(self.prev_span().end) } else { self.span() };
        self.sink.error(errors::SYNTAX, span, format!("expected {what}, found {shown}"), "here");
        Err(Message)
    }

    /// Tells that an expression is expected behind the last token.
    fn expected_expression<T>(&mut self) -> Read<T> {
        let before = match self.at.checked_sub(1) {
            Some(i) => format!(" after `{}`", self.tokens[i].text(&self.file)),
            None => String::new(),
        };
        self.expected(&format!("an expression{before}"))
    }

    fn expect(&mut self, lex: Lex, what: &str) -> Read<Span> {
        match self.eat(lex) {
            Some(span) => Ok(span),
            None => self.expected(what),
        }
    }

    /// Closes a bracket that was opened at `open`.
    fn close(&mut self, lex: Lex, text: &str, open: Span) -> Read<Span> {
        if let Some(span) = self.eat(lex) {
            return Ok(span);
        }
        if self.is_unknown() {
            return Err(Message);
        }
        let shown = self.shown();
        let span = if self.at_end() { Span::at(self.prev_span().end) } else { self.span() };
        let file = self.file.clone();
        let diagnostic = self
            .sink
            .start(errors::SYNTAX, span, format!("expected `{text}`, found {shown}"))
            .with_label("here")
            .with_related(&file, open, "opened here");
        self.sink.push(diagnostic);
        Err(Message)
    }

    /// The `;` behind a `what`. When the next token stands on another line, or starts a statement,
    /// it is enough to tell;
    /// then there is no `;`.
    fn semicolon(&mut self, what: &str) -> Read<Option<Span>> {
        if let Some(span) = self.eat(Lex::Semicolon) {
            return Ok(Some(span));
        }
        if self.peek() == Lex::Unknown {
            return Err(Message);
        }
        let place = self.prev_span().end;
        let edits = vec![Edit::insert(place, ";")];
        let next_line = self.tok(0).first || self.at_end() || self.peek() == Lex::RBrace || self.starts_statement();
        let from_macro = self.at.checked_sub(1).is_some_and(|i| self.tokens[i].from_macro);
        let mut diagnostic = self
            .sink
            .start(errors::SYNTAX, Span::at(place), format!("expected `;` after this {what}"))
            .with_label("`;` is missing");
        if next_line && !from_macro {
            diagnostic = diagnostic.with_fix("Insert `;`", Safety::Safe, edits);
        }
        self.sink.push(diagnostic);
        if next_line { Ok(None) } else { Err(Message) }
    }

    fn is_name(&self, ahead: usize) -> bool {
        self.tok(ahead).is_word() && !self.words.keyword(self.word_at(ahead))
    }

    /// A name that is no keyword.
    fn ident(&mut self, what: &str) -> Read<Ident> {
        if self.is_name(0) {
            let name = self.word().to_owned();
            self.reserved();
            return Ok(Ident { name, span: self.advance() });
        }
        if self.peek() == Lex::Word {
            let message = format!("`{}` is a keyword and cannot be {what}", self.word());
            self.sink.error(errors::SYNTAX, self.span(), message, "choose another name");
            return Err(Message);
        }
        self.expected(what)
    }

    /// Tells when the word here is kept for later versions.
    fn reserved(&mut self) {
        if !self.words.reserved(self.word()) {
            return;
        }
        let name = self.word().to_owned();
        let diagnostic = self
            .sink
            .start(errors::RESERVED, self.span(), message!("`{name}` is a reserved word", "`{name}` は予約語です"))
            .with_label(message!("cannot be a name", "名前には使えません"))
            .with_why(message!(
                "this version of the language keeps the word for itself",
                "このバージョンの言語がこの語を予約しています"
            ))
            .with_help(message!("choose another name", "別の名前にしてください"));
        self.sink.push(diagnostic);
    }

    /// Counts a level of recursion.
    fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Read<T>) -> Read<T> {
        if self.depth >= DEEPEST {
            let message = format!("the text is nested more than {DEEPEST} levels deep here, and is not read further");
            self.sink.error(errors::TOO_DEEP, self.span(), message, "split it into several statements");
            return Err(Message);
        }
        self.depth += 1;
        let result = read(self);
        self.depth -= 1;
        result
    }

    fn add(&mut self, kind: ExprKind, span: Span, from_macro: bool) -> Read<ExprId> {
        let id = self.arena.add(Expr { kind, span, from_macro });
        if self.arena.depth(id) == LONGEST_CHAIN {
            let message = format!("this expression has more than {LONGEST_CHAIN} operators in a row");
            self.sink.error(errors::TOO_DEEP, span, message, "split it into several statements");
            return Err(Message);
        }
        Ok(id)
    }

    /// Skips to behind the next `;` or block, or to a `}` that closes what is around, or to a
    /// line that starts a statement. Always moves past `from`, so that reading ends.
    fn recover(&mut self, from: usize) {
        let mut braces = 0_usize;
        while !self.at_end() {
            let moved = self.at > from;
            match self.peek() {
                Lex::Semicolon if braces == 0 => {
                    self.advance();
                    return;
                }
                Lex::LBrace => braces += 1,
                Lex::RBrace if braces == 0 => return,
                Lex::RBrace => {
                    braces -= 1;
                    if braces == 0 {
                        self.advance();
                        self.eat(Lex::Semicolon);
                        return;
                    }
                }
                Lex::Word if braces == 0 && moved && self.tok(0).first && self.starts_statement() => return,
                _ => {}
            }
            self.advance();
        }
    }

    /// Skips an initialiser that cannot be read: to the `;` of its declaration.
    fn skip_initializer(&mut self) {
        let mut open = 0_usize;
        while !self.at_end() {
            match self.peek() {
                Lex::Semicolon => return,
                Lex::LBrace => open += 1,
                Lex::RBrace if open == 0 => return,
                Lex::RBrace => open -= 1,
                Lex::Word if open == 0 && self.tok(0).first && self.starts_statement() => return,
                _ => {}
            }
            self.advance();
        }
    }

    /// True when the word here can start a statement or declaration.
    fn starts_statement(&self) -> bool {
        let word = self.word();
        words::is_statement_word(word)
            || self.words.qualifier(word)
            || word == "precision"
            || word == "struct"
            // `float x` starts one, `float(x)` may go on with an expression.
            || (super::types::Type::from_name(word).is_some() && self.peek_at(1) == Lex::Word)
    }
}
