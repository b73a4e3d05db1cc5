//! Statements (WGSL, section 9), as those of GLSL: `loop` with `continuing` and `break if` is a `do` loop.

use super::super::ast::{BinaryOp, Block, Condition, ExprId, ExprKind, Stmt, StmtKind, UnaryOp};
use super::parser::{Parser, Read};
use base::text::Span;

/// Operators that assign.
const ASSIGN: &[(&str, Option<BinaryOp>)] = &[
    ("=", None),
    ("+=", Some(BinaryOp::Add)),
    ("-=", Some(BinaryOp::Sub)),
    ("*=", Some(BinaryOp::Mul)),
    ("/=", Some(BinaryOp::Div)),
    ("%=", Some(BinaryOp::Rem)),
    ("&=", Some(BinaryOp::BitAnd)),
    ("|=", Some(BinaryOp::BitOr)),
    ("^=", Some(BinaryOp::BitXor)),
    ("<<=", Some(BinaryOp::Shl)),
    (">>=", Some(BinaryOp::Shr)),
];

/// What stands in `continuing`.
#[derive(Default)]
struct Continuing {
    statements: Vec<Stmt>,
    breaks: Option<ExprId>,
}

impl Parser<'_> {
    /// `{ … }`
    pub(super) fn block(&mut self) -> Read<Block> {
        self.skip_attributes()?;
        let start = self.expect("{")?;
        let statements = self.statements();
        let span = start.to(self.expect("}")?);
        Ok(Block { statements, span })
    }

    fn skip_attributes(&mut self) -> Read<()> {
        while self.take("@").is_some() {
            self.ident()?;
            if self.take("(").is_some() {
                while !matches!(self.peek(), ")" | "") {
                    self.advance();
                }
                self.expect(")")?;
            }
        }
        Ok(())
    }

    fn statements(&mut self) -> Vec<Stmt> {
        let mut found = Vec::new();
        while !matches!(self.peek(), "}" | "" | "continuing") {
            let start = self.span();
            match self.deeper(Self::statement) {
                Ok(statement) => found.push(statement),
                Err(_) => {
                    self.skip();
                    // What does not get on here is behind what is read.
                    if self.span() == start {
                        self.advance();
                    }
                    found.push(Stmt { kind: StmtKind::Error, span: start.to(self.before()) });
                }
            }
        }
        found
    }

    fn statement(&mut self) -> Read<Stmt> {
        self.skip_attributes()?;
        let start = self.span();
        let kind = match self.peek() {
            ";" => {
                self.advance();
                StmtKind::Empty
            }
            "{" => StmtKind::Block(self.block()?),
            "if" => return self.branch(),
            "for" => self.counting(start)?,
            "while" => {
                self.advance();
                let condition = Condition::Expr(self.expression()?);
                StmtKind::While { condition, body: Box::new(self.body()?) }
            }
            "loop" => self.endless(start)?,
            "switch" => self.switch()?,
            "return" => {
                self.advance();
                let value = if self.peek() == ";" { None } else { Some(self.expression()?) };
                self.expect(";")?;
                StmtKind::Return(value)
            }
            "break" => {
                self.advance();
                self.expect(";")?;
                StmtKind::Break
            }
            "continue" => {
                self.advance();
                self.expect(";")?;
                StmtKind::Continue
            }
            "discard" => {
                self.advance();
                self.expect(";")?;
                StmtKind::Discard
            }
            "const_assert" => {
                self.advance();
                self.expression()?;
                self.expect(";")?;
                StmtKind::Empty
            }
            "var" | "let" | "const" => {
                let (variable, declaration) = self.variable(start, Vec::new())?;
                self.out.locals.insert(variable.name.span.start, variable);
                StmtKind::Declaration(declaration)
            }
            _ => {
                let expr = self.simple()?;
                self.expect(";")?;
                StmtKind::Expr(expr)
            }
        };
        Ok(Stmt { kind, span: start.to(self.before()) })
    }

    fn body(&mut self) -> Read<Stmt> {
        let block = self.block()?;
        Ok(Stmt { span: block.span, kind: StmtKind::Block(block) })
    }

    /// An assignment, a step or a call; without the `;`.
    fn simple(&mut self) -> Read<ExprId> {
        let start = self.span();
        if self.peek() == "_" && self.ahead(1) == "=" {
            self.advance();
            self.advance();
            return self.expression();
        }
        let target = self.expression_of_target()?;
        let increment = match self.peek() {
            "++" => Some(true),
            "--" => Some(false),
            _ => None,
        };
        if let Some(increment) = increment {
            let op_span = self.advance();
            return Ok(self.add(ExprKind::Postfix { increment, op_span, operand: target }, start.to(op_span)));
        }
        if let Some((_, op)) = ASSIGN.iter().find(|(text, _)| *text == self.peek()) {
            let op_span = self.advance();
            let value = self.expression()?;
            let span = start.to(self.before());
            return Ok(self.add(ExprKind::Assign { op: *op, op_span, target, value }, span));
        }
        match self.out.arena.get(target).kind {
            ExprKind::Call { .. } => Ok(target),
            _ => Err(self.expected("an assignment or a call")),
        }
    }

    /// What may stand on the left: a place, with `*` or `&` in front, or a call.
    fn expression_of_target(&mut self) -> Read<ExprId> {
        if self.peek() == "*" || self.peek() == "&" {
            let address = self.peek() == "&";
            let start = self.advance();
            let inner = self.deeper(Self::expression_of_target)?;
            let id = self.add(ExprKind::Paren(inner), start.to(self.before()));
            if address {
                self.out.addresses.insert(id);
            }
            return Ok(id);
        }
        self.postfix()
    }

    fn branch(&mut self) -> Read<Stmt> {
        let start = self.advance();
        let condition = self.expression()?;
        let then = Box::new(self.body()?);
        let otherwise = if self.take("else").is_some() {
            let statement = if self.peek() == "if" { self.deeper(Self::branch)? } else { self.body()? };
            Some(Box::new(statement))
        } else {
            None
        };
        Ok(Stmt { kind: StmtKind::If { condition, then, otherwise }, span: start.to(self.before()) })
    }

    fn counting(&mut self, start: Span) -> Read<StmtKind> {
        self.advance();
        self.expect("(")?;
        let from = self.span();
        let init = match self.peek() {
            ";" => {
                self.advance();
                StmtKind::Empty
            }
            "var" | "let" | "const" => {
                let (variable, declaration) = self.variable(from, Vec::new())?;
                self.out.locals.insert(variable.name.span.start, variable);
                StmtKind::Declaration(declaration)
            }
            _ => {
                let expr = self.simple()?;
                self.expect(";")?;
                StmtKind::Expr(expr)
            }
        };
        let init = Box::new(Stmt { kind: init, span: from.to(self.before()) });
        let condition = if self.peek() == ";" { None } else { Some(Condition::Expr(self.expression()?)) };
        self.expect(";")?;
        let step = if self.peek() == ")" { None } else { Some(self.simple()?) };
        let head_span = start.to(self.expect(")")?);
        Ok(StmtKind::For { init, condition, step, body: Box::new(self.body()?), head_span })
    }

    /// `loop { statements continuing { statements break if condition; } }`
    fn endless(&mut self, start: Span) -> Read<StmtKind> {
        self.advance();
        self.skip_attributes()?;
        let open = self.expect("{")?;
        let mut statements = self.statements();
        let continuing = if self.peek() == "continuing" { self.continuing()? } else { Continuing::default() };
        let span = open.to(self.expect("}")?);
        // Steps that are expressions run after `continue` as well; others are read as the end of the body.
        let mut steps = Vec::new();
        if continuing.statements.iter().all(|s| matches!(s.kind, StmtKind::Expr(_))) {
            steps.extend(continuing.statements.iter().filter_map(|s| match s.kind {
                StmtKind::Expr(expr) => Some(expr),
                _ => None,
            }));
        } else {
            statements.extend(continuing.statements);
        }
        let body = Box::new(Stmt { kind: StmtKind::Block(Block { statements, span }), span });
        let step = steps.into_iter().reduce(|left, right| {
            let span = self.out.arena.get(left).span.to(self.out.arena.get(right).span);
            self.add(ExprKind::Comma { left, right }, span)
        });
        let Some(breaks) = continuing.breaks else {
            let init = Box::new(Stmt { kind: StmtKind::Empty, span: Span::at(start.end) });
            return Ok(StmtKind::For { init, condition: None, step, body, head_span: start });
        };
        let at = self.out.arena.get(breaks).span;
        let again = self.add(ExprKind::Unary { op: UnaryOp::Not, op_span: Span::at(at.start), operand: breaks }, at);
        let condition = match step {
            Some(left) => self.add(ExprKind::Comma { left, right: again }, at),
            None => again,
        };
        Ok(StmtKind::DoWhile { body, condition })
    }

    fn continuing(&mut self) -> Read<Continuing> {
        self.advance();
        self.skip_attributes()?;
        self.expect("{")?;
        let mut found = Continuing::default();
        while !matches!(self.peek(), "}" | "") {
            if self.peek() == "break" && self.ahead(1) == "if" {
                self.advance();
                self.advance();
                found.breaks = Some(self.expression()?);
                self.expect(";")?;
            } else {
                found.statements.push(self.deeper(Self::statement)?);
            }
        }
        self.expect("}")?;
        Ok(found)
    }

    /// Clauses of a `switch` do not fall through: each ends with a `break` in the tree.
    fn switch(&mut self) -> Read<StmtKind> {
        self.advance();
        let selector = self.expression()?;
        self.skip_attributes()?;
        let open = self.expect("{")?;
        let mut statements = Vec::new();
        while !matches!(self.peek(), "}" | "") {
            let start = self.span();
            match self.peek() {
                "default" => {
                    self.advance();
                    statements.push(Stmt { kind: StmtKind::Default, span: start });
                }
                "case" => {
                    self.advance();
                    while !matches!(self.peek(), ":" | "{" | "") {
                        let at = self.span();
                        let label = match self.take("default") {
                            Some(_) => StmtKind::Default,
                            None => StmtKind::Case(self.expression()?),
                        };
                        statements.push(Stmt { kind: label, span: at.to(self.before()) });
                        if self.take(",").is_none() {
                            break;
                        }
                    }
                }
                _ => return Err(self.expected("`case` or `default`")),
            }
            self.take(":");
            let body = self.body()?;
            let end = Span::at(body.span.end);
            let leaves = match &body.kind {
                StmtKind::Block(block) => block.statements.last().is_some_and(|s| {
                    matches!(s.kind, StmtKind::Return(_) | StmtKind::Break | StmtKind::Continue | StmtKind::Discard)
                }),
                _ => false,
            };
            statements.push(body);
            if !leaves {
                statements.push(Stmt { kind: StmtKind::Break, span: end });
            }
        }
        let span = open.to(self.expect("}")?);
        Ok(StmtKind::Switch { selector, body: Block { statements, span } })
    }
}
