//! The names of one shader: what each place means.

use base::text::Span;
use syntax::Shader;
use syntax::ast::{Callee, ExprKind, ItemKind, TypeKind};
use syntax::symbols::{CallTarget, FunctionId, SymbolId};
use syntax::types::Type;
use syntax::wgsl::{ModuleItem, TypeSyntax};

use crate::walk::parts;

/// What a name means in one shader.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Meaning {
    /// A variable.
    Symbol(SymbolId),
    /// A function.
    Function(FunctionId),
    /// A member of a structure or block, by the place of its name in the declaration.
    Member(Span, String),
    /// A structure.
    Struct(String),
    /// A block, by its index in the interface.
    Block(usize),
}

/// A name at a place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Occurrence {
    pub span: Span,
    pub meaning: Meaning,
    /// True where it is declared.
    pub declares: bool,
    /// True where it gets a value.
    pub writes: bool,
}

/// All names of a shader, in the order of the text. What a macro writes is left out: it does not stand there.
pub(crate) fn all(shader: &Shader) -> Vec<Occurrence> {
    let mut found = Vec::new();
    let mut add = |span: Span, meaning: Meaning, declares: bool, writes: bool| {
        if !span.is_empty() {
            found.push(Occurrence { span, meaning, declares, writes });
        }
    };
    for (id, symbol) in shader.symbols() {
        if let Some(span) = symbol.span {
            add(span, Meaning::Symbol(id), true, false);
        }
    }
    for use_ in shader.uses() {
        add(use_.span, Meaning::Symbol(use_.symbol), false, use_.access.writes());
    }
    for (id, function) in shader.functions() {
        add(function.name.span, Meaning::Function(id), true, false);
        for &item in function.prototypes.iter().chain(&function.definition) {
            if let Some(ItemKind::Function(f)) = shader.unit().items.get(item).map(|i| &i.kind) {
                add(f.name.span, Meaning::Function(id), true, false);
            }
        }
    }
    for (index, block) in shader.interface().blocks.iter().enumerate() {
        add(block.name.span, Meaning::Block(index), true, false);
        for member in block.members.iter().filter(|m| m.symbol.is_none()) {
            add(member.name.span, Meaning::Member(member.name.span, member.name.name.clone()), true, false);
        }
    }
    for (id, expr) in shader.arena().iter() {
        match &expr.kind {
            ExprKind::Call { callee: Callee::Name(name), args: _ } => match shader.callee(id) {
                Some(CallTarget::User(function)) => add(name.span, Meaning::Function(*function), false, false),
                Some(CallTarget::Constructor(Type::Struct(s))) => {
                    add(name.span, Meaning::Struct(s.name.clone()), false, false);
                }
                _ => {}
            },
            ExprKind::Field { base, field } => {
                if let Type::Struct(s) = shader.type_of(*base)
                    && let Some(member) = s.fields.iter().find(|f| f.name == field.name)
                {
                    add(field.span, Meaning::Member(member.span, member.name.clone()), false, false);
                }
            }
            _ => {}
        }
    }
    let parts = parts(shader);
    for ty in &parts.types {
        if let TypeKind::Named(name) = &ty.kind
            && shader.wgsl().is_none()
            && Type::from_name(name).is_none()
        {
            add(ty.name_span, Meaning::Struct(name.clone()), false, false);
        }
    }
    for s in &parts.structs {
        if let Some(name) = &s.name {
            add(name.span, Meaning::Struct(name.name.clone()), true, false);
        }
        for name in s.members.iter().flat_map(|m| &m.declarators).map(|d| &d.name) {
            add(name.span, Meaning::Member(name.span, name.name.clone()), true, false);
        }
    }
    if let Some(module) = shader.wgsl() {
        of_module(module, &mut add);
    }
    found.sort_by_key(|o| (o.span, !o.declares));
    found.dedup_by(|b, a| a.span == b.span && a.meaning == b.meaning);
    found.retain(|o| shader.file().expansion(o.span).is_none());
    found
}

/// Structures of a module in WGSL, and the types that name them.
fn of_module(module: &syntax::wgsl::Module, add: &mut impl FnMut(Span, Meaning, bool, bool)) {
    let mut types: Vec<&TypeSyntax> = Vec::new();
    for item in &module.items {
        match item {
            ModuleItem::Struct { name, members } => {
                add(name.span, Meaning::Struct(name.name.clone()), true, false);
                for member in members {
                    add(member.name.span, Meaning::Member(member.name.span, member.name.name.clone()), true, false);
                    types.push(&member.ty);
                }
            }
            ModuleItem::Alias { name, ty } => {
                add(name.span, Meaning::Struct(name.name.clone()), true, false);
                types.push(ty);
            }
            ModuleItem::Variable(variable) => types.extend(&variable.ty),
            ModuleItem::Function { attributes: _, name: _, params, returns, item: _ } => {
                types.extend(params.iter().map(|p| &p.ty));
                types.extend(returns.iter().map(|(_, ty)| ty));
            }
        }
    }
    types.extend(module.locals.values().filter_map(|v| v.ty.as_ref()));
    let declared = |name: &str| {
        module.items.iter().any(|i| match i {
            ModuleItem::Struct { name: n, members: _ } | ModuleItem::Alias { name: n, ty: _ } => n.name == name,
            ModuleItem::Variable(_) | ModuleItem::Function { .. } => false,
        })
    };
    while let Some(ty) = types.pop() {
        types.extend(ty.args.iter().filter_map(|a| a.ty.as_ref()));
        if declared(&ty.name.name) {
            add(ty.name.span, Meaning::Struct(ty.name.name.clone()), false, false);
        }
    }
}
