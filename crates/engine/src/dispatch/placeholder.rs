//! Specialization constants that a host has to set: 0 and 1 are written for them because something must be. Of real numbers
//! only 0 is taken for that.

use base::text::{Assembly, SourceFile, Span};
use syntax::Shader;
use syntax::interface::{StageLayout, Variable};
use syntax::types::Type;

/// The text with these constants, as far as they have one of some types, as uniforms: they get the numbers of a host, and what
/// follows from them is told as such. None where there is nothing to change. What the size of a workgroup or an array is made
/// of stays as it is.
pub fn with_host_numbers(shader: &Shader, types: &[Type]) -> Option<SourceFile> {
    let file = shader.file();
    let is_one = |constant: &&Variable| types.contains(&constant.ty) && is_placeholder(shader, constant);
    let mut all: Vec<&Variable> = shader.interface().constants.iter().filter(is_one).collect();
    all.sort_by_key(|constant| constant.declaration_span.start);
    let mut assembly = Assembly::new();
    let mut at = 0;
    for constant in &all {
        let span = constant.declaration_span;
        assembly.copy(file, Span::new(at, span.start));
        assembly.replace(&format!("uniform {} {};", constant.ty, constant.name), file, constant.name_span);
        at = span.end;
    }
    assembly.copy(file, Span::new(at, file.text().len()));
    (!all.is_empty()).then(|| assembly.finish(file.name()))
}

fn is_placeholder(shader: &Shader, constant: &Variable) -> bool {
    let Some(id) = constant.qualifiers.layout_entry("constant_id") else { return false };
    let id = id.value.and_then(|id| shader.fold(id));
    let is_size = |layout: &StageLayout| {
        let keys = ["local_size_x_id", "local_size_y_id", "local_size_z_id"];
        let mut entries = keys.iter().filter_map(|key| layout.qualifiers.layout_entry(key)?.value);
        entries.any(|value| shader.fold(value) == id)
    };
    let written = constant.initializer.and_then(|value| shader.fold(value)?.as_f64());
    let holds_place = match constant.ty {
        Type::INT | Type::UINT => [Some(0.0), Some(1.0)].contains(&written),
        Type::FLOAT => written == Some(0.0),
        _ => false,
    };
    let is_in_text = shader.file().slice(constant.name_span) == constant.name;
    holds_place
        && is_in_text
        && constant.siblings == 1
        && !shader.interface().stage_layouts.iter().any(is_size)
        && shader.uses_of(constant.symbol).all(|usage| usage.function.is_some())
}
