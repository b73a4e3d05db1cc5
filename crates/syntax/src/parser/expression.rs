//! Expressions, by precedence (GLSL 4.60 specification, section 5.1).

use super::super::ast::{ArrayDim, BinaryOp, Callee, ExprId, ExprKind, Literal, TypeKind, TypeSpecifier, UnaryOp};
use super::super::lexer::Lex;
use super::super::{errors, number};
use super::{Ident, Message, Parser, Read};
use base::text::Span;

impl Parser<'_> {
    /// An expression with commas.
    pub(super) fn expression(&mut self) -> Read<ExprId> {
        let mut left = self.assignment()?;
        while self.peek() == Lex::Comma {
            let from_macro = self.tok(0).from_macro;
            let comma = self.advance();
            let right = self.assignment()?;
            let span = self.across(left, comma, right);
            left = self.add(ExprKind::Comma { left, right }, span, from_macro)?;
        }
        Ok(left)
    }

    fn span_of(&self, id: ExprId) -> Span {
        self.arena.get(id).span
    }

    /// The place of two operands and what stands between them: where a macro writes the operator, and is given both
    /// operands, the whole use of the macro.
    fn across(&self, left: ExprId, operator: Span, right: ExprId) -> Span {
        self.span_of(left).to(operator).to(self.span_of(right))
    }

    /// An expression or `{ list }` behind `=`.
    pub(super) fn initializer(&mut self) -> Read<ExprId> {
        if self.peek() != Lex::LBrace {
            return self.assignment();
        }
        self.deeper(|this| {
            let from_macro = this.tok(0).from_macro;
            let open = this.advance();
            let mut items = Vec::new();
            while this.peek() != Lex::RBrace {
                items.push(this.initializer()?);
                if this.eat(Lex::Comma).is_none() {
                    break;
                }
            }
            this.close(Lex::RBrace, "}", open)?;
            let span = this.since(open);
            this.add(ExprKind::List(items), span, from_macro)
        })
    }

    /// An expression without commas.
    pub(super) fn assignment(&mut self) -> Read<ExprId> {
        self.deeper(|this| {
            let target = this.ternary()?;
            let op = match this.peek() {
                Lex::Assign => None,
                Lex::AddAssign => Some(BinaryOp::Add),
                Lex::SubAssign => Some(BinaryOp::Sub),
                Lex::MulAssign => Some(BinaryOp::Mul),
                Lex::DivAssign => Some(BinaryOp::Div),
                Lex::RemAssign => Some(BinaryOp::Rem),
                Lex::ShlAssign => Some(BinaryOp::Shl),
                Lex::ShrAssign => Some(BinaryOp::Shr),
                Lex::AndAssign => Some(BinaryOp::BitAnd),
                Lex::XorAssign => Some(BinaryOp::BitXor),
                Lex::OrAssign => Some(BinaryOp::BitOr),
                _ => return Ok(target),
            };
            let from_macro = this.tok(0).from_macro;
            let op_span = this.advance();
            let value = this.assignment()?;
            let span = this.across(target, op_span, value);
            this.add(ExprKind::Assign { op, op_span, target, value }, span, from_macro)
        })
    }

    /// A conditional expression: what a constant may be.
    pub(super) fn ternary(&mut self) -> Read<ExprId> {
        let condition = self.binary(0)?;
        if self.peek() != Lex::Question {
            return Ok(condition);
        }
        self.deeper(|this| {
            let from_macro = this.tok(0).from_macro;
            let question = this.advance();
            let yes = this.expression()?;
            this.expect(Lex::Colon, "`:` of the conditional expression")?;
            let no = this.assignment()?;
            let span = this.across(condition, question, no);
            this.add(ExprKind::Ternary { condition, yes, no }, span, from_macro)
        })
    }

    fn binary(&mut self, least: u8) -> Read<ExprId> {
        let mut left = self.unary()?;
        // An operator that is filled in, with what follows it.
        while self.peek() == Lex::Hole && !self.tok(0).first {
            let (name, from_macro) = (self.word().to_owned(), self.tok(0).from_macro);
            self.advance();
            if matches!(self.peek(), Lex::Word | Lex::Number | Lex::LParen | Lex::Minus) && !self.tok(0).first {
                self.unary()?;
            }
            let span = self.since(self.span_of(left));
            left = self.add(ExprKind::Name(name), span, from_macro)?;
        }
        while let Some((op, level)) = infix(self.peek()).filter(|(_, level)| *level >= least) {
            let from_macro = self.tok(0).from_macro;
            let op_span = self.advance();
            let right = self.binary(level + 1)?;
            let span = self.across(left, op_span, right);
            left = self.add(ExprKind::Binary { op, op_span, left, right }, span, from_macro)?;
        }
        Ok(left)
    }

    fn unary(&mut self) -> Read<ExprId> {
        let op = match self.peek() {
            Lex::Plus => UnaryOp::Plus,
            Lex::Minus => UnaryOp::Minus,
            Lex::Bang => UnaryOp::Not,
            Lex::Tilde => UnaryOp::Complement,
            Lex::Increment => UnaryOp::Increment,
            Lex::Decrement => UnaryOp::Decrement,
            _ => return self.postfix(),
        };
        self.deeper(|this| {
            let from_macro = this.tok(0).from_macro;
            let op_span = this.advance();
            let operand = this.unary()?;
            let span = op_span.to(this.span_of(operand));
            this.add(ExprKind::Unary { op, op_span, operand }, span, from_macro)
        })
    }

    fn postfix(&mut self) -> Read<ExprId> {
        let mut base = self.primary()?;
        loop {
            let from_macro = self.tok(0).from_macro;
            let mut start = self.span_of(base);
            let kind = match self.peek() {
                Lex::LBracket => {
                    let open = self.advance();
                    if self.peek() == Lex::RBracket {
                        // `S[](…)`: only a constructor of a structure array may leave the size out.
                        let close = self.advance();
                        let Some((name, mut dims)) = self.indexed_name(base) else { return self.expected_expression() };
                        dims.push(ArrayDim { span: open.to(close), size: None });
                        base = self.structure_array(name, dims)?;
                        continue;
                    }
                    let index = self.expression()?;
                    self.close(Lex::RBracket, "]", open)?;
                    if self.peek() == Lex::LParen
                        && let Some((name, mut dims)) = self.indexed_name(base)
                    {
                        dims.push(ArrayDim { span: self.since(open), size: Some(index) });
                        base = self.structure_array(name, dims)?;
                        continue;
                    }
                    ExprKind::Index { base, index }
                }
                Lex::Dot => {
                    start = start.to(self.advance());
                    let name = if self.tok(0).is_word() {
                        let name = self.word().to_owned();
                        Ident { name, span: self.advance() }
                    } else {
                        self.ident("the name of a member or component after `.`")?
                    };
                    if self.peek() == Lex::LParen {
                        let args = self.arguments()?;
                        ExprKind::Method { base, method: name, args }
                    } else {
                        ExprKind::Field { base, field: name }
                    }
                }
                Lex::Increment | Lex::Decrement => {
                    let increment = self.peek() == Lex::Increment;
                    let op_span = self.advance();
                    ExprKind::Postfix { increment, op_span, operand: base }
                }
                _ => return Ok(base),
            };
            let span = self.since(start);
            base = self.add(kind, span, from_macro)?;
        }
    }

    /// The name and the indices of `Name[…][…]`, which may turn out to be the type of an array; none of anything else.
    fn indexed_name(&self, base: ExprId) -> Option<(ExprId, Vec<ArrayDim>)> {
        let (mut at, mut dims) = (base, Vec::new());
        loop {
            match &self.arena.get(at).kind {
                ExprKind::Name(_) => break,
                ExprKind::Index { base, index } => {
                    dims.push(ArrayDim { span: self.span_of(*index), size: Some(*index) });
                    at = *base;
                }
                _ => return None,
            }
        }
        dims.reverse();
        Some((at, dims))
    }

    /// `Name[…](args)` with the first dimensions read.
    fn structure_array(&mut self, base: ExprId, mut dims: Vec<ArrayDim>) -> Read<ExprId> {
        let expr = self.arena.get(base).clone();
        let ExprKind::Name(name) = expr.kind else { return self.expected_expression() };
        dims.extend(self.dims()?);
        let span = self.since(expr.span);
        let ty = TypeSpecifier { kind: TypeKind::Named(name), name_span: expr.span, dims, span };
        if self.peek() != Lex::LParen {
            return self.expected("`(` with the elements of the array");
        }
        let args = self.arguments()?;
        let span = self.since(expr.span);
        self.add(ExprKind::Call { callee: Callee::Type(ty), args }, span, expr.from_macro)
    }

    /// `( args )`.
    fn arguments(&mut self) -> Read<Vec<ExprId>> {
        let open = self.expect(Lex::LParen, "`(`")?;
        let mut args = Vec::new();
        if self.word() == "void" && self.peek_at(1) == Lex::RParen {
            self.advance();
        }
        if self.peek() != Lex::RParen {
            loop {
                args.push(self.assignment()?);
                if self.eat(Lex::Comma).is_none() {
                    break;
                }
            }
        }
        self.close(Lex::RParen, ")", open)?;
        Ok(args)
    }

    fn primary(&mut self) -> Read<ExprId> {
        let from_macro = self.tok(0).from_macro;
        let start = self.span();
        match self.peek() {
            Lex::Number => {
                let text = self.tok(0).text(&self.file).to_owned();
                self.advance();
                if number::lacks_point(&text) {
                    let digits = &text[..text.len() - 1];
                    let error = self
                        .sink
                        .start(errors::LITERAL, start, format!("`{text}` is no number of GLSL"))
                        .with_label("lacks a point")
                        .with_why("the suffix `f` stands behind a fraction or an exponent")
                        .with_help(format!("write `{digits}.0`"));
                    self.sink.push(error);
                }
                let kind = match number::literal(&text) {
                    Ok(literal) => ExprKind::Literal(literal),
                    // Integers of 64 bits, and what else an extension that is not known here may bring.
                    Err(_) if text.ends_with(['l', 'L']) && self.words.language().is_open() => ExprKind::Error,
                    Err(wrong) => {
                        self.sink.error(errors::LITERAL, start, format!("`{text}` {wrong}"), "this literal");
                        ExprKind::Error
                    }
                };
                self.add(kind, start, from_macro)
            }
            Lex::Quoted => {
                self.advance();
                self.add(ExprKind::Error, start, from_macro)
            }
            Lex::LParen => {
                self.advance();
                let inner = self.expression()?;
                self.close(Lex::RParen, ")", start)?;
                let span = self.since(start);
                self.add(ExprKind::Paren(inner), span, from_macro)
            }
            Lex::Word if matches!(self.word(), "true" | "false") => {
                let value = self.word() == "true";
                self.advance();
                self.add(ExprKind::Literal(Literal::Bool(value)), start, from_macro)
            }
            // An operator that says how a value differs, and changes nothing (GL_EXT_nonuniform_qualifier).
            Lex::Word
                if self.word() == "nonuniformEXT" && self.words.language().enabled("EXT_nonuniform_qualifier") =>
            {
                self.advance();
                let open = self.span();
                if self.peek() != Lex::LParen {
                    return self.expected("`(` after `nonuniformEXT`");
                }
                self.advance();
                let inner = self.expression()?;
                self.close(Lex::RParen, ")", open)?;
                let span = self.since(start);
                self.add(ExprKind::Paren(inner), span, from_macro)
            }
            Lex::Word if self.words.built_in_type(self.word()) => {
                let ty = self.type_specifier()?;
                if self.peek() != Lex::LParen {
                    return self.expected("`(` after the type: a constructor takes arguments");
                }
                let args = self.arguments()?;
                let span = self.since(start);
                self.add(ExprKind::Call { callee: Callee::Type(ty), args }, span, from_macro)
            }
            Lex::Word | Lex::Hole if self.is_name(0) => {
                let name = self.word().to_owned();
                self.advance();
                if self.peek() == Lex::LParen {
                    let args = self.arguments()?;
                    let span = self.since(start);
                    let callee = Callee::Name(Ident { name, span: start });
                    return self.add(ExprKind::Call { callee, args }, span, from_macro);
                }
                self.add(ExprKind::Name(name), start, from_macro)
            }
            Lex::LBrace => {
                let message = "a list in `{ }` can only initialise a variable";
                self.sink.error(errors::SYNTAX, start, message, "not allowed here");
                Err(Message)
            }
            _ => self.expected_expression(),
        }
    }
}

fn infix(lex: Lex) -> Option<(BinaryOp, u8)> {
    Some(match lex {
        Lex::OrOr => (BinaryOp::Or, 0),
        Lex::XorXor => (BinaryOp::Xor, 1),
        Lex::AndAnd => (BinaryOp::And, 2),
        Lex::Pipe => (BinaryOp::BitOr, 3),
        Lex::Caret => (BinaryOp::BitXor, 4),
        Lex::Amp => (BinaryOp::BitAnd, 5),
        Lex::EqualEqual => (BinaryOp::Equal, 6),
        Lex::NotEqual => (BinaryOp::NotEqual, 6),
        Lex::Less => (BinaryOp::Less, 7),
        Lex::Greater => (BinaryOp::Greater, 7),
        Lex::LessEqual => (BinaryOp::LessEqual, 7),
        Lex::GreaterEqual => (BinaryOp::GreaterEqual, 7),
        Lex::Shl => (BinaryOp::Shl, 8),
        Lex::Shr => (BinaryOp::Shr, 8),
        Lex::Plus => (BinaryOp::Add, 9),
        Lex::Minus => (BinaryOp::Sub, 9),
        Lex::Star => (BinaryOp::Mul, 10),
        Lex::Slash => (BinaryOp::Div, 10),
        Lex::Percent => (BinaryOp::Rem, 10),
        _ => return None,
    })
}
