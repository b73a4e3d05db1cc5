//! Constructs that naga's GLSL front end accepts and gets wrong. They are refused by name: a module
//! that means something else than the text is worse than none.

use super::Work;
use crate::glsl::Shader;
use crate::glsl::ast::{BinaryOp, Callee, ExprId, ExprKind, UnaryOp};
use crate::glsl::interface::Storage;
use crate::glsl::symbols::{CallTarget, Direction, FunctionId, SymbolKind};

pub(super) fn check(work: &mut Work<'_>) {
    global_initializers(work);
    short_circuits(work);
    constructors(work);
}

/// naga drops the initialiser of a global variable when it is not constant: the variable is then 0.
fn global_initializers(work: &mut Work<'_>) {
    let shader = work.shader;
    for global in shader.interface().globals.iter().chain(&shader.interface().constants) {
        let Some(value) = global.initializer else { continue };
        if !is_constant(shader, value) {
            let message =
                format!("global `{}` starts with a value that is not constant; the translator drops it", global.name);
            work.unsupported(shader.expr(value).span, message, "assign it at the start of `main`");
        }
    }
}

fn is_constant(shader: &Shader, id: ExprId) -> bool {
    if shader.fold(id).is_some() {
        return true;
    }
    let expr = shader.expr(id);
    let own = match &expr.kind {
        ExprKind::Name(_) => shader.symbol_of(id).is_some_and(|s| {
            let symbol = shader.symbol(s);
            symbol.kind == SymbolKind::Global(Storage::Const) || symbol.value.is_some()
        }),
        ExprKind::Call { callee: Callee::Name(_), .. } => {
            !matches!(shader.callee(id), Some(CallTarget::User(_)) | None)
        }
        ExprKind::Assign { .. } | ExprKind::Postfix { .. } | ExprKind::Error => false,
        _ => true,
    };
    own && expr.children().iter().all(|&c| is_constant(shader, c))
}

/// naga evaluates both sides of `&&` and `||`: it shows when the right side does something.
fn short_circuits(work: &mut Work<'_>) {
    let shader = work.shader;
    for (_, expr) in shader.arena().iter() {
        if let ExprKind::Binary { op: op @ (BinaryOp::And | BinaryOp::Or), right, op_span, .. } = &expr.kind
            && has_effect(shader, *right, 0)
        {
            let message = format!("the right side of `{}` has an effect; the translator runs it always", op.text());
            work.unsupported(*op_span, message, "write an `if`");
        }
    }
}

/// Deepest chain of calls that is followed; deeper ones count as having an effect.
const MAX_CALLS: u32 = 32;

fn has_effect(shader: &Shader, id: ExprId, depth: u32) -> bool {
    let expr = shader.expr(id);
    let own = match &expr.kind {
        ExprKind::Assign { .. } | ExprKind::Postfix { .. } => true,
        ExprKind::Unary { op: UnaryOp::Increment | UnaryOp::Decrement, .. } => true,
        ExprKind::Call { callee: Callee::Name(name), .. } => match shader.callee(id) {
            Some(CallTarget::User(function)) => function_has_effect(shader, *function, depth + 1),
            Some(CallTarget::Builtin(directions)) => {
                directions.iter().any(|d| *d != Direction::In)
                    || matches!(name.name.as_str(), "EmitVertex" | "EndPrimitive")
            }
            Some(CallTarget::Constructor(_)) | None => false,
        },
        _ => false,
    };
    own || expr.children().iter().any(|&c| has_effect(shader, c, depth))
}

fn function_has_effect(shader: &Shader, function: FunctionId, depth: u32) -> bool {
    let info = shader.function_info(function);
    if depth > MAX_CALLS || info.params.iter().any(|p| p.direction != Direction::In) {
        return true;
    }
    let writes_global = shader.uses().iter().any(|u| {
        let local = matches!(shader.symbol(u.symbol).kind, SymbolKind::Local | SymbolKind::Param(_));
        u.function == Some(function) && u.access.writes() && !local
    });
    let Some(syntax) = shader.function_syntax(info) else { return true };
    let Some(body) = &syntax.body else { return true };
    let calls_effect = shader.arena().iter().any(|(id, e)| {
        let inside = body.span.contains(e.span.start);
        let calls = matches!(&e.kind, ExprKind::Call { callee: Callee::Name(_), .. });
        inside && calls && has_effect(shader, id, depth)
    });
    writes_global || calls_effect
}

/// naga takes constructors with arguments left over and drops these in silence.
fn constructors(work: &mut Work<'_>) {
    let shader = work.shader;
    for (id, expr) in shader.arena().iter() {
        let ExprKind::Call { callee: Callee::Type(_), args } = &expr.kind else { continue };
        let Some(needed) = shader.type_of(id).components() else { continue };
        if args.len() < 2 {
            continue;
        }
        let given: Option<Vec<usize>> = args.iter().map(|&a| shader.type_of(a).components()).collect();
        let Some(given) = given else { continue };
        let before_last: usize = given[..given.len() - 1].iter().sum();
        let total: usize = given.iter().sum();
        if before_last >= needed {
            let ty = shader.type_of(id);
            let message =
                format!("`{ty}` takes {needed} components, and {total} are given; the translator drops the rest");
            work.unsupported(expr.span, message, "run `shadercheck lint`, which explains and repairs it (T001)");
        } else if total < needed {
            let ty = shader.type_of(id);
            let message = format!("`{ty}` takes {needed} components, and only {total} are given");
            work.unsupported(expr.span, message, "give the missing components");
        }
    }
}
