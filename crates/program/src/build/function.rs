//! The function under construction: expressions, statements and blocks.

use std::collections::HashMap;

use naga::{
    Arena, Block, Expression, Function, FunctionArgument, FunctionResult, Handle, Literal, LocalVariable, Range,
    Statement, Type as NagaType,
};

use super::place::{Lvalue, Var};
use super::{Build, Expr, Result};
use base::text::Span;
use syntax::Shader;
use syntax::ast::ExprId;
use syntax::symbols::SymbolId;
use syntax::types::{ScalarType, Type};

/// A value with its type.
#[derive(Clone, Debug)]
pub(super) struct Val {
    pub e: Expr,
    /// Its type in GLSL.
    pub ty: Type,
}

/// A function under construction.
pub(super) struct Fun<'b, 's> {
    pub build: &'b mut Build<'s>,
    pub shader: &'s Shader,
    expressions: Arena<Expression>,
    locals: Arena<LocalVariable>,
    blocks: Vec<(Block, bool)>,
    pub names: HashMap<SymbolId, Var>,
    /// Computed indices into samplers that stand for one number now.
    pub chosen: HashMap<ExprId, u32>,
    /// What the function returns.
    pub result: Type,
    /// Where expressions and statements are taken from now.
    pub at: Span,
    /// The invocation may be discarded in it.
    pub stops: bool,
    /// In the step of a loop, which cannot return.
    pub in_step: bool,
    pub in_loop: bool,
    /// Derivatives that it comes to.
    pub sites: u32,
}

impl<'b, 's> Fun<'b, 's> {
    pub(super) fn new(build: &'b mut Build<'s>, result: Type) -> Self {
        let shader = build.shader;
        Self {
            build,
            shader,
            expressions: Arena::new(),
            locals: Arena::new(),
            blocks: vec![(Block::new(), false)],
            names: HashMap::new(),
            chosen: HashMap::new(),
            result,
            at: Span::at(0),
            stops: false,
            in_step: false,
            in_loop: false,
            sites: 0,
        }
    }

    /// Ends the function.
    pub(super) fn finish(
        mut self,
        name: &str,
        arguments: Vec<FunctionArgument>,
        result: Option<FunctionResult>,
    ) -> Function {
        Function {
            name: Some(name.to_owned()),
            arguments,
            result,
            body: self.blocks.pop().unwrap_or_default().0,
            local_variables: self.locals,
            expressions: self.expressions,
            ..Function::default()
        }
    }

    fn span(&self) -> naga::Span {
        let part = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        naga::Span::new(part(self.at.start), part(self.at.end))
    }

    /// Adds an expression, computed here where it is computed at all.
    pub(super) fn add(&mut self, expression: Expression) -> Expr {
        let quiet = expression.needs_pre_emit()
            || matches!(expression, Expression::CallResult(_) | Expression::AtomicResult { .. })
            || matches!(expression, Expression::SubgroupBallotResult | Expression::SubgroupOperationResult { .. });
        let span = self.span();
        let handle = self.expressions.append(expression, span);
        if quiet || self.is_done() {
            return handle;
        }
        if let Some((block, _)) = self.blocks.last_mut() {
            if let Some(Statement::Emit(range)) = block.last_mut()
                && let Some((first, last)) = range.first_and_last()
                && last.index() + 1 == handle.index()
            {
                *range = Range::new_from_bounds(first, handle);
                return handle;
            }
            block.push(Statement::Emit(Range::new_from_bounds(handle, handle)), span);
        }
        handle
    }

    /// The expression behind a handle.
    pub(super) fn get(&self, e: Expr) -> &Expression {
        &self.expressions[e]
    }

    /// Adds a statement. What stands behind the end of a block is never run, and left out.
    pub(super) fn push(&mut self, statement: Statement) {
        if self.is_done() {
            return;
        }
        let ends =
            matches!(statement, Statement::Break | Statement::Continue | Statement::Return { .. } | Statement::Kill);
        let span = self.span();
        if let Some((block, done)) = self.blocks.last_mut() {
            block.push(statement, span);
            *done = ends;
        }
    }

    /// True behind `return`, `break`, `continue` and `discard`.
    pub(super) fn is_done(&self) -> bool {
        self.blocks.last().is_some_and(|(_, done)| *done)
    }

    /// Marks the end of the block as never reached.
    pub(super) fn finish_block(&mut self) {
        if let Some((_, done)) = self.blocks.last_mut() {
            *done = true;
        }
    }

    /// What `work` adds, as a block of its own.
    pub(super) fn block<T>(&mut self, work: impl FnOnce(&mut Self) -> Result<T>) -> Result<(Block, T)> {
        let dead = self.is_done();
        self.blocks.push((Block::new(), dead));
        let result = work(self);
        let block = self.blocks.pop().unwrap_or_default().0;
        Ok((block, result?))
    }

    /// Puts a block before everything that has been added.
    pub(super) fn prepend(&mut self, mut first: Block) {
        if let Some((block, _)) = self.blocks.first_mut() {
            first.append(block);
            *block = first;
        }
    }

    /// A new variable of the function.
    pub(super) fn local(&mut self, name: &str, ty: &Type) -> Result<Lvalue> {
        let host = self.build.value_type(ty, self.at)?;
        let variable = LocalVariable { name: Some(name.to_owned()), ty: host, init: None };
        let span = self.span();
        let local = self.locals.append(variable, span);
        let ptr = self.add(Expression::LocalVariable(local));
        Ok(Lvalue { ptr, ty: ty.clone(), host, swizzle: None })
    }

    pub(super) fn ty(&mut self, ty: &Type) -> Result<Handle<NagaType>> {
        self.build.value_type(ty, self.at)
    }

    pub(super) fn i32(&mut self, value: i32) -> Expr {
        self.add(Expression::Literal(Literal::I32(value)))
    }

    /// A number of a scalar type.
    #[expect(clippy::cast_possible_truncation, reason = "only small whole numbers are asked for")]
    pub(super) fn number(&mut self, scalar: ScalarType, value: f64) -> Expr {
        if scalar == ScalarType::Half {
            return self.half(value as f32);
        }
        self.add(Expression::Literal(match scalar {
            ScalarType::Bool => Literal::Bool(value != 0.0),
            ScalarType::Int8 | ScalarType::Int16 | ScalarType::Int => Literal::I32(value as i32),
            ScalarType::Uint8 | ScalarType::Uint16 | ScalarType::Uint => Literal::U32(value as u32),
            ScalarType::Int64 => Literal::I64(value as i64),
            ScalarType::Uint64 => Literal::U64(value as u64),
            ScalarType::Half | ScalarType::Float => Literal::F32(value as f32),
            ScalarType::Double => Literal::F64(value),
        }))
    }

    /// A number of binary16.
    pub(super) fn half(&mut self, value: f32) -> Expr {
        let expr = self.add(Expression::Literal(Literal::F32(value)));
        self.add(Expression::As { expr, kind: naga::ScalarKind::Float, convert: Some(2) })
    }

    /// A number in every component of a scalar, vector or matrix.
    pub(super) fn all(&mut self, ty: &Type, value: f64) -> Result<Val> {
        let number = self.number(ty.scalar().unwrap_or(ScalarType::Float), value);
        let e = match ty {
            Type::Vector(_, n) => self.add(Expression::Splat { size: super::types::size(*n), value: number }),
            Type::Matrix(s, columns, rows) => {
                let column = self.all(&Type::Vector(*s, *rows), value)?.e;
                let ty = self.ty(ty)?;
                self.add(Expression::Compose { ty, components: vec![column; usize::from(*columns)] })
            }
            _ => number,
        };
        Ok(Val { e, ty: ty.clone() })
    }

    /// Component, column, element or member with a known index.
    pub(super) fn part(&mut self, base: Expr, index: u32) -> Expr {
        // What was just put together is taken apart again for free.
        if let Expression::Splat { value, .. } = self.expressions[base] {
            return value;
        }
        self.add(Expression::AccessIndex { base, index })
    }

    pub(super) fn compose(&mut self, ty: &Type, components: Vec<Expr>) -> Result<Val> {
        let handle = self.ty(ty)?;
        Ok(Val { e: self.add(Expression::Compose { ty: handle, components }), ty: ty.clone() })
    }

    /// `if (condition) { accept } else { reject }`.
    pub(super) fn branch(
        &mut self,
        condition: Expr,
        accept: impl FnOnce(&mut Self) -> Result<()>,
        reject: impl FnOnce(&mut Self) -> Result<()>,
    ) -> Result<()> {
        let at = self.at;
        let (accept, first) = self.block(|f| accept(f).map(|()| f.is_done()))?;
        let (reject, second) = self.block(|f| reject(f).map(|()| f.is_done()))?;
        // It stands where its condition does, and not where its last statement ends.
        self.at = at;
        self.push(Statement::If { condition, accept, reject });
        if first && second {
            self.finish_block();
        }
        Ok(())
    }
}
