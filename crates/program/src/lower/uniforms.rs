//! Uniforms: each variable outside a block becomes a block of its own, in place, so that everything it mentions is
//! declared before it and its name stays global.

use super::Lowering;
use super::declaration::by_declaration;
use base::text::{Edit, Span};
use base::value::Scalar;
use syntax::ast::Qualifiers;
use syntax::interface::{Block, Storage, Variable};

pub(super) fn lower(work: &mut Lowering<'_>) {
    let shader = work.shader;
    let mut number = 0;
    for group in by_declaration(&shader.interface().uniforms) {
        let mut heads = Vec::new();
        for &uniform in &group {
            let Some(head) = head(work, uniform, number) else { return };
            work.drop_initializer(uniform);
            heads.push(if heads.is_empty() { head } else { format!("}}; {head}") });
            number += 1;
        }
        // naga reads `T a, b;` in a block no better than outside: each variable is written out.
        work.split(&group, |k| heads[k].clone());
        work.edits.push(Edit::insert(group[0].declaration_span.end, " };"));
    }
    for block in &shader.interface().blocks {
        match block.storage {
            Storage::Uniform => uniform_block(work, block),
            Storage::Buffer => work.refuse(block.name.span, format!("storage block `{}`", block.name.name)),
            _ => {}
        }
    }
}

/// What stands in place of the qualifiers of a uniform.
fn head(work: &mut Lowering<'_>, uniform: &Variable, number: u32) -> Option<String> {
    if !work.is_editable(uniform) {
        return None;
    }
    let shape = work.shape_of(uniform, "uniform")?;
    if shape.scalar == Scalar::Bool {
        work.refuse(uniform.name_span, format!("uniform `{}` of type `{}` in a block", uniform.name, uniform.ty));
    }
    // Columns of two components stand 16 bytes apart in std140, which naga cannot express. The layout of these blocks
    // is ours to choose.
    let layout = if shape.columns > 1 && shape.rows == 2 { "std430" } else { "std140" };
    let place = place(work, &uniform.name, uniform.name_span)?;
    Some(format!("layout({layout}, {place}) uniform sc_uniforms_{number} {{ "))
}

/// Group and binding of a uniform or a block, as layout qualifiers.
fn place(work: &mut Lowering<'_>, name: &str, span: Span) -> Option<String> {
    let Some((group, binding)) = work.places.uniforms.get(name) else {
        work.refuse(span, format!("`{name}` has no binding"));
        return None;
    };
    Some(format!("set = {group}, binding = {binding}"))
}

fn uniform_block(work: &mut Lowering<'_>, block: &Block) {
    let name = block.instance.as_ref().unwrap_or(&block.name);
    if !block.dims.is_empty() {
        work.refuse(block.name.span, format!("uniform block `{}` is an array", block.name.name));
    }
    for member in &block.members {
        if member.ty.shape().is_none_or(|shape| shape.scalar == Scalar::Bool) {
            work.refuse(member.name.span, format!("member `{}` of type `{}`", member.name.name, member.ty));
        }
    }
    // What places members elsewhere than std140 goes with the layout that is replaced.
    let moves = |q: &Qualifiers| ["offset", "align"].iter().any(|key| q.layout_entry(key).is_some());
    if moves(&block.qualifiers) || block.members.iter().any(|member| moves(&member.qualifiers)) {
        work.refuse(block.name.span, format!("uniform block `{}` with offsets", block.name.name));
    }
    if let Some(place) = place(work, &name.name, name.span) {
        for (_, span) in block.qualifiers.layouts() {
            work.edits.push(Edit::delete(span));
        }
        work.edits.push(Edit::insert(block.span.start, format!("layout(std140, {place}) ")));
    }
}
