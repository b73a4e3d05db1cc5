//! Uniforms: each declaration outside a block becomes a block of its own, in place, so that
//! everything it mentions is declared before it and its names stay global.

use super::Work;
use super::declaration::{by_declaration, variable};
use super::lowered::Variable;
use base::text::{Edit, Span};
use base::value::Scalar;
use syntax::interface::{Block, Storage};

pub(super) fn lower(work: &mut Work<'_>) -> Vec<Variable> {
    let shader = work.shader;
    let mut found: Vec<(usize, Vec<Variable>)> = Vec::new();
    let mut binding = 0;
    for group in by_declaration(&shader.interface().uniforms) {
        let mut variables = Vec::new();
        for &uniform in &group {
            if !work.is_editable(uniform) {
                return Vec::new();
            }
            if uniform.ty.contains_opaque() {
                let message =
                    format!("uniform `{}` of type `{}`: textures and images are not fed", uniform.name, uniform.ty);
                work.unsupported(uniform.name_span, message, "test a function that takes the fetched value instead");
                continue;
            }
            let Some(shape) = work.shape_of(uniform, "uniform") else { continue };
            if shape.scalar == Scalar::Bool {
                let message = format!("uniform `{}` of type `{}`: a block cannot hold it", uniform.name, uniform.ty);
                work.unsupported(uniform.name_span, message, "use an `int` and compare it with 0");
                continue;
            }
            work.drop_initializer(uniform);
            variables.push(variable(uniform, shape, None));
        }
        // naga reads `T a, b;` in a block no better than outside: each member is written out.
        // Columns of two components stand 16 bytes apart in std140, which naga cannot express. The
        // layout of these blocks is ours to choose.
        let two_rows = variables.iter().any(|v| v.shape.columns > 1 && v.shape.rows == 2);
        let layout = if two_rows { "std430" } else { "std140" };
        let block = format!("layout({layout}, set = 0, binding = {binding}) uniform sc_uniforms_{binding} {{ ");
        binding += 1;
        work.split(&group, |k| if k == 0 { block.clone() } else { String::new() });
        work.edits.push(Edit::insert(group[0].declaration_span.end, " };"));
        found.push((group[0].item, variables));
    }
    for block in shader.interface().blocks.iter().filter(|b| b.storage == Storage::Uniform) {
        let head = format!("layout(std140, set = 0, binding = {binding}) ");
        binding += 1;
        let variables = members(work, block);
        replace_layout(work, block, &head);
        found.push((block.item, variables));
    }
    for block in shader.interface().blocks.iter().filter(|b| b.storage == Storage::Buffer) {
        let message = format!("storage block `{}` is not fed", block.name.name);
        work.unsupported(block.name.span, message, "pass the values as uniforms or attributes");
    }
    found.sort_by_key(|(item, _)| *item);
    found.into_iter().flat_map(|(_, variables)| variables).collect()
}

fn members(work: &mut Work<'_>, block: &Block) -> Vec<Variable> {
    let mut variables = Vec::new();
    if !block.dims.is_empty() {
        let message = format!("uniform block `{}` is an array", block.name.name);
        work.unsupported(block.name.span, message, "declare one block for each element");
        return variables;
    }
    for member in &block.members {
        let fed = member.ty.shape().filter(|s| s.scalar != Scalar::Bool);
        let Some(shape) = fed else {
            let message = format!("member `{}` of type `{}` cannot be fed", member.name.name, member.ty);
            work.unsupported(member.name.span, message, "only numbers, vectors, matrices and arrays of them are fed");
            continue;
        };
        let name = match &block.instance {
            Some(instance) => format!("{}.{}", instance.name, member.name.name),
            None => member.name.name.clone(),
        };
        variables.push(Variable { name, shape, span: member.name.span, location: None });
    }
    variables
}

/// Puts `head` in place of the block's own layout qualifiers.
fn replace_layout(work: &mut Work<'_>, block: &Block, head: &str) {
    let layouts: Vec<Span> = block.qualifiers.layouts().map(|(_, span)| span).collect();
    for span in layouts {
        work.edits.push(Edit::delete(span));
    }
    work.edits.push(Edit::insert(block.span.start, head));
}
