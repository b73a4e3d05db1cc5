//! Which variables an expression reads and writes.

use super::super::ast::{ExprId, ExprKind, UnaryOp};
use super::super::symbols::{Access, CallTarget, Direction, Use};
use super::Checker;

impl Checker<'_> {
    /// Records the uses below a typed expression whose value is read.
    pub(super) fn record_uses(&mut self, root: ExprId) {
        let function = self.current.as_ref().map(|c| c.0);
        let mut todo = vec![(root, Access::Read, false)];
        while let Some((id, access, partial)) = todo.pop() {
            let expr = self.arena.get(id);
            match &expr.kind {
                ExprKind::Name(_) => {
                    if let Some(symbol) = self.out.names[id.index()] {
                        let (span, from_macro) = (expr.span, expr.from_macro);
                        self.out.uses.push(Use { symbol, expr: id, span, from_macro, access, partial, function });
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
                ExprKind::Comma { left, right } => {
                    todo.push((*right, access, partial));
                    todo.push((*left, Access::Read, false));
                }
                ExprKind::Call { callee: _, args } => {
                    let directions: Vec<Direction> = match &self.out.calls[id.index()] {
                        Some(CallTarget::User(f)) => {
                            self.out.functions[f.index()].params.iter().map(|p| p.direction).collect()
                        }
                        Some(CallTarget::Builtin(call)) => call.directions.clone(),
                        Some(CallTarget::Constructor(_)) | None => Vec::new(),
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
                ExprKind::Literal(_)
                | ExprKind::Method { .. }
                | ExprKind::Unary { .. }
                | ExprKind::Binary { .. }
                | ExprKind::Ternary { .. }
                | ExprKind::List(_)
                | ExprKind::Error => todo.extend(expr.children().into_iter().map(|c| (c, Access::Read, false))),
            }
        }
    }
}
