//! `min`, `max` and `clamp` that change no number, and so are there for NaN alone: `max(sqrt(x), 0.0)`.

use base::diagnostic::{Message, message};
use syntax::ast::{ExprId, ExprKind};
use syntax::symbols::CallTarget;
use syntax::{BuiltinFunction as F, Shader};

use analysis::numeric::{bare, constant};

/// Beyond this size there are hardly any numbers.
const HUGE: f64 = 3e38;

/// What is relied on, where a call is one of these.
pub(super) fn relied_on(shader: &Shader, id: ExprId) -> Option<Message> {
    let (function, args) = called(shader, id)?;
    let holds = match (function, args) {
        (F::Max, [a, b]) => [(*a, *b), (*b, *a)].into_iter().any(|(x, end)| within(shader, x, [Some(end), None])),
        (F::Min, [a, b]) => [(*a, *b), (*b, *a)].into_iter().any(|(x, end)| within(shader, x, [None, Some(end)])),
        (F::Clamp, [x, low, high]) => within(shader, *x, [Some(*low), Some(*high)]),
        _ => false,
    };
    let text = shader.text_of(id);
    holds.then(|| {
        message!(
            "`{text}` changes no number, and of NaN nothing is certain",
            "`{text}` はどの数も変えず、NaN については何も保証されません"
        )
    })
}

fn called(shader: &Shader, id: ExprId) -> Option<(F, &[ExprId])> {
    match (&shader.expr(bare(shader, id)).kind, shader.callee(bare(shader, id))) {
        (ExprKind::Call { args, .. }, Some(CallTarget::Builtin(call))) => Some((call.function, args)),
        _ => None,
    }
}

/// True for a value that may be NaN, and where it is not lies between these ends already.
fn within(shader: &Shader, x: ExprId, ends: [Option<ExprId>; 2]) -> bool {
    let mut values = [f64::NEG_INFINITY, f64::INFINITY];
    for (value, end) in values.iter_mut().zip(ends) {
        let Some(end) = end else { continue };
        let Some(known) = number(shader, end) else { return false };
        *value = known;
    }
    let floating = shader.type_of(x).scalar().is_some_and(|scalar| scalar.is_floating());
    let [low, high] = values;
    let wide = |end: f64| end.abs() >= HUGE;
    if floating && constant(shader, x).is_none() && wide(low) && wide(high) && (low.is_finite() || high.is_finite()) {
        return low < high;
    }
    results(shader, x).is_some_and(|[least, most]| low <= least && most <= high)
}

/// A constant, or a vector that has it in each component.
fn number(shader: &Shader, id: ExprId) -> Option<f64> {
    let id = bare(shader, id);
    constant(shader, id).or_else(|| match (&shader.expr(id).kind, shader.callee(id)) {
        (ExprKind::Call { args, .. }, Some(CallTarget::Constructor(_))) if args.len() == 1 => number(shader, args[0]),
        _ => None,
    })
}

/// Between what the numbers lie that a function gives whose argument may be outside of its domain.
fn results(shader: &Shader, id: ExprId) -> Option<[f64; 2]> {
    use std::f64::consts::{FRAC_PI_2, PI};
    let (function, args) = called(shader, id)?;
    let kept = !matches!(function, F::Normalize) && args.first().is_some_and(|arg| keeps(shader, *arg));
    // Binary32 may have π rounded up.
    let wider = 1.0 - 1e-6;
    match function {
        _ if kept => None,
        F::Sqrt | F::Inversesqrt | F::Pow | F::Acosh => Some([0.0, f64::INFINITY]),
        F::Acos => Some([0.0, PI * wider]),
        F::Asin => Some([-FRAC_PI_2 * wider, FRAC_PI_2 * wider]),
        F::Normalize => Some([-1.0, 1.0]),
        _ => None,
    }
}

/// True for an argument that something keeps in its domain, or that is known.
fn keeps(shader: &Shader, id: ExprId) -> bool {
    let id = bare(shader, id);
    let square = match shader.expr(id).kind {
        syntax::ast::ExprKind::Binary { op: syntax::ast::BinaryOp::Mul, left, right, .. } => {
            shader.text_of(left) == shader.text_of(right)
        }
        _ => false,
    };
    let cut = called(shader, id).is_some_and(|(function, args)| match function {
        F::Max | F::Min | F::Clamp | F::Abs | F::Length | F::Distance | F::Fract => true,
        F::Dot => matches!(args, [a, b] if shader.text_of(*a) == shader.text_of(*b)),
        _ => false,
    });
    square || cut || number(shader, id).is_some()
}
