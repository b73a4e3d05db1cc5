//! What entry points of WGSL get from outside.

use syntax::Shader;
use syntax::ast::{ExprId, ExprKind};
use syntax::symbols::SymbolId;
use syntax::wgsl::{Attribute, Module, ModuleItem};

/// The variable of which an expression is a part, with the names of the members on the way to it.
pub fn root(shader: &Shader, id: ExprId) -> Option<(SymbolId, Vec<&str>)> {
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
pub struct Input<'m> {
    /// The parameter of the entry point.
    pub param: SymbolId,
    /// The member, where the parameter is a structure.
    pub member: Option<&'m str>,
    /// Its attributes.
    pub attributes: &'m [Attribute],
    /// Its name.
    pub name: &'m syntax::ast::Ident,
}

/// The inputs of an entry point.
pub fn inputs<'m>(shader: &Shader, module: &'m Module, item: usize) -> Vec<Input<'m>> {
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
pub fn builtin_value<'s>(shader: &'s Shader, attributes: &[Attribute]) -> Option<&'s str> {
    let attribute = Module::attribute(attributes, "builtin")?;
    Some(shader.text_of(*attribute.args.first()?))
}

/// True for a member of an input that is interpolated and not flat.
pub fn is_interpolated(shader: &Shader, id: ExprId) -> bool {
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
pub fn is_flat(shader: &Shader, attributes: &[Attribute]) -> bool {
    let kind = Module::attribute(attributes, "interpolate").and_then(|a| a.args.first());
    kind.is_some_and(|k| shader.text_of(*k) == "flat")
}
