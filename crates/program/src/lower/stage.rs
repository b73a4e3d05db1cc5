//! The vertex stage, and single functions.

use std::collections::HashMap;

use super::Lowering;
use super::declaration::by_declaration;
use base::text::Edit;
use base::value::{Scalar, Shape};
use syntax::interface::{self, Storage};
use syntax::{Shader, Stage, ast};

/// Rewrites a vertex stage.
pub(super) fn vertex(work: &mut Lowering<'_>) {
    let shader = work.shader;
    let places = work.places;
    located(work, &shader.interface().inputs, "in", places.inputs.as_ref());
    located(work, &shader.interface().outputs, "out", places.outputs.as_ref());
    for block in shader.interface().blocks.iter().filter(|b| matches!(b.storage, Storage::In | Storage::Out)) {
        work.refuse(block.name.span, format!("interface block `{}`", block.name.name));
    }
    rename_indices(work);
    qualified_names(work);
    if shader.builtin("gl_Position").is_none_or(|s| !shader.is_written(s)) {
        start_position(work);
    }
}

/// Gives each variable its location and a declaration of its own.
fn located(
    work: &mut Lowering<'_>,
    variables: &[interface::Variable],
    keyword: &str,
    places: Option<&HashMap<String, u32>>,
) {
    let mut taken: Vec<u32> = Vec::new();
    for group in by_declaration(variables) {
        let mut heads = Vec::new();
        for &v in &group {
            if !work.is_editable(v) {
                return;
            }
            let Some(shape) = work.shape_of(v, keyword) else { return };
            if shape.columns > 1 || shape.array.is_some() || shape.scalar == Scalar::Bool {
                work.refuse(v.name_span, format!("`{keyword}` variable `{}` of type `{}`", v.name, v.ty));
            }
            let location = match places {
                Some(places) => places.get(&v.name).copied(),
                None => u32::try_from(taken.len()).ok(),
            };
            let Some(location) = location.filter(|location| !taken.contains(location)) else {
                work.refuse(v.name_span, format!("`{}` has no location of its own", v.name));
                return;
            };
            taken.push(location);
            // An integer is never interpolated; GLSL lets a vertex stage leave the word out, naga does not.
            let flat = shape.scalar != Scalar::F32 && keyword == "out";
            heads.push(format!("layout(location = {location}) {}{keyword} ", interpolation(v, flat)));
        }
        work.split(&group, |k| heads[k].clone());
    }
}

fn interpolation(variable: &interface::Variable, flat: bool) -> &'static str {
    match variable.qualifiers.interpolation() {
        _ if flat => "flat ",
        Some((ast::Interpolation::Flat, _)) => "flat ",
        Some((ast::Interpolation::NoPerspective, _)) => "noperspective ",
        Some((ast::Interpolation::Smooth, _)) | None => "",
    }
}

/// `gl_Position` and `gl_PointSize`, when they are written.
pub(super) fn built_in_outputs<'s>(shader: &'s Shader) -> impl Iterator<Item = (&'static str, Shape)> + use<'s> {
    let written = |name: &str| shader.builtin(name).is_some_and(|symbol| shader.is_written(symbol));
    [("gl_Position", Shape::VEC4), ("gl_PointSize", Shape::FLOAT)].into_iter().filter(move |(name, _)| written(name))
}

/// A vertex stage need not write a position (GLSL 4.60, 7.1); naga wants one. It is not captured.
fn start_position(work: &mut Lowering<'_>) {
    let shader = work.shader;
    let body = shader.function("main").and_then(|f| shader.function_syntax(f)).and_then(|f| f.body.as_ref());
    if let Some(body) = body.filter(|b| shader.file().slice(b.span).starts_with('{')) {
        work.edits.push(Edit::insert(body.span.start + 1, " gl_Position = vec4(0.0);"));
    }
}

/// Vulkan GLSL has other names for the vertex and instance number, and counts them without sign.
fn rename_indices(work: &mut Lowering<'_>) {
    let shader = work.shader;
    for (old, new) in [("gl_VertexID", "int(gl_VertexIndex)"), ("gl_InstanceID", "int(gl_InstanceIndex)")] {
        if shader.builtin(old).is_none() {
            continue;
        }
        for token in shader.tokens() {
            if work.slice(token.span) == old {
                work.edits.push(Edit::replace(token.span, new));
            }
        }
    }
}

/// `invariant gl_Position;` and the like promise the same value in several programs; the harness
/// runs one program at a time, and naga does not read them.
fn qualified_names(work: &mut Lowering<'_>) {
    for item in &work.shader.unit().items {
        if matches!(item.kind, ast::ItemKind::Qualified(_)) {
            work.edits.push(Edit::delete(item.span));
        }
    }
}

/// Makes the text around a function one that naga reads: its `main` is not run.
pub(super) fn function(work: &mut Lowering<'_>) {
    let shader = work.shader;
    if shader.stage() == Stage::Vertex {
        return vertex(work);
    }
    work.preamble.push_str("layout(local_size_x = 1) in;\n");
    if shader.function("main").is_none() {
        work.edits.push(Edit::insert(shader.file().text().len(), "\nvoid main() {}\n"));
    }
}
