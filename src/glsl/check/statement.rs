//! Statements and function bodies.

use super::super::ast::{Block, Condition, ExprId, Stmt, StmtKind};
use super::super::errors;
use super::super::types::{ScalarType, Type};
use super::Checker;
use super::expression::article;
use crate::text::Span;

impl Checker<'_> {
    /// Statements of a block, in a scope that exists already.
    pub(super) fn statements(&mut self, block: &Block) {
        for statement in &block.statements {
            self.statement(statement);
        }
    }

    fn statement(&mut self, statement: &Stmt) {
        match &statement.kind {
            StmtKind::Empty
            | StmtKind::Precision(_)
            | StmtKind::Default
            | StmtKind::Break
            | StmtKind::Continue
            | StmtKind::Discard
            | StmtKind::Error => {}
            StmtKind::Declaration(declaration) => self.local_declaration(declaration),
            StmtKind::Qualified(names) => self.qualified_names(names),
            StmtKind::Expr(value) => {
                self.expression(*value);
            }
            StmtKind::Block(block) => self.scoped(|this| this.statements(block)),
            StmtKind::If { condition, then, otherwise } => {
                self.bool_condition(*condition, "the condition of `if`");
                self.scoped(|this| this.statement(then));
                if let Some(otherwise) = otherwise {
                    self.scoped(|this| this.statement(otherwise));
                }
            }
            StmtKind::For { init, condition, step, body, head_span: _ } => self.scoped(|this| {
                this.statement(init);
                if let Some(condition) = condition {
                    this.condition(condition, "the condition of `for`");
                }
                if let Some(step) = step {
                    this.expression(*step);
                }
                this.scoped(|this| this.statement(body));
            }),
            StmtKind::While { condition, body } => self.scoped(|this| {
                this.condition(condition, "the condition of `while`");
                this.scoped(|this| this.statement(body));
            }),
            StmtKind::DoWhile { body, condition } => {
                self.scoped(|this| this.statement(body));
                self.bool_condition(*condition, "the condition of `while`");
            }
            StmtKind::Switch { selector, body } => {
                let ty = self.expression(*selector);
                let integer = ty.is_scalar() && ty.scalar().is_some_and(ScalarType::is_integer);
                if !integer && !ty.is_error() {
                    let message = format!("`switch` needs an integer, not {} `{ty}`", article(&ty));
                    let span = self.arena.get(*selector).span;
                    self.sink.error(errors::CONDITION_TYPE, span, message, "selector");
                }
                self.scoped(|this| this.statements(body));
            }
            StmtKind::Case(value) => {
                self.expression(*value);
            }
            StmtKind::Return(value) => self.return_statement(*value, statement.span),
        }
    }

    fn condition(&mut self, condition: &Condition, what: &str) {
        match condition {
            Condition::Expr(value) => self.bool_condition(*value, what),
            Condition::Declaration(declaration) => self.local_declaration(declaration),
        }
    }

    fn bool_condition(&mut self, value: ExprId, what: &str) {
        self.expression(value);
        self.require_bool(value, what);
    }

    fn return_statement(&mut self, value: Option<ExprId>, span: Span) {
        let given = match value {
            Some(value) => self.expression(value),
            None => Type::Void,
        };
        let Some((function, wanted)) = self.current.clone() else { return };
        if self.conversions.allow(&given, &wanted) {
            return;
        }
        let name = &self.out.functions[function.index()].name.name;
        let (span, message) = match value {
            None => {
                (span, format!("`return` without a value in `{name}`, which returns {} `{wanted}`", article(&wanted)))
            }
            Some(value) if wanted == Type::Void => {
                (self.arena.get(value).span, format!("`{name}` returns nothing, but a value is returned"))
            }
            Some(value) => (
                self.arena.get(value).span,
                format!(
                    "{} `{given}` is returned from `{name}`, which returns {} `{wanted}`",
                    article(&given),
                    article(&wanted)
                ),
            ),
        };
        self.sink.error(errors::RETURN_TYPE, span, message, "returned here");
    }
}
