//! How the outputs of a stage meet the inputs of the next one.

use std::collections::BTreeSet;

use crate::project::ShaderFile;
use syntax::ast::{AuxiliaryQualifier, Interpolation, QualifierKind, Qualifiers};
use syntax::interface::{Block, Storage, Variable};
use syntax::symbols::SymbolId;
use syntax::types::{ArraySize, Type};
use syntax::{Stage, Token, TokenKind, TokenPlace};

/// The `layout(location = n)` of a variable, when it is a plain number.
pub fn location(shader: &ShaderFile, qualifiers: &Qualifiers) -> Option<i64> {
    shader.shader.fold(qualifiers.layout_entry("location")?.value?)?.as_integer()
}

fn has_location(variable: &Variable) -> bool {
    variable.qualifiers.layout_entry("location").is_some()
}

/// The variable of `others` that meets `variable`: the one at the same location when both have one,
/// or the one of the same name.
fn partner<'o>(
    shader: &ShaderFile,
    variable: &Variable,
    other: &ShaderFile,
    others: &'o [Variable],
) -> Option<&'o Variable> {
    let named = || others.iter().find(|o| o.name == variable.name);
    if !has_location(variable) {
        return named();
    }
    let Some(at) = location(shader, &variable.qualifiers) else { return named() };
    let component = |v: &Variable| v.qualifiers.layout_entry("component").is_some();
    if component(variable) || others.iter().any(component) {
        return named();
    }
    others.iter().find(|o| location(other, &o.qualifiers) == Some(at)).or_else(|| named().filter(|o| !has_location(o)))
}

/// The output that an input gets its value from.
pub fn producer<'p>(from: &'p ShaderFile, to: &ShaderFile, input: &Variable) -> Option<&'p Variable> {
    partner(to, input, from, &from.shader.interface().outputs)
}

/// The input that an output goes to.
pub fn consumer<'p>(from: &ShaderFile, to: &'p ShaderFile, output: &Variable) -> Option<&'p Variable> {
    partner(from, output, to, &to.shader.interface().inputs)
}

/// The output block that an input block gets its members from: the one of the same name.
pub fn block<'p>(shader: &'p ShaderFile, storage: Storage, name: &str) -> Option<&'p Block> {
    shader.shader.interface().blocks.iter().find(|b| b.storage == storage && b.name.name == name)
}

/// True when a block of `storage` has a member of that name, or is called so.
pub fn in_block(shader: &ShaderFile, storage: Storage, name: &str) -> bool {
    let blocks = shader.shader.interface().blocks.iter();
    blocks
        .filter(|b| b.storage == storage)
        .any(|b| b.members.iter().any(|m| m.name.name == name) || b.instance.as_ref().is_some_and(|i| i.name == name))
}

/// True for names of the language, which no stage declares.
pub fn is_built_in(name: &str) -> bool {
    name.starts_with("gl_")
}

/// True when the stage has one value per vertex of each input: an array that the type of the stage
/// before does not have.
fn is_arrayed_input(stage: Stage, qualifiers: &Qualifiers) -> bool {
    matches!(stage, Stage::Geometry | Stage::TessControl | Stage::TessEvaluation) && !is_patch(qualifiers)
}

/// True for `patch in` and `patch out`.
pub fn is_patch(qualifiers: &Qualifiers) -> bool {
    qualifiers.list.iter().any(|q| q.kind == QualifierKind::Auxiliary(AuxiliaryQualifier::Patch))
}

/// Type of an input of one vertex; none when the array that the stage needs is not there.
pub fn input_type<'v>(shader: &ShaderFile, ty: &'v Type, qualifiers: &Qualifiers) -> Option<&'v Type> {
    if is_arrayed_input(shader.shader.stage(), qualifiers) { element(ty) } else { Some(ty) }
}

/// Type of an output of one vertex.
pub fn output_type<'v>(shader: &ShaderFile, ty: &'v Type, qualifiers: &Qualifiers) -> Option<&'v Type> {
    let arrayed = shader.shader.stage() == Stage::TessControl && !is_patch(qualifiers);
    if arrayed { element(ty) } else { Some(ty) }
}

fn element(ty: &Type) -> Option<&Type> {
    match ty {
        Type::Array(element, _) => Some(element),
        Type::Error
        | Type::Void
        | Type::Scalar(_)
        | Type::Vector(..)
        | Type::Matrix(..)
        | Type::Opaque(_)
        | Type::Struct(_) => None,
    }
}

/// True unless the types differ for certain. Structures are compared by their members.
pub fn agree(a: &Type, b: &Type) -> bool {
    match (a, b) {
        (Type::Error, _) | (_, Type::Error) => true,
        (Type::Array(x, m), Type::Array(y, n)) => {
            let sizes = match (m, n) {
                (ArraySize::Known(m), ArraySize::Known(n)) => m == n,
                (ArraySize::Known(_) | ArraySize::Unsized | ArraySize::Unknown, _) => true,
            };
            sizes && agree(x, y)
        }
        (Type::Struct(x), Type::Struct(y)) => {
            x.fields.len() == y.fields.len()
                && x.fields.iter().zip(&y.fields).all(|(f, g)| f.name == g.name && agree(&f.ty, &g.ty))
        }
        (a, b) => a == b,
    }
}

/// Interpolation of a variable; smooth when nothing is written.
pub fn interpolation(qualifiers: &Qualifiers) -> Interpolation {
    qualifiers.interpolation().map_or(Interpolation::Smooth, |(i, _)| i)
}

/// The keyword.
pub fn keyword(interpolation: Interpolation) -> &'static str {
    match interpolation {
        Interpolation::Smooth => "smooth",
        Interpolation::Flat => "flat",
        Interpolation::NoPerspective => "noperspective",
    }
}

/// True when a variable is used in a function that `main` reaches: linkers drop the others.
pub fn is_used(shader: &ShaderFile, variable: &Variable) -> bool {
    is_read(shader, variable.symbol)
}

/// As [`is_used`], for any symbol.
pub fn is_read(shader: &ShaderFile, symbol: SymbolId) -> bool {
    let mut uses = shader.shader.uses_of(symbol).peekable();
    if uses.peek().is_none() {
        return false;
    }
    let reached = reached(shader);
    uses.any(|u| u.function.is_none_or(|f| reached.contains(shader.shader.function_info(f).name.name.as_str())))
}

/// Names of the functions that `main` calls, itself and through others. Names in directives count as
/// called: a macro may be used anywhere.
fn reached(shader: &ShaderFile) -> BTreeSet<&str> {
    let text = |t: &Token| shader.file.slice(t.span);
    let words = || shader.shader.tokens().iter().filter(|t| t.kind == TokenKind::Word);
    let in_directives = words().filter(|t| t.place == TokenPlace::Directive).map(text);
    let mut todo: Vec<&str> = in_directives.chain(["main"]).collect();
    let mut found: BTreeSet<&str> = BTreeSet::new();
    while let Some(name) = todo.pop() {
        if shader.shader.function(name).is_none() || !found.insert(name) {
            continue;
        }
        for (_, function) in shader.shader.functions().filter(|(_, f)| f.name.name == name) {
            let item = function.definition.and_then(|d| shader.shader.unit().items.get(d));
            let Some(place) = item.map(|i| i.span) else { continue };
            todo.extend(words().filter(|t| place.contains(t.span.start)).map(text));
        }
    }
    found
}
