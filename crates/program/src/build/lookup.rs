//! Lookups of filtered texels: coordinates, layers, reference values and levels of detail.

use naga::{BinaryOperator as B, Expression, MathFunction, SampleLevel, ScalarKind, SwizzleComponent};

use super::function::{Fun, Val};
use super::{Expr, Result};
use base::text::Span;
use syntax::BuiltinFunction as F;
use syntax::Stage;
use syntax::types::{OpaqueType, ScalarType, TextureDim, Type};

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
    #[expect(clippy::too_many_arguments, reason = "they are the parts of one call")]
    pub(super) fn sample(
        &mut self,
        function: F,
        ty: OpaqueType,
        image: Expr,
        sampler: Option<Expr>,
        rest: &[Option<Val>],
        offset: Option<Expr>,
        span: Span,
    ) -> Result<Val> {
        let has = |part: &str| function.name().contains(part);
        let floats = |f: &mut Self, v: Val| {
            let from = v.ty.scalar().unwrap_or(ScalarType::Float);
            f.cast(v, from, ScalarType::Float)
        };
        let Some(at) = rest.first().cloned().flatten() else {
            return Err(self.build.unsupported(span, format!("`{function}` like this"), "give it a coordinate"));
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
        let fragment = matches!(self.shader.stage(), Stage::Fragment | Stage::Library);
        // What is run has textures of one level.
        self.build.differs |= fragment;
        let mut level = if fragment && !self.build.run {
            SampleLevel::Auto
        } else {
            // No other stage has derivatives: the first level is meant (GLSL 4.60, 8.9).
            SampleLevel::Zero
        };
        let mut component = None;
        if gather {
            // Behind the offset, if there is one.
            let chosen = rest.iter().skip(1).flatten().next().cloned().filter(|_| !ty.shadow);
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
                return Err(self.build.unsupported(span, format!("`{function}` like this"), "give it two derivatives"));
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
            self.build.stand_for(span, format!("`{function}` of a `{ty}`"), "use `texelFetch`")?;
            if matches!(ty.dim, TextureDim::D1 | TextureDim::D2 | TextureDim::D3) {
                return self.nearest(&lookup, offset);
            }
            return Err(self.build.unsupported(span, format!("`{function}` of a `{ty}`"), "use `texelFetch`"));
        }
        if lookup.reference.is_some() && !matches!(level, SampleLevel::Auto | SampleLevel::Zero) {
            let zero = match level {
                SampleLevel::Exact(e) => {
                    matches!(self.get(e), Expression::Literal(naga::Literal::F32(v)) if *v == 0.0)
                }
                _ => false,
            };
            if !zero {
                let message = format!("a level of detail in a lookup with comparison (`{function}`)");
                return Err(self.build.unsupported(span, message, "compare without one"));
            }
            level = SampleLevel::Zero;
        }
        let Some(sampler) = lookup.sampler else {
            return Err(self.build.unsupported(span, format!("`{function}` of a `{ty}`"), "use `texelFetch`"));
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

    /// A texel of whole numbers, which no sampler filters: the one that the coordinates lie in, or the nearest to them.
    fn nearest(&mut self, lookup: &Lookup, offset: Option<Expr>) -> Result<Val> {
        let Lookup { ty, image, at, .. } = lookup;
        let zero = self.i32(0);
        let size =
            self.add(Expression::ImageQuery { image: *image, query: naga::ImageQuery::Size { level: Some(zero) } });
        let of = |scalar| Type::vector(scalar, ty.coordinates());
        let size = self.cast(Val { e: size, ty: of(ScalarType::Uint) }, ScalarType::Uint, ScalarType::Float)?;
        let one = self.all(&size.ty, 1.0)?;
        let last = self.add(Expression::Binary { op: B::Subtract, left: size.e, right: one.e });
        let scaled = self.add(Expression::Binary { op: B::Multiply, left: at.e, right: size.e });
        let mut texel = self.math(MathFunction::Floor, &[scaled]);
        if let Some(offset) = offset {
            let offset = self.cast(Val { e: offset, ty: of(ScalarType::Int) }, ScalarType::Int, ScalarType::Float)?;
            texel = self.add(Expression::Binary { op: B::Add, left: texel, right: offset.e });
        }
        let first = self.all(&size.ty, 0.0)?;
        let inside = self.math(MathFunction::Clamp, &[texel, first.e, last]);
        let texel = self.cast(Val { e: inside, ty: of(ScalarType::Float) }, ScalarType::Float, ScalarType::Int)?;
        let layer = match lookup.layer {
            Some(layer) => {
                let count = self.add(Expression::ImageQuery { image: *image, query: naga::ImageQuery::NumLayers });
                let count = self.cast(Val { e: count, ty: Type::UINT }, ScalarType::Uint, ScalarType::Int)?;
                let one = self.i32(1);
                let last = self.add(Expression::Binary { op: B::Subtract, left: count.e, right: one });
                let first = self.i32(0);
                Some(self.math(MathFunction::Clamp, &[layer, first, last]))
            }
            None => None,
        };
        self.texel_of(*ty, *image, texel, layer)
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
