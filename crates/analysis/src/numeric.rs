//! What rules about numbers share: calls and operators with the ranges of their operands.

use crate::range::Range;
use base::text::Edit;
use syntax::Shader;
use syntax::ast::{Callee, ExprId, ExprKind, UnaryOp};
use syntax::symbols::CallTarget;

/// A call of a built-in function.
pub struct BuiltinCall<'s> {
    /// The call.
    pub id: ExprId,
    /// The function.
    pub name: &'s str,
    /// Its arguments.
    pub args: &'s [ExprId],
}

/// All calls of built-in functions with these names.
pub fn calls<'s>(shader: &'s Shader, names: &'static [&'static str]) -> impl Iterator<Item = BuiltinCall<'s>> {
    shader.arena().iter().filter_map(move |(id, expr)| {
        let ExprKind::Call { callee: Callee::Name(name), args } = &expr.kind else { return None };
        let builtin = matches!(shader.callee(id), Some(CallTarget::Builtin(_)));
        (builtin && names.contains(&name.name.as_str())).then_some(BuiltinCall { id, name: &name.name, args })
    })
}

/// An expression without the parentheses around it.
pub fn bare(shader: &Shader, id: ExprId) -> ExprId {
    match &shader.expr(id).kind {
        ExprKind::Paren(inner) => bare(shader, *inner),
        _ => id,
    }
}

/// True for a name or a member of one, which may be written twice without harm.
pub fn is_simple(shader: &Shader, id: ExprId) -> bool {
    match &shader.expr(id).kind {
        ExprKind::Name(_) => !shader.expr(id).from_macro,
        ExprKind::Field { base, field: _ } => !shader.expr(id).from_macro && is_simple(shader, *base),
        _ => false,
    }
}

/// True when none of these expressions has text of a macro.
pub fn is_plain(shader: &Shader, all: &[ExprId]) -> bool {
    all.iter().all(|id| !shader.expr(*id).from_macro)
}

/// Edits that put `before` and `after` around an expression; none when it comes from a macro.
pub fn around(shader: &Shader, call: ExprId, arg: ExprId, before: &str, after: &str) -> Option<Vec<Edit>> {
    is_plain(shader, &[call, arg]).then(|| {
        let span = shader.expr(arg).span;
        vec![Edit::replace(span, format!("{before}{}{after}", shader.text_of(arg)))]
    })
}

/// `text`, which stands for an expression, in parentheses where its place needs them.
pub fn in_place(shader: &Shader, id: ExprId, text: String) -> String {
    let operand = shader.arena().iter().any(|(_, user)| {
        let binds = match &user.kind {
            ExprKind::Index { base, index: _ } | ExprKind::Field { base, field: _ } => *base == id,
            ExprKind::Method { base, method: _, args: _ } => *base == id,
            ExprKind::Unary { .. } | ExprKind::Postfix { .. } | ExprKind::Binary { .. } | ExprKind::Ternary { .. } => {
                true
            }
            ExprKind::Literal(_)
            | ExprKind::Name(_)
            | ExprKind::Paren(_)
            | ExprKind::Call { .. }
            | ExprKind::Assign { .. }
            | ExprKind::Comma { .. }
            | ExprKind::List(_)
            | ExprKind::Error => false,
        };
        binds && user.children().contains(&id)
    });
    if operand { format!("({text})") } else { text }
}

/// The constant number that an expression is, with a sign in front or without.
pub fn constant(shader: &Shader, id: ExprId) -> Option<f64> {
    shader.fold(id).and_then(syntax::Const::as_f64)
}

/// The bits of a constant whole number of 32 bits.
pub fn bits(shader: &Shader, id: ExprId) -> Option<u32> {
    match shader.fold(id)? {
        syntax::Const::Int(value) => Some(value.cast_unsigned()),
        syntax::Const::Uint(value) => Some(value),
        _ => None,
    }
}

/// True for a number as it is written, with a sign in front or without.
pub fn is_literal(shader: &Shader, id: ExprId) -> bool {
    match &shader.expr(id).kind {
        ExprKind::Literal(_) => true,
        ExprKind::Paren(inner) => is_literal(shader, *inner),
        ExprKind::Unary { op: UnaryOp::Minus | UnaryOp::Plus, op_span: _, operand } => is_literal(shader, *operand),
        _ => false,
    }
}

/// A number in few words.
pub fn number(x: f64) -> String {
    if x.is_infinite() {
        return if x > 0.0 { "∞" } else { "-∞" }.to_owned();
    }
    if x != 0.0 && (x.abs() < 1e-3 || x.abs() >= 1e7) {
        return format!("{x:.1e}");
    }
    let text = format!("{x:.7}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The ends of a range in words.
pub fn ends(range: &Range) -> (String, String) {
    (number(range.lo), number(range.hi))
}
