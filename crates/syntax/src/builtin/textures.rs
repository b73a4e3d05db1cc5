//! Texture and image functions (GLSL 4.60 specification, sections 8.9 and 8.12, and the older
//! ones of GLSL 1.20, section 8.7), made from the sampler types.

use super::super::symbols::Direction;
use super::super::types::{OpaqueKind, OpaqueType, ScalarType, TextureDim, Type};
use super::functions::{Signature, Table};

const DIMS: [TextureDim; 6] =
    [TextureDim::D1, TextureDim::D2, TextureDim::D3, TextureDim::Cube, TextureDim::Rect, TextureDim::Buffer];

fn all_types(kind: OpaqueKind) -> Vec<OpaqueType> {
    let mut all = Vec::new();
    for scalar in [ScalarType::Float, ScalarType::Int, ScalarType::Uint] {
        for dim in DIMS {
            for flags in 0..8 {
                let (arrayed, shadow, multisampled) = (flags & 1 != 0, flags & 2 != 0, flags & 4 != 0);
                let ty = OpaqueType { kind, scalar, dim, arrayed, shadow, multisampled, separate: false };
                // The spelling says which combinations exist.
                if OpaqueType::from_name(&ty.to_string()) == Some(ty) {
                    all.push(ty);
                }
            }
        }
    }
    all
}

fn floats(n: u8) -> Type {
    Type::vector(ScalarType::Float, n)
}

fn ints(n: u8) -> Type {
    Type::vector(ScalarType::Int, n)
}

struct Adder<'a> {
    all: &'a mut Table,
}

impl Adder<'_> {
    fn add(&mut self, name: &'static str, params: &[Type], result: &Type) {
        let params = params.iter().map(|t| (Direction::In, t.clone())).collect();
        self.all.entry(name).or_default().push(Signature { params, result: result.clone(), bias: false });
    }

    /// With and without a last parameter.
    fn optional(&mut self, name: &'static str, params: &[Type], last: &[Type], result: &Type) {
        self.add(name, params, result);
        self.add(name, &[params, last].concat(), result);
        let bias = last == [Type::FLOAT];
        if let Some(added) = self.all.entry(name).or_default().last_mut() {
            added.bias = bias;
        }
    }
}

pub(super) fn add(all: &mut Table) {
    let mut to = Adder { all };
    for sampler in all_types(OpaqueKind::Sampler) {
        modern(&mut to, sampler);
    }
    legacy(&mut to);
    for image in all_types(OpaqueKind::Image) {
        images(&mut to, image);
    }
    for name in
        ["subpassInput", "isubpassInput", "usubpassInput", "subpassInputMS", "isubpassInputMS", "usubpassInputMS"]
    {
        let Some(input) = OpaqueType::of_vulkan(name).map(OpaqueType::sampled) else { continue };
        let params = [Type::Opaque(input), Type::INT];
        let count = if input.multisampled { 2 } else { 1 };
        to.add("subpassLoad", &params[..count], &Type::Vector(input.scalar, 4));
    }
}

/// Components of the coordinate of `texture`: layer and reference value included. A 1D shadow
/// look-up skips the second component. `samplerCubeArrayShadow` takes the reference by itself.
fn coordinate(s: OpaqueType) -> u8 {
    let n = s.coordinates() + u8::from(s.arrayed);
    match (s.shadow, s.dim) {
        (false, _) => n,
        (true, TextureDim::D1) => 3,
        (true, TextureDim::Cube) if s.arrayed => 4,
        (true, _) => n + 1,
    }
}

fn modern(to: &mut Adder<'_>, s: OpaqueType) {
    let sampler = Type::Opaque(s);
    let texel = Type::Vector(s.scalar, 4);
    let result = if s.shadow { Type::FLOAT } else { texel.clone() };
    let n = s.coordinates();
    let mipmapped = !s.multisampled && !matches!(s.dim, TextureDim::Rect | TextureDim::Buffer);
    // Sizes: with a level where there are levels.
    let size_n = match s.dim {
        TextureDim::Cube => 2,
        _ => n,
    } + u8::from(s.arrayed);
    if mipmapped {
        to.add("textureSize", &[sampler.clone(), Type::INT], &ints(size_n));
        to.add("textureQueryLevels", std::slice::from_ref(&sampler), &Type::INT);
        to.add("textureQueryLod", &[sampler.clone(), floats(n)], &Type::VEC2);
    } else {
        to.add("textureSize", std::slice::from_ref(&sampler), &ints(size_n));
    }
    if s.multisampled {
        to.add("textureSamples", std::slice::from_ref(&sampler), &Type::INT);
    }
    // Texel fetches.
    let texel_at = ints(n + u8::from(s.arrayed));
    if !s.shadow && s.dim != TextureDim::Cube {
        let mut params = vec![sampler.clone(), texel_at];
        if mipmapped || s.multisampled {
            params.push(Type::INT);
        }
        to.add("texelFetch", &params, &texel);
        if !s.multisampled && s.dim != TextureDim::Buffer {
            params.push(ints(n));
            to.add("texelFetchOffset", &params, &texel);
        }
    }
    if s.multisampled || s.dim == TextureDim::Buffer {
        return;
    }
    let cube_array_shadow = s.shadow && s.arrayed && s.dim == TextureDim::Cube;
    let mut base = vec![sampler.clone(), floats(coordinate(s))];
    if cube_array_shadow {
        base.push(Type::FLOAT);
    }
    let bias: &[Type] = if mipmapped && !cube_array_shadow { &[Type::FLOAT] } else { &[] };
    sample(to, "texture", &base, bias, &result);
    let offsets = s.dim != TextureDim::Cube;
    let with = |base: &[Type], more: &[Type]| [base, more].concat();
    let grad = floats(n);
    if offsets {
        sample(to, "textureOffset", &with(&base, &[ints(n)]), bias, &result);
    }
    if mipmapped && !cube_array_shadow {
        to.add("textureLod", &with(&base, &[Type::FLOAT]), &result);
        if offsets {
            to.add("textureLodOffset", &with(&base, &[Type::FLOAT, ints(n)]), &result);
        }
    }
    to.add("textureGrad", &with(&base, &[grad.clone(), grad.clone()]), &result);
    if offsets {
        to.add("textureGradOffset", &with(&base, &[grad.clone(), grad.clone(), ints(n)]), &result);
    }
    if !s.arrayed && s.dim != TextureDim::Cube {
        // Projective: one more component, or always four.
        let sizes: &[u8] = if s.shadow || s.dim == TextureDim::D3 { &[4] } else { &[n + 1, 4] };
        for (i, size) in sizes.iter().enumerate() {
            if i == 1 && sizes[0] == 4 {
                continue;
            }
            let base = vec![sampler.clone(), floats(*size)];
            sample(to, "textureProj", &base, bias, &result);
            sample(to, "textureProjOffset", &with(&base, &[ints(n)]), bias, &result);
            if mipmapped {
                to.add("textureProjLod", &with(&base, &[Type::FLOAT]), &result);
                to.add("textureProjLodOffset", &with(&base, &[Type::FLOAT, ints(n)]), &result);
            }
            to.add("textureProjGrad", &with(&base, &[grad.clone(), grad.clone()]), &result);
            to.add("textureProjGradOffset", &with(&base, &[grad.clone(), grad.clone(), ints(n)]), &result);
        }
    }
    if matches!(s.dim, TextureDim::D2 | TextureDim::Cube | TextureDim::Rect) {
        let mut base = vec![sampler, floats(n + u8::from(s.arrayed))];
        let component: &[Type] = if s.shadow { &[] } else { &[Type::INT] };
        if s.shadow {
            base.push(Type::FLOAT);
        }
        sample(to, "textureGather", &base, component, &texel);
        if offsets {
            sample(to, "textureGatherOffset", &with(&base, &[ints(2)]), component, &texel);
            sample(to, "textureGatherOffsets", &with(&base, &[ints(2).array(4)]), component, &texel);
        }
    }
}

fn sample(to: &mut Adder<'_>, name: &'static str, params: &[Type], last: &[Type], result: &Type) {
    if last.is_empty() { to.add(name, params, result) } else { to.optional(name, params, last, result) }
}

/// The functions of GLSL 1.20 and of the extensions around it.
fn legacy(to: &mut Adder<'_>) {
    let sampler = |name: &str| Type::from_name(name).unwrap_or(Type::Error);
    // Name, projective name, sampler, size of the coordinate, sizes of the projective coordinate.
    let rows: &[(&'static str, &'static str, &str, u8, &[u8])] = &[
        ("texture1D", "texture1DProj", "sampler1D", 1, &[2, 4]),
        ("texture2D", "texture2DProj", "sampler2D", 2, &[3, 4]),
        ("texture3D", "texture3DProj", "sampler3D", 3, &[4]),
        ("textureCube", "", "samplerCube", 3, &[]),
        ("shadow1D", "shadow1DProj", "sampler1DShadow", 3, &[4]),
        ("shadow2D", "shadow2DProj", "sampler2DShadow", 3, &[4]),
    ];
    for (name, projective, ty, n, sizes) in rows {
        let ty = sampler(ty);
        to.optional(name, &[ty.clone(), floats(*n)], &[Type::FLOAT], &Type::VEC4);
        for size in *sizes {
            to.optional(projective, &[ty.clone(), floats(*size)], &[Type::FLOAT], &Type::VEC4);
        }
    }
    let lods: &[(&'static str, &str, &[u8])] = &[
        ("texture1DLod", "sampler1D", &[1]),
        ("texture1DProjLod", "sampler1D", &[2, 4]),
        ("texture2DLod", "sampler2D", &[2]),
        ("texture2DLodEXT", "sampler2D", &[2]),
        ("texture2DProjLod", "sampler2D", &[3, 4]),
        ("texture3DLod", "sampler3D", &[3]),
        ("texture3DProjLod", "sampler3D", &[4]),
        ("textureCubeLod", "samplerCube", &[3]),
        ("textureCubeLodEXT", "samplerCube", &[3]),
        ("shadow1DLod", "sampler1DShadow", &[3]),
        ("shadow1DProjLod", "sampler1DShadow", &[4]),
        ("shadow2DLod", "sampler2DShadow", &[3]),
        ("shadow2DProjLod", "sampler2DShadow", &[4]),
    ];
    for (name, ty, sizes) in lods {
        for size in *sizes {
            to.add(name, &[sampler(ty), floats(*size), Type::FLOAT], &Type::VEC4);
        }
    }
    for (name, ty, n) in [
        ("texture1DGradARB", "sampler1D", 1),
        ("texture2DGradARB", "sampler2D", 2),
        ("texture2DGradEXT", "sampler2D", 2),
        ("texture3DGradARB", "sampler3D", 3),
        ("textureCubeGradARB", "samplerCube", 3),
        ("textureCubeGradEXT", "samplerCube", 3),
    ] {
        to.add(name, &[sampler(ty), floats(n), floats(n), floats(n)], &Type::VEC4);
    }
    to.add("texture2DRect", &[sampler("sampler2DRect"), Type::VEC2], &Type::VEC4);
    to.add("texture2DRectProj", &[sampler("sampler2DRect"), Type::VEC3], &Type::VEC4);
    to.add("texture2DRectProj", &[sampler("sampler2DRect"), Type::VEC4], &Type::VEC4);
    to.add("shadow2DRect", &[sampler("sampler2DRectShadow"), Type::VEC3], &Type::VEC4);
    to.add("shadow2DRectProj", &[sampler("sampler2DRectShadow"), Type::VEC4], &Type::VEC4);
    to.optional("texture2DArray", &[sampler("sampler2DArray"), Type::VEC3], &[Type::FLOAT], &Type::VEC4);
    to.optional("texture1DArray", &[sampler("sampler1DArray"), Type::VEC2], &[Type::FLOAT], &Type::VEC4);
}

fn images(to: &mut Adder<'_>, i: OpaqueType) {
    let image = Type::Opaque(i);
    let texel = Type::Vector(i.scalar, 4);
    // A cube image is addressed by face as its third coordinate.
    let n = match i.dim {
        TextureDim::Cube => 3,
        _ => i.coordinates() + u8::from(i.arrayed),
    };
    let size_n = match i.dim {
        TextureDim::Cube => 2 + u8::from(i.arrayed),
        _ => n,
    };
    let mut base = vec![image.clone(), ints(n)];
    if i.multisampled {
        base.push(Type::INT);
        to.add("imageSamples", std::slice::from_ref(&image), &Type::INT);
    }
    to.add("imageSize", &[image], &ints(size_n));
    to.add("imageLoad", &base, &texel);
    to.add("imageStore", &[base.as_slice(), &[texel]].concat(), &Type::Void);
    let scalar = Type::Scalar(i.scalar);
    let data = [base.as_slice(), std::slice::from_ref(&scalar)].concat();
    to.add("imageAtomicExchange", &data, &scalar);
    if i.scalar.is_integer() {
        for name in
            ["imageAtomicAdd", "imageAtomicMin", "imageAtomicMax", "imageAtomicAnd", "imageAtomicOr", "imageAtomicXor"]
        {
            to.add(name, &data, &scalar);
        }
        to.add("imageAtomicCompSwap", &[data.as_slice(), std::slice::from_ref(&scalar)].concat(), &scalar);
    }
}

#[cfg(test)]
mod tests {
    use super::super::functions::functions;
    use super::*;

    fn has(name: &str, params: &[&str], result: &str) -> bool {
        let params: Vec<_> = params.iter().map(|p| (Direction::In, Type::from_name(p).unwrap())).collect();
        let result = Type::from_name(result).unwrap();
        functions(name).iter().any(|s| s.params == params && s.result == result)
    }

    #[test]
    fn coordinates_follow_the_sampler() {
        assert!(has("texture", &["sampler2D", "vec2"], "vec4"));
        assert!(has("texture", &["sampler2D", "vec2", "float"], "vec4"));
        assert!(has("texture", &["usampler2DArray", "vec3"], "uvec4"));
        assert!(has("texture", &["sampler2DShadow", "vec3"], "float"));
        assert!(has("texture", &["sampler1DShadow", "vec3"], "float"));
        assert!(has("texture", &["samplerCubeArrayShadow", "vec4", "float"], "float"));
        assert!(!has("texture", &["sampler2D", "vec3"], "vec4"));
        assert!(has("texelFetch", &["isamplerBuffer", "int"], "ivec4"));
        assert!(has("texelFetch", &["sampler2DMS", "ivec2", "int"], "vec4"));
        assert!(has("textureSize", &["samplerCube", "int"], "ivec2"));
        assert!(has("textureProj", &["sampler2D", "vec4"], "vec4"));
        assert!(has("textureGather", &["sampler2DShadow", "vec2", "float"], "vec4"));
        assert!(has("texture2D", &["sampler2D", "vec2"], "vec4"));
        assert!(has("imageStore", &["uimage2D", "ivec2", "uvec4"], "void"));
    }
}
