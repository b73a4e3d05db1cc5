//! Samplers and images: what an expression names, and lookups (GLSL 4.60, 8.9; GLSL 1.20, 8.7).

use std::sync::Arc;

use naga::{
    AddressSpace, BinaryOperator as B, Expression, GlobalVariable, Handle, ImageClass, ImageDimension, ImageQuery,
    ResourceBinding, ScalarKind, TypeInner,
};

use super::function::{Fun, Val};
use super::image::{ImageLayout, sized_format, storage_format};
use super::place::{Lvalue, Var};
use super::{Build, Expr, Result};
use crate::texture::{Image, TextureKind};
use crate::{Texture as Supplied, binding};
use base::text::Span;
use syntax::BuiltinFunction as F;
use syntax::ast::{ExprId, ExprKind};
use syntax::symbols::CallTarget;
use syntax::types::{OpaqueKind, OpaqueType, ScalarType, TextureDim, Type};

/// Where the numbers of a structure with samplers lie: a variable, and the indices on the way in. It
/// means the same in every function.
#[derive(Clone, Debug)]
pub(super) struct Data {
    pub variable: Handle<GlobalVariable>,
    pub path: Vec<u32>,
}

impl Data {
    fn inside(mut self, index: u32) -> Self {
        self.path.push(index);
        self
    }
}

/// A uniform that holds a sampler or image, or a part of one.
#[derive(Clone, Debug)]
pub(super) struct Opaque {
    /// The way there, such as `material.diffuse` or `maps[2]`.
    pub key: String,
    /// What it is.
    pub ty: Type,
    /// The rest of a structure that holds more than samplers.
    pub data: Option<Data>,
    /// Format and access of an image.
    pub image: ImageLayout,
}

/// A texture with its sampler.
#[derive(Clone, Copy, Debug)]
pub(super) struct Texture {
    pub image: Handle<GlobalVariable>,
    pub sampler: Option<Handle<GlobalVariable>>,
}

fn kind(scalar: ScalarType) -> ScalarKind {
    super::types::scalar(scalar).kind
}

impl Build<'_> {
    /// The variables of a sampler or image, made when it is first used.
    pub(super) fn texture(&mut self, opaque: &Opaque, ty: OpaqueType, span: Span) -> Result<Texture> {
        if let Some(texture) = self.made.textures.get(&opaque.key) {
            return Ok(*texture);
        }
        let dim = match ty.dim {
            TextureDim::D1 => ImageDimension::D1,
            TextureDim::D2 | TextureDim::Rect | TextureDim::Subpass => ImageDimension::D2,
            TextureDim::D3 => ImageDimension::D3,
            TextureDim::Cube => ImageDimension::Cube,
            TextureDim::Buffer => return Err(self.unsupported(span, format!("`{ty}`"), "use a storage buffer")),
        };
        // What is run has the samples of a pixel in layers: the harness draws into no texture.
        let layered = self.run && ty.multisampled && !ty.arrayed && ty.kind == OpaqueKind::Sampler;
        self.differs |= layered;
        if layered && self.shader.stage() != syntax::Stage::Fragment {
            self.stand_for(span, format!("`{ty}` outside of a fragment shader"), "translate a fragment shader")?;
        }
        if ty.dim == TextureDim::Subpass {
            self.stand_for(span, "an input attachment", "use a texture, and read it at `gl_FragCoord`")?;
        }
        let multi = ty.multisampled && !layered;
        let class = match ty.kind {
            OpaqueKind::Sampler if ty.shadow => ImageClass::Depth { multi },
            OpaqueKind::Sampler => ImageClass::Sampled { kind: kind(ty.scalar), multi },
            OpaqueKind::Image => {
                let format = match (opaque.image.format.as_deref(), ty.scalar) {
                    (Some(format), scalar) => storage_format(sized_format(format, scalar)),
                    // What is only written takes any format (GLSL 4.60, 4.4.6.2), and so does all with the extension: the
                    // widest one loses nothing.
                    (None, _) if opaque.image.reads && !super::image::loads_any_format(self.shader) => None,
                    (None, ScalarType::Int) => Some(naga::StorageFormat::Rgba32Sint),
                    (None, ScalarType::Uint) => Some(naga::StorageFormat::Rgba32Uint),
                    (None, _) => Some(naga::StorageFormat::Rgba32Float),
                };
                let Some(format) = format else {
                    let message = format!("`{ty}` without a format");
                    return Err(self.unsupported(span, message, "write `layout(rgba8)` or another format"));
                };
                let mut access = naga::StorageAccess::empty();
                access.set(naga::StorageAccess::LOAD, opaque.image.reads);
                access.set(naga::StorageAccess::STORE, opaque.image.writes);
                if dim == ImageDimension::Cube || ty.multisampled {
                    return Err(self.unsupported(span, format!("`{ty}` that is written"), "use a two-dimensional one"));
                }
                ImageClass::Storage { format, access }
            }
            OpaqueKind::AtomicCounter => {
                return Err(self.unsupported(span, "an atomic counter", "use a number in a storage buffer"));
            }
        };
        let image = self.insert(None, TypeInner::Image { dim, arrayed: ty.arrayed || layered, class });
        let name: String =
            opaque.key.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect::<String>();
        let image = self.with_binding(name.trim_end_matches('_'), AddressSpace::Handle, image);
        let sampled = ty.kind == OpaqueKind::Sampler && !ty.multisampled && ty.dim != TextureDim::Subpass;
        let sampler = sampled.then(|| {
            let ty = self.insert(None, TypeInner::Sampler { comparison: ty.shadow });
            self.with_binding(&format!("{name}_sampler"), AddressSpace::Handle, ty)
        });
        match TextureKind::of(dim, ty.arrayed || layered, class) {
            Some(kind) => {
                let contents = Arc::new(Image::procedural(&opaque.key, kind));
                self.ports.bound.push(Supplied { name: opaque.key.clone(), kind, image, sampler, contents });
            }
            None => self.ports.unfed.push((format!("`{}` of type `{ty}`", opaque.key), span)),
        }
        let texture = Texture { image, sampler };
        self.made.textures.insert(opaque.key.clone(), texture);
        Ok(texture)
    }

    /// A global variable with the next free binding.
    pub(super) fn with_binding(
        &mut self,
        name: &str,
        space: AddressSpace,
        ty: Handle<naga::Type>,
    ) -> Handle<GlobalVariable> {
        // Kernels fill uniforms themselves; what they hand on to the device has a group of its own.
        let group = if space == AddressSpace::Uniform { 0 } else { binding::TEXTURES };
        let binding = ResourceBinding { group, binding: self.ports.next_binding };
        self.ports.next_binding += 1;
        super::super::capture::add_global(&mut self.module, name, space, Some(binding), ty)
    }
}

impl Fun<'_, '_> {
    /// The sampler, image or structure with one inside that an expression names.
    pub(super) fn opaque(&mut self, id: ExprId) -> Result<Option<Opaque>> {
        let expr = self.shader.expr(id);
        let found = match &expr.kind {
            ExprKind::Name(name) => match self.variable(id, name, expr.span)? {
                Var::Opaque(opaque) => Some(opaque),
                Var::Place(_) | Var::Value(_) => None,
            },
            ExprKind::Paren(inner) => self.opaque(*inner)?,
            ExprKind::Field { base, field } => {
                let Some(opaque) = self.opaque(*base)? else { return Ok(None) };
                let Type::Struct(s) = &opaque.ty else { return Ok(None) };
                let Some(member) = s.fields.iter().find(|f| f.name == field.name) else { return Ok(None) };
                let ty = member.ty.clone();
                if !ty.contains_opaque() {
                    return Ok(None);
                }
                let data = match (opaque.data, Build::member_index(s, &field.name)) {
                    (Some(data), Some(index)) if super::types::has_data(&ty) => Some(data.inside(index)),
                    _ => None,
                };
                Some(Opaque { key: format!("{}.{}", opaque.key, field.name), ty, data, image: opaque.image })
            }
            ExprKind::Index { base, index } => {
                let Some(opaque) = self.opaque(*base)? else { return Ok(None) };
                let Some(ty) = opaque.ty.indexed() else { return Ok(None) };
                let Some(k) = self.constant_index(*index) else {
                    return Err(self.build.unsupported(
                        expr.span,
                        "an array of samplers with a computed index",
                        "use numbers as indices",
                    ));
                };
                let data = opaque.data.map(|data| data.inside(k));
                Some(Opaque { key: format!("{}[{k}]", opaque.key), ty, data, image: opaque.image })
            }
            // `sampler2D(texture, sampler)` of Vulkan: which sampler it is, the host states.
            ExprKind::Call { callee: _, args } if args.len() == 2 => match self.shader.callee(id) {
                Some(CallTarget::Constructor(ty @ Type::Opaque(made))) => self.opaque(args[0])?.map(|texture| {
                    // One texture is read with and without comparisons: these are two kinds.
                    let key = if made.shadow { format!("{}.shadow", texture.key) } else { texture.key };
                    Opaque { key, ty: ty.clone(), ..texture }
                }),
                _ => None,
            },
            _ => None,
        };
        Ok(found)
    }

    /// The numbers of a structure with samplers, in this function.
    pub(super) fn data_place(&mut self, opaque: &Opaque) -> Option<Lvalue> {
        let data = opaque.data.as_ref()?;
        let mut place = self.whole(data.variable, opaque.ty.clone());
        for &index in &data.path {
            place.host = match self.build.members(place.host).get(index as usize) {
                Some(&member) => member,
                None => self.build.element(place.host),
            };
            place.ptr = self.add(Expression::AccessIndex { base: place.ptr, index });
        }
        Some(place)
    }

    /// A call of a function of textures or images: `None` when it is no such function, else its value.
    pub(super) fn texture_call(
        &mut self,
        id: ExprId,
        function: F,
        args: &[ExprId],
        span: Span,
    ) -> Result<Option<Option<Val>>> {
        let family = ["texture", "texel", "shadow", "image", "atomicCounter", "subpass"];
        if !family.iter().any(|f| function.name().starts_with(f)) {
            return Ok(None);
        }
        let Some(&first) = args.first() else { return Ok(None) };
        if let Some(index) = self.computed_index(first) {
            let ty = self.shader.type_of(id).clone();
            return self.choose(&ty, index, &mut |f| f.builtin(id, function, args, span)).map(Some);
        }
        let Some(opaque) = self.opaque(first)? else { return Ok(None) };
        let Type::Opaque(ty) = opaque.ty else { return Ok(None) };
        if self.build.is_buffer(&opaque, ty) {
            let mut rest = Vec::new();
            for &arg in &args[1..] {
                rest.push(Some(self.expression(arg)?));
            }
            return self.buffer_call(plain_name(function), &opaque, ty, &rest, self.shader.expr(first).span).map(Some);
        }
        let texture = self.build.texture(&opaque, ty, self.shader.expr(first).span)?;
        let image = self.add(Expression::GlobalVariable(texture.image));
        let sampler = texture.sampler.map(|s| self.add(Expression::GlobalVariable(s)));
        let mut rest = Vec::new();
        let offset_at = offset_argument(function, ty.shadow, args.len());
        for (k, &arg) in args.iter().enumerate().skip(1) {
            // Offsets are constants, and are read as such.
            let constant = Some(k) == offset_at && function != F::TexelFetchOffset;
            rest.push(if constant { None } else { Some(self.expression(arg)?) });
        }
        let value = |k: usize| rest.get(k).cloned().flatten();
        let want = self.shader.type_of(id).clone();
        let plain = plain_name(function);
        if plain.name().starts_with("image") {
            return self.image_call(plain, ty, image, &rest, span);
        }
        let result = match plain {
            F::TextureSize => self.size(ty, image, value(0))?,
            F::TextureQueryLevels => self.query(image, ImageQuery::NumLevels)?,
            F::TextureSamples if self.is_layered(ty) => self.query(image, ImageQuery::NumLayers)?,
            F::TextureSamples => self.query(image, ImageQuery::NumSamples)?,
            F::SubpassLoad => self.subpass(ty, image, value(0), span)?,
            F::TextureQueryLod => {
                return Err(self.build.unsupported(span, "`textureQueryLod`", "compute the level of detail"));
            }
            F::TexelFetch | F::TexelFetchOffset => self.fetch(plain, ty, image, &rest, span)?,
            F::TextureGatherOffsets => {
                let Some(offsets) = offset_at.and_then(|k| self.four_offsets(args[k])) else {
                    return Err(self.build.unsupported(span, "offsets that are computed", "write numbers"));
                };
                // Of each footprint the texel at its origin is meant, which a gather gives last (GLSL 4.60, 8.9.4).
                let mut parts = Vec::new();
                for offset in offsets {
                    let offset = Some(self.offset_of(&offset)?);
                    let texels = self.sample(F::TextureGatherOffset, ty, image, sampler, &rest, offset, span)?;
                    parts.push(self.part(texels.e, 3));
                }
                self.compose(&Type::Vector(ty.scalar, 4), parts)?
            }
            _ => {
                let offset = match offset_at {
                    Some(k) => Some(self.constant_offset(args[k])?),
                    None => None,
                };
                self.sample(plain, ty, image, sampler, &rest, offset, span)?
            }
        };
        // The old functions give four numbers where the new ones give one.
        let result = match (&result.ty, &want) {
            (Type::Scalar(_), Type::Vector(s, 4)) => {
                let one = self.number(*s, 1.0);
                self.compose(&Type::Vector(*s, 4), vec![result.e, result.e, result.e, one])?
            }
            _ => result,
        };
        Ok(Some(Some(result)))
    }

    fn query(&mut self, image: Expr, query: ImageQuery) -> Result<Val> {
        let e = self.add(Expression::ImageQuery { image, query });
        self.cast(Val { e, ty: Type::UINT }, ScalarType::Uint, ScalarType::Int)
    }

    pub(super) fn size(&mut self, ty: OpaqueType, image: Expr, level: Option<Val>) -> Result<Val> {
        let n = match ty.dim {
            TextureDim::Cube => 2,
            _ => ty.coordinates(),
        };
        let level = match level {
            Some(level) => Some(self.convert(level, &Type::INT)?.e),
            None => None,
        };
        let e = self.add(Expression::ImageQuery { image, query: ImageQuery::Size { level } });
        let mut value = Val { e, ty: Type::vector(ScalarType::Uint, n) };
        if ty.arrayed {
            let layers = self.add(Expression::ImageQuery { image, query: ImageQuery::NumLayers });
            value = self.compose(&Type::Vector(ScalarType::Uint, n + 1), vec![value.e, layers])?;
        }
        self.cast(value, ScalarType::Uint, ScalarType::Int)
    }

    /// The coordinates of a texel, and its layer.
    pub(super) fn texel(&mut self, ty: OpaqueType, at: &Val) -> Result<(Val, Option<Expr>)> {
        let n = ty.coordinates();
        let coordinates = self.swizzle(at, &(0..n).collect::<Vec<_>>())?;
        let layer = if ty.arrayed { Some(self.part(at.e, u32::from(n))) } else { None };
        Ok((coordinates, layer))
    }

    fn fetch(&mut self, function: F, ty: OpaqueType, image: Expr, rest: &[Option<Val>], span: Span) -> Result<Val> {
        let value = |k: usize| rest.get(k).cloned().flatten();
        let Some(at) = value(0) else {
            return Err(self.build.unsupported(span, format!("`{function}` like this"), "give it a coordinate"));
        };
        let (mut at, array_index) = self.texel(ty, &at)?;
        if function == F::TexelFetchOffset
            && let Some(offset) = value(rest.len() - 1)
        {
            let e = self.add(Expression::Binary { op: B::Add, left: at.e, right: offset.e });
            at = Val { e, ty: at.ty };
        }
        let second = value(1).map(|v| v.e);
        if let Some(sample) = second.filter(|_| self.is_layered(ty)) {
            return self.sample_in_layer(ty, image, at, sample);
        }
        let (sample, level) = match (ty.multisampled, ty.dim) {
            (true, _) => (second, None),
            (false, TextureDim::Rect) => (None, Some(self.i32(0))),
            (false, _) => (None, Some(second.unwrap_or_else(|| self.i32(0)))),
        };
        let e = self.add(Expression::ImageLoad { image, coordinate: at.e, array_index, sample, level });
        Ok(Val { e, ty: Type::Vector(ty.scalar, 4) })
    }

    /// Whether the samples of a texture are its layers.
    fn is_layered(&self, ty: OpaqueType) -> bool {
        self.build.run && ty.multisampled && !ty.arrayed
    }

    /// A sample of a pixel, the last one for numbers behind it: how many there are, the host says.
    fn sample_in_layer(&mut self, ty: OpaqueType, image: Expr, at: Val, sample: Expr) -> Result<Val> {
        let count = self.query(image, ImageQuery::NumLayers)?;
        let one = self.i32(1);
        let last = self.add(Expression::Binary { op: B::Subtract, left: count.e, right: one });
        let layer = self.math(naga::MathFunction::Min, &[sample, last]);
        self.texel_of(ty, image, at, Some(layer))
    }

    /// A texel of the first level.
    pub(super) fn texel_of(&mut self, ty: OpaqueType, image: Expr, at: Val, layer: Option<Expr>) -> Result<Val> {
        let level = Some(self.i32(0));
        let e = self.add(Expression::ImageLoad { image, coordinate: at.e, array_index: layer, sample: None, level });
        Ok(Val { e, ty: Type::Vector(ty.scalar, 4) })
    }

    /// What an earlier subpass wrote to the pixel. No pixel lies outside of the attachment: where that of the harness is
    /// smaller, it repeats.
    fn subpass(&mut self, ty: OpaqueType, image: Expr, sample: Option<Val>, span: Span) -> Result<Val> {
        let pixel = self.state("gl_FragCoord", span)?;
        let pixel = self.swizzle(&pixel, &[0, 1])?;
        let mut at = self.cast(pixel, ScalarType::Float, ScalarType::Int)?;
        let level = Some(self.i32(0));
        let size = self.add(Expression::ImageQuery { image, query: ImageQuery::Size { level } });
        let plain = self.cast(at, ScalarType::Int, ScalarType::Uint)?;
        let e = self.add(Expression::Binary { op: B::Modulo, left: plain.e, right: size });
        at = self.cast(Val { e, ty: plain.ty }, ScalarType::Uint, ScalarType::Int)?;
        match sample {
            Some(sample) => self.sample_in_layer(ty, image, at, sample.e),
            None => self.texel_of(ty, image, at, None),
        }
    }

    /// `ivec2(1, -1)` and the like, as naga wants it: with numbers alone.
    fn constant_offset(&mut self, id: ExprId) -> Result<Expr> {
        let Some(numbers) = self.integers(id) else {
            let span = self.shader.expr(id).span;
            return Err(self.build.unsupported(span, "an offset that is computed", "write numbers"));
        };
        self.offset_of(&numbers)
    }

    /// The numbers of a constant array of four offsets.
    fn four_offsets(&self, id: ExprId) -> Option<Vec<Vec<i32>>> {
        let (ExprKind::Call { args: items, .. } | ExprKind::List(items)) = &self.shader.expr(id).kind else {
            let ExprKind::Name(_) = self.shader.expr(id).kind else { return None };
            return self.four_offsets(self.build.initializer(self.shader.symbol_of(id)?)?);
        };
        let all: Option<Vec<Vec<i32>>> = items.iter().map(|&item| self.integers(item)).collect();
        all.filter(|all| all.len() == 4)
    }

    fn offset_of(&mut self, numbers: &[i32]) -> Result<Expr> {
        let parts: Vec<Expr> = numbers.iter().map(|&n| self.i32(n)).collect();
        match parts[..] {
            [only] => Ok(only),
            _ => {
                let n = u8::try_from(parts.len()).unwrap_or(4);
                Ok(self.compose(&Type::Vector(ScalarType::Int, n), parts)?.e)
            }
        }
    }

    /// The numbers of a constant vector.
    fn integers(&self, id: ExprId) -> Option<Vec<i32>> {
        if let Some(constant) = self.shader.fold(id) {
            // `ivec2(1.0, 0.0)` takes the whole part.
            #[expect(clippy::cast_possible_truncation, reason = "a constructor of integers truncates")]
            let n = constant.as_integer().or_else(|| constant.as_f64().map(|v| v.trunc() as i64));
            return Some(vec![i32::try_from(n?).ok()?]);
        }
        match &self.shader.expr(id).kind {
            ExprKind::Paren(inner) => self.integers(*inner),
            ExprKind::Call { args, .. } => {
                let n = self.shader.type_of(id).components()?;
                let mut all = Vec::new();
                for &arg in args {
                    all.extend(self.integers(arg)?);
                }
                if all.len() == 1 {
                    all = vec![all[0]; n];
                }
                (all.len() == n).then_some(all)
            }
            ExprKind::Unary { op: syntax::ast::UnaryOp::Minus, operand, .. } => {
                Some(self.integers(*operand)?.into_iter().map(i32::wrapping_neg).collect())
            }
            ExprKind::Name(_) => self.integers(self.build.initializer(self.shader.symbol_of(id)?)?),
            ExprKind::Field { base, field } => {
                let all = self.integers(*base)?;
                super::place::components(&field.name)?.iter().map(|&k| all.get(usize::from(k)).copied()).collect()
            }
            _ => None,
        }
    }
}

/// The type of a variable or a part of it, with the sizes that are known.
pub(super) fn argument_of(build: &Build<'_>, id: ExprId) -> Option<Type> {
    match &build.shader.expr(id).kind {
        ExprKind::Name(_) => {
            let symbol = build.shader.symbol_of(id)?;
            Some(build.with_size(symbol, &build.shader.symbol(symbol).ty))
        }
        _ => Some(build.shader.type_of(id).clone()),
    }
}

/// `texture2DProjLodEXT` and the like without dimension and suffix.
fn plain_name(function: F) -> F {
    let name = function.name();
    let name = name.strip_suffix("ARB").or_else(|| name.strip_suffix("EXT")).unwrap_or(name);
    for old in ["texture", "shadow"] {
        let Some(rest) = name.strip_prefix(old) else { continue };
        for dim in ["1DArray", "2DArray", "2DRect", "1D", "2D", "3D", "Cube"] {
            if let Some(rest) = rest.strip_prefix(dim) {
                return F::from_name(&format!("texture{rest}")).unwrap_or(function);
            }
        }
    }
    function
}

/// Which argument is a constant offset.
fn offset_argument(function: F, shadow: bool, count: usize) -> Option<usize> {
    let name = function.name();
    if !name.contains("Offset") {
        return None;
    }
    // The bias of `textureOffset` and the component of `textureGatherOffset` stand behind it.
    let fixed = if name.contains("Grad") {
        4
    } else if name.contains("Lod") {
        3
    } else if name.starts_with("texelFetch") {
        count - 1
    } else if name.contains("Gather") && shadow {
        // Behind the reference value.
        3
    } else {
        2
    };
    (fixed < count).then_some(fixed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_names_lose_their_dimension() {
        for (name, plain) in [
            ("texture2D", "texture"),
            ("shadow2DProj", "textureProj"),
            ("textureCubeLodEXT", "textureLod"),
            ("texture2DArray", "texture"),
            ("texture2DGradARB", "textureGrad"),
            ("textureProjOffset", "textureProjOffset"),
            ("texelFetch", "texelFetch"),
        ] {
            assert_eq!(plain_name(F::from_name(name).unwrap()).name(), plain);
        }
    }
}
