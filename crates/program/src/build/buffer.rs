//! What is a buffer of numbers in naga's terms: atomic counters (GLSL 4.60, 7.7), textures and images that
//! are buffers, and images whose texels change atomically or that naga has no type for.

use std::sync::Arc;

use naga::{
    AddressSpace, AtomicFunction, BinaryOperator as B, Expression, GlobalVariable, Handle, MathFunction as M, Scalar,
    ScalarKind, Statement, StorageAccess, StructMember, TypeInner,
};

use super::function::{Fun, Val};
use super::texture::Opaque;
use super::{Build, Expr, Result};
use base::text::Span;
use syntax::BuiltinFunction as F;
use syntax::ast::{Callee, ExprKind, Qualifiers};
use syntax::types::{OpaqueKind, OpaqueType, ScalarType, StructField, StructType, TextureDim, Type};

/// How a texel stands in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BufferCell {
    /// So many components of the texel's own type.
    Plain(u8),
    /// One word, packed and unpacked by built-in functions; so many components are kept.
    Packed(M, M, u8),
}

/// A buffer behind a texture, image or counter.
#[derive(Clone, Copy, Debug)]
pub(super) struct TexelBuffer {
    variable: Handle<GlobalVariable>,
    cell: BufferCell,
    /// True for one that starts with its size: width, height, depth or layers, samples.
    sized: bool,
    atomic: bool,
}

/// What the names of types of images in buffers begin with; the number of coordinates follows.
const TEXELS: &str = "sc_texels_";

/// For the type of an image that lies in a buffer, the coordinates of a texel. Four words with the width, the height, the
/// depth or layers, and the samples stand in front of its texels.
pub(crate) fn axes_of_texels(ty: &naga::Type) -> Option<usize> {
    let rest = ty.name.as_deref()?.strip_prefix(TEXELS)?;
    rest.split('_').next()?.parse().ok()
}

/// An image behind its size.
fn with_size(texels: &Type) -> Type {
    let field = |name: &str, ty| StructField {
        name: name.to_owned(),
        ty,
        qualifiers: Qualifiers::default(),
        span: Span::at(0),
    };
    let fields = vec![field("size", Type::Vector(ScalarType::Uint, 4)), field("texels", texels.clone())];
    Type::Struct(Arc::new(StructType { name: "sc_texels".to_owned(), fields, span: Span::at(0) }))
}

/// The texel of a format; none for one that is no whole word.
fn cell(format: Option<&str>) -> Option<BufferCell> {
    Some(match format {
        None | Some("rgba32f" | "rgba32i" | "rgba32ui") => BufferCell::Plain(4),
        Some("rg32f" | "rg32i" | "rg32ui") => BufferCell::Plain(2),
        Some("r32f" | "r32i" | "r32ui") => BufferCell::Plain(1),
        Some("rgba8") => BufferCell::Packed(M::Unpack4x8unorm, M::Pack4x8unorm, 4),
        Some("rgba8_snorm") => BufferCell::Packed(M::Unpack4x8snorm, M::Pack4x8snorm, 4),
        Some("rg16") => BufferCell::Packed(M::Unpack2x16unorm, M::Pack2x16unorm, 2),
        Some("rg16_snorm") => BufferCell::Packed(M::Unpack2x16snorm, M::Pack2x16snorm, 2),
        Some("rg16f") => BufferCell::Packed(M::Unpack2x16float, M::Pack2x16float, 2),
        Some(_) => return None,
    })
}

impl Build<'_> {
    /// True for what is made of a buffer.
    pub(super) fn is_buffer(&self, opaque: &Opaque, ty: OpaqueType) -> bool {
        match ty.kind {
            OpaqueKind::AtomicCounter => true,
            OpaqueKind::Sampler => ty.dim == TextureDim::Buffer,
            OpaqueKind::Image => {
                let one = matches!(opaque.image.format.as_deref(), Some("r32f" | "r32i" | "r32ui"));
                matches!(ty.dim, TextureDim::Buffer | TextureDim::Cube | TextureDim::Rect)
                    || ty.multisampled
                    || one && self.has_image_atomics()
            }
        }
    }

    /// True when an atomic function of images is called anywhere: which image it is called on is not
    /// followed through parameters.
    fn has_image_atomics(&self) -> bool {
        self.shader.arena().iter().any(|(id, e)| match &e.kind {
            ExprKind::Call { callee: Callee::Name(name), .. } => {
                name.name.starts_with("imageAtomic") && self.shader.callee(id).is_some()
            }
            _ => false,
        })
    }

    /// The buffer of a texture, image or counter, made when it is first used.
    fn buffer(&mut self, opaque: &Opaque, ty: OpaqueType, span: Span) -> Result<TexelBuffer> {
        if let Some(buffer) = self.made.buffers.get(&opaque.key) {
            return Ok(*buffer);
        }
        let name: String = opaque.key.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        let name = name.trim_end_matches('_').to_owned();
        let all = StorageAccess::LOAD | StorageAccess::STORE;
        let buffer = if ty.kind == OpaqueKind::AtomicCounter {
            let counter = self.insert(None, TypeInner::Atomic(Scalar::U32));
            let variable = self.with_binding(&name, AddressSpace::Storage { access: all }, counter);
            self.memory_behind(&opaque.key, variable, &Type::UINT, true, span);
            TexelBuffer { variable, cell: BufferCell::Plain(1), sized: false, atomic: true }
        } else {
            let format = opaque.image.format.as_deref().filter(|_| ty.kind == OpaqueKind::Image);
            let open = format.is_none() && opaque.image.reads && !super::image::loads_any_format(self.shader);
            if ty.kind == OpaqueKind::Image && open {
                let message = format!("`{ty}` without a format");
                return Err(self.unsupported(span, message, "write `layout(r32ui)` or another format"));
            }
            let Some(cell) = cell(format) else {
                let message = format!("`{ty}` of the format `{}`", format.unwrap_or_default());
                return Err(self.unsupported(span, message, "use a format of 32 bits or `rgba8`"));
            };
            let atomic = cell == BufferCell::Plain(1) && ty.kind == OpaqueKind::Image && self.has_image_atomics();
            let texel = match cell {
                BufferCell::Plain(n) => self.value_type(&Type::vector(ty.scalar, n), span)?,
                BufferCell::Packed(..) => self.value_type(&Type::UINT, span)?,
            };
            let base = match (atomic, ty.scalar) {
                (false, _) => texel,
                (true, ScalarType::Int) => self.insert(None, TypeInner::Atomic(Scalar::I32)),
                // A `float` is exchanged as its bits.
                (true, _) => self.insert(None, TypeInner::Atomic(Scalar::U32)),
            };
            let stride = self.module.types[base].inner.size(self.module.to_ctx());
            let array = self.insert(None, TypeInner::Array { base, size: naga::ArraySize::Dynamic, stride });
            let sized = ty.dim != TextureDim::Buffer;
            let host = if sized {
                let size = self.value_type(&Type::Vector(ScalarType::Uint, 4), span)?;
                let member =
                    |name: &str, ty, offset| StructMember { name: Some(name.to_owned()), ty, binding: None, offset };
                let members = vec![member("size", size, 0), member("texels", array, 16)];
                let axes = if ty.arrayed { 3 } else { ty.coordinates() };
                let span = 16 + stride.next_multiple_of(16);
                self.insert(Some(format!("{TEXELS}{axes}_{name}")), TypeInner::Struct { members, span })
            } else {
                array
            };
            let access = if ty.kind == OpaqueKind::Image && opaque.image.writes { all } else { StorageAccess::LOAD };
            let variable = self.with_binding(&name, AddressSpace::Storage { access }, host);
            let texel = match cell {
                BufferCell::Packed(..) => Type::UINT,
                BufferCell::Plain(_) if atomic && ty.scalar == ScalarType::Float => Type::UINT,
                BufferCell::Plain(n) => Type::vector(ty.scalar, n),
            };
            let texels = texel.array(crate::memory::LENGTH);
            let inside = if sized { with_size(&texels) } else { texels };
            self.memory_behind(&opaque.key, variable, &inside, access == all, span);
            TexelBuffer { variable, cell, sized, atomic }
        };
        self.made.buffers.insert(opaque.key.clone(), buffer);
        Ok(buffer)
    }
}

impl Fun<'_, '_> {
    /// A function of counters, buffer textures or images that are buffers. `rest` are the arguments behind
    /// the first.
    pub(super) fn buffer_call(
        &mut self,
        function: F,
        opaque: &Opaque,
        ty: OpaqueType,
        rest: &[Option<Val>],
        span: Span,
    ) -> Result<Option<Val>> {
        let buffer = self.build.buffer(opaque, ty, span)?;
        let whole = self.add(Expression::GlobalVariable(buffer.variable));
        let value = |k: usize| rest.get(k).cloned().flatten();
        if ty.kind == OpaqueKind::AtomicCounter {
            return self.counter(function, whole, rest, span).map(Some);
        }
        let texels = if buffer.sized { self.add(Expression::AccessIndex { base: whole, index: 1 }) } else { whole };
        match function {
            F::TextureSize | F::ImageSize if !buffer.sized => {
                let e = self.array_length(texels);
                self.cast(Val { e, ty: Type::UINT }, ScalarType::Uint, ScalarType::Int).map(Some)
            }
            F::ImageSize => {
                let size = self.buffer_size(whole);
                let n = if ty.dim == TextureDim::Cube { 2 } else { ty.coordinates() };
                let mut parts: Vec<Expr> = (0..u32::from(n)).map(|k| self.part(size, k)).collect();
                if ty.arrayed {
                    let layers = self.part(size, 2);
                    let six = self.number(ScalarType::Uint, if ty.dim == TextureDim::Cube { 6.0 } else { 1.0 });
                    parts.push(self.add(Expression::Binary { op: B::Divide, left: layers, right: six }));
                }
                let found = match parts[..] {
                    [only] => Val { e: only, ty: Type::UINT },
                    _ => {
                        let n = u8::try_from(parts.len()).unwrap_or(3);
                        self.compose(&Type::Vector(ScalarType::Uint, n), parts)?
                    }
                };
                self.cast(found, ScalarType::Uint, ScalarType::Int).map(Some)
            }
            F::ImageSamples => {
                let size = self.buffer_size(whole);
                let e = self.part(size, 3);
                self.cast(Val { e, ty: Type::UINT }, ScalarType::Uint, ScalarType::Int).map(Some)
            }
            F::TexelFetch | F::ImageLoad => {
                let Some(at) = value(0) else { return Err(self.odd(function, span)) };
                let sample = value(1);
                let (index, inside) = self.texel_index(whole, &buffer, ty, &at, sample)?;
                let want = Type::Vector(ty.scalar, 4);
                let Some(inside) = inside else {
                    return self.load_texel(texels, index, &buffer, ty.scalar).map(Some);
                };
                // What lies outside reads as zero (GLSL 4.60, 8.12).
                let place = self.local("sc_texel", &want)?;
                let zero = self.all(&want, 0.0)?;
                self.store(&place, &zero)?;
                self.branch(
                    inside,
                    |f| {
                        let texel = f.load_texel(texels, index, &buffer, ty.scalar)?;
                        f.store(&place, &texel)
                    },
                    |_| Ok(()),
                )?;
                self.load(&place).map(Some)
            }
            F::ImageStore => {
                let (Some(at), Some(texel)) = (value(0), rest.last().cloned().flatten()) else {
                    return Err(self.odd(function, span));
                };
                let sample = value(1).filter(|_| rest.len() > 2);
                let texel = self.convert(texel, &Type::Vector(ty.scalar, 4))?;
                let (index, inside) = self.texel_index(whole, &buffer, ty, &at, sample)?;
                match inside {
                    None => self.store_texel(texels, index, &buffer, &texel)?,
                    Some(inside) => {
                        self.branch(inside, |f| f.store_texel(texels, index, &buffer, &texel), |_| Ok(()))?;
                    }
                }
                Ok(None)
            }
            _ => self.image_atomic(function, (whole, texels), &buffer, ty, rest, span).map(Some),
        }
    }

    fn odd(&self, function: impl std::fmt::Display, span: Span) -> Box<base::diagnostic::Diagnostic> {
        self.build.unsupported(span, format!("`{function}` like this"), "give it a coordinate and a value")
    }

    fn buffer_size(&mut self, whole: Expr) -> Expr {
        let at = self.add(Expression::AccessIndex { base: whole, index: 0 });
        self.add(Expression::Load { pointer: at })
    }

    /// The index of a texel, and whether it lies inside; a buffer texture has no promise outside.
    fn texel_index(
        &mut self,
        whole: Expr,
        buffer: &TexelBuffer,
        ty: OpaqueType,
        at: &Val,
        sample: Option<Val>,
    ) -> Result<(Expr, Option<Expr>)> {
        let from = at.ty.scalar().unwrap_or(ScalarType::Int);
        let at = self.cast(at.clone(), from, ScalarType::Uint)?;
        if !buffer.sized {
            if ty.kind == OpaqueKind::Sampler {
                return Ok((at.e, None));
            }
            let texels = self.array_length(whole);
            let inside = self.add(Expression::Binary { op: B::Less, left: at.e, right: texels });
            return Ok((at.e, Some(inside)));
        }
        let size = self.buffer_size(whole);
        let n = super::types::count(&at.ty);
        let n = if at.ty.is_scalar() { 1 } else { n };
        let mut coordinates: Vec<(Expr, u32)> = Vec::new();
        for k in 0..n {
            let part = if n == 1 { at.e } else { self.part(at.e, k) };
            // The layer of a one-dimensional image stands behind its only coordinate.
            let bound = if ty.arrayed && k + 1 == n { 2 } else { k };
            coordinates.push((part, bound));
        }
        if let Some(sample) = sample.filter(|_| ty.multisampled) {
            let from = sample.ty.scalar().unwrap_or(ScalarType::Int);
            coordinates.push((self.cast(sample, from, ScalarType::Uint)?.e, 3));
        }
        let mut inside: Option<Expr> = None;
        let mut index: Option<Expr> = None;
        for (part, bound) in coordinates.iter().rev() {
            let limit = self.part(size, *bound);
            let fits = self.add(Expression::Binary { op: B::Less, left: *part, right: limit });
            inside = Some(match inside {
                None => fits,
                Some(all) => self.add(Expression::Binary { op: B::LogicalAnd, left: all, right: fits }),
            });
            index = Some(match index {
                None => *part,
                Some(outer) => {
                    let row = self.add(Expression::Binary { op: B::Multiply, left: outer, right: limit });
                    self.add(Expression::Binary { op: B::Add, left: row, right: *part })
                }
            });
        }
        match (index, inside) {
            (Some(index), Some(inside)) => {
                let texels = self.add(Expression::AccessIndex { base: whole, index: 1 });
                let length = self.array_length(texels);
                let there = self.add(Expression::Binary { op: B::Less, left: index, right: length });
                let both = self.add(Expression::Binary { op: B::LogicalAnd, left: inside, right: there });
                Ok((index, Some(both)))
            }
            _ => Err(self.odd("an image", self.at)),
        }
    }

    fn load_texel(&mut self, texels: Expr, index: Expr, buffer: &TexelBuffer, scalar: ScalarType) -> Result<Val> {
        let pointer = self.add(Expression::Access { base: texels, index });
        let mut e = self.add(Expression::Load { pointer });
        if buffer.atomic && scalar == ScalarType::Float {
            e = self.add(Expression::As { expr: e, kind: ScalarKind::Float, convert: None });
        }
        let (e, have) = match buffer.cell {
            BufferCell::Plain(n) => (e, n),
            BufferCell::Packed(unpack, _, n) => (self.math(unpack, &[e]), n),
        };
        if have == 4 {
            return Ok(Val { e, ty: Type::Vector(scalar, 4) });
        }
        let mut parts: Vec<Expr> = (0..u32::from(have)).map(|k| if have == 1 { e } else { self.part(e, k) }).collect();
        for k in have..4 {
            parts.push(self.number(scalar, if k == 3 { 1.0 } else { 0.0 }));
        }
        self.compose(&Type::Vector(scalar, 4), parts)
    }

    fn store_texel(&mut self, texels: Expr, index: Expr, buffer: &TexelBuffer, texel: &Val) -> Result<()> {
        let n = match buffer.cell {
            BufferCell::Plain(n) | BufferCell::Packed(_, _, n) => n,
        };
        let kept = self.swizzle(texel, &(0..n).collect::<Vec<_>>())?.e;
        let value = match buffer.cell {
            BufferCell::Plain(_) if buffer.atomic && texel.ty.scalar() == Some(ScalarType::Float) => {
                self.add(Expression::As { expr: kept, kind: ScalarKind::Uint, convert: None })
            }
            BufferCell::Plain(_) => kept,
            BufferCell::Packed(_, pack, _) => self.math(pack, &[kept]),
        };
        let pointer = self.add(Expression::Access { base: texels, index });
        self.push(Statement::Store { pointer, value });
        Ok(())
    }

    fn image_atomic(
        &mut self,
        function: F,
        (whole, texels): (Expr, Expr),
        buffer: &TexelBuffer,
        ty: OpaqueType,
        rest: &[Option<Val>],
        span: Span,
    ) -> Result<Val> {
        let value = |k: usize| rest.get(k).cloned().flatten();
        let unknown = |f: &Self| f.build.unsupported(span, format!("`{function}` of a `{ty}`"), "use a storage buffer");
        let first = 1 + usize::from(ty.multisampled);
        let atomic = buffer.atomic && function.name().starts_with("imageAtomic");
        let (Some(at), true) = (value(0), atomic) else { return Err(unknown(self)) };
        let float = ty.scalar == ScalarType::Float;
        if float && function != F::ImageAtomicExchange {
            return Err(unknown(self));
        }
        let mut values = Vec::new();
        for k in first..rest.len() {
            let Some(v) = value(k) else { return Err(unknown(self)) };
            let v = self.convert(v, &Type::Scalar(ty.scalar))?.e;
            values.push(match float {
                true => self.add(Expression::As { expr: v, kind: ScalarKind::Uint, convert: None }),
                false => v,
            });
        }
        let (index, inside) = self.texel_index(whole, buffer, ty, &at, value(1))?;
        let result_ty = Type::Scalar(ty.scalar);
        let place = self.local("sc_before", &result_ty)?;
        let zero = self.all(&result_ty, 0.0)?;
        self.store(&place, &zero)?;
        let condition = match inside {
            Some(inside) => inside,
            None => self.number(ScalarType::Bool, 1.0),
        };
        self.branch(
            condition,
            |f| {
                let pointer = f.add(Expression::Access { base: texels, index });
                let number = if float { Type::UINT } else { result_ty.clone() };
                let mut before = f.atomic_at(function, pointer, &number, &values, span)?;
                if float {
                    let e = f.add(Expression::As { expr: before.e, kind: ScalarKind::Float, convert: None });
                    before = Val { e, ty: Type::FLOAT };
                }
                f.store(&place, &before)
            },
            |_| Ok(()),
        )?;
        self.load(&place)
    }

    /// A function of an atomic counter (GLSL 4.60, 8.10). All but the decrement give the value before.
    fn counter(&mut self, function: F, pointer: Expr, rest: &[Option<Val>], span: Span) -> Result<Val> {
        let one = |f: &mut Self| f.number(ScalarType::Uint, 1.0);
        let step = |f: &mut Self, fun: AtomicFunction| -> Result<Expr> {
            let value = one(f);
            let ty = f.ty(&Type::UINT)?;
            let result = f.add(Expression::AtomicResult { ty, comparison: false });
            f.push(Statement::Atomic { pointer, fun, value, result: Some(result) });
            Ok(result)
        };
        let e = match function {
            F::AtomicCounter => self.add(Expression::Load { pointer }),
            F::AtomicCounterIncrement => step(self, AtomicFunction::Add)?,
            F::AtomicCounterDecrement => {
                let before = step(self, AtomicFunction::Subtract)?;
                let one = one(self);
                self.add(Expression::Binary { op: B::Subtract, left: before, right: one })
            }
            _ => {
                let mut values = Vec::new();
                for value in rest.iter().flatten() {
                    values.push(self.convert(value.clone(), &Type::UINT)?.e);
                }
                return self.atomic_at(function, pointer, &Type::UINT, &values, span);
            }
        };
        Ok(Val { e, ty: Type::UINT })
    }
}
