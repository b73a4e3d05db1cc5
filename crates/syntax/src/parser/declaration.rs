//! Items at file scope and declarations.

use super::super::ast::{
    Block, Declaration, Declarator, ExprKind, Function, Initializer, InterfaceBlock, Item, ItemKind, Param, Precision,
    PrecisionStatement, QualifiedNames, QualifierKind, Qualifiers, TypeKind, TypeSpecifier, Unit,
};
use super::super::errors;
use super::super::lexer::Lex;
use super::{Ident, Message, Parser, Read, words};
use base::text::Span;

impl Parser<'_> {
    pub(super) fn unit(&mut self) -> Unit {
        let mut items = Vec::new();
        while !self.at_end() {
            let start = self.span();
            let (from, told) = (self.at, self.sink.len());
            let kind = match self.item() {
                Ok(kind) => kind,
                Err(Message) => {
                    self.skip(from, told);
                    if self.peek() == Lex::RBrace && self.at == from {
                        self.advance();
                    }
                    ItemKind::Error
                }
            };
            items.append(&mut self.prototypes);
            items.push(Item { kind, span: self.since(start) });
        }
        Unit { items }
    }

    fn item(&mut self) -> Read<ItemKind> {
        if self.hole() {
            return Ok(ItemKind::Error);
        }
        match self.peek() {
            Lex::Semicolon => {
                self.advance();
                return Ok(ItemKind::Empty);
            }
            Lex::RBrace => {
                self.sink.error(errors::SYNTAX, self.span(), "this `}` closes nothing", "one `}` too many");
                self.advance();
                return Err(Message);
            }
            _ => {}
        }
        if self.word() == "precision" {
            return Ok(ItemKind::Precision(self.precision_statement()?));
        }
        if words::is_statement_word(self.word()) && self.words.keyword(self.word()) {
            let message = format!("`{}` stands outside any function", self.word());
            let diagnostic = self
                .sink
                .start(errors::SYNTAX, self.span(), message)
                .with_label("statements belong into functions")
                .with_help("look for a `}` too many above");
            self.sink.push(diagnostic);
            return Err(Message);
        }
        let start = self.span();
        let qualifiers = self.qualifiers()?;
        if !qualifiers.list.is_empty() {
            if self.eat(Lex::Semicolon).is_some() {
                return Ok(ItemKind::Qualified(QualifiedNames { qualifiers, names: Vec::new() }));
            }
            if self.is_name(0) && self.peek_at(1) == Lex::LBrace {
                return Ok(ItemKind::Block(self.interface_block(qualifiers)?));
            }
            // The name of a type that is declared below (GL_EXT_buffer_reference).
            let refers = qualifiers.layout_entry("buffer_reference").is_some();
            if refers && self.is_name(0) && self.peek_at(1) == Lex::Semicolon {
                self.advance();
                self.advance();
                return Ok(ItemKind::Qualified(QualifiedNames { qualifiers, names: Vec::new() }));
            }
            if let Some(names) = self.qualified_names(&qualifiers)? {
                return Ok(ItemKind::Qualified(QualifiedNames { qualifiers, names }));
            }
        } else if self.is_name(0) && self.peek_at(1) == Lex::LParen {
            let name = self.word().to_owned();
            return self.expected(&format!("a return type before `{name}`"));
        } else if self.is_name(0) && !matches!(self.peek_at(1), Lex::Word | Lex::Hole | Lex::LBracket) {
            return self.expected("a declaration");
        }
        let ty = self.type_specifier()?;
        if self.peek_at(1) == Lex::LParen && self.tok(0).is_word() {
            return Ok(ItemKind::Function(self.function(start, qualifiers, ty)?));
        }
        Ok(ItemKind::Declaration(self.declarators(start, qualifiers, ty)?))
    }

    /// Names behind `invariant` or `precise`, when no type stands there.
    pub(super) fn qualified_names(&mut self, qualifiers: &Qualifiers) -> Read<Option<Vec<Ident>>> {
        if !self.is_name(0) || !matches!(self.peek_at(1), Lex::Semicolon | Lex::Comma | Lex::Assign) {
            return Ok(None);
        }
        let plain =
            qualifiers.list.iter().all(|q| {
                matches!(q.kind, QualifierKind::Invariant | QualifierKind::Precise | QualifierKind::Layout(_))
            }) || (qualifiers.list.len() > 1 && qualifiers.list.iter().any(|q| q.kind == QualifierKind::Invariant));
        if !plain || self.peek_at(1) == Lex::Assign {
            let name = self.word().to_owned();
            return self.expected(&format!("a type before `{name}`"));
        }
        let mut names = vec![self.ident("a name")?];
        while self.eat(Lex::Comma).is_some() {
            names.push(self.ident("a name")?);
        }
        self.semicolon("declaration")?;
        Ok(Some(names))
    }

    pub(super) fn precision_statement(&mut self) -> Read<PrecisionStatement> {
        self.advance();
        let precision = match self.word() {
            "lowp" => Precision::Low,
            "mediump" => Precision::Medium,
            "highp" => Precision::High,
            _ => return self.expected("`lowp`, `mediump` or `highp`"),
        };
        self.advance();
        let ty = self.type_specifier()?;
        self.semicolon("statement")?;
        Ok(PrecisionStatement { precision, ty })
    }

    fn interface_block(&mut self, qualifiers: Qualifiers) -> Read<InterfaceBlock> {
        let name = self.ident("the name of the block")?;
        let open = self.expect(Lex::LBrace, "`{`")?;
        let members = self.members(open)?;
        let body_span = self.since(open);
        let instance = if self.is_name(0) && !self.tok(0).first
            || matches!(self.peek_at(1), Lex::Semicolon | Lex::LBracket) && self.is_name(0)
        {
            Some(self.ident("the name of the instance")?)
        } else {
            None
        };
        let dims = if instance.is_some() { self.dims()? } else { Vec::new() };
        let semicolon = self.semicolon("block")?;
        Ok(InterfaceBlock { qualifiers, name, members, body_span, instance, dims, semicolon })
    }

    /// A whole declaration with its `;`.
    pub(super) fn declaration(&mut self) -> Read<Declaration> {
        let start = self.span();
        let qualifiers = self.qualifiers()?;
        let ty = self.type_specifier()?;
        self.declarators(start, qualifiers, ty)
    }

    /// Declarators and `;` behind a type.
    pub(super) fn declarators(&mut self, start: Span, qualifiers: Qualifiers, ty: TypeSpecifier) -> Read<Declaration> {
        let mut declarators = Vec::new();
        self.skipped = false;
        let definition = matches!(ty.kind, TypeKind::Struct(_));
        // Behind `struct S { … }` without `;` the next line is no name of a variable, unless it is one alone.
        let alone = matches!(self.peek_at(1), Lex::Semicolon | Lex::Comma | Lex::LBracket);
        let named = self.is_name(0) && (alone || !self.tok(0).first);
        if self.peek() != Lex::Semicolon && (named || !definition) {
            loop {
                declarators.push(self.declarator()?);
                if self.eat(Lex::Comma).is_none() {
                    break;
                }
            }
        }
        if std::mem::take(&mut self.skipped) {
            // Why there may be no `;` has been told.
            let semicolon = self.eat(Lex::Semicolon);
            return Ok(Declaration { qualifiers, ty, declarators, span: self.since(start), semicolon });
        }
        let semicolon = self.semicolon(if declarators.is_empty() && definition { "structure" } else { "declaration" });
        // The names are known even when something wrong follows them.
        let semicolon = match semicolon {
            Ok(semicolon) => semicolon,
            Err(Message) => {
                self.recover(self.at);
                None
            }
        };
        Ok(Declaration { qualifiers, ty, declarators, span: self.since(start), semicolon })
    }

    pub(super) fn declarator(&mut self) -> Read<Declarator> {
        let name = self.ident("a name")?;
        let dims = self.dims()?;
        let initializer = match self.eat(Lex::Assign) {
            None => None,
            Some(equals) => {
                let value = match self.initializer() {
                    Ok(value) => value,
                    Err(Message) => {
                        let start = self.span();
                        self.skip_initializer();
                        self.skipped = true;
                        self.add(ExprKind::Error, Span::at(start.start), false)?
                    }
                };
                Some(Initializer { equals, value })
            }
        };
        let span = self.since(name.span);
        Ok(Declarator { name, dims, initializer, span })
    }

    pub(super) fn function(
        &mut self,
        start: Span,
        qualifiers: Qualifiers,
        return_type: TypeSpecifier,
    ) -> Read<Function> {
        let name = self.ident("the name of a function")?;
        let open = self.expect(Lex::LParen, "`(`")?;
        let mut params = Vec::new();
        if self.word() == "void" && self.peek_at(1) == Lex::RParen {
            self.advance();
        }
        if self.peek() != Lex::RParen {
            loop {
                params.push(self.param()?);
                if self.eat(Lex::Comma).is_none() {
                    break;
                }
            }
        }
        self.close(Lex::RParen, ")", open)?;
        let params_span = self.since(open);
        let head_span = self.since(start);
        self.hints()?;
        let body = if self.peek() == Lex::LBrace {
            Some(self.block()?)
        } else if self.tok(0).first || self.peek() == Lex::Semicolon || self.at_end() {
            self.semicolon("prototype")?;
            None
        } else {
            return self.expected("`{` or `;` after the head of a function");
        };
        Ok(Function { qualifiers, return_type, name, params, params_span, head_span, body })
    }

    fn param(&mut self) -> Read<Param> {
        let start = self.span();
        let qualifiers = self.qualifiers()?;
        let ty = self.type_specifier()?;
        let (name, dims) = if matches!(self.peek(), Lex::Comma | Lex::RParen) {
            (None, Vec::new())
        } else {
            (Some(self.ident("the name of a parameter")?), self.dims()?)
        };
        Ok(Param { qualifiers, ty, name, dims, span: self.since(start) })
    }

    /// `{ … }`; an open block at the end of the file is told and kept.
    pub(super) fn block(&mut self) -> Read<Block> {
        let open = self.expect(Lex::LBrace, "`{`")?;
        let mut statements = Vec::new();
        while self.peek() != Lex::RBrace {
            if self.at_end() {
                self.sink.error(errors::SYNTAX, open, "this `{` is never closed", "opened here");
                break;
            }
            statements.push(self.statement());
        }
        self.advance();
        Ok(Block { statements, span: self.since(open) })
    }
}
