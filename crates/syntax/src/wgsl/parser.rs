//! Declarations at module scope, attributes and types (WGSL, sections 4, 6, 7 and 11).

use std::collections::{HashMap, HashSet};

use super::super::ast::{
    Arena, Block, Declaration, Declarator, Expr, ExprId, ExprKind, Function, Ident, Initializer, Item, ItemKind, Param,
    Qualifiers, StructSpecifier, TypeKind, TypeSpecifier, Unit,
};
use super::super::errors;
use super::super::sink::Sink;
use super::super::{Token, TokenKind};
use super::syntax::{Attribute, DeclarationKind, MemberSyntax, ModuleItem, TypeArg, TypeSyntax, VariableSyntax};
use base::diagnostic::message;
use base::text::Span;

/// Levels of blocks, parentheses and operands that are read.
pub(super) const DEEPEST: u32 = 200;

/// What could not be read has been reported.
pub(super) struct Unread;

pub(super) type Read<T> = Result<T, Unread>;

/// What reading a text gives.
#[derive(Debug, Default)]
pub(super) struct Parsed {
    pub unit: Unit,
    pub arena: Arena,
    pub items: Vec<ModuleItem>,
    /// Variables of functions, by the place of their names.
    pub locals: HashMap<usize, VariableSyntax>,
    /// Types that calls name, by the call.
    pub constructed: HashMap<ExprId, TypeSyntax>,
    /// `&operand`
    pub addresses: HashSet<ExprId>,
    /// Places of numbers whose suffix says their type.
    pub suffixed: HashSet<usize>,
}

pub(super) struct Parser<'a> {
    pub(super) text: &'a str,
    tokens: Vec<Token>,
    /// Where template lists open.
    templates: HashSet<usize>,
    at: usize,
    pub(super) out: Parsed,
    pub(super) sink: &'a mut Sink,
    /// Errors are not reported: an engine completes the text.
    silent: bool,
    pub(super) depth: u32,
    /// What is read may be a part of something else.
    filled: bool,
    /// An attribute of the early drafts has been reported.
    old: bool,
}

impl<'a> Parser<'a> {
    pub(super) fn new(text: &'a str, tokens: &[Token], (silent, filled): (bool, bool), sink: &'a mut Sink) -> Self {
        Self {
            text,
            tokens: tokens.to_vec(),
            templates: template_lists(text, tokens),
            at: 0,
            out: Parsed::default(),
            sink,
            silent,
            depth: 0,
            filled,
            old: false,
        }
    }

    /// Reads the whole text.
    pub(super) fn run(mut self) -> Parsed {
        while self.at < self.tokens.len() {
            let start = self.at;
            if self.item().is_err() {
                self.at = self.at.max(start);
                let from = self.tokens[start].span;
                self.skip();
                let span = from.to(self.before());
                self.out.unit.items.push(Item { kind: ItemKind::Error, span });
            }
            // Every round reads something.
            self.at = self.at.max(start + 1);
        }
        self.out.arena.shrink();
        self.out
    }

    /// The text of the token ahead; empty at the end.
    pub(super) fn peek(&self) -> &'a str {
        self.ahead(0)
    }

    pub(super) fn ahead(&self, n: usize) -> &'a str {
        self.tokens.get(self.at + n).map_or("", |t| &self.text[t.span.range()])
    }

    pub(super) fn kind(&self) -> Option<TokenKind> {
        self.tokens.get(self.at).map(|t| t.kind)
    }

    /// Place of the token ahead, or of the end.
    pub(super) fn span(&self) -> Span {
        self.tokens.get(self.at).map_or_else(|| Span::at(self.before().end), |t| t.span)
    }

    /// Place of the token that was read last.
    pub(super) fn before(&self) -> Span {
        self.at.checked_sub(1).and_then(|i| self.tokens.get(i)).map_or(Span::at(0), |t| t.span)
    }

    pub(super) fn advance(&mut self) -> Span {
        let span = self.span();
        self.at += 1;
        span
    }

    pub(super) fn take(&mut self, text: &str) -> Option<Span> {
        (self.peek() == text).then(|| self.advance())
    }

    pub(super) fn expect(&mut self, text: &str) -> Read<Span> {
        match self.take(text) {
            Some(span) => Ok(span),
            None => Err(self.expected(&format!("`{text}`"))),
        }
    }

    /// Reports what stands ahead in place of what is expected.
    pub(super) fn expected(&mut self, what: &str) -> Unread {
        let found = self.peek();
        let (message, place) = if found.is_empty() {
            (
                message!("the text ends where {what} is expected", "{what} が必要な所でテキストが終わっています"),
                self.before(),
            )
        } else {
            (message!("expected {what}, found `{found}`", "{what} が必要な所に `{found}` があります"), self.span())
        };
        if !self.silent {
            self.sink.error(errors::SYNTAX, place, message, message!("not expected here", "ここでは使えません"));
        }
        Unread
    }

    pub(super) fn report(
        &mut self,
        code: base::diagnostic::Code,
        span: Span,
        message: base::diagnostic::Message,
        help: base::diagnostic::Message,
    ) {
        if !self.filled {
            let d = self.sink.start(code, span, message).with_help(help);
            self.sink.push(d);
        }
    }

    /// Reads one level deeper.
    pub(super) fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Read<T>) -> Read<T> {
        if self.depth >= DEEPEST {
            let message = message!("nested more than {DEEPEST} levels deep", "{DEEPEST} 段を超える入れ子です");
            let help = message!("split it into several statements or functions", "複数の文か関数に分けてください");
            self.report(errors::TOO_DEEP, self.span(), message, help);
            return Err(Unread);
        }
        self.depth += 1;
        let result = read(self);
        self.depth -= 1;
        result
    }

    /// Skips to behind the next `;` or block at this level; a `}` that closes what is around stays.
    pub(super) fn skip(&mut self) {
        let mut depth = 0usize;
        while self.at < self.tokens.len() {
            match self.peek() {
                "{" => depth += 1,
                "}" if depth == 0 => return,
                "}" => {
                    depth -= 1;
                    if depth == 0 {
                        self.at += 1;
                        return;
                    }
                }
                ";" if depth == 0 => {
                    self.at += 1;
                    return;
                }
                "fn" if depth == 0 => return,
                _ => {}
            }
            self.at += 1;
        }
    }

    pub(super) fn add(&mut self, kind: ExprKind, span: Span) -> ExprId {
        self.out.arena.add(Expr { kind, span, from_macro: false })
    }

    /// A name; those of other modules with `::` are one.
    pub(super) fn ident(&mut self) -> Read<Ident> {
        if self.kind() != Some(TokenKind::Word) {
            return Err(self.expected("a name"));
        }
        let mut span = self.advance();
        while self.peek() == "::" && self.tokens.get(self.at + 1).is_some_and(|t| t.kind == TokenKind::Word) {
            self.advance();
            span = span.to(self.advance());
        }
        Ok(Ident { name: self.text[span.range()].to_owned(), span })
    }

    fn attributes(&mut self) -> Read<Vec<Attribute>> {
        let mut found = Vec::new();
        loop {
            if self.peek() == "[" && self.ahead(1) == "[" {
                self.old_attributes(&mut found)?;
            } else if let Some(at) = self.take("@") {
                found.push(self.attribute(at)?);
            } else {
                return Ok(found);
            }
        }
    }

    /// `[[…]]`, in which early drafts had attributes.
    fn old_attributes(&mut self, into: &mut Vec<Attribute>) -> Read<()> {
        let start = self.advance();
        self.advance();
        while self.peek() != "]" {
            let at = self.span();
            into.push(self.attribute(at)?);
            if self.take(",").is_none() {
                break;
            }
        }
        self.expect("]")?;
        let span = start.to(self.expect("]")?);
        if !std::mem::replace(&mut self.old, true) {
            let message = message!("`[[…]]` is no attribute any more", "`[[…]]` は現在の属性の書き方ではありません");
            let help = message!(
                "write `@location(0)` for `[[location(0)]]`",
                "`[[location(0)]]` は `@location(0)` と書いてください"
            );
            self.report(errors::SYNTAX, span, message, help);
        }
        Ok(())
    }

    /// `stage(vertex)`, which early drafts had, is `vertex` today.
    fn attribute(&mut self, at: Span) -> Read<Attribute> {
        let mut name = self.ident()?;
        let mut args = Vec::new();
        let mut span = at.to(name.span);
        if self.take("(").is_some() {
            if name.name == "stage" {
                name = self.ident()?;
            }
            while self.peek() != ")" {
                args.push(self.expression()?);
                if self.take(",").is_none() {
                    break;
                }
            }
            span = at.to(self.expect(")")?);
        }
        Ok(Attribute { name, args, span })
    }

    fn item(&mut self) -> Read<()> {
        let start = self.span();
        if self.take(";").is_some() {
            self.out.unit.items.push(Item { kind: ItemKind::Empty, span: start });
            return Ok(());
        }
        let attributes = self.attributes()?;
        match self.peek() {
            "fn" => self.function(start, attributes),
            "struct" => self.structure(start),
            "alias" | "type" => {
                self.advance();
                let name = self.ident()?;
                self.expect("=")?;
                let ty = self.ty()?;
                self.expect(";")?;
                self.out.items.push(ModuleItem::Alias { name, ty });
                self.out.unit.items.push(Item { kind: ItemKind::Empty, span: start.to(self.before()) });
                Ok(())
            }
            "var" | "let" | "const" | "override" => {
                let (variable, declaration) = self.variable(start, attributes)?;
                self.out.items.push(ModuleItem::Variable(variable));
                let span = start.to(self.before());
                self.out.unit.items.push(Item { kind: ItemKind::Declaration(declaration), span });
                Ok(())
            }
            "const_assert" => {
                self.advance();
                self.expression()?;
                self.expect(";")?;
                self.out.unit.items.push(Item { kind: ItemKind::Empty, span: start.to(self.before()) });
                Ok(())
            }
            // Directives, and imports of composers.
            "enable" | "requires" | "diagnostic" | "import" | "export" => {
                while !matches!(self.peek(), ";" | "") {
                    self.advance();
                }
                self.expect(";")?;
                self.out.unit.items.push(Item { kind: ItemKind::Empty, span: start.to(self.before()) });
                Ok(())
            }
            _ => Err(self.expected("a declaration")),
        }
    }

    /// `var<space, access> name : type = value;`, and `let`, `const`, `override`, with the `;`.
    pub(super) fn variable(&mut self, start: Span, attributes: Vec<Attribute>) -> Read<(VariableSyntax, Declaration)> {
        let (variable, declaration) = self.variable_head(start, attributes)?;
        let semicolon = self.expect(";")?;
        let span = start.to(semicolon);
        Ok((VariableSyntax { span, ..variable }, Declaration { span, semicolon: Some(semicolon), ..declaration }))
    }

    /// The same without the `;`.
    pub(super) fn variable_head(
        &mut self,
        start: Span,
        attributes: Vec<Attribute>,
    ) -> Read<(VariableSyntax, Declaration)> {
        let kind = match self.peek() {
            "var" => DeclarationKind::Var,
            "const" => DeclarationKind::Const,
            "override" => DeclarationKind::Override,
            _ => DeclarationKind::Let,
        };
        self.advance();
        let mut space = Vec::new();
        if kind == DeclarationKind::Var && self.take("<").is_some() {
            while self.kind() == Some(TokenKind::Word) {
                space.push(self.ident()?);
                if self.take(",").is_none() {
                    break;
                }
            }
            self.close()?;
        }
        let name = self.ident()?;
        let ty = if self.take(":").is_some() { Some(self.ty()?) } else { None };
        let equals = self.take("=");
        let value = if equals.is_some() { Some(self.expression()?) } else { None };
        let end = self.before();
        let initializer = equals.zip(value).map(|(equals, value)| Initializer { equals, value });
        let declarator = Declarator { name: name.clone(), dims: Vec::new(), initializer, span: name.span.to(end) };
        let declaration = Declaration {
            qualifiers: Qualifiers::default(),
            ty: self.specifier(ty.as_ref(), name.span),
            declarators: vec![declarator],
            span: start.to(end),
            semicolon: None,
        };
        let variable = VariableSyntax { kind, space, attributes, name, ty, value, span: start.to(end) };
        Ok((variable, declaration))
    }

    /// A type as the tree names it; without a type, an empty name.
    pub(super) fn specifier(&self, ty: Option<&TypeSyntax>, place: Span) -> TypeSpecifier {
        let span = ty.map_or(Span::at(place.start), |t| t.span);
        let name = self.text[span.range()].to_owned();
        TypeSpecifier { kind: TypeKind::Named(name), name_span: span, dims: Vec::new(), span }
    }

    fn structure(&mut self, start: Span) -> Read<()> {
        self.advance();
        let name = self.ident()?;
        self.expect("{")?;
        let (mut members, mut declarations) = (Vec::new(), Vec::new());
        while !matches!(self.peek(), "}" | "") {
            let from = self.span();
            let attributes = self.attributes()?;
            let member = self.ident()?;
            self.expect(":")?;
            let ty = self.ty()?;
            let declarator =
                Declarator { name: member.clone(), dims: Vec::new(), initializer: None, span: member.span };
            declarations.push(Declaration {
                qualifiers: Qualifiers::default(),
                ty: self.specifier(Some(&ty), member.span),
                declarators: vec![declarator],
                span: from.to(self.before()),
                semicolon: None,
            });
            members.push(MemberSyntax { attributes, name: member, ty });
            if self.take(",").is_none() && self.take(";").is_none() {
                break;
            }
        }
        let close = self.expect("}")?;
        let semicolon = self.take(";");
        let span = start.to(close);
        let specifier = StructSpecifier { name: Some(name.clone()), members: declarations, span };
        let ty = TypeSpecifier { kind: TypeKind::Struct(specifier), name_span: span, dims: Vec::new(), span };
        let declaration =
            Declaration { qualifiers: Qualifiers::default(), ty, declarators: Vec::new(), span, semicolon };
        self.out.items.push(ModuleItem::Struct { name, members });
        self.out.unit.items.push(Item { kind: ItemKind::Declaration(declaration), span });
        Ok(())
    }

    fn function(&mut self, start: Span, attributes: Vec<Attribute>) -> Read<()> {
        self.advance();
        let name = self.ident()?;
        let open = self.expect("(")?;
        let (mut params, mut declared) = (Vec::new(), Vec::new());
        while !matches!(self.peek(), ")" | "") {
            let from = self.span();
            let attributes = self.attributes()?;
            let param = self.ident()?;
            self.expect(":")?;
            let ty = self.ty()?;
            declared.push(Param {
                qualifiers: Qualifiers::default(),
                ty: self.specifier(Some(&ty), param.span),
                name: Some(param.clone()),
                dims: Vec::new(),
                span: from.to(self.before()),
            });
            params.push(MemberSyntax { attributes, name: param, ty });
            if self.take(",").is_none() {
                break;
            }
        }
        let params_span = open.to(self.expect(")")?);
        let returns = match self.take("->") {
            Some(_) => Some((self.attributes()?, self.ty()?)),
            None => None,
        };
        let head_span = start.to(self.before());
        let return_type = match &returns {
            Some((_, ty)) => self.specifier(Some(ty), name.span),
            None => TypeSpecifier { kind: TypeKind::Named("void".to_owned()), ..self.specifier(None, name.span) },
        };
        let body: Block = self.block()?;
        let span = start.to(body.span);
        let function = Function {
            qualifiers: Qualifiers::default(),
            return_type,
            name: name.clone(),
            params: declared,
            params_span,
            head_span,
            body: Some(body),
        };
        let item = self.out.unit.items.len();
        self.out.items.push(ModuleItem::Function { attributes, name, params, returns, item });
        self.out.unit.items.push(Item { kind: ItemKind::Function(function), span });
        Ok(())
    }

    /// Reads a type with its parameters.
    pub(super) fn ty(&mut self) -> Read<TypeSyntax> {
        self.deeper(|p| {
            let name = p.ident()?;
            p.arguments(name)
        })
    }

    /// The arguments behind the name of a type, if there are any.
    pub(super) fn arguments(&mut self, name: Ident) -> Read<TypeSyntax> {
        let mut args = Vec::new();
        let start = name.span;
        if self.take("<").is_some() {
            while !self.peek().starts_with('>') {
                args.push(self.argument()?);
                if self.take(",").is_none() {
                    break;
                }
            }
            self.close()?;
        }
        Ok(TypeSyntax { name, args, span: start.to(self.before()) })
    }

    fn argument(&mut self) -> Read<TypeArg> {
        let is_end = |t: &str| t == "," || t.starts_with('>') || t == "<";
        if self.kind() == Some(TokenKind::Word) && (is_end(self.ahead(1)) || self.ahead(1) == "::") {
            let ty = self.ty()?;
            let expr = ty.args.is_empty().then(|| self.add(ExprKind::Name(ty.name.name.clone()), ty.span));
            return Ok(TypeArg { ty: Some(ty), expr });
        }
        // `>` ends the argument.
        let expr = self.sum()?;
        Ok(TypeArg { ty: None, expr: Some(expr) })
    }

    /// Whether the `<` that comes next opens a template list and compares nothing.
    pub(super) fn opens_template(&self) -> bool {
        self.peek() == "<" && self.templates.contains(&self.span().start)
    }

    /// Reads a `>`, be it the first character of a longer token.
    fn close(&mut self) -> Read<()> {
        match self.peek() {
            ">" => {
                self.advance();
                Ok(())
            }
            ">>" | ">=" | ">>=" => {
                // Both halves stay tokens, so that the place that was read last ends here.
                let span = self.span();
                let first = Token { span: Span::new(span.start, span.start + 1), ..self.tokens[self.at] };
                self.tokens[self.at].span = Span::new(span.start + 1, span.end);
                self.tokens.insert(self.at, first);
                self.advance();
                Ok(())
            }
            _ => Err(self.expected("`>`")),
        }
    }
}

/// Where template lists open: each `<` behind a word that a `>` closes before a token which no template list has (WGSL, 3.9
/// "Template Lists").
fn template_lists(text: &str, tokens: &[Token]) -> HashSet<usize> {
    let mut found = HashSet::new();
    // Each `<` that may open a list, and how many brackets are open around it.
    let mut open: Vec<(usize, u32)> = Vec::new();
    let mut depth = 0_u32;
    let mut behind_word = false;
    for token in tokens {
        match &text[token.span.range()] {
            ";" | "{" | ":" | "=" => {
                open.clear();
                depth = 0;
            }
            "&&" | "||" => pop_inner(&mut open, depth),
            "(" | "[" => depth += 1,
            ")" | "]" => {
                pop_inner(&mut open, depth);
                depth = depth.saturating_sub(1);
            }
            "<" if behind_word => open.push((token.span.start, depth)),
            marks @ (">" | ">>" | ">=" | ">>=") => {
                for _ in marks.matches('>') {
                    found.extend(open.pop_if(|(_, around)| *around == depth).map(|(at, _)| at));
                }
            }
            _ => {}
        }
        behind_word = token.kind == TokenKind::Word;
    }
    found
}

/// Leaves those out that lie as deep or deeper.
fn pop_inner(open: &mut Vec<(usize, u32)>, depth: u32) {
    while open.pop_if(|(_, around)| *around >= depth).is_some() {}
}
