//! Bodies of functions: scopes, and which variables statements read and write (WGSL, section 9).

use std::collections::HashMap;

use super::super::ast::{Block, Condition, ExprId, ExprKind, Stmt, StmtKind, UnaryOp};
use super::super::symbols::{Access, CallTarget, Direction, FunctionId, SymbolKind, Use};
use super::super::types::Type;
use super::builtin;
use super::check::{Checker, Entry};
use super::syntax::DeclarationKind;

impl Checker<'_> {
    pub(super) fn body(&mut self, function: FunctionId, body: &Block) {
        let info = self.out.functions[function.index()].clone();
        self.aliased = self
            .locals
            .values()
            .filter(|v| body.span.contains(v.name.span.start))
            .filter_map(|v| self.pointee(v.value?))
            .collect();
        let mut scope = HashMap::new();
        for param in &info.params {
            if let (Some(name), Some(symbol)) = (&param.name, param.symbol) {
                scope.insert(name.name.clone(), Entry::Variable(symbol));
            }
        }
        self.scopes = vec![scope];
        self.current = Some((function, info.return_type));
        self.statements(&body.statements);
        self.scopes.clear();
        self.current = None;
    }

    /// The name of the variable to which `&variable.member[index]` points.
    fn pointee(&self, value: ExprId) -> Option<String> {
        let mut id = self.addresses.contains(&value).then_some(value)?;
        loop {
            id = match &self.arena.get(id).kind {
                ExprKind::Name(name) => return Some(name.clone()),
                ExprKind::Paren(inner) => *inner,
                ExprKind::Index { base, .. } | ExprKind::Field { base, .. } => *base,
                _ => return None,
            };
        }
    }

    fn inside(&mut self, run: impl FnOnce(&mut Self)) {
        self.scopes.push(HashMap::new());
        run(self);
        self.scopes.pop();
    }

    fn statements(&mut self, statements: &[Stmt]) {
        statements.iter().for_each(|s| self.statement(s));
    }

    fn statement(&mut self, statement: &Stmt) {
        match &statement.kind {
            StmtKind::Declaration(declaration) => {
                for declarator in &declaration.declarators {
                    self.local(declarator.name.span.start);
                }
            }
            StmtKind::Expr(expr) | StmtKind::Case(expr) => {
                self.root(*expr);
            }
            StmtKind::Block(block) => self.inside(|c| c.statements(&block.statements)),
            StmtKind::If { condition, then, otherwise } => {
                self.condition(*condition);
                self.statement(then);
                if let Some(otherwise) = otherwise {
                    self.statement(otherwise);
                }
            }
            StmtKind::For { init, condition, step, body, head_span: _ } => self.inside(|c| {
                c.statement(init);
                if let Some(Condition::Expr(condition)) = condition {
                    c.condition(*condition);
                }
                c.statement(body);
                if let Some(step) = step {
                    c.root(*step);
                }
            }),
            StmtKind::While { condition, body } => {
                if let Condition::Expr(condition) = condition {
                    self.condition(*condition);
                }
                self.statement(body);
            }
            // The condition stands in `continuing`, where the variables of the body are known.
            StmtKind::DoWhile { body, condition } => self.inside(|c| {
                match &body.kind {
                    StmtKind::Block(block) => c.statements(&block.statements),
                    _ => c.statement(body),
                }
                c.condition(*condition);
            }),
            StmtKind::Switch { selector, body } => {
                self.root(*selector);
                self.inside(|c| c.statements(&body.statements));
            }
            StmtKind::Return(value) => {
                let Some(value) = value else { return };
                self.root(*value);
                if let Some(scalar) = self.current.as_ref().and_then(|(_, ty)| ty.scalar()) {
                    self.adopt(*value, scalar);
                }
                self.result_fits(*value);
            }
            StmtKind::Empty
            | StmtKind::Precision(_)
            | StmtKind::Qualified(_)
            | StmtKind::Default
            | StmtKind::Break
            | StmtKind::Continue
            | StmtKind::Discard
            | StmtKind::Error => {}
        }
    }

    fn local(&mut self, place: usize) {
        let Some(variable) = self.locals.get(&place) else { return };
        let (ty, is_abstract) = self.declared(variable);
        let is_pointer = variable.value.is_some_and(|v| self.addresses.contains(&v))
            || variable.ty.as_ref().is_some_and(|t| t.name.name == "ptr");
        let name = variable.name.name.clone();
        let entry = if is_pointer || self.aliased.contains(&name) {
            Entry::Hidden(ty)
        } else {
            let symbol = self.symbol(&variable.name, ty, SymbolKind::Local);
            let value = variable.value.and_then(|v| self.out.values[v.index()]);
            let info = &mut self.out.symbols[symbol.index()];
            info.read_only = variable.kind != DeclarationKind::Var;
            if variable.kind == DeclarationKind::Const {
                info.value = value;
                info.initializer = variable.value;
            }
            if is_abstract {
                self.abstract_symbols.insert(symbol);
            }
            Entry::Variable(symbol)
        };
        if let Some(scope) = self.scopes.last_mut() {
            scope.insert(name, entry);
        }
    }

    fn condition(&mut self, id: ExprId) {
        self.root(id);
        self.condition_fits(id);
    }

    /// Types a whole expression and records which variables it uses.
    pub(super) fn root(&mut self, id: ExprId) -> Type {
        let ty = self.expression(id);
        let access = if self.addresses.contains(&id) { Access::ReadWrite } else { Access::Read };
        self.record(id, access);
        ty
    }

    fn record(&mut self, root: ExprId, access: Access) {
        let function = self.current.as_ref().map(|c| c.0);
        let mut todo = vec![(root, access, false)];
        while let Some((id, access, partial)) = todo.pop() {
            let expr = self.arena.get(id);
            match &expr.kind {
                ExprKind::Name(_) => {
                    if let Some(symbol) = self.out.names[id.index()] {
                        let span = expr.span;
                        self.out.uses.push(Use {
                            symbol,
                            expr: id,
                            span,
                            from_macro: false,
                            access,
                            partial,
                            function,
                        });
                    }
                }
                ExprKind::Paren(inner) => todo.push((*inner, access, partial)),
                ExprKind::Index { base, index } => {
                    todo.push((*index, Access::Read, false));
                    todo.push((*base, access, true));
                }
                ExprKind::Field { base, field: _ } => todo.push((*base, access, true)),
                ExprKind::Assign { op, op_span: _, target, value } => {
                    todo.push((*value, Access::Read, false));
                    todo.push((*target, if op.is_some() { Access::ReadWrite } else { Access::Write }, false));
                }
                ExprKind::Unary { op: UnaryOp::Increment | UnaryOp::Decrement, op_span: _, operand }
                | ExprKind::Postfix { increment: _, op_span: _, operand } => {
                    todo.push((*operand, Access::ReadWrite, false));
                }
                ExprKind::Call { callee, args } => {
                    let directions: Vec<Direction> = match (&self.out.calls[id.index()], callee) {
                        (Some(CallTarget::User(f)), _) => {
                            self.out.functions[f.index()].params.iter().map(|p| p.direction).collect()
                        }
                        (None, super::super::ast::Callee::Name(name)) => builtin::directions(&name.name, args.len()),
                        _ => Vec::new(),
                    };
                    for (i, arg) in args.iter().enumerate() {
                        let access = match directions.get(i).copied().unwrap_or_default() {
                            Direction::In => Access::Read,
                            Direction::Out => Access::Write,
                            Direction::InOut => Access::ReadWrite,
                        };
                        todo.push((*arg, access, false));
                    }
                }
                _ => todo.extend(expr.children().into_iter().map(|c| (c, Access::Read, false))),
            }
        }
    }
}
