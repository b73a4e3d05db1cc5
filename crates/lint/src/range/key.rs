//! Spellings of expressions by which equal ones are recognised.

use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind, UnaryOp};
use syntax::symbols::{CallTarget, Direction, SymbolId};

/// How a variable is spelt in a key.
pub fn of_symbol(symbol: SymbolId) -> String {
    format!("<{}>", symbol.index())
}

/// The spelling of an expression without side effects: two expressions with one spelling have the
/// same value as long as no variable in it is written. None for others.
pub fn of(shader: &Shader, id: ExprId) -> Option<String> {
    let mut text = String::new();
    write(shader, id, &mut text)?;
    Some(text)
}

/// The spelling of `left op right`.
pub fn of_binary(op: BinaryOp, left: &str, right: &str) -> String {
    format!("({left}{}{right})", op.text())
}

fn write(shader: &Shader, id: ExprId, into: &mut String) -> Option<()> {
    if let Some(value) = shader.fold(id) {
        into.push_str(&value.to_string());
        return Some(());
    }
    match &shader.expr(id).kind {
        ExprKind::Paren(inner) => write(shader, *inner, into)?,
        ExprKind::Name(_) => into.push_str(&of_symbol(shader.symbol_of(id)?)),
        ExprKind::Index { base, index } => {
            write(shader, *base, into)?;
            into.push('[');
            write(shader, *index, into)?;
            into.push(']');
        }
        ExprKind::Field { base, field } => {
            write(shader, *base, into)?;
            into.push('.');
            into.push_str(&field.name);
        }
        ExprKind::Unary { op: UnaryOp::Increment | UnaryOp::Decrement, .. } => return None,
        ExprKind::Unary { op, op_span: _, operand } => {
            into.push_str(op.text());
            write(shader, *operand, into)?;
        }
        ExprKind::Binary { op, op_span: _, left, right } => {
            let mut sides = [String::new(), String::new()];
            write(shader, *left, &mut sides[0])?;
            write(shader, *right, &mut sides[1])?;
            into.push_str(&of_binary(*op, &sides[0], &sides[1]));
        }
        ExprKind::Call { args, .. } => {
            match shader.callee(id) {
                Some(CallTarget::Builtin(call)) if call.directions.iter().all(|d| *d == Direction::In) => {
                    into.push_str(call.function.name());
                }
                Some(CallTarget::Constructor(ty)) => into.push_str(&ty.to_string()),
                _ => return None,
            }
            into.push('(');
            for arg in args {
                write(shader, *arg, into)?;
                into.push(',');
            }
            into.push(')');
        }
        ExprKind::Literal(_)
        | ExprKind::Method { .. }
        | ExprKind::Postfix { .. }
        | ExprKind::Assign { .. }
        | ExprKind::Ternary { .. }
        | ExprKind::Comma { .. }
        | ExprKind::List(_)
        | ExprKind::Error => return None,
    }
    Some(())
}
