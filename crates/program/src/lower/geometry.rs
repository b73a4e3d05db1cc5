//! The geometry stage, which naga does not have: a function over the vertices of one primitive.
//!
//! Inputs and outputs become plain variables; `EmitVertex` and `EndPrimitive` are declared empty,
//! and capture fills them in.

use std::fmt::Write as _;

use super::Work;
use super::declaration::{by_declaration, variable};
use super::lowered::{Primitives, Role, Variable};
use super::stage::built_in_outputs;
use base::text::{Edit, Span};
use base::value::Shape;
use syntax::ast::{Callee, ExprKind};
use syntax::interface::Storage;

type Parts = (Role, Vec<Variable>, Vec<Variable>);

pub(super) fn lower(work: &mut Work<'_>) -> Parts {
    let shader = work.shader;
    let Some(primitives) = primitives(work) else {
        return (Role::Vertex, Vec::new(), Vec::new());
    };
    work.preamble.push_str("layout(local_size_x = 1) in;\nvoid EmitVertex() {}\nvoid EndPrimitive() {}\n");
    for layout in &shader.interface().stage_layouts {
        work.edits.push(Edit::delete(layout.span));
    }
    let mut inputs = built_in_inputs(work, primitives.input_vertices());
    inputs.extend(plain(work, true, primitives.input_vertices()));
    let mut outputs = built_in_outputs(work);
    for output in &outputs {
        let _ = writeln!(work.preamble, "{} {};", output.shape, output.name);
    }
    outputs.extend(plain(work, false, 0));
    if outputs.is_empty() {
        work.incomplete(
            Span::at(0),
            "the shader writes no output, so there is nothing to judge",
            "write `gl_Position`",
        );
    }
    for block in shader.interface().blocks.iter().filter(|b| matches!(b.storage, Storage::In | Storage::Out)) {
        let message = format!("interface block `{}` cannot be fed or captured", block.name.name);
        work.unsupported(block.name.span, message, "declare its members as separate variables");
    }
    refuse_streams(work);
    (Role::Geometry(primitives), inputs, outputs)
}

fn primitives(work: &mut Work<'_>) -> Option<Primitives> {
    let layout = &work.shader.interface().geometry;
    let (input, output, max) = (layout.input, layout.output, layout.max_vertices);
    for (missing, what, help) in [
        (input.is_none(), "an input primitive", "write `layout(triangles) in;` or the primitive that is drawn"),
        (output.is_none(), "an output primitive", "write `layout(triangle_strip, max_vertices = N) out;`"),
        (max.is_none(), "`max_vertices`", "add `max_vertices = N` to the `layout(…) out;`"),
    ] {
        if missing {
            work.incomplete(
                Span::at(0),
                format!("the geometry shader declares no {}", what.trim_start_matches("an ")),
                help,
            );
        }
    }
    if let Some(invocations) = layout.invocations.filter(|i| i.value > 1) {
        work.unsupported(invocations.span, "several invocations of a geometry shader", "remove `invocations`");
    }
    Some(Primitives { input: input?.value, output: output?.value, max_vertices: max?.value })
}

/// `gl_in` and `gl_PrimitiveIDIn`, when they are read.
fn built_in_inputs(work: &mut Work<'_>, vertices: u32) -> Vec<Variable> {
    let shader = work.shader;
    let number = shader.builtin("gl_PrimitiveIDIn").map(|symbol| {
        work.preamble.push_str("int gl_PrimitiveIDIn;\n");
        let span = shader.uses_of(symbol).next().map_or(Span::at(0), |u| u.span);
        Variable { name: "gl_PrimitiveIDIn".to_owned(), shape: Shape::INT, span, location: None }
    });
    let Some(symbol) = shader.builtin("gl_in") else { return number.into_iter().collect() };
    let span = shader.uses_of(symbol).next().map_or(Span::at(0), |u| u.span);
    let uses_field = |name: &str| {
        let mut all = shader.arena().iter();
        all.any(|(_, e)| matches!(&e.kind, ExprKind::Field { field, .. } if field.name == name))
    };
    if uses_field("gl_ClipDistance") {
        work.unsupported(span, "`gl_ClipDistance` of a geometry shader", "pass the distance as a variable of your own");
    }
    let _ = writeln!(
        work.preamble,
        "struct sc_PerVertex {{ vec4 gl_Position; float gl_PointSize; }};\nsc_PerVertex gl_in[{vertices}];"
    );
    let mut inputs =
        vec![Variable { name: "gl_Position".to_owned(), shape: Shape::VEC4.array_of(vertices), span, location: None }];
    let reads_size = shader.arena().iter().any(|(_, e)| {
        let ExprKind::Field { base, field } = &e.kind else { return false };
        field.name == "gl_PointSize" && matches!(shader.expr(*base).kind, ExprKind::Index { .. })
    });
    if reads_size {
        inputs.push(Variable {
            name: "gl_PointSize".to_owned(),
            shape: Shape::FLOAT.array_of(vertices),
            span,
            location: None,
        });
    }
    inputs.extend(number);
    inputs
}

/// Inputs or outputs as plain global variables.
fn plain(work: &mut Work<'_>, input: bool, vertices: u32) -> Vec<Variable> {
    let interface = work.shader.interface();
    let (variables, kind) = if input { (&interface.inputs, "input") } else { (&interface.outputs, "output") };
    let mut lowered = Vec::new();
    for group in by_declaration(variables) {
        for &v in &group {
            if !work.is_editable(v) {
                return lowered;
            }
            let Some(shape) = work.shape_of(v, kind) else { continue };
            if input && shape.array != Some(vertices) {
                let message = format!("input `{}` is no array over the {vertices} vertices of the primitive", v.name);
                work.incomplete(v.name_span, message, "declare it with `[]` behind the name");
                continue;
            }
            // The size that GLSL takes from the primitive.
            if let Some(unsized_dim) = v.dims.iter().find(|d| d.size.is_none()) {
                work.edits.push(Edit::replace(unsized_dim.span, format!("[{vertices}]")));
            }
            lowered.push(variable(v, shape, None));
        }
        work.split(&group, |_| String::new());
    }
    lowered
}

/// Vertex streams other than the first have no record.
fn refuse_streams(work: &mut Work<'_>) {
    let shader = work.shader;
    for (_, expr) in shader.arena().iter() {
        if let ExprKind::Call { callee: Callee::Name(name), .. } = &expr.kind
            && matches!(name.name.as_str(), "EmitStreamVertex" | "EndStreamPrimitive")
        {
            let message = format!("`{}`: only the first vertex stream is captured", name.name);
            work.unsupported(name.span, message, "use `EmitVertex` and `EndPrimitive`");
        }
    }
}
