//! Values that variables begin with, and the names by which ranges are stated for them.

use std::collections::BTreeSet;

use syntax::ast::{ExprId, ExprKind};
use syntax::interface::Storage;
use syntax::symbols::{Symbol, SymbolId, SymbolKind};
use syntax::types::{ScalarType, Type};
use syntax::{Const, Shader, walk};

use super::value::{Evidence, Range, Sources, Value};
use super::{Stated, builtin, operator};

/// Constants that a host may set, and those that follow from them.
pub fn specialized(shader: &Shader) -> BTreeSet<SymbolId> {
    let mut found = BTreeSet::new();
    for constant in &shader.interface().constants {
        let follows = |value: ExprId| {
            walk::expressions(shader, value)
                .into_iter()
                .any(|e| shader.symbol_of(e).is_some_and(|s| found.contains(&s)))
        };
        if constant.is_specialized() || constant.initializer.is_some_and(follows) {
            found.insert(constant.symbol);
        }
    }
    found
}

/// A value that follows from the text alone, and not from constants that a host may set.
pub fn folded(shader: &Shader, specialized: &BTreeSet<SymbolId>, id: ExprId) -> Option<Const> {
    let value = shader.fold(id)?;
    let is_set = |e: ExprId| shader.symbol_of(e).is_some_and(|symbol| specialized.contains(&symbol));
    let set = !specialized.is_empty() && walk::expressions(shader, id).into_iter().any(is_set);
    (!set).then_some(value)
}

/// The value of a variable that was not written yet.
pub fn beginning(shader: &Shader, stated: &[Stated], id: SymbolId) -> Value {
    let symbol: &Symbol = shader.symbol(id);
    let sources = Sources::of(id.index());
    if let Some(v) = symbol.value.and_then(Const::as_f64) {
        return Value::scalar(Range::exactly(v));
    }
    let from_outside = match symbol.kind {
        SymbolKind::Builtin => {
            let n = if matches!(symbol.ty, Type::Scalar(_) | Type::Vector(..)) { symbol.ty.components() } else { None };
            let part = |i| {
                builtin::variable(&symbol.name, i).map_or_else(
                    || Range::unknown(sources),
                    |(lo, hi, by)| {
                        let mut r = Range::of(lo, hi, by, sources);
                        if hi.is_infinite() {
                            r.hi_by = Evidence::Bound;
                        }
                        r
                    },
                )
            };
            return n.map_or_else(|| Value::opaque(sources), |n| Value::new((0..n).map(part).collect()));
        }
        SymbolKind::Global(Storage::In | Storage::Uniform | Storage::Buffer) | SymbolKind::BlockMember(_) => true,
        SymbolKind::Global(Storage::Out | Storage::Shared | Storage::Const | Storage::Global)
        | SymbolKind::BlockInstance(_)
        | SymbolKind::Param(_)
        | SymbolKind::Local => false,
    };
    match super::stated(stated, &symbol.name).filter(|_| from_outside) {
        Some((lo, hi)) => within(&symbol.ty, lo, hi, Evidence::Stated, sources),
        None => unknown_of(&symbol.ty, sources),
    }
}

/// A value of that type with every component between two numbers.
pub fn within(ty: &Type, lo: f64, hi: f64, by: Evidence, sources: Sources) -> Value {
    match ty {
        Type::Scalar(_) | Type::Vector(..) => {
            Value::new(vec![Range::of(lo, hi, by, sources); ty.components().unwrap_or(1)])
        }
        Type::Matrix(..) | Type::Error | Type::Void | Type::Opaque(_) | Type::Struct(_) | Type::Array(..) => {
            Value::opaque(sources)
        }
    }
}

/// A value of which only the type is known.
pub fn unknown_of(ty: &Type, sources: Sources) -> Value {
    match ty {
        Type::Scalar(ScalarType::Bool) => Value::scalar(Range::truth(sources)),
        Type::Scalar(scalar) | Type::Vector(scalar, _) => {
            let range = operator::fit(Range::unknown(sources), *scalar);
            Value::new(vec![range; ty.components().unwrap_or(1)])
        }
        Type::Matrix(..) | Type::Error | Type::Void | Type::Opaque(_) | Type::Struct(_) | Type::Array(..) => {
            Value::opaque(sources)
        }
    }
}

/// A number that mostly differs for different texts.
pub fn hash(text: &str) -> usize {
    text.bytes().fold(7, |h: usize, b| h.wrapping_mul(31).wrapping_add(usize::from(b)))
}

/// Indices of the components that a swizzle names.
pub fn swizzle(field: &str) -> impl Iterator<Item = Option<usize>> {
    field.chars().map(|c| ["xrs", "ygt", "zbp", "waq"].iter().position(|set| set.contains(c)))
}

/// The name of a member with points, from the variable on, and whether the variable is from outside
/// the shader. Indices are left out.
pub fn path(shader: &Shader, id: ExprId) -> Option<(String, bool)> {
    match &shader.expr(id).kind {
        ExprKind::Paren(inner) => path(shader, *inner),
        ExprKind::Index { base, index: _ } => path(shader, *base),
        ExprKind::Field { base, field } => {
            let (before, outside) = path(shader, *base)?;
            Some((format!("{before}.{}", field.name), outside))
        }
        ExprKind::Name(name) => {
            let kind = shader.symbol(shader.symbol_of(id)?).kind;
            let outside = matches!(
                kind,
                SymbolKind::Global(Storage::In | Storage::Uniform | Storage::Buffer)
                    | SymbolKind::BlockMember(_)
                    | SymbolKind::BlockInstance(_)
            );
            Some((name.clone(), outside))
        }
        _ => None,
    }
}
