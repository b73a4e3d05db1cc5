//! Rules on what WGSL alone has.

mod interface;

// Rules: each in a folder with its name, with its pages.
pub(super) mod atomic_in_read_only_storage;
pub(super) mod binding_layout_differs;
pub(super) mod buffer_size_differs;
pub(super) mod dispatch_counts_items;
pub(super) mod members_differ;
pub(super) mod non_uniform_control_flow;
pub(super) mod override_without_value;
pub(super) mod pixel_centre_rounded;
pub(super) mod private_variable_never_set;
pub(super) mod resource_of_another_pass;
pub(super) mod structure_laid_out_differently;
pub(super) mod unknown_entry_point;
pub(super) mod unused_binding;
pub(super) mod vertex_attribute_differs;

use syntax::Shader;
use syntax::ast::{ExprId, ExprKind};
use syntax::symbols::SymbolId;
use syntax::wgsl::{Attribute, Module, ModuleItem};

/// The variable of which an expression is a part, with the names of the members on the way to it.
pub(crate) fn root(shader: &Shader, id: ExprId) -> Option<(SymbolId, Vec<&str>)> {
    let mut members = Vec::new();
    let mut id = id;
    loop {
        id = match &shader.expr(id).kind {
            ExprKind::Name(_) => {
                members.reverse();
                return Some((shader.symbol_of(id)?, members));
            }
            ExprKind::Paren(inner) => *inner,
            ExprKind::Index { base, index: _ } => *base,
            ExprKind::Field { base, field } => {
                members.push(field.name.as_str());
                *base
            }
            _ => return None,
        };
    }
}

/// What an entry point gets from outside: attributes of a parameter, or of the member of its structure.
pub(crate) struct Input<'m> {
    pub param: SymbolId,
    /// The member, where the parameter is a structure.
    pub member: Option<&'m str>,
    pub attributes: &'m [Attribute],
    pub name: &'m syntax::ast::Ident,
}

/// The inputs of an entry point.
pub(crate) fn inputs<'m>(shader: &Shader, module: &'m Module, item: usize) -> Vec<Input<'m>> {
    let Some(ModuleItem::Function { params, .. }) = module.items.get(item) else { return Vec::new() };
    let Some(function) = module.function(item) else { return Vec::new() };
    let mut found = Vec::new();
    for (syntax, info) in params.iter().zip(&shader.function_info(function).params) {
        let Some(param) = info.symbol else { continue };
        let whole = Input { param, member: None, attributes: &syntax.attributes, name: &syntax.name };
        match module.members(&syntax.ty.name.name).filter(|_| syntax.attributes.is_empty()) {
            Some(members) => found.extend(members.iter().map(|m| Input {
                param,
                member: Some(&m.name.name),
                attributes: &m.attributes,
                name: &m.name,
            })),
            None => found.push(whole),
        }
    }
    found
}

/// The built-in value that attributes name.
pub(crate) fn builtin_value<'s>(shader: &'s Shader, attributes: &[Attribute]) -> Option<&'s str> {
    let attribute = Module::attribute(attributes, "builtin")?;
    Some(shader.text_of(*attribute.args.first()?))
}

/// True for a member of an input that is interpolated and not flat.
pub(crate) fn is_interpolated(shader: &Shader, id: ExprId) -> bool {
    let Some(module) = shader.wgsl() else { return false };
    let Some((symbol, members)) = root(shader, id) else { return false };
    module.entry_points.iter().filter(|e| e.stage == syntax::Stage::Fragment).any(|entry| {
        inputs(shader, module, entry.item).iter().any(|input| {
            let same = input.param == symbol && members.first().copied() == input.member;
            same && Module::attribute(input.attributes, "location").is_some() && !is_flat(shader, input.attributes)
        })
    })
}

/// True for `@interpolate(flat)`.
pub(crate) fn is_flat(shader: &Shader, attributes: &[Attribute]) -> bool {
    let kind = Module::attribute(attributes, "interpolate").and_then(|a| a.args.first());
    kind.is_some_and(|k| shader.text_of(*k) == "flat")
}

#[cfg(test)]
pub(crate) mod testing {
    use crate::{Input, Level, Selection, Settings, run_with};
    use base::diagnostic::Diagnostic;
    use base::text::SourceFile;

    /// What a rule says of a module at the strictest level.
    pub fn found(code: &str, text: &str) -> Vec<Diagnostic> {
        let settings = Settings { selection: Selection::default().at(Level::Heuristic), ..Settings::default() };
        let found = run_with(&[Input::new(SourceFile::new("a.wgsl", text))], &settings);
        assert!(found.iter().all(|d| !d.code.0.starts_with('E')), "{found:#?}\n{text}");
        found.into_iter().filter(|d| d.code.0 == code).collect()
    }

    /// How often.
    pub fn count(code: &str, text: &str) -> usize {
        found(code, text).len()
    }
}
