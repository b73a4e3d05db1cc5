//! Texels: which one a coordinate chooses, and its words.
//!
//! Textures have one level, are sampled with the nearest texel and clamped to their edge (Vulkan 1.4,
//! "Image Sample Operations"; OpenGL 4.6, 8.14). Whatever chooses the level is computed and has no effect.

use naga::{Expression, Handle, ImageQuery, SampleLevel, SwizzleComponent};

use super::super::code::{Inst, Register, Word2};
use super::super::domain::{Binary, Comparison, FromWords, Site, ToWords, Unary};
use super::{Compiler, Evaluated, Frame, InterpError, unsupported};
use crate::Texture;
use crate::texture::{Dimension, Texel};
use base::value::Scalar;

/// A texture with its number among the tables.
type Bound<'m> = (u32, &'m Texture);

/// Where a lookup lands: the coordinates of a texel in a layer or slice, and that.
#[derive(Clone, Copy)]
struct TexelAt {
    x: Register,
    y: Register,
    layer: Register,
}

impl<'m> Compiler<'m> {
    fn bound(
        &mut self,
        frame: &mut Frame<'m>,
        image: Handle<Expression>,
        span: naga::Span,
    ) -> Result<Bound<'m>, InterpError> {
        let Evaluated::Image(global) = self.value(frame, image)? else {
            return Err(unsupported("a texture that is computed".to_owned(), span));
        };
        let found = self.subject.textures.iter().position(|t| t.image == global);
        let Some(k) = found else {
            let name = self.module.global_variables[global].name.as_deref().unwrap_or("a texture");
            return Err(unsupported(format!("`{name}`, to which nothing is bound,"), span));
        };
        Ok((k as u32, &self.subject.textures[k]))
    }

    /// A texel chosen by coordinates that are real numbers.
    pub(super) fn image_sample(
        &mut self,
        frame: &mut Frame<'m>,
        site: Site,
        handle: Handle<Expression>,
        span: naga::Span,
    ) -> Result<Vec<Register>, InterpError> {
        let Expression::ImageSample { image, gather, coordinate, array_index, offset, level, depth_ref, .. } =
            frame.function.expressions[handle]
        else {
            return Err(InterpError::internal("no lookup of a texel".to_owned()));
        };
        let texture = self.bound(frame, image, span)?;
        match level {
            // One level is there, whichever is asked for.
            SampleLevel::Auto
            | SampleLevel::Zero
            | SampleLevel::Exact(_)
            | SampleLevel::Bias(_)
            | SampleLevel::Gradient { .. } => {}
        }
        let coordinate = self.registers(frame, coordinate)?.to_vec();
        let layer = array_index.map(|layer| self.single(frame, layer)).transpose()?;
        let offset = offset.map_or(Ok(Vec::new()), |offset| offsets(frame, offset, span))?;
        let reference = depth_ref.map(|reference| self.single(frame, reference)).transpose()?;
        let reference = reference.map(|r| self.within_unit(site, r));
        let (face, coordinate) = match (texture.1.kind.dimension, &coordinate[..]) {
            (Dimension::Cube, &[x, y, z]) => {
                let (face, s, t) = self.face(site, [x, y, z]);
                (Some(face), vec![s, t])
            }
            _ => (None, coordinate),
        };
        let layer = self.layer(site, texture.1, face, layer);
        if let Some(component) = gather {
            if face.is_some() {
                return Err(unsupported("gathering from a cube".to_owned(), span));
            }
            return self.gathered(site, texture, &coordinate, layer, (&offset, component), reference, span);
        }
        let at = self.nearest(site, texture.1, &coordinate, layer, &offset, span)?;
        let channels = if texture.1.kind.texel == Texel::Depth { 0..1 } else { 0..4 };
        let texel: Vec<Register> = channels.map(|c| self.fetched(site, texture, at, c, None)).collect();
        Ok(match (reference, &texel[..]) {
            (Some(reference), &[depth]) => vec![self.compared(site, reference, depth)],
            _ => texel,
        })
    }

    /// A texel with known numbers. What lies outside of the texture is not promised.
    pub(super) fn image_load(
        &mut self,
        frame: &mut Frame<'m>,
        site: Site,
        handle: Handle<Expression>,
        span: naga::Span,
    ) -> Result<Vec<Register>, InterpError> {
        let Expression::ImageLoad { image, coordinate, array_index, sample, level } =
            frame.function.expressions[handle]
        else {
            return Err(InterpError::internal("no texel to load".to_owned()));
        };
        if sample.is_some() {
            return Err(unsupported("textures with several samples".to_owned(), span));
        }
        if let Some(texel) = self.load_texel(frame, site, image, (coordinate, array_index))? {
            return Ok(texel);
        }
        let texture = self.bound(frame, image, span)?;
        let coordinate = self.registers(frame, coordinate)?.to_vec();
        let [width, height, depth] = texture.1.contents.size();
        let zero = self.word(0, Scalar::U32);
        let get = |k: usize| coordinate.get(k).copied().unwrap_or(zero);
        let layer = match array_index {
            Some(layer) => self.single(frame, layer)?,
            None => get(2),
        };
        let at = TexelAt { x: get(0), y: get(1), layer };
        let mut inside = self.below(site, at.x, width);
        for (one, size) in [(at.y, height), (at.layer, depth)] {
            let more = self.below(site, one, size);
            inside = self.word2(site, Word2::And, inside, more, Scalar::Bool);
        }
        if let Some(level) = level {
            let level = self.single(frame, level)?;
            let more = self.below(site, level, 1);
            inside = self.word2(site, Word2::And, inside, more, Scalar::Bool);
        }
        let channels = if texture.1.kind.texel == Texel::Depth { 0..1 } else { 0..4 };
        Ok(channels.map(|c| self.fetched(site, texture, at, c, Some(inside))).collect())
    }

    /// Sizes and counts.
    pub(super) fn image_query(
        &mut self,
        frame: &mut Frame<'m>,
        site: Site,
        image: Handle<Expression>,
        query: ImageQuery,
        span: naga::Span,
    ) -> Result<Vec<Register>, InterpError> {
        if let Some(numbers) = self.storage_query(frame, image, query)? {
            return Ok(numbers);
        }
        let (_, texture) = self.bound(frame, image, span)?;
        let [width, height, layers] = texture.contents.size();
        let numbers = match query {
            ImageQuery::NumLevels => vec![1],
            ImageQuery::NumLayers if texture.kind.dimension == Dimension::Cube => vec![layers / 6],
            ImageQuery::NumLayers => vec![layers],
            ImageQuery::NumSamples => {
                return Err(unsupported("textures with several samples".to_owned(), span));
            }
            ImageQuery::Size { level } => {
                let numbers = match texture.kind.dimension {
                    Dimension::D1 => vec![width],
                    Dimension::D2 | Dimension::Cube => vec![width, height],
                    Dimension::D3 => vec![width, height, layers],
                };
                if let Some(level) = level {
                    // A level that is not there has no size.
                    let level = self.single(frame, level)?;
                    let inside = self.below(site, level, 1);
                    let table = self.executable.tables.len() as u32;
                    self.executable.tables.push([&numbers[..], &[0; 4]].concat()[..4].into());
                    let index = self.word(0, Scalar::U32).reg;
                    let number = |this: &mut Self, channel: usize| {
                        let to = this.temporary();
                        let (channel, inside) = (channel as u8, Some(inside.reg));
                        this.push(Inst::Texel { table, index, channel, inside, to, site });
                        Register { scalar: Scalar::U32, reg: to }
                    };
                    return Ok((0..numbers.len()).map(|k| number(self, k)).collect());
                }
                numbers
            }
        };
        Ok(numbers.into_iter().map(|n| self.word(n, Scalar::U32)).collect())
    }

    /// True for 0 ≤ word < size; a negative number is a large one without a sign.
    fn below(&mut self, site: Site, word: Register, size: u32) -> Register {
        let size = self.word(size, Scalar::U32);
        self.word2(site, Word2::LessUnsigned, word, size, Scalar::Bool)
    }

    fn within_unit(&mut self, site: Site, value: Register) -> Register {
        let (zero, one) = (self.real(0.0, None), self.real(1.0, None));
        let value = self.real2(site, Binary::Max, value, zero);
        self.real2(site, Binary::Min, value, one)
    }

    /// ⌊size·u + shift⌋ + offset, clamped.
    fn texel_of(&mut self, site: Site, u: Register, size: u32, shift: f32, low: i32, high: i32) -> Register {
        let scale = self.real(size as f32, None);
        let mut x = self.real2(site, Binary::Multiply, u, scale);
        if shift != 0.0 {
            let shift = self.real(shift, None);
            x = self.real2(site, Binary::Add, x, shift);
        }
        self.words_of(site, ToWords::Texel { low, high }, x, Scalar::I32)
    }

    fn plus(&mut self, site: Site, a: Register, n: i32) -> Register {
        if n == 0 {
            return a;
        }
        let n = self.word(n.cast_unsigned(), Scalar::I32);
        self.word2(site, Word2::AddUnsigned, a, n, Scalar::I32)
    }

    fn nearest(
        &mut self,
        site: Site,
        texture: &Texture,
        coordinate: &[Register],
        layer: Register,
        offset: &[i32],
        span: naga::Span,
    ) -> Result<TexelAt, InterpError> {
        let zero = self.word(0, Scalar::I32);
        let mut at = [zero, zero, layer];
        let sizes = texture.contents.size();
        if coordinate.len() > 3 {
            return Err(unsupported("a lookup with so many coordinates".to_owned(), span));
        }
        for (k, &u) in coordinate.iter().enumerate() {
            let size = sizes[k];
            let offset = offset.get(k).copied().unwrap_or(0);
            let last = size.cast_signed() - 1;
            let texel = self.texel_of(site, u, size, 0.0, -offset, last - offset);
            at[k] = self.plus(site, texel, offset);
        }
        Ok(TexelAt { x: at[0], y: at[1], layer: at[2] })
    }

    /// The four texels around a point: (i0, j1), (i1, j1), (i1, j0), (i0, j0).
    #[expect(clippy::too_many_arguments, reason = "they are the parts of one lookup")]
    fn gathered(
        &mut self,
        site: Site,
        texture: Bound<'m>,
        coordinate: &[Register],
        layer: Register,
        (offset, component): (&[i32], SwizzleComponent),
        reference: Option<Register>,
        span: naga::Span,
    ) -> Result<Vec<Register>, InterpError> {
        let &[u, v] = coordinate else {
            return Err(unsupported("gathering from a texture that is not flat".to_owned(), span));
        };
        let [width, height, _] = texture.1.contents.size();
        let pair = |this: &mut Self, u: Register, size: u32, offset: i32| {
            let last = size.cast_signed() - 1;
            // The lower one of two neighbours, from one before the first to the last.
            let low = this.texel_of(site, u, size, -0.5, -1 - offset, last - offset);
            let (low, high) = (this.plus(site, low, offset), this.plus(site, low, offset + 1));
            let (zero, last) = (this.word(0, Scalar::I32), this.word(last.cast_unsigned(), Scalar::I32));
            [
                this.word2(site, Word2::MaxSigned, low, zero, Scalar::I32),
                this.word2(site, Word2::MinSigned, high, last, Scalar::I32),
            ]
        };
        let [i0, i1] = pair(self, u, width, offset.first().copied().unwrap_or(0));
        let [j0, j1] = pair(self, v, height, offset.get(1).copied().unwrap_or(0));
        let channel = if texture.1.kind.texel == Texel::Depth { 0 } else { component as u8 };
        let mut all = Vec::with_capacity(4);
        for (x, y) in [(i0, j1), (i1, j1), (i1, j0), (i0, j0)] {
            let texel = self.fetched(site, texture, TexelAt { x, y, layer }, channel, None);
            all.push(match reference {
                Some(reference) => self.compared(site, reference, texel),
                None => texel,
            });
        }
        Ok(all)
    }

    /// The number of a layer: clamped, and the face counted in.
    fn layer(&mut self, site: Site, texture: &Texture, face: Option<Register>, layer: Option<Register>) -> Register {
        let layers = texture.contents.size()[2];
        let zero = self.word(0, Scalar::I32);
        let Some(layer) = layer else { return face.unwrap_or(zero) };
        let count = if face.is_some() { layers / 6 } else { layers };
        let last = self.word(count.saturating_sub(1), Scalar::I32);
        let layer = self.word2(site, Word2::MaxSigned, Register { scalar: Scalar::I32, ..layer }, zero, Scalar::I32);
        let layer = self.word2(site, Word2::MinSigned, layer, last, Scalar::I32);
        let Some(face) = face else { return layer };
        let six = self.word(6, Scalar::I32);
        let first = self.word2(site, Word2::MultiplyUnsigned, layer, six, Scalar::I32);
        self.word2(site, Word2::AddUnsigned, first, face, Scalar::I32)
    }

    /// The face that a direction meets and the coordinates there (OpenGL 4.6, table 8.19).
    fn face(&mut self, site: Site, [x, y, z]: [Register; 3]) -> (Register, Register, Register) {
        let one = self.real(1.0, None);
        // Which face two equal coordinates choose is not promised: rounding makes a doubt of it.
        let [ax, ay, az] = [x, y, z].map(|c| {
            let size = self.real1(site, Unary::Abs, c);
            self.real2(site, Binary::Multiply, size, one)
        });
        let zero = self.real(0.0, None);
        let z_most = {
            let (a, b) = (
                self.compare(site, Comparison::GreaterEqual, az, ax),
                self.compare(site, Comparison::GreaterEqual, az, ay),
            );
            self.word2(site, Word2::And, a, b, Scalar::Bool)
        };
        let y_most = self.compare(site, Comparison::GreaterEqual, ay, ax);
        let [nx, ny, nz] = [x, y, z].map(|c| self.real1(site, Unary::Negate, c));
        let mut sides = Vec::new();
        // For each axis: its length, the number of the face, and the coordinates on the two faces.
        for (axis, length, number, s, t) in
            [(x, ax, 0, (nz, z), (ny, ny)), (y, ay, 2, (x, x), (z, nz)), (z, az, 4, (x, nx), (ny, ny))]
        {
            let negative = self.compare(site, Comparison::Less, axis, zero);
            let (front, back) = (self.word(number, Scalar::I32), self.word(number + 1, Scalar::I32));
            let face = self.select(negative, back, front);
            let (s, t) = (self.select(negative, s.1, s.0), self.select(negative, t.1, t.0));
            sides.push([face, s, t, length]);
        }
        let chosen: Vec<Register> = (0..4)
            .map(|k| {
                let other = self.select(y_most, sides[1][k], sides[0][k]);
                self.select(z_most, sides[2][k], other)
            })
            .collect();
        let half = self.real(0.5, None);
        let [s, t] = [chosen[1], chosen[2]].map(|c| {
            let ratio = self.real2(site, Binary::Divide, c, chosen[3]);
            let ratio = self.real2(site, Binary::Multiply, ratio, half);
            self.real2(site, Binary::Add, ratio, half)
        });
        (chosen[0], s, t)
    }

    /// 1 where the reference is at most the depth.
    fn compared(&mut self, site: Site, reference: Register, depth: Register) -> Register {
        let (zero, one) = (self.real(0.0, None), self.real(1.0, None));
        // A device makes the depth out of an integer, and may round it.
        let depth = self.real2(site, Binary::Multiply, depth, one);
        let passes = self.compare(site, Comparison::LessEqual, reference, depth);
        self.select(passes, one, zero)
    }

    /// A channel of a texel.
    fn fetched(
        &mut self,
        site: Site,
        (table, texture): Bound<'m>,
        at: TexelAt,
        channel: u8,
        inside: Option<Register>,
    ) -> Register {
        let [width, height, _] = texture.contents.size();
        let width = self.word(width, Scalar::U32);
        let height = self.word(height, Scalar::U32);
        let rows = self.word2(site, Word2::MultiplyUnsigned, at.layer, height, Scalar::U32);
        let row = self.word2(site, Word2::AddUnsigned, rows, at.y, Scalar::U32);
        let first = self.word2(site, Word2::MultiplyUnsigned, row, width, Scalar::U32);
        let index = self.word2(site, Word2::AddUnsigned, first, at.x, Scalar::U32);
        let to = self.temporary();
        self.push(Inst::Texel { table, index: index.reg, channel, inside: inside.map(|i| i.reg), to, site });
        let word = |scalar| Register { scalar, reg: to };
        match texture.kind.texel {
            Texel::Float | Texel::Depth => self.reals_of(site, FromWords::Bits, word(Scalar::U32)),
            Texel::Int => word(Scalar::I32),
            Texel::Uint => word(Scalar::U32),
        }
    }
}

/// The numbers of a constant offset.
fn offsets(frame: &Frame<'_>, handle: Handle<Expression>, span: naga::Span) -> Result<Vec<i32>, InterpError> {
    let arena = &frame.function.expressions;
    let number = |handle: Handle<Expression>| match arena[handle] {
        Expression::Literal(naga::Literal::I32(n)) => Some(n),
        _ => None,
    };
    let numbers = match &arena[handle] {
        Expression::Compose { components, .. } => components.iter().map(|&c| number(c)).collect(),
        _ => number(handle).map(|n| vec![n]),
    };
    numbers.ok_or_else(|| unsupported("an offset that is computed".to_owned(), span))
}
