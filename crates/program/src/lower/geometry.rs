//! The geometry stage, which naga does not have: a function over the vertices of one primitive.
//!
//! Inputs and outputs become plain variables; `EmitVertex` and `EndPrimitive` are declared empty,
//! and capture fills them in.

use std::fmt::Write as _;

use super::Lowering;
use super::declaration::by_declaration;
use super::stage::built_in_outputs;
use base::text::{Edit, Span};
use syntax::ast::{Callee, ExprKind};
use syntax::interface::Storage;

pub(super) fn lower(work: &mut Lowering<'_>) {
    let shader = work.shader;
    let layout = &shader.interface().geometry;
    if let Some(invocations) = layout.invocations.filter(|i| i.value > 1) {
        work.refuse(invocations.span, "several invocations of a geometry shader");
    }
    let Some(input) = layout.input else { return work.refuse(Span::at(0), "a geometry shader without a primitive") };
    let vertices = input.value.vertices();
    work.preamble.push_str("layout(local_size_x = 1) in;\nvoid EmitVertex() {}\nvoid EndPrimitive() {}\n");
    for layout in &shader.interface().stage_layouts {
        work.edits.push(Edit::delete(layout.span));
    }
    built_in_inputs(work, vertices);
    plain(work, true, vertices);
    for (name, shape) in built_in_outputs(shader) {
        let _ = writeln!(work.preamble, "{shape} {name};");
    }
    plain(work, false, 0);
    for block in shader.interface().blocks.iter().filter(|b| matches!(b.storage, Storage::In | Storage::Out)) {
        work.refuse(block.name.span, format!("interface block `{}`", block.name.name));
    }
    refuse_streams(work);
}

/// `gl_in` and `gl_PrimitiveIDIn`, when they are read.
fn built_in_inputs(work: &mut Lowering<'_>, vertices: u32) {
    let shader = work.shader;
    if shader.builtin("gl_PrimitiveIDIn").is_some() {
        work.preamble.push_str("int gl_PrimitiveIDIn;\n");
    }
    let Some(symbol) = shader.builtin("gl_in") else { return };
    let clips = |expr: &ExprKind| matches!(expr, ExprKind::Field { field, .. } if field.name == "gl_ClipDistance");
    if shader.arena().iter().any(|(_, e)| clips(&e.kind)) {
        let span = shader.uses_of(symbol).next().map_or(Span::at(0), |u| u.span);
        work.refuse(span, "`gl_ClipDistance` of a geometry shader");
    }
    let _ = writeln!(
        work.preamble,
        "struct sc_PerVertex {{ vec4 gl_Position; float gl_PointSize; }};\nsc_PerVertex gl_in[{vertices}];"
    );
}

/// Inputs or outputs as plain global variables.
fn plain(work: &mut Lowering<'_>, input: bool, vertices: u32) {
    let interface = work.shader.interface();
    let variables = if input { &interface.inputs } else { &interface.outputs };
    for group in by_declaration(variables) {
        for &v in &group {
            if !work.is_editable(v) {
                return;
            }
            let Some(shape) = work.shape_of(v, if input { "input" } else { "output" }) else { continue };
            if input && shape.array != Some(vertices) {
                work.refuse(v.name_span, format!("input `{}` is no array over {vertices} vertices", v.name));
                continue;
            }
            // The size that GLSL takes from the primitive.
            if let Some(unsized_dim) = v.dims.iter().find(|d| d.size.is_none()) {
                work.edits.push(Edit::replace(unsized_dim.span, format!("[{vertices}]")));
            }
        }
        work.split(&group, |_| String::new());
    }
}

/// Vertex streams other than the first have no record.
fn refuse_streams(work: &mut Lowering<'_>) {
    let shader = work.shader;
    for (_, expr) in shader.arena().iter() {
        if let ExprKind::Call { callee: Callee::Name(name), .. } = &expr.kind
            && matches!(name.name.as_str(), "EmitStreamVertex" | "EndStreamPrimitive")
        {
            work.refuse(name.span, format!("`{}`", name.name));
        }
    }
}
