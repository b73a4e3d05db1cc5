//! Samplers and images: what an expression names, and lookups (GLSL 4.60, 8.9; GLSL 1.20, 8.7).

use naga::{
    AddressSpace, BinaryOperator as B, Expression, GlobalVariable, Handle, ImageClass, ImageDimension, ImageQuery,
    MathFunction, ResourceBinding, SampleLevel, ScalarKind, SwizzleComponent, TypeInner,
};

use super::function::{Fun, Val};
use super::image::{ImageLayout, storage_format};
use super::place::{Place, Var};
use super::{Build, Expr, Result};
use crate::glsl::Stage;
use crate::glsl::ast::{ExprId, ExprKind};
use crate::glsl::types::{OpaqueKind, OpaqueType, ScalarType, TextureDim, Type};
use crate::text::Span;

/// Group in which textures and storage are bound: the harness keeps the first two.
pub(super) const GROUP: u32 = 2;

/// A uniform that holds a sampler or image, or a part of one.
#[derive(Clone, Debug)]
pub(super) struct Opaque {
    /// The way there, such as `material.diffuse` or `maps[2]`.
    pub key: String,
    /// What it is.
    pub ty: Type,
    /// The rest of a structure that holds more than samplers.
    pub data: Option<Place>,
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
        if let Some(texture) = self.textures.get(&opaque.key) {
            return Ok(*texture);
        }
        let dim = match ty.dim {
            TextureDim::D1 => ImageDimension::D1,
            TextureDim::D2 | TextureDim::Rect => ImageDimension::D2,
            TextureDim::D3 => ImageDimension::D3,
            TextureDim::Cube => ImageDimension::Cube,
            TextureDim::Buffer => {
                let message = format!("`{ty}`: a texture that is a buffer");
                return Err(self.unsupported(span, message, "use a storage buffer"));
            }
        };
        let class = match ty.kind {
            OpaqueKind::Sampler if ty.shadow => ImageClass::Depth { multi: ty.multisampled },
            OpaqueKind::Sampler => ImageClass::Sampled { kind: kind(ty.scalar), multi: ty.multisampled },
            OpaqueKind::Image => {
                let Some(format) = opaque.image.format.as_deref().and_then(storage_format) else {
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
        let image = self.insert(None, TypeInner::Image { dim, arrayed: ty.arrayed, class });
        let name: String =
            opaque.key.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect::<String>();
        let image = self.bound(name.trim_end_matches('_'), AddressSpace::Handle, image);
        let sampled = ty.kind == OpaqueKind::Sampler && !ty.multisampled;
        let sampler = sampled.then(|| {
            let ty = self.insert(None, TypeInner::Sampler { comparison: ty.shadow });
            self.bound(&format!("{name}_sampler"), AddressSpace::Handle, ty)
        });
        let texture = Texture { image, sampler };
        self.textures.insert(opaque.key.clone(), texture);
        Ok(texture)
    }

    /// A global variable with the next free binding.
    pub(super) fn bound(&mut self, name: &str, space: AddressSpace, ty: Handle<naga::Type>) -> Handle<GlobalVariable> {
        let binding = ResourceBinding { group: GROUP, binding: self.next_binding };
        self.next_binding += 1;
        super::super::capture::add_global(&mut self.module, name, space, Some(binding), ty)
    }
}

/// What a lookup asks for.
struct Lookup {
    ty: OpaqueType,
    image: Expr,
    sampler: Option<Expr>,
    /// Coordinates of the texel or point.
    at: Val,
    layer: Option<Expr>,
    reference: Option<Expr>,
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
                let data = match opaque.data {
                    Some(place) if super::types::has_data(&ty) => self.field(place, &field.name, field.span)?,
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
                let data = match opaque.data {
                    Some(place) => {
                        let host = self.build.element(place.host);
                        let ptr = self.add(Expression::AccessIndex { base: place.ptr, index: k });
                        Some(Place { ptr, ty: ty.clone(), host, swizzle: None })
                    }
                    None => None,
                };
                Some(Opaque { key: format!("{}[{k}]", opaque.key), ty, data, image: opaque.image })
            }
            _ => None,
        };
        Ok(found)
    }

    /// A call of a function of textures or images: `None` when it is no such function, else its value.
    pub(super) fn texture_call(
        &mut self,
        id: ExprId,
        name: &str,
        args: &[ExprId],
        span: Span,
    ) -> Result<Option<Option<Val>>> {
        let family = ["texture", "texel", "shadow", "image"];
        if !family.iter().any(|f| name.starts_with(f)) {
            return Ok(None);
        }
        let Some(&first) = args.first() else { return Ok(None) };
        let Some(opaque) = self.opaque(first)? else { return Ok(None) };
        let Type::Opaque(ty) = opaque.ty else { return Ok(None) };
        let texture = self.build.texture(&opaque, ty, self.shader.expr(first).span)?;
        let image = self.add(Expression::GlobalVariable(texture.image));
        let sampler = texture.sampler.map(|s| self.add(Expression::GlobalVariable(s)));
        let mut rest = Vec::new();
        let offset_at = offset_argument(name, args.len());
        for (k, &arg) in args.iter().enumerate().skip(1) {
            // Offsets are constants, and are read as such.
            let constant = Some(k) == offset_at && !name.starts_with("texelFetch");
            rest.push(if constant { None } else { Some(self.expression(arg)?) });
        }
        let value = |k: usize| rest.get(k).cloned().flatten();
        let want = self.shader.type_of(id).clone();
        let plain = plain_name(name);
        if plain.starts_with("image") {
            return self.image_call(&plain, ty, image, &rest, span);
        }
        let result = match plain.as_str() {
            "textureSize" => self.size(ty, image, value(0))?,
            "textureQueryLevels" => self.query(image, ImageQuery::NumLevels)?,
            "textureSamples" => self.query(image, ImageQuery::NumSamples)?,
            "textureQueryLod" => {
                return Err(self.build.unsupported(span, "`textureQueryLod`", "compute the level of detail"));
            }
            n if n.starts_with("texelFetch") => self.fetch(n, ty, image, &rest, span)?,
            n => {
                let offset = match offset_at {
                    Some(k) => Some(self.constant_offset(args[k])?),
                    None => None,
                };
                self.sample(n, ty, image, sampler, &rest, offset, span)?
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

    fn fetch(&mut self, name: &str, ty: OpaqueType, image: Expr, rest: &[Option<Val>], span: Span) -> Result<Val> {
        let value = |k: usize| rest.get(k).cloned().flatten();
        let Some(at) = value(0) else {
            return Err(self.build.unsupported(span, format!("`{name}` like this"), "give it a coordinate"));
        };
        let (mut at, array_index) = self.texel(ty, &at)?;
        if name.ends_with("Offset")
            && let Some(offset) = value(rest.len() - 1)
        {
            let e = self.add(Expression::Binary { op: B::Add, left: at.e, right: offset.e });
            at = Val { e, ty: at.ty };
        }
        let second = value(1).map(|v| v.e);
        let (sample, level) = match (ty.multisampled, ty.dim) {
            (true, _) => (second, None),
            (false, TextureDim::Rect) => (None, Some(self.i32(0))),
            (false, _) => (None, Some(second.unwrap_or_else(|| self.i32(0)))),
        };
        let e = self.add(Expression::ImageLoad { image, coordinate: at.e, array_index, sample, level });
        Ok(Val { e, ty: Type::Vector(ty.scalar, 4) })
    }

    /// `ivec2(1, -1)` and the like, as naga wants it: with numbers alone.
    fn constant_offset(&mut self, id: ExprId) -> Result<Expr> {
        let Some(numbers) = self.integers(id) else {
            let span = self.shader.expr(id).span;
            return Err(self.build.unsupported(span, "an offset that is computed", "write numbers"));
        };
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
        if let Some(n) = self.shader.fold(id).and_then(|c| c.as_integer()) {
            return Some(vec![i32::try_from(n).ok()?]);
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
            ExprKind::Unary { op: crate::glsl::ast::UnaryOp::Minus, operand, .. } => {
                Some(self.integers(*operand)?.into_iter().map(i32::wrapping_neg).collect())
            }
            ExprKind::Name(_) => self.integers(self.build.initializer(self.shader.symbol_of(id)?)?),
            _ => None,
        }
    }

    #[expect(clippy::too_many_arguments, reason = "they are the parts of one call")]
    fn sample(
        &mut self,
        name: &str,
        ty: OpaqueType,
        image: Expr,
        sampler: Option<Expr>,
        rest: &[Option<Val>],
        offset: Option<Expr>,
        span: Span,
    ) -> Result<Val> {
        let has = |part: &str| name.contains(part);
        let floats = |f: &mut Self, v: Val| {
            let from = v.ty.scalar().unwrap_or(ScalarType::Float);
            f.cast(v, from, ScalarType::Float)
        };
        let Some(at) = rest.first().cloned().flatten() else {
            return Err(self.build.unsupported(span, format!("`{name}` like this"), "give it a coordinate"));
        };
        let at = floats(self, at)?;
        let mut next = 1;
        let mut take = |f: &mut Self| -> Result<Option<Val>> {
            let value = rest.get(next).cloned().flatten();
            next += 1;
            value.map(|v| floats(f, v)).transpose()
        };
        let gather = has("Gather");
        let mut lookup = self.lookup(ty, image, sampler, &at, has("Proj"), gather)?;
        if ty.shadow && lookup.reference.is_none() {
            lookup.reference = take(self)?.map(|v| v.e);
        }
        let mut level = if matches!(self.shader.stage(), Stage::Fragment | Stage::Library) {
            SampleLevel::Auto
        } else {
            // No other stage has derivatives: the first level is meant (GLSL 4.60, 8.9).
            SampleLevel::Zero
        };
        let mut component = None;
        if gather {
            let chosen = rest.get(if ty.shadow { 2 } else { 1 }).cloned().flatten().filter(|_| !ty.shadow);
            let chosen = chosen.map_or(Some(0), |v| match self.get(v.e) {
                Expression::Literal(naga::Literal::I32(n)) => usize::try_from(*n).ok(),
                _ => None,
            });
            let Some(pick) = chosen.and_then(|k| SwizzleComponent::XYZW.get(k)) else {
                return Err(self.build.unsupported(span, "a gathered component that is computed", "write a number"));
            };
            component = Some(*pick);
            level = SampleLevel::Zero;
        } else if has("Grad") {
            let (x, y) = (take(self)?, take(self)?);
            let (Some(x), Some(y)) = (x, y) else {
                return Err(self.build.unsupported(span, format!("`{name}` like this"), "give it two derivatives"));
            };
            level = SampleLevel::Gradient { x: x.e, y: y.e };
        } else if has("Lod") {
            if let Some(lod) = take(self)? {
                level = SampleLevel::Exact(lod.e);
            }
        } else if let Some(Some(bias)) =
            rest.iter().skip(1 + usize::from(ty.shadow && self.separate(ty))).find(|v| v.is_some())
        {
            let bias = floats(self, bias.clone())?;
            if !matches!(level, SampleLevel::Zero) {
                level = SampleLevel::Bias(bias.e);
            }
        }
        if ty.scalar != ScalarType::Float && !gather {
            let message = format!("`{name}` of a `{ty}`");
            return Err(self.build.unsupported(span, message, "use `texelFetch`"));
        }
        if lookup.reference.is_some() && !matches!(level, SampleLevel::Auto | SampleLevel::Zero) {
            let zero = match level {
                SampleLevel::Exact(e) => {
                    matches!(self.get(e), Expression::Literal(naga::Literal::F32(v)) if *v == 0.0)
                }
                _ => false,
            };
            if !zero {
                let message = format!("a level of detail in a lookup with comparison (`{name}`)");
                return Err(self.build.unsupported(span, message, "compare without one"));
            }
            level = SampleLevel::Zero;
        }
        let Some(sampler) = lookup.sampler else {
            return Err(self.build.unsupported(span, format!("`{name}` of a `{ty}`"), "use `texelFetch`"));
        };
        let compares = lookup.reference.is_some();
        let e = self.add(Expression::ImageSample {
            image: lookup.image,
            sampler,
            gather: component,
            coordinate: lookup.at.e,
            array_index: lookup.layer,
            offset,
            level,
            depth_ref: lookup.reference,
            clamp_to_edge: false,
        });
        let ty = if compares && !gather { Type::FLOAT } else { Type::Vector(lookup.ty.scalar, 4) };
        Ok(Val { e, ty })
    }

    /// True when the reference value is an argument of its own.
    fn separate(&self, ty: OpaqueType) -> bool {
        ty.dim == TextureDim::Cube && ty.arrayed
    }

    /// Takes the coordinates of a lookup apart.
    fn lookup(
        &mut self,
        ty: OpaqueType,
        image: Expr,
        sampler: Option<Expr>,
        at: &Val,
        projected: bool,
        gather: bool,
    ) -> Result<Lookup> {
        let n = ty.coordinates();
        let have = match at.ty {
            Type::Vector(_, n) => n,
            _ => 1,
        };
        let mut coordinates = self.swizzle(at, &(0..n).collect::<Vec<_>>())?;
        let mut reference = None;
        if ty.shadow && !gather && !self.separate(ty) {
            // Behind the coordinates and the layer, but never before the third place.
            let place = (n + u8::from(ty.arrayed)).max(2);
            if place < have {
                reference = Some(self.part(at.e, u32::from(place)));
            }
        }
        if projected {
            let last = self.part(at.e, u32::from(have - 1));
            let divisor = self.widened(Val { e: last, ty: Type::FLOAT }, &coordinates.ty);
            let e = self.add(Expression::Binary { op: B::Divide, left: coordinates.e, right: divisor.e });
            coordinates = Val { e, ty: coordinates.ty };
            reference = reference.map(|r| self.add(Expression::Binary { op: B::Divide, left: r, right: last }));
        }
        let layer = if ty.arrayed {
            let layer = self.part(at.e, u32::from(n));
            let layer = self.math(MathFunction::Round, &[layer]);
            Some(self.add(Expression::As { expr: layer, kind: ScalarKind::Sint, convert: Some(4) }))
        } else {
            None
        };
        if ty.dim == TextureDim::Rect {
            // Rectangles are addressed in texels.
            let size = self.size(ty, image, None)?;
            let size = self.cast(size, ScalarType::Int, ScalarType::Float)?;
            let e = self.add(Expression::Binary { op: B::Divide, left: coordinates.e, right: size.e });
            coordinates = Val { e, ty: coordinates.ty };
        }
        Ok(Lookup { ty, image, sampler, at: coordinates, layer, reference })
    }
}

/// `texture2DProjLodEXT` and the like without dimension and suffix.
fn plain_name(name: &str) -> String {
    let name = name.strip_suffix("ARB").or_else(|| name.strip_suffix("EXT")).unwrap_or(name);
    for old in ["texture", "shadow"] {
        let Some(rest) = name.strip_prefix(old) else { continue };
        for dim in ["1DArray", "2DArray", "2DRect", "1D", "2D", "3D", "Cube"] {
            if let Some(rest) = rest.strip_prefix(dim) {
                return format!("texture{rest}");
            }
        }
    }
    name.to_owned()
}

/// Which argument is a constant offset.
fn offset_argument(name: &str, count: usize) -> Option<usize> {
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
            ("texture2DArrayLod", "textureLod"),
            ("texture2DGradARB", "textureGrad"),
            ("textureProjOffset", "textureProjOffset"),
            ("texelFetch", "texelFetch"),
        ] {
            assert_eq!(plain_name(name), plain);
        }
    }
}
