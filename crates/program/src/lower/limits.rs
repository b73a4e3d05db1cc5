//! Constructs that naga refuses without a place in the text, or takes for something else. They are
//! told here, where the author wrote them.

use super::Work;
use base::text::Span;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind};
use syntax::symbols::{CallTarget, Direction, FunctionId};
use syntax::types::{ScalarType, Type};
use syntax::{Shader, Stage, TokenPlace};

pub(super) fn check(work: &mut Work<'_>) {
    types(work);
    comparisons(work);
    references(work);
    recursion(work);
    discards(work);
    clip_distances(work);
}

/// naga reads `a[2][3]` as three arrays of two, and has no `double` without a feature of the device.
fn types(work: &mut Work<'_>) {
    let shader = work.shader;
    for (_, symbol) in shader.symbols() {
        let Some(span) = symbol.span else { continue };
        if let Type::Array(element, _) = &symbol.ty
            && matches!(**element, Type::Array(..))
        {
            let message = format!("`{}` is an array of arrays; the translator swaps its sizes", symbol.name);
            work.unsupported(span, message, "use one array and compute the index");
        }
        if is_double(&symbol.ty) {
            let message = format!("`{}` of type `{}`: only 32-bit numbers are run", symbol.name, symbol.ty);
            work.unsupported(span, message, "use `float`");
        }
    }
}

fn is_double(ty: &Type) -> bool {
    match ty {
        Type::Scalar(scalar) | Type::Vector(scalar, _) | Type::Matrix(scalar, _, _) => *scalar == ScalarType::Double,
        Type::Array(element, _) => is_double(element),
        Type::Error | Type::Void | Type::Opaque(_) | Type::Struct(_) => false,
    }
}

/// naga compares numbers and vectors alone.
fn comparisons(work: &mut Work<'_>) {
    let shader = work.shader;
    for (_, expr) in shader.arena().iter() {
        if let ExprKind::Binary { op: op @ (BinaryOp::Equal | BinaryOp::NotEqual), left, op_span, .. } = &expr.kind {
            let kind = match shader.type_of(*left) {
                Type::Array(..) => "arrays",
                Type::Struct(_) => "structures",
                _ => continue,
            };
            let message = format!("`{}` between {kind} is not known to the translator", op.text());
            work.unsupported(*op_span, message, "compare their parts");
        }
    }
}

/// Only a whole variable can be passed by reference: neither SPIR-V nor WGSL takes a part of one.
fn references(work: &mut Work<'_>) {
    let shader = work.shader;
    for (id, expr) in shader.arena().iter() {
        let ExprKind::Call { callee: Callee::Name(name), args } = &expr.kind else { continue };
        let Some(CallTarget::User(function)) = shader.callee(id) else { continue };
        for (param, &arg) in shader.function_info(*function).params.iter().zip(args) {
            if param.direction != Direction::In && !matches!(shader.expr(arg).kind, ExprKind::Name(_)) {
                let message = format!("a part of a variable as `out` or `inout` argument of `{}`", name.name);
                work.unsupported(shader.expr(arg).span, message, "pass a variable of its own and copy it back");
            }
        }
    }
}

/// GLSL forbids recursion (GLSL 4.60, 6.1), and naga tells it without a place.
fn recursion(work: &mut Work<'_>) {
    let shader = work.shader;
    let calls: Vec<(FunctionId, FunctionId, ExprId)> = shader
        .functions()
        .filter_map(|(caller, info)| Some((caller, shader.function_syntax(info)?.body.as_ref()?.span)))
        .flat_map(|(caller, body)| calls_in(shader, body).map(move |(callee, id)| (caller, callee, id)))
        .collect();
    for &(caller, callee, id) in &calls {
        let mut reached = vec![callee];
        let mut at = 0;
        while at < reached.len() {
            let next = calls.iter().filter(|(from, ..)| *from == reached[at]).map(|(_, to, _)| *to);
            let new: Vec<FunctionId> = next.filter(|to| !reached.contains(to)).collect();
            reached.extend(new);
            at += 1;
        }
        if reached.contains(&caller) {
            let message = format!("`{}` calls itself", shader.function_info(caller).name.name);
            work.unsupported(shader.expr(id).span, message, "GLSL has no recursion: write a loop");
        }
    }
}

fn calls_in(shader: &Shader, body: Span) -> impl Iterator<Item = (FunctionId, ExprId)> {
    shader.arena().iter().filter(move |(_, e)| body.contains(e.span.start)).filter_map(|(id, _)| {
        match shader.callee(id) {
            Some(CallTarget::User(function)) => Some((*function, id)),
            Some(CallTarget::Builtin(_) | CallTarget::Constructor(_)) | None => None,
        }
    })
}

fn discards(work: &mut Work<'_>) {
    let shader = work.shader;
    if shader.stage() == Stage::Fragment {
        return;
    }
    let tokens = shader.tokens().iter().filter(|t| t.place == TokenPlace::Text);
    for token in tokens.filter(|t| shader.file().slice(t.span) == "discard") {
        let message = format!("`discard` in a {} shader", shader.stage().name());
        work.unsupported(token.span, message, "only a fragment shader can discard");
    }
}

fn clip_distances(work: &mut Work<'_>) {
    let shader = work.shader;
    for name in ["gl_ClipDistance", "gl_CullDistance"] {
        let Some(symbol) = shader.builtin(name) else { continue };
        if let Some(first) = shader.uses_of(symbol).next() {
            let message = format!("`{name}` is not captured");
            work.unsupported(first.span, message, "pass the distance as a variable of your own");
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::lower::{Target, lower};
    use base::text::SourceFile;
    use syntax::{Shader, Stage};

    /// What is refused in a vertex shader with these globals and statements.
    fn refused(globals: &str, body: &str) -> Vec<String> {
        let text = format!("#version 430\nin vec4 p;\n{globals}\nvoid main() {{ {body} gl_Position = p; }}\n");
        let parsed = Shader::parse(&SourceFile::new("t.vert", text), Stage::Vertex);
        // Misplaced statements and recursion are errors of the front end already.
        let known = ["E045", "E046"];
        assert!(parsed.diagnostics.iter().all(|d| known.contains(&d.code.0)), "{:?}", parsed.diagnostics);
        let told = lower(&parsed.shader, &Target::Stage).err().unwrap_or_default();
        told.iter().map(|d| format!("{} {}", d.file.position(d.span.start), d.message)).collect()
    }

    #[test]
    fn arrays_of_arrays_and_doubles() {
        assert_eq!(
            refused("float a[2][3];", "double d;"),
            [
                "3:7 `a` is an array of arrays; the translator swaps its sizes",
                "4:22 `d` of type `double`: only 32-bit numbers are run"
            ]
        );
    }

    #[test]
    fn comparisons_of_whole_arrays_and_structures() {
        let globals = "struct S { float x; };";
        assert_eq!(
            refused(globals, "float a[2]; S s; bool b = a == a || s != s;"),
            [
                "4:43 `==` between arrays is not known to the translator",
                "4:53 `!=` between structures is not known to the translator"
            ]
        );
        assert!(refused(globals, "float a[2]; S s; bool b = a[0] == a[1] || s.x != s.x || p == p;").is_empty());
    }

    #[test]
    fn parts_of_variables_by_reference() {
        let globals = "void f(inout float x, float y) { x = y; }";
        assert_eq!(
            refused(globals, "vec4 q; f(q.x, 1.0);"),
            ["4:25 a part of a variable as `out` or `inout` argument of `f`"]
        );
        assert!(refused(globals, "float q = 0.0; f(q, p.x);").is_empty());
    }

    #[test]
    fn recursion_through_another_function() {
        let globals = "float f(float x);\nfloat g(float x) { return f(x); }\nfloat f(float x) { return g(x); }";
        assert_eq!(refused(globals, "float y = f(1.0);"), ["4:27 `g` calls itself", "5:27 `f` calls itself"]);
        assert!(
            refused("float f(float x);\nfloat g(float x) { return f(x); }\nfloat f(float x) { return x; }", "")
                .is_empty()
        );
    }

    #[test]
    fn discard_and_clip_distances() {
        assert_eq!(
            refused("", "gl_ClipDistance[0] = 1.0; discard;"),
            ["4:15 `gl_ClipDistance` is not captured", "4:41 `discard` in a vertex shader"]
        );
    }
}
