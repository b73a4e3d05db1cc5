//! Which forms of built-in functions a version has, and how far types are from each other.

use super::super::builtin::{self, Signature};
use super::super::language::{Feature, Language};
use super::super::types::{Conversions, OpaqueKind, ScalarType, Type};

/// True when the version has this form of a built-in function: those on unsigned integers, on `double`,
/// and some on integers came later than the function itself. Arguments that have a type of an extension need it already,
/// which is told of the type.
pub(super) fn available(
    name: &str,
    signature: &Signature,
    given: &[Type],
    language: &Language,
    fragment: bool,
) -> bool {
    if language.is_open() {
        return true;
    }
    let uses = |wanted: ScalarType| {
        let is = |t: &Type| {
            t.scalar() == Some(wanted)
                || matches!(t, Type::Opaque(o) if o.scalar == wanted && o.kind != OpaqueKind::AtomicCounter)
        };
        signature.params.iter().any(|p| is(&p.1)) || is(&signature.result)
    };
    if uses(ScalarType::Double) && !language.has(Feature::Doubles) {
        return false;
    }
    let has = |of: ScalarType| builtin::has_scalar(of, language) || given.iter().any(|t| t.scalar() == Some(of));
    if SIZED.into_iter().any(|sized| uses(sized) && !has(sized)) {
        return false;
    }
    if uses(ScalarType::Uint) && !language.has(Feature::UnsignedIntegers) {
        return false;
    }
    if signature.bias && !fragment {
        return false;
    }
    let first = signature.params.first().and_then(|p| p.1.scalar());
    match name {
        "abs" | "sign" | "min" | "max" | "clamp" if first == Some(ScalarType::Int) => {
            language.since((130, 300, &["EXT_gpu_shader4"]))
        }
        "mix" if signature.params.last().and_then(|p| p.1.scalar()) == Some(ScalarType::Bool) => {
            if first.is_some_and(ScalarType::is_floating) {
                language.at_least(130, 300)
            } else {
                language.since((450, 310, &["EXT_shader_integer_mix"]))
            }
        }
        // With a scope, the kind of memory and its order.
        "memoryBarrier" if signature.params.len() > 1 => language.enabled("KHR_memory_scope_semantics"),
        _ if name.starts_with("atomic") && signature.params.len() > 4 => language.enabled("KHR_memory_scope_semantics"),
        "outerProduct" | "transpose" | "matrixCompMult" => {
            !language.es() || language.number() >= 300 || square(signature)
        }
        _ => true,
    }
}

fn square(signature: &Signature) -> bool {
    matches!(signature.result, Type::Matrix(_, c, r) if c == r)
}

/// Types that an extension brings.
const SIZED: [ScalarType; 7] = [
    ScalarType::Int8,
    ScalarType::Uint8,
    ScalarType::Int16,
    ScalarType::Uint16,
    ScalarType::Int64,
    ScalarType::Uint64,
    ScalarType::Half,
];

/// How far a type of an extension is from another one: promotions to 32 bits come first
/// (GL_EXT_shader_explicit_arithmetic_types, 6.1).
pub(super) fn to_other(from: ScalarType, to: ScalarType) -> u32 {
    match (from, to) {
        (ScalarType::Half, ScalarType::Float) => 1,
        (_, ScalarType::Int) if from.is_small_integer() => 1,
        _ if from.is_integer() && to.is_integer() => 2 + to.bits() / 32,
        _ => 5 + to.bits() / 32,
    }
}

pub(super) fn cost(from: &Type, to: &Type, rules: Conversions) -> Option<u32> {
    if !rules.allow(from, to) {
        return None;
    }
    Some(match (from.scalar(), to.scalar()) {
        (Some(a), Some(b)) if a != b => match (a, b) {
            _ if a.is_sized() => to_other(a, b),
            (ScalarType::Float, ScalarType::Double) => 1,
            (_, ScalarType::Uint) => 2,
            (_, ScalarType::Float) => 3,
            _ => 4,
        },
        _ => 0,
    })
}
