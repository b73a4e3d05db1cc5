//! Predeclared types and how they are spelled (WGSL, sections 6 and 6.9).

use super::super::types::{ArraySize, OpaqueKind, OpaqueType, ScalarType, TextureDim, Type};

/// Names of types with arguments.
const GENERATORS: &[&str] = &["array", "atomic", "bitcast", "binding_array", "ptr"];

/// A number of components or columns.
fn digit(text: &str) -> Option<u8> {
    match text {
        "2" => Some(2),
        "3" => Some(3),
        "4" => Some(4),
        _ => None,
    }
}

/// True for the name of a predeclared type that may be followed by `<`.
pub(super) fn is_generator(name: &str) -> bool {
    let sized = |rest: &str| digit(rest).is_some() || shape(rest).is_some();
    GENERATORS.contains(&name)
        || name.starts_with("texture_")
        || name.strip_prefix("vec").or_else(|| name.strip_prefix("mat")).is_some_and(sized)
}

/// `3x2`
fn shape(text: &str) -> Option<(u8, u8)> {
    let (columns, rows) = text.split_once('x')?;
    Some((digit(columns)?, digit(rows)?))
}

/// True for the name of a predeclared type that a call can construct.
pub fn is_type(name: &str) -> bool {
    is_generator(name) || plain(name).is_some()
}

/// The scalar of that name. Half floats are taken for floats: what rules know holds for both.
pub(super) fn scalar(name: &str) -> Option<ScalarType> {
    Some(match name {
        "bool" => ScalarType::Bool,
        "i32" => ScalarType::Int,
        "u32" => ScalarType::Uint,
        "f32" | "f16" => ScalarType::Float,
        _ => return None,
    })
}

/// A type without arguments: scalars and the short names of vectors and matrices.
pub fn plain(name: &str) -> Option<Type> {
    if let Some(scalar) = scalar(name) {
        return Some(Type::Scalar(scalar));
    }
    let letter = name.chars().last()?;
    let element = match letter {
        'f' | 'h' => ScalarType::Float,
        'i' => ScalarType::Int,
        'u' => ScalarType::Uint,
        _ => return None,
    };
    let stem = &name[..name.len() - 1];
    if let Some(n) = stem.strip_prefix("vec").and_then(digit) {
        return Some(Type::Vector(element, n));
    }
    let (columns, rows) = shape(stem.strip_prefix("mat")?)?;
    (element == ScalarType::Float).then_some(Type::Matrix(element, columns, rows))
}

/// A vector or matrix whose component type stands between `<` and `>`, or follows from the arguments of a call.
pub(super) fn with_component(name: &str, scalar: ScalarType) -> Option<Type> {
    if let Some(n) = name.strip_prefix("vec").and_then(digit) {
        return Some(Type::Vector(scalar, n));
    }
    let (columns, rows) = shape(name.strip_prefix("mat")?)?;
    Some(Type::Matrix(scalar, columns, rows))
}

/// A texture or sampler; the component type is that of its texels.
pub(super) fn opaque(name: &str, texel: ScalarType) -> Option<OpaqueType> {
    let of = |kind, dim| OpaqueType {
        kind,
        scalar: texel,
        dim,
        arrayed: false,
        shadow: false,
        multisampled: false,
        separate: false,
    };
    if name == "sampler" || name == "sampler_comparison" {
        return Some(of(OpaqueKind::AtomicCounter, TextureDim::Buffer));
    }
    let rest = name.strip_prefix("texture_")?;
    if rest == "external" {
        return Some(of(OpaqueKind::Sampler, TextureDim::D2));
    }
    let (rest, kind) = rest.strip_prefix("storage_").map_or((rest, OpaqueKind::Sampler), |r| (r, OpaqueKind::Image));
    let (rest, shadow) = rest.strip_prefix("depth_").map_or((rest, false), |r| (r, true));
    let (rest, multisampled) = rest.strip_prefix("multisampled_").map_or((rest, false), |r| (r, true));
    let (rest, arrayed) = rest.strip_suffix("_array").map_or((rest, false), |r| (r, true));
    let dim = match rest {
        "1d" => TextureDim::D1,
        "2d" => TextureDim::D2,
        "3d" => TextureDim::D3,
        "cube" => TextureDim::Cube,
        _ => return None,
    };
    Some(OpaqueType { arrayed, shadow, multisampled, ..of(kind, dim) })
}

/// True for what `sampler` and `sampler_comparison` declare, which GLSL has no type for.
pub fn is_sampler(ty: &Type) -> bool {
    matches!(ty, Type::Opaque(OpaqueType { kind: OpaqueKind::AtomicCounter, .. }))
}

/// How WGSL spells a type.
pub fn spelling(ty: &Type) -> String {
    let name = |s: ScalarType| match s {
        ScalarType::Bool => "bool",
        s if s.is_floating() => "f32",
        s if s.is_unsigned() => "u32",
        _ => "i32",
    };
    match ty {
        Type::Scalar(s) => name(*s).to_owned(),
        Type::Vector(ScalarType::Bool, n) => format!("vec{n}<bool>"),
        Type::Vector(s, n) => format!("vec{n}{}", &name(*s)[..1]),
        Type::Matrix(_, columns, rows) => format!("mat{columns}x{rows}f"),
        Type::Array(element, ArraySize::Known(n)) => format!("array<{}, {n}>", spelling(element)),
        Type::Array(element, ArraySize::Unsized | ArraySize::Unknown) => format!("array<{}>", spelling(element)),
        Type::Opaque(_) if is_sampler(ty) => "sampler".to_owned(),
        Type::Opaque(_) => "texture".to_owned(),
        Type::Error | Type::Void | Type::Struct(_) => ty.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_names_are_types_and_are_spelled_back() {
        for name in ["f32", "vec3f", "vec2u", "mat4x3f", "i32", "vec4i"] {
            assert_eq!(plain(name).map(|t| spelling(&t)).as_deref(), Some(name));
        }
        assert_eq!(plain("mat2x2i"), None);
        assert_eq!((is_generator("vec3"), is_generator("vec3f"), is_generator("mat4x4")), (true, false, true));
        assert!(opaque("texture_depth_2d_array", ScalarType::Float).is_some_and(|t| t.shadow && t.arrayed));
    }
}
