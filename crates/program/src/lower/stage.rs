//! The vertex stage, and single functions.

use super::Work;
use super::declaration::{by_declaration, variable};
use super::lowered::{Role, Variable};
use base::text::{Edit, Span};
use base::value::{Scalar, Shape};
use syntax::interface::{self, Storage};
use syntax::symbols::{Direction, FunctionId, SymbolKind};
use syntax::types::Type;
use syntax::{Stage, ast};

type Parts = (Role, Vec<Variable>, Vec<Variable>);

pub(super) fn vertex(work: &mut Work<'_>) -> Parts {
    let shader = work.shader;
    let mut inputs = located(work, &shader.interface().inputs, "in", "attribute");
    inputs.extend(numbers_of_the_draw(work));
    let mut outputs = built_in_outputs(work);
    outputs.extend(located(work, &shader.interface().outputs, "out", "output"));
    if outputs.is_empty() {
        let help = "write `gl_Position` or declare an output";
        work.incomplete(Span::at(0), "the shader writes no output, so there is nothing to judge", help);
    }
    for block in shader.interface().blocks.iter().filter(|b| matches!(b.storage, Storage::In | Storage::Out)) {
        let message = format!("interface block `{}` cannot be fed or captured", block.name.name);
        work.unsupported(block.name.span, message, "declare its members as separate variables");
    }
    rename_indices(work);
    qualified_names(work);
    if shader.builtin("gl_Position").is_none_or(|s| !shader.is_written(s)) {
        start_position(work);
    }
    (Role::Vertex, inputs, outputs)
}

/// Gives each variable a location and a declaration of its own. Locations that the author wrote stay.
fn located(work: &mut Work<'_>, variables: &[interface::Variable], keyword: &str, kind: &str) -> Vec<Variable> {
    let shader = work.shader;
    let written = |v: &interface::Variable| {
        let value = v.qualifiers.layout_entry("location")?.value?;
        shader.fold(value).and_then(|c| c.as_integer()).and_then(|n| u32::try_from(n).ok())
    };
    let mut taken: Vec<u32> = Vec::new();
    for group in by_declaration(variables) {
        let mut at = written(group[0]);
        for v in group {
            if let Some(location) = at {
                let size = v.ty.shape().map_or(1, slots);
                if (location..location.saturating_add(size)).any(|l| taken.contains(&l)) {
                    let message = format!("{kind} `{}` shares location {location} with another one", v.name);
                    work.unsupported(v.name_span, message, "give each a location of its own");
                }
                taken.extend(location..location.saturating_add(size));
                at = Some(location.saturating_add(size));
            }
        }
    }
    let mut next = 0;
    let mut lowered = Vec::new();
    for group in by_declaration(variables) {
        let mut explicit = written(group[0]);
        let mut heads = Vec::new();
        for &v in &group {
            if !work.is_editable(v) {
                return lowered;
            }
            let Some(shape) = work.shape_of(v, kind) else { return lowered };
            if shape.columns > 1 || shape.array.is_some() {
                let message = format!("{kind} `{}` of type `{}` takes several locations", v.name, v.ty);
                work.unsupported(v.name_span, message, "declare one vector for each column or element");
            }
            if shape.scalar == Scalar::Bool {
                let message = format!("{kind} `{}` of type `{}`", v.name, v.ty);
                work.unsupported(v.name_span, message, "use an `int`");
            }
            let size = slots(shape);
            let location = explicit.unwrap_or_else(|| {
                while (next..next + size).any(|l| taken.contains(&l)) {
                    next += 1;
                }
                taken.extend(next..next + size);
                next
            });
            explicit = explicit.map(|l| l + size);
            // An integer is never interpolated; GLSL lets a vertex stage leave the word out, naga does not.
            let flat = shape.scalar != Scalar::F32 && keyword == "out";
            heads.push(format!("layout(location = {location}) {}{keyword} ", interpolation(v, flat)));
            lowered.push(variable(v, shape, Some(location)));
        }
        work.split(&group, |k| heads[k].clone());
    }
    lowered
}

fn interpolation(variable: &interface::Variable, flat: bool) -> &'static str {
    match variable.qualifiers.interpolation() {
        _ if flat => "flat ",
        Some((ast::Interpolation::Flat, _)) => "flat ",
        Some((ast::Interpolation::NoPerspective, _)) => "noperspective ",
        Some((ast::Interpolation::Smooth, _)) | None => "",
    }
}

/// Locations that a value takes: one for each column of each element.
fn slots(shape: Shape) -> u32 {
    u32::from(shape.columns) * shape.elements() as u32
}

/// `gl_Position` and `gl_PointSize`, when they are written.
pub(super) fn built_in_outputs(work: &Work<'_>) -> Vec<Variable> {
    let shader = work.shader;
    [("gl_Position", Shape::VEC4), ("gl_PointSize", Shape::FLOAT)]
        .into_iter()
        .filter_map(|(name, shape)| {
            let symbol = shader.builtin(name).filter(|&s| shader.is_written(s))?;
            let first = shader.uses_of(symbol).find(|u| u.access.writes())?;
            Some(Variable { name: name.to_owned(), shape, span: first.span, location: None })
        })
        .collect()
}

/// The numbers of the draw, when they are read.
fn numbers_of_the_draw(work: &Work<'_>) -> Vec<Variable> {
    let shader = work.shader;
    let vertex = ["gl_VertexID", "gl_VertexIndex", "gl_BaseVertex"];
    let others = ["gl_InstanceID", "gl_InstanceIndex", "gl_BaseInstance", "gl_DrawID"];
    let all = vertex.into_iter().chain(others);
    all.filter_map(|name| {
        let first = shader.uses_of(shader.builtin(name)?).next()?;
        Some(Variable { name: name.to_owned(), shape: Shape::INT, span: first.span, location: None })
    })
    .collect()
}

/// A vertex stage need not write a position (GLSL 4.60, 7.1); naga wants one. It is not captured.
fn start_position(work: &mut Work<'_>) {
    let shader = work.shader;
    let body = shader.function("main").and_then(|f| shader.function_syntax(f)).and_then(|f| f.body.as_ref());
    if let Some(body) = body.filter(|b| shader.file().slice(b.span).starts_with('{')) {
        work.edits.push(Edit::insert(body.span.start + 1, " gl_Position = vec4(0.0);"));
    }
}

/// Vulkan GLSL has other names for the vertex and instance number, and counts them without sign.
fn rename_indices(work: &mut Work<'_>) {
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
fn qualified_names(work: &mut Work<'_>) {
    for item in &work.shader.unit().items {
        if matches!(item.kind, ast::ItemKind::Qualified(_)) {
            work.edits.push(Edit::delete(item.span));
        }
    }
}

pub(super) fn function(work: &mut Work<'_>, name: &str) -> Parts {
    let shader = work.shader;
    let role = Role::Function { name: name.to_owned() };
    let mut found = shader.functions().filter(|(_, f)| f.name.name == name && f.definition.is_some());
    let Some((id, info)) = found.next() else {
        let known: Vec<&str> = shader.functions().map(|(_, f)| f.name.name.as_str()).collect();
        let help = format!("the file defines: {}", known.join(", "));
        work.incomplete(Span::at(0), format!("there is no function `{name}`"), &help);
        return (role, Vec::new(), Vec::new());
    };
    if let Some((_, other)) = found.next() {
        work.unsupported(other.name.span, format!("`{name}` is overloaded"), "rename the one to test");
    }
    inputs_of_the_stage(work, id);
    let mut inputs = Vec::new();
    let mut outputs = Vec::new();
    let value = |work: &mut Work<'_>, ty: &Type, name: &str, span: Span| {
        let shape = ty.shape();
        if shape.is_none() {
            let message = format!("`{name}` of type `{ty}` cannot be fed or captured");
            work.unsupported(span, message, "only numbers, vectors, matrices and arrays of them are passed");
        }
        shape.map(|shape| Variable { name: name.to_owned(), shape, span, location: None })
    };
    if info.return_type != Type::Void {
        outputs.extend(value(work, &info.return_type, "return", info.name.span));
    }
    for param in &info.params {
        let Some(ident) = &param.name else {
            work.unsupported(param.span, "a parameter without name", "give it a name, so that a suite can feed it");
            continue;
        };
        let Some(variable) = value(work, &param.ty, &ident.name, ident.span) else { continue };
        if matches!(param.direction, Direction::In | Direction::InOut) {
            inputs.push(variable.clone());
        }
        if matches!(param.direction, Direction::Out | Direction::InOut) {
            outputs.push(variable);
        }
    }
    if outputs.is_empty() {
        work.incomplete(
            info.name.span,
            format!("`{name}` gives nothing back"),
            "return a value or use `out` parameters",
        );
    }
    if shader.stage() != Stage::Vertex {
        work.preamble.push_str("layout(local_size_x = 1) in;\n");
        if shader.function("main").is_none() {
            work.edits.push(Edit::insert(shader.file().text().len(), "\nvoid main() {}\n"));
        }
    }
    (role, inputs, outputs)
}

/// A function that is run alone has nobody to give it what its stage takes: it would read zeros.
fn inputs_of_the_stage(work: &mut Work<'_>, function: FunctionId) {
    let shader = work.shader;
    for id in shader.used_by(&shader.reachable(function)) {
        let symbol = shader.symbol(id);
        let is_input = match symbol.kind {
            SymbolKind::Global(storage) => storage == Storage::In,
            SymbolKind::BlockMember(k) | SymbolKind::BlockInstance(k) => {
                shader.interface().blocks.get(k).is_some_and(|b| b.storage == Storage::In)
            }
            // Limits are constants.
            SymbolKind::Builtin => {
                symbol.read_only && !symbol.name.starts_with("gl_Max") && !symbol.name.starts_with("gl_Min")
            }
            SymbolKind::Param(_) | SymbolKind::Local => false,
        };
        if is_input {
            let name = shader.function_info(function).name.span;
            let span = symbol.span.or(shader.uses_of(id).next().map(|u| u.span)).unwrap_or(name);
            let message = format!("`{}`, an input of the stage, cannot be fed or read", symbol.name);
            work.unsupported(span, message, "pass it to the function as a parameter");
        }
    }
}
