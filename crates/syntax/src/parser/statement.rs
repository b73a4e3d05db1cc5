//! Statements.

use super::super::ast::{Condition, Declaration, Item, ItemKind, QualifiedNames, Qualifiers, Stmt, StmtKind};
use super::super::errors;
use super::super::is_macro;
use super::super::language::{Feature, NEVER, Since};
use super::super::lexer::Lex;
use super::{Message, Parser, Read};
use base::diagnostic::message;
use base::text::Span;

/// Hints for a compiler, which change no result.
pub(crate) const HINTS: [&str; 9] = [
    "unroll",
    "dont_unroll",
    "loop",
    "dont_loop",
    "branch",
    "flatten",
    "dont_flatten",
    "dependency_infinite",
    "subgroup_uniform_control_flow",
];

impl Parser<'_> {
    /// A statement; one that cannot be read is skipped and becomes an error node.
    pub(super) fn statement(&mut self) -> Stmt {
        let start = self.span();
        let (from, told) = (self.at, self.sink.len());
        match self.deeper(Self::statement_kind) {
            Ok(kind) => Stmt { kind, span: self.since(start) },
            Err(Message) => {
                self.skip(from, told);
                Stmt { kind: StmtKind::Error, span: self.since(start) }
            }
        }
    }

    /// Passes over `[[unroll]]` and the like: hints for a compiler, which change no result.
    /// (GL_EXT_control_flow_attributes, GL_EXT_subgroup_uniform_control_flow)
    pub(super) fn hints(&mut self) -> Read<()> {
        const SINCE: Since = (NEVER, NEVER, &["EXT_control_flow_attributes", "EXT_subgroup_uniform_control_flow"]);
        while (self.peek(), self.peek_at(1)) == (Lex::LBracket, Lex::LBracket) {
            if !self.words.language().since(SINCE) {
                let name = self.word_at(2).to_owned();
                if !HINTS.contains(&name.as_str()) {
                    return Ok(());
                }
                let (span, what) = (self.span(), message!("`[[{name}]]`", "`[[{name}]]`"));
                self.words.language().lacks(self.sink, &what, SINCE, span);
            }
            self.advance();
            self.advance();
            loop {
                if self.peek() != Lex::Word {
                    return self.expected("the name of an attribute");
                }
                self.advance();
                if let Some(open) = self.eat(Lex::LParen) {
                    self.expression()?;
                    self.close(Lex::RParen, ")", open)?;
                }
                if self.eat(Lex::Comma).is_none() {
                    break;
                }
            }
            self.expect(Lex::RBracket, "`]]` behind the attributes")?;
            self.expect(Lex::RBracket, "`]]` behind the attributes")?;
        }
        Ok(())
    }

    fn statement_kind(&mut self) -> Read<StmtKind> {
        if self.hole() || self.macro_alone() {
            return Ok(StmtKind::Error);
        }
        if self.hints().is_err() {
            // What they stand before can be read.
            while self.eat(Lex::RBracket).is_some() {}
        }
        match self.peek() {
            Lex::LBrace => return Ok(StmtKind::Block(self.block()?)),
            Lex::Semicolon => {
                self.advance();
                return Ok(StmtKind::Empty);
            }
            _ => {}
        }
        let word = self.word().to_owned();
        if word == "switch" && !self.words.keyword(&word) && self.peek_at(1) == Lex::LParen {
            let span = self.span();
            let feature = Feature::Switch;
            self.words.language().lacks(self.sink, &feature.name(), feature.since(), span);
            self.words.enable(&["switch", "case", "default"]);
        }
        if !self.words.keyword(&word) {
            return self.simple(&word);
        }
        match word.as_str() {
            "if" => self.if_statement(),
            "for" => self.for_statement(),
            "while" => {
                self.advance();
                let open = self.expect(Lex::LParen, "`(` after `while`")?;
                let condition = self.condition()?;
                self.close(Lex::RParen, ")", open)?;
                Ok(StmtKind::While { condition, body: Box::new(self.statement()) })
            }
            "do" => {
                self.advance();
                let body = Box::new(self.statement());
                if self.eat_word("while").is_none() {
                    return self.expected("`while` after the body of `do`");
                }
                let condition = self.parenthesised("while")?;
                self.semicolon("loop")?;
                Ok(StmtKind::DoWhile { body, condition })
            }
            "switch" => {
                self.advance();
                let selector = self.parenthesised("switch")?;
                Ok(StmtKind::Switch { selector, body: self.block()? })
            }
            "case" => {
                self.advance();
                let value = self.expression()?;
                self.expect(Lex::Colon, "`:` after the value of `case`")?;
                Ok(StmtKind::Case(value))
            }
            "default" => {
                self.advance();
                self.expect(Lex::Colon, "`:` after `default`")?;
                Ok(StmtKind::Default)
            }
            "return" => {
                self.advance();
                let value =
                    if matches!(self.peek(), Lex::Semicolon | Lex::RBrace) { None } else { Some(self.expression()?) };
                self.semicolon("statement")?;
                Ok(StmtKind::Return(value))
            }
            "break" | "continue" | "discard" => {
                self.advance();
                self.semicolon("statement")?;
                Ok(match word.as_str() {
                    "break" => StmtKind::Break,
                    "continue" => StmtKind::Continue,
                    _ => StmtKind::Discard,
                })
            }
            "else" => self.expected("a statement: this `else` belongs to no `if`"),
            _ => self.simple(&word),
        }
    }

    /// A name in capitals on a line of its own, in front of a statement: a mark that its host replaces, or a macro of the
    /// host's.
    fn macro_alone(&mut self) -> bool {
        let (own, next) = (self.tok(0), self.tok(1));
        let word = self.word().to_owned();
        let alone = own.first && next.first && own.lex == Lex::Word && next.lex == Lex::Word;
        if !alone || !is_macro(&word) || self.words.keyword(&word) || self.words.built_in_type(&word) {
            return false;
        }
        // The type of a variable that is named on the next line.
        if self.file.text().contains(&format!("struct {word}")) {
            return false;
        }
        let span = self.span();
        let message = format!("expected a statement, found `{word}` alone");
        self.sink.error(errors::SYNTAX, span, message, "no macro of this name is defined");
        self.holes.push(span);
        self.advance();
        true
    }

    /// A declaration or an expression, with the `;`.
    fn simple(&mut self, word: &str) -> Read<StmtKind> {
        if word == "precision" {
            return Ok(StmtKind::Precision(self.precision_statement()?));
        }
        if self.words.qualifier(word) {
            let start = self.span();
            let qualifiers = self.qualifiers()?;
            if let Some(names) = self.qualified_names(&qualifiers)? {
                return Ok(StmtKind::Qualified(QualifiedNames { qualifiers, names }));
            }
            let ty = self.type_specifier()?;
            return Ok(StmtKind::Declaration(self.declarators(start, qualifiers, ty)?));
        }
        if self.prototype_follows() {
            let start = self.span();
            let ty = self.type_specifier()?;
            let function = self.function(start, Qualifiers::default(), ty)?;
            if let Some(body) = &function.body {
                self.sink.error(errors::SYNTAX, body.span, "a function cannot be defined in another", "this body");
            }
            // It means what it means at file scope, where it is known from here on.
            self.prototypes.push(Item { kind: ItemKind::Function(function), span: self.since(start) });
            return Ok(StmtKind::Empty);
        }
        if self.declaration_follows() {
            return Ok(StmtKind::Declaration(self.declaration()?));
        }
        let value = self.expression()?;
        self.semicolon("statement")?;
        Ok(StmtKind::Expr(value))
    }

    /// True when a type and a name stand here: `T x`, `T[2] x`, `struct`.
    /// True at a prototype in a function, which GLSL 1.10 has (section 6.1) and no version behind it.
    fn prototype_follows(&self) -> bool {
        let language = self.words.language();
        let first = language.number() == 110 && !language.es();
        let parameter = self.peek_at(3) == Lex::RParen
            || self.words.built_in_type(self.word_at(3))
            || self.words.qualifier(self.word_at(3));
        let ty = self.word() == "void" || self.words.built_in_type(self.word());
        first && ty && self.peek_at(1) == Lex::Word && self.peek_at(2) == Lex::LParen && parameter
    }

    fn declaration_follows(&self) -> bool {
        if self.word() == "struct" {
            return true;
        }
        if !(self.words.built_in_type(self.word()) || self.is_name(0)) {
            return false;
        }
        let mut ahead = 1;
        let mut open = 0_usize;
        loop {
            match self.peek_at(ahead) {
                Lex::LBracket => open += 1,
                Lex::RBracket if open > 0 => open -= 1,
                Lex::Semicolon | Lex::LBrace | Lex::RBrace | Lex::End => return false,
                // `float;` and `float = 1;` are declarations without a name; but a lone name is an expression.
                lex if open == 0 => return matches!(lex, Lex::Word | Lex::Hole),
                _ => {}
            }
            ahead += 1;
        }
    }

    fn if_statement(&mut self) -> Read<StmtKind> {
        self.advance();
        let condition = self.parenthesised("if")?;
        let then = Box::new(self.statement());
        let otherwise = self.eat_word("else").map(|_| Box::new(self.statement()));
        Ok(StmtKind::If { condition, then, otherwise })
    }

    fn parenthesised(&mut self, word: &str) -> Read<super::ExprId> {
        let open = self.expect(Lex::LParen, &format!("`(` after `{word}`"))?;
        let value = self.expression()?;
        self.close(Lex::RParen, ")", open)?;
        Ok(value)
    }

    fn for_statement(&mut self) -> Read<StmtKind> {
        let start = self.advance();
        let open = self.expect(Lex::LParen, "`(` after `for`")?;
        let init_start = self.span();
        let init = if self.eat(Lex::Semicolon).is_some() {
            StmtKind::Empty
        } else {
            let word = self.word().to_owned();
            self.simple(&word)?
        };
        let init = Box::new(Stmt { kind: init, span: self.since(init_start) });
        let condition = if self.peek() == Lex::Semicolon { None } else { Some(self.condition()?) };
        self.expect(Lex::Semicolon, "`;` after the condition of `for`")?;
        let step = if self.peek() == Lex::RParen { None } else { Some(self.expression()?) };
        self.close(Lex::RParen, ")", open)?;
        let head_span: Span = self.since(start);
        Ok(StmtKind::For { init, condition, step, body: Box::new(self.statement()), head_span })
    }

    fn condition(&mut self) -> Read<Condition> {
        if !self.declaration_follows() && !self.words.qualifier(self.word()) {
            return Ok(Condition::Expr(self.expression()?));
        }
        let start = self.span();
        let qualifiers = self.qualifiers()?;
        let ty = self.type_specifier()?;
        let declarator = self.declarator()?;
        let span = self.since(start);
        Ok(Condition::Declaration(Declaration { qualifiers, ty, declarators: vec![declarator], span, semicolon: None }))
    }
}
