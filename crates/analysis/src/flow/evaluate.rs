//! What evaluating an expression does: reads, writes and calls in their order.

use syntax::BuiltinFunction as F;
use syntax::ast::{BinaryOp, ExprId, ExprKind, Literal, UnaryOp};
use syntax::symbols::{CallTarget, Direction, FunctionId};

use super::build::{Builder, Frame};
use super::graph::{Kind, Store};
use super::place::{full, place};

/// Levels of operators that are followed.
const DEEPEST: u32 = 400;

impl<'s> Builder<'s> {
    /// Evaluates an expression whose value is used as a whole.
    pub(super) fn value(&mut self, id: ExprId) {
        self.read(id, true);
    }

    fn read(&mut self, id: ExprId, all: bool) {
        if self.failed || self.shader.arena().depth(id) > DEEPEST {
            self.failed = true;
            return;
        }
        let shader = self.shader;
        let expr = shader.expr(id);
        match &expr.kind {
            ExprKind::Literal(
                Literal::Bool(_)
                | Literal::Int(_)
                | Literal::Uint(_)
                | Literal::Float(_)
                | Literal::Double(_)
                | Literal::Half(_)
                | Literal::Sized(..),
            ) => {}
            ExprKind::Error => self.failed = true,
            ExprKind::Paren(inner) => self.read(*inner, all),
            ExprKind::Name(_) | ExprKind::Index { .. } | ExprKind::Field { .. } => match place(shader, id) {
                Some(place) => {
                    self.indices(id);
                    let Some(variable) = self.variable(place.root) else { return };
                    let numeric = shader.type_of(id).components().is_some();
                    let accumulates =
                        self.assigning == Some(place.root) && self.loops > self.graph.variables[variable].loops;
                    let kind = Kind::Read { all: all && numeric && place.exact, accumulates };
                    self.event(kind, variable, place.mask, expr.span, Some(id));
                }
                None => expr.children().into_iter().for_each(|c| self.value(c)),
            },
            // Only the length of the array is asked for.
            ExprKind::Method { base, method: _, args: _ } => self.indices(*base),
            ExprKind::Call { args, .. } => self.call(id, args),
            ExprKind::Unary { op: UnaryOp::Increment | UnaryOp::Decrement, op_span: _, operand }
            | ExprKind::Postfix { increment: _, op_span: _, operand } => {
                self.compute(*operand, |this| this.value(*operand));
                self.write(*operand, Store::Assigned, id);
            }
            ExprKind::Unary {
                op: UnaryOp::Plus | UnaryOp::Minus | UnaryOp::Not | UnaryOp::Complement,
                op_span: _,
                operand,
            } => self.value(*operand),
            ExprKind::Binary { op: BinaryOp::And | BinaryOp::Or, op_span: _, left, right } => {
                self.value(*left);
                let head = self.current;
                self.go_on();
                self.value(*right);
                let after = self.go_on();
                self.edge(head, after, false);
            }
            ExprKind::Binary { op: _, op_span: _, left, right } => {
                self.value(*left);
                self.value(*right);
            }
            ExprKind::Comma { left, right } => {
                self.value(*left);
                self.read(*right, all);
            }
            ExprKind::Assign { op, op_span: _, target, value } => {
                if op.is_none() {
                    self.indices(*target);
                }
                self.compute(*target, |this| {
                    if op.is_some() {
                        this.value(*target);
                    }
                    this.value(*value);
                });
                self.write(*target, Store::Assigned, id);
            }
            ExprKind::Ternary { condition, yes, no } => {
                self.value(*condition);
                let head = self.current;
                self.go_on();
                self.read(*yes, all);
                let after_yes = self.current;
                self.current = self.block();
                self.edge(head, self.current, false);
                self.read(*no, all);
                self.go_on();
                self.edge(after_yes, self.current, false);
            }
            ExprKind::List(items) => items.iter().for_each(|i| self.value(*i)),
        }
    }

    /// Does something that computes the next value of `target`.
    fn compute(&mut self, target: ExprId, run: impl FnOnce(&mut Self)) {
        let root = place(self.shader, target).map(|p| p.root);
        let outer = std::mem::replace(&mut self.assigning, root);
        run(self);
        self.assigning = outer;
    }

    /// Evaluates the indices inside a place, and not the place.
    fn indices(&mut self, id: ExprId) {
        match self.shader.expr(id).kind {
            ExprKind::Index { base, index } => {
                self.indices(base);
                self.value(index);
            }
            ExprKind::Field { base, field: _ } => self.indices(base),
            ExprKind::Paren(inner) => self.indices(inner),
            ExprKind::Name(_) => {}
            _ => self.value(id),
        }
    }

    fn write(&mut self, target: ExprId, store: Store, by: ExprId) {
        let Some(place) = place(self.shader, target) else { return };
        let Some(variable) = self.variable(place.root) else { return };
        let span = self.shader.expr(target).span;
        self.event(Kind::Write { exact: place.exact, store }, variable, place.mask, span, Some(by));
    }

    fn call(&mut self, id: ExprId, args: &[ExprId]) {
        let shader = self.shader;
        match shader.callee(id) {
            None => self.failed = true,
            Some(CallTarget::Constructor(_)) => args.iter().for_each(|a| self.value(*a)),
            Some(CallTarget::Builtin(call)) => {
                let directions = &call.directions;
                for (&arg, direction) in args.iter().zip(directions) {
                    match direction {
                        Direction::In => self.value(arg),
                        Direction::Out => self.indices(arg),
                        // The memory behind an image or a counter.
                        Direction::InOut => self.value(arg),
                    }
                }
                for (&arg, direction) in args.iter().zip(directions) {
                    if *direction != Direction::In {
                        self.write(arg, Store::Passed, id);
                    }
                }
                let kind = match call.function {
                    F::EmitVertex | F::EmitStreamVertex => Kind::Emit,
                    F::EndPrimitive | F::EndStreamPrimitive => Kind::EndPrimitive,
                    _ => return,
                };
                self.event(kind, 0, 0, shader.expr(id).span, Some(id));
            }
            Some(CallTarget::User(function)) => self.inline(id, *function, args),
        }
    }

    fn inline(&mut self, id: ExprId, function: FunctionId, args: &[ExprId]) {
        let shader = self.shader;
        let info = shader.function_info(function);
        let body = shader.function_syntax(info).and_then(|f| f.body.as_ref());
        let (Some(body), false) = (body, self.frames.iter().any(|f| f.function == function)) else {
            self.failed = true;
            return;
        };
        // A variable that is passed as a whole is copied, and so is what is not known about it.
        let mut passed = Vec::new();
        for (&arg, param) in args.iter().zip(&info.params) {
            let whole = match param.direction {
                Direction::In => {
                    self.read(arg, false);
                    None
                }
                Direction::Out | Direction::InOut => {
                    self.indices(arg);
                    let place = place(shader, arg).filter(|p| p.exact && p.mask == full(&shader.symbol(p.root).ty));
                    place.filter(|p| shader.symbol(p.root).ty == param.ty).and_then(|p| self.variable(p.root))
                }
            };
            passed.push(whole);
        }
        self.copies += 1;
        let (copy, exit) = (self.copies, self.block());
        self.frames.push(Frame { function, copy, exit, breaks: Vec::new(), continues: Vec::new() });
        if !self.graph.functions.contains(&function) {
            self.graph.functions.push(function);
        }
        let assigning = self.assigning.take();
        let mut back = Vec::new();
        for (param, whole) in info.params.iter().zip(&passed) {
            let Some(variable) = param.symbol.and_then(|s| self.variable(s)) else {
                back.push(None);
                continue;
            };
            let kind = match (param.direction, whole) {
                (Direction::Out, _) => Kind::Declare,
                (Direction::InOut, Some(from)) => Kind::Copy { from: *from },
                (Direction::In | Direction::InOut, _) => Kind::Write { exact: true, store: Store::Passed },
            };
            self.event(kind, variable, full(&param.ty), param.span, None);
            back.push(Some(variable));
        }
        self.body(body, &info.return_type);
        self.frames.pop();
        self.assigning = assigning;
        let span = shader.expr(id).span;
        for (((&arg, param), whole), variable) in args.iter().zip(&info.params).zip(passed).zip(back) {
            match (param.direction, whole, variable) {
                (Direction::In, ..) => {}
                (Direction::InOut, Some(to), Some(from)) => {
                    self.event(Kind::Copy { from }, to, full(&param.ty), span, Some(id));
                }
                (Direction::Out | Direction::InOut, ..) => self.write(arg, Store::Passed, id),
            }
        }
    }
}
