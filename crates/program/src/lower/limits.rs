//! Constructs that naga's GLSL front end does not have, or takes for something else.

use super::Lowering;
use syntax::ast::{BinaryOp, Callee, ExprKind};
use syntax::symbols::{CallTarget, Direction};
use syntax::types::Type;

pub(super) fn check(work: &mut Lowering<'_>) {
    types(work);
    comparisons(work);
    references(work);
    clip_distances(work);
}

/// naga reads `a[2][3]` as three arrays of two, and has no `double` without a feature of the device.
fn types(work: &mut Lowering<'_>) {
    let shader = work.shader;
    for (_, symbol) in shader.symbols() {
        let Some(span) = symbol.span else { continue };
        if let Type::Array(element, _) = &symbol.ty
            && matches!(**element, Type::Array(..))
        {
            let message = format!("`{}` is an array of arrays; the translator swaps its sizes", symbol.name);
            work.refuse(span, message);
        }
        if is_double(&symbol.ty) {
            let message = format!("`{}` of type `{}`: only 32-bit numbers are run", symbol.name, symbol.ty);
            work.refuse(span, message);
        }
    }
}

fn is_double(ty: &Type) -> bool {
    match ty {
        Type::Scalar(scalar) | Type::Vector(scalar, _) | Type::Matrix(scalar, _, _) => scalar.bits() != 32,
        Type::Array(element, _) => is_double(element),
        Type::Error | Type::Void | Type::Opaque(_) | Type::Struct(_) => false,
    }
}

/// naga compares numbers and vectors alone.
fn comparisons(work: &mut Lowering<'_>) {
    let shader = work.shader;
    for (_, expr) in shader.arena().iter() {
        if let ExprKind::Binary { op: op @ (BinaryOp::Equal | BinaryOp::NotEqual), left, op_span, .. } = &expr.kind {
            let kind = match shader.type_of(*left) {
                Type::Array(..) => "arrays",
                Type::Struct(_) => "structures",
                _ => continue,
            };
            let message = format!("`{}` between {kind} is not known to the translator", op.text());
            work.refuse(*op_span, message);
        }
    }
}

/// Only a whole variable can be passed by reference: neither SPIR-V nor WGSL takes a part of one.
fn references(work: &mut Lowering<'_>) {
    let shader = work.shader;
    for (id, expr) in shader.arena().iter() {
        let ExprKind::Call { callee: Callee::Name(name), args } = &expr.kind else { continue };
        let Some(CallTarget::User(function)) = shader.callee(id) else { continue };
        for (param, &arg) in shader.function_info(*function).params.iter().zip(args) {
            if param.direction != Direction::In && !matches!(shader.expr(arg).kind, ExprKind::Name(_)) {
                let message = format!("a part of a variable as `out` or `inout` argument of `{}`", name.name);
                work.refuse(shader.expr(arg).span, message);
            }
        }
    }
}

fn clip_distances(work: &mut Lowering<'_>) {
    let shader = work.shader;
    for name in ["gl_ClipDistance", "gl_CullDistance"] {
        let Some(symbol) = shader.builtin(name) else { continue };
        if let Some(first) = shader.uses_of(symbol).next() {
            let message = format!("`{name}` is not captured");
            work.refuse(first.span, message);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::lower::{Places, Target, lower};
    use base::text::SourceFile;
    use syntax::{Shader, Stage};

    /// What is refused in a vertex shader with these globals and statements.
    fn refused(globals: &str, body: &str) -> Vec<String> {
        let text = format!("#version 430\nin vec4 p;\n{globals}\nvoid main() {{ {body} gl_Position = p; }}\n");
        let file = SourceFile::new("t.vert", text);
        let parsed = Shader::parse(&file, Stage::Vertex);
        assert!(parsed.diagnostics.is_empty(), "{:?}", parsed.diagnostics);
        let found = lower(&parsed.shader, &Target::Stage, &Places::default()).err().unwrap_or_default();
        found.iter().map(|refused| format!("{} {}", file.position(refused.span.start), refused.why)).collect()
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
    fn clip_distances() {
        assert_eq!(refused("", "gl_ClipDistance[0] = 1.0;"), ["4:15 `gl_ClipDistance` is not captured"]);
    }
}
