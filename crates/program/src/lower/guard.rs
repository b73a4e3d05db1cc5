//! Constructs that naga's GLSL front end is known to accept and get wrong. They do not reach it: every author who uses
//! them would be told about the same defects of naga again.

use super::Lowering;
use syntax::BuiltinFunction as F;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind, UnaryOp};
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, Direction, FunctionId, SymbolKind};
use syntax::{Fit, Shader};

pub(super) fn check(work: &mut Lowering<'_>) {
    global_initializers(work);
    short_circuits(work);
    constructors(work);
    out_arguments(work);
}

/// naga passes `out` parameters by reference: one that the function does not write keeps what the argument held, and
/// two that are one variable are one inside of the function. GLSL copies them back (4.60, 6.1.1).
fn out_arguments(work: &mut Lowering<'_>) {
    let shader = work.shader;
    for (id, expr) in shader.arena().iter() {
        if let Some(CallTarget::User(function)) = shader.callee(id)
            && shader.function_info(*function).params.iter().any(|param| param.direction == Direction::Out)
        {
            let message = "the translator passes `out` parameters by reference";
            work.refuse(expr.span, message);
        }
    }
}

/// naga drops the initialiser of a global variable when it is not constant: the variable is then 0.
fn global_initializers(work: &mut Lowering<'_>) {
    let shader = work.shader;
    for global in shader.interface().globals.iter().chain(&shader.interface().constants) {
        let Some(value) = global.initializer else { continue };
        if !is_constant(shader, value) {
            let message =
                format!("global `{}` starts with a value that is not constant; the translator drops it", global.name);
            work.refuse(shader.expr(value).span, message);
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
fn short_circuits(work: &mut Lowering<'_>) {
    let shader = work.shader;
    for (_, expr) in shader.arena().iter() {
        if let ExprKind::Binary { op: op @ (BinaryOp::And | BinaryOp::Or), right, op_span, .. } = &expr.kind
            && has_effect(shader, *right, 0)
        {
            let message = format!("the right side of `{}` has an effect; the translator runs it always", op.text());
            work.refuse(*op_span, message);
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
        ExprKind::Call { .. } => match shader.callee(id) {
            Some(CallTarget::User(function)) => function_has_effect(shader, *function, depth + 1),
            Some(CallTarget::Builtin(call)) => {
                call.directions.iter().any(|d| *d != Direction::In)
                    || matches!(call.function, F::EmitVertex | F::EndPrimitive)
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
fn constructors(work: &mut Lowering<'_>) {
    let shader = work.shader;
    for (id, expr) in shader.arena().iter() {
        let Some(constructor) = shader.constructor(id) else { continue };
        let (ty, needs) = (&constructor.ty, constructor.needs);
        match constructor.fit {
            Fit::Fits | Fit::Unknown => {}
            Fit::TooMany { .. } => {
                let total: usize = constructor.given.iter().flatten().sum();
                let message = format!("`{ty}` takes {needs} components, and {total} are given");
                work.refuse(expr.span, message);
            }
            Fit::TooFew { given } => {
                let message = format!("`{ty}` takes {needs} components, and only {given} are given");
                work.refuse(expr.span, message);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::lower::{Places, Target, lower};
    use base::text::SourceFile;
    use syntax::{Shader, Stage};

    /// Messages with their columns, for a `main` of one line.
    fn refused(body: &str) -> Vec<(usize, String)> {
        let text = format!("#version 150\nin vec4 v;\nvoid main() {{ {body} }}\n");
        let file = SourceFile::new("t.vert", text);
        let shader = Shader::parse(&file, Stage::Vertex).shader;
        let found = lower(&shader, &Target::Stage, &Places::default()).err().unwrap_or_default();
        found.into_iter().map(|refused| (file.position(refused.span.start).column, refused.why)).collect()
    }

    #[test]
    fn constructors_with_arguments_left_over_never_reach_naga() {
        let four = "`vec3` takes 3 components, and 4 are given".to_owned();
        let column = |body: &str| 15 + body.find("vec3(").unwrap();
        for body in [
            "vec3 p = vec3(1.0, 2.0, 3.0, 4.0); gl_Position = vec4(p, 1.0);",
            "gl_Position = vec4(vec3(v.x, v.y, v.z, 1.0), 1.0);",
            "vec4 p = vec3(1.0, 2.0, 3.0, 4.0); gl_Position = p;",
        ] {
            // The first `vec3(` is the constructor, not the declaration before it.
            assert_eq!(refused(body), [(column(body), four.clone())], "{body}");
        }
    }

    #[test]
    fn constructors_with_too_few_arguments_never_reach_naga() {
        let found = refused("gl_Position = vec4(v.xyz);");
        assert_eq!(found, [(29, "`vec4` takes 4 components, and only 3 are given".to_owned())]);
    }

    #[test]
    fn a_last_argument_that_is_used_in_part_is_fine() {
        assert_eq!(refused("gl_Position = vec4(vec3(v), 1.0) + vec4(v.xy, v.z, 1.0) + vec4(0.0);"), []);
    }
}
