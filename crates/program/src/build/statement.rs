//! Statements.

use naga::{Block as NagaBlock, Expression, Statement, SwitchCase, SwitchValue, UnaryOperator};

use super::function::{Fun, Val};
use super::place::Var;
use super::types::same;
use super::{Expr, Result};
use syntax::ast::{ArrayDim, Block, Condition, Declaration, ExprId, Stmt, StmtKind, TypeKind};
use syntax::symbols::SymbolId;
use syntax::types::{ArraySize, Type};
use syntax::{Const, Stage};

impl Fun<'_, '_> {
    pub(super) fn statements(&mut self, statements: &[Stmt]) -> Result<()> {
        for statement in statements {
            if self.is_done() {
                break;
            }
            self.statement(statement)?;
        }
        Ok(())
    }

    fn statement(&mut self, statement: &Stmt) -> Result<()> {
        self.at = statement.span;
        match &statement.kind {
            StmtKind::Empty | StmtKind::Precision(_) | StmtKind::Qualified(_) => {}
            StmtKind::Declaration(declaration) => self.declaration(declaration)?,
            StmtKind::Expr(id) if self.prints(*id) => {}
            StmtKind::Expr(id) => {
                // `c ? f() : g();` without values is a branch.
                self.discarded(*id)?;
            }
            StmtKind::Block(block) => self.nested(block)?,
            StmtKind::If { condition, then, otherwise } => {
                let condition = self.expression(*condition)?.e;
                self.branch(
                    condition,
                    |f| f.statement(then),
                    |f| otherwise.as_ref().map_or(Ok(()), |s| f.statement(s)),
                )?;
            }
            StmtKind::For { init, condition, step, body, .. } => {
                self.statement(init)?;
                self.repeat(condition.as_ref(), *step, body)?;
            }
            StmtKind::While { condition, body } => self.repeat(Some(condition), None, body)?,
            StmtKind::DoWhile { body, condition } => {
                let outside = std::mem::replace(&mut self.in_loop, true);
                let (block, ()) = self.block(|f| f.statement(body))?;
                let around = std::mem::replace(&mut self.in_step, true);
                let (continuing, stop) = self.block(|f| {
                    let condition = f.expression(*condition)?.e;
                    Ok(f.add(Expression::Unary { op: UnaryOperator::LogicalNot, expr: condition }))
                })?;
                (self.in_step, self.in_loop) = (around, outside);
                self.push(Statement::Loop { body: block, continuing, break_if: Some(stop) });
            }
            StmtKind::Switch { selector, body } => self.switch(*selector, body)?,
            StmtKind::Case(_) | StmtKind::Default => {
                return Err(self.build.unsupported(
                    statement.span,
                    "a label that is not at the top of its `switch`",
                    "move it there",
                ));
            }
            StmtKind::Return(value) => {
                let value = match value {
                    Some(value) => {
                        let want = self.result.clone();
                        if want == Type::Void {
                            self.statement_expression(*value)?;
                            None
                        } else {
                            Some(self.initial(*value, &want)?.e)
                        }
                    }
                    None => None,
                };
                self.push(Statement::Return { value });
            }
            StmtKind::Break => self.push(Statement::Break),
            StmtKind::Continue => self.push(Statement::Continue),
            StmtKind::Discard => {
                if !matches!(self.shader.stage(), Stage::Fragment | Stage::Library) {
                    return Err(self.build.unsupported(
                        statement.span,
                        "`discard` outside of a fragment shader",
                        "only a fragment shader can discard",
                    ));
                }
                if self.build.run {
                    self.discard(statement.span)?;
                } else {
                    self.push(Statement::Kill);
                }
            }
            StmtKind::Error => {
                return Err(self.build.unsupported(statement.span, "text that could not be read", "correct it"));
            }
        }
        Ok(())
    }

    /// True for a call that prints and changes nothing. Its string is no value of the language.
    fn prints(&self, id: ExprId) -> bool {
        use syntax::ast::{Callee, ExprKind};
        matches!(&self.shader.expr(id).kind, ExprKind::Call { callee: Callee::Name(name), .. } if name.name == syntax::PRINTS)
    }

    /// An expression whose value nobody wants.
    fn discarded(&mut self, id: ExprId) -> Result<()> {
        use syntax::ast::ExprKind;
        match &self.shader.expr(id).kind {
            ExprKind::Paren(inner) => self.discarded(*inner),
            ExprKind::Ternary { condition, yes, no } if self.shader.type_of(*yes) == &Type::Void => {
                let condition = self.expression(*condition)?.e;
                self.branch(condition, |f| f.discarded(*yes), |f| f.discarded(*no))
            }
            _ => self.statement_expression(id).map(|_| ()),
        }
    }

    /// A block of its own is a scope only: names of GLSL are told apart by their symbols.
    fn nested(&mut self, block: &Block) -> Result<()> {
        self.statements(&block.statements)
    }

    pub(super) fn declaration(&mut self, declaration: &Declaration) -> Result<()> {
        for declarator in &declaration.declarators {
            self.at = declarator.span;
            let symbols = self.of_type(self.build.declared(&declarator.name), &declaration.ty.kind);
            let Some(&first) = symbols.first() else {
                // An array that is declared again only gets its size.
                if declarator.initializer.is_none() {
                    continue;
                }
                return Err(self.build.unsupported(
                    declarator.span,
                    "an array that is declared again with a value",
                    "declare it once",
                ));
            };
            let dims: Vec<&ArrayDim> = declarator.dims.iter().chain(&declaration.ty.dims).collect();
            let ty = self.build.with_dims(&self.shader.symbol(first).ty, &dims);
            if let Some(initializer) = declarator.initializer.as_ref().filter(|_| declaration.qualifiers.is_const()) {
                for &symbol in &symbols {
                    self.build.made.local_constants.insert(symbol, initializer.value);
                }
            }
            let value = match &declarator.initializer {
                Some(initializer) => Some(self.initial(initializer.value, &ty)?),
                None => None,
            };
            let ty = match &value {
                Some(value) if same(&value.ty, &ty) => value.ty.clone(),
                _ => self.build.with_size(first, &ty),
            };
            let place = self.local(&declarator.name.name, &ty)?;
            if let Some(value) = value {
                self.store(&place, &Val { e: value.e, ty })?;
            }
            for symbol in symbols {
                self.names.insert(symbol, Var::Place(place.clone()));
            }
        }
        Ok(())
    }

    /// Of the variables of one place, those of the type that is written: a macro that declares one in each of several functions
    /// has one place for all of them.
    fn of_type(&self, all: Vec<SymbolId>, kind: &TypeKind) -> Vec<SymbolId> {
        let TypeKind::Named(written) = kind else { return all };
        let is_written = |symbol: &&SymbolId| {
            let mut ty = &self.shader.symbol(**symbol).ty;
            while let Type::Array(element, _) = ty {
                ty = element;
            }
            ty.to_string() == *written
        };
        let own: Vec<SymbolId> = all.iter().filter(is_written).copied().collect();
        if own.is_empty() { all } else { own }
    }

    fn condition(&mut self, condition: &Condition) -> Result<Expr> {
        match condition {
            Condition::Expr(id) => Ok(self.expression(*id)?.e),
            Condition::Declaration(declaration) => {
                self.declaration(declaration)?;
                let last = declaration.declarators.last();
                let symbol = last.and_then(|d| self.build.declared(&d.name).first().copied());
                match symbol.and_then(|s| self.names.get(&s).cloned()) {
                    Some(Var::Place(place)) => Ok(self.load(&place)?.e),
                    _ => Err(self.build.unsupported(declaration.span, "this condition", "declare it before the loop")),
                }
            }
        }
    }

    fn repeat(&mut self, condition: Option<&Condition>, step: Option<ExprId>, body: &Stmt) -> Result<()> {
        let outside = std::mem::replace(&mut self.in_loop, true);
        let (block, ()) = self.block(|f| {
            if let Some(condition) = condition {
                let goes_on = f.condition(condition)?;
                f.branch(
                    goes_on,
                    |_| Ok(()),
                    |f| {
                        f.push(Statement::Break);
                        Ok(())
                    },
                )?;
            }
            f.statement(body)
        })?;
        let around = std::mem::replace(&mut self.in_step, true);
        let (continuing, ()) = self.block(|f| step.map_or(Ok(()), |step| f.discarded(step)))?;
        (self.in_step, self.in_loop) = (around, outside);
        let endless = condition.is_none() && !leaves(&block);
        self.push(Statement::Loop { body: block, continuing, break_if: None });
        if endless {
            self.finish_block();
        }
        Ok(())
    }

    /// `switch`: what falls through is written out again, since not every language has it.
    fn switch(&mut self, selector: ExprId, body: &Block) -> Result<()> {
        let selector = self.expression(selector)?;
        let unsigned = selector.ty == Type::UINT;
        // Groups of labels with the statements behind them.
        let mut groups: Vec<(Vec<SwitchValue>, &[Stmt])> = Vec::new();
        let mut at = 0;
        let statements = &body.statements;
        let is_label = |s: &Stmt| matches!(s.kind, StmtKind::Case(_) | StmtKind::Default);
        while at < statements.len() {
            let mut labels = Vec::new();
            while let Some(label) = statements.get(at).filter(|s| is_label(s)) {
                labels.push(match &label.kind {
                    StmtKind::Case(value) => self.label(*value, unsigned)?,
                    _ => SwitchValue::Default,
                });
                at += 1;
            }
            let end = statements[at..].iter().position(is_label).map_or(statements.len(), |n| at + n);
            if labels.is_empty() {
                // Statements before the first label are never run.
                at = end;
                continue;
            }
            groups.push((labels, &statements[at..end]));
            at = end;
        }
        let mut cases: Vec<SwitchCase> = Vec::new();
        for k in 0..groups.len() {
            let rest: Vec<&[Stmt]> = groups[k..].iter().map(|(_, s)| *s).collect();
            let (block, ()) = self.block(|f| {
                for part in rest {
                    f.statements(part)?;
                }
                f.push(Statement::Break);
                Ok(())
            })?;
            let labels = groups[k].0.clone();
            for (i, value) in labels.iter().enumerate() {
                let last = i + 1 == labels.len();
                let body = if last { block.clone() } else { NagaBlock::new() };
                cases.push(SwitchCase { value: *value, body, fall_through: !last });
            }
        }
        if !cases.iter().any(|c| c.value == SwitchValue::Default) {
            cases.push(SwitchCase { value: SwitchValue::Default, body: NagaBlock::new(), fall_through: false });
        }
        let ends = |case: &SwitchCase| case.fall_through || (ends(&case.body) && !leaves(&case.body));
        let all = cases.iter().all(ends);
        self.push(Statement::Switch { selector: selector.e, cases });
        if all {
            self.finish_block();
        }
        Ok(())
    }

    fn label(&mut self, value: ExprId, unsigned: bool) -> Result<SwitchValue> {
        match self.shader.fold(value) {
            Some(Const::Int(v)) if unsigned => Ok(SwitchValue::U32(v.cast_unsigned())),
            Some(Const::Uint(v)) if !unsigned => Ok(SwitchValue::I32(v.cast_signed())),
            Some(Const::Int(v)) => Ok(SwitchValue::I32(v)),
            Some(Const::Uint(v)) => Ok(SwitchValue::U32(v)),
            _ => {
                let span = self.shader.expr(value).span;
                Err(self.build.unsupported(span, "a label whose value is not known", "write a number"))
            }
        }
    }

    /// Ends a function. What one gives that ends without `return` is undefined (GLSL 4.60, 6.1): a variable without
    /// a value says so.
    pub(super) fn end(&mut self) -> Result<()> {
        if self.is_done() {
            return Ok(());
        }
        if self.result == Type::Void {
            self.push(Statement::Return { value: None });
            return Ok(());
        }
        let ty = self.result.clone();
        let place = self.local(crate::NO_RETURN, &ty)?;
        let value = self.load(&place)?;
        self.push(Statement::Return { value: Some(value.e) });
        Ok(())
    }
}

/// True when a `break` in the block leaves the loop or `switch` around it.
fn leaves(block: &NagaBlock) -> bool {
    block.iter().any(|statement| match statement {
        Statement::Break => true,
        Statement::Block(inner) => leaves(inner),
        Statement::If { accept, reject, .. } => leaves(accept) || leaves(reject),
        _ => false,
    })
}

/// True when the end of the block is never reached.
fn ends(block: &NagaBlock) -> bool {
    match block.last() {
        Some(Statement::Return { .. } | Statement::Kill | Statement::Continue) => true,
        Some(Statement::If { accept, reject, .. }) => ends(accept) && ends(reject),
        _ => false,
    }
}

/// The size that an array without one takes.
pub(super) fn with_length(ty: &Type, n: u32) -> Type {
    match ty {
        Type::Array(element, ArraySize::Unsized | ArraySize::Unknown) => element.as_ref().clone().array(n),
        _ => ty.clone(),
    }
}
