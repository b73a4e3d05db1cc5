//! Storage images of a dispatch: loads, stores, atomic functions and sizes (GLSL 4.60, 8.12; WGSL, 17.7).

use naga::{AtomicFunction, Expression, GlobalVariable, Handle, ImageClass, ImageDimension, ImageQuery, Module};
use naga::{StorageAccess, TypeInner};

use super::super::code::{Inst, Register, Word2};
use super::super::domain::{Binary, FromWords, Site, ToWords, Unary};
use super::super::group::{Array, Channel, Extent, Leaf, MemoryAccess, MemoryOp, MemoryShape, Space, Step, Texels};
use super::{Compiler, Evaluated, Frame, InterpError, unsupported};
use base::value::Scalar;

/// Coordinates of a texel: those in its plane or volume, and the layer.
pub(super) type Coordinates = (Handle<Expression>, Option<Handle<Expression>>);

/// The memory behind a storage image; `None` for any other variable.
pub(super) fn shape(module: &Module, handle: Handle<GlobalVariable>) -> Option<Result<MemoryShape, String>> {
    let variable = &module.global_variables[handle];
    let TypeInner::Image { dim, arrayed, class: ImageClass::Storage { format, access } } =
        module.types[variable.ty].inner
    else {
        return None;
    };
    let Some(channels) = Channel::all_of(format) else {
        return Some(Err(format!("an image of the format {format:?}")));
    };
    let axes = match dim {
        ImageDimension::D1 => 1,
        ImageDimension::D2 => 2,
        ImageDimension::D3 => 3,
        ImageDimension::Cube => return Some(Err("a storage image of the faces of a cube".to_owned())),
    };
    let count = channels.len();
    let leaf = |(k, channel): (usize, &Channel)| Leaf {
        name: "".into(),
        offset: k as u32,
        scalar: channel.scalar(),
        short: false,
        component: (count > 1).then_some(k as u32),
        lens: [].into(),
    };
    let leaves = channels.iter().enumerate().map(leaf).collect();
    Some(Ok(MemoryShape {
        name: variable.name.clone().unwrap_or_default(),
        space: Space::Storage { writes: access.contains(StorageAccess::STORE) },
        unit: 4,
        words: 0,
        fixed: Vec::new(),
        array: Some(Array { name: String::new(), offset: 0, stride: count as u32, leaves }),
        image: Some(Texels { channels, axes: axes + usize::from(arrayed), layered: arrayed }),
    }))
}

impl<'m> Compiler<'m> {
    /// The number of the memory behind a storage image, with its texels; `None` for what is no image of a dispatch.
    fn texels(
        &mut self,
        frame: &mut Frame<'m>,
        image: Handle<Expression>,
    ) -> Result<Option<(u32, Texels)>, InterpError> {
        let Evaluated::Image(global) = self.value(frame, image)? else { return Ok(None) };
        let found = self.subject.shared.iter().position(|&own| own == global);
        let shape = found.and_then(|k| Some((k as u32, self.executable.memories.get(k)?)));
        Ok(shape.and_then(|(k, shape)| Some((k, shape.image.clone()?))))
    }

    /// The same where nothing else will do.
    fn storage(
        &mut self,
        frame: &mut Frame<'m>,
        image: Handle<Expression>,
        span: naga::Span,
    ) -> Result<(u32, Texels), InterpError> {
        self.texels(frame, image)?.ok_or_else(|| unsupported("writing images".to_owned(), span))
    }

    fn texel_access(
        &mut self,
        frame: &mut Frame<'m>,
        memory: u32,
        texels: &Texels,
        (coordinate, layer): Coordinates,
        op: MemoryOp,
        site: Site,
    ) -> Result<MemoryAccess, InterpError> {
        let mut all = self.registers(frame, coordinate)?.to_vec();
        if let Some(layer) = layer {
            all.push(self.single(frame, layer)?);
        }
        if all.len() != texels.axes {
            return Err(InterpError::internal("other coordinates than the image has".to_owned()));
        }
        let step = |(axis, register): (usize, Register)| Step {
            reg: register.reg,
            stride: texels.channels.len() as u32,
            len: Extent::Side(axis),
            site,
        };
        let steps = all.into_iter().enumerate().map(step).collect();
        Ok(MemoryAccess { memory, offset: 0, steps, op, atomic: false, site })
    }

    /// A texel of a storage image, with 0 and 1 in place of channels that it has not; `None` for a texture.
    pub(super) fn load_texel(
        &mut self,
        frame: &mut Frame<'m>,
        site: Site,
        image: Handle<Expression>,
        at: Coordinates,
    ) -> Result<Option<Vec<Register>>, InterpError> {
        let Some((memory, texels)) = self.texels(frame, image)? else { return Ok(None) };
        let mut loaded: Vec<Register> = Vec::new();
        for channel in &texels.channels {
            loaded.push(Register { scalar: channel.scalar(), reg: self.temporary() });
        }
        let op = MemoryOp::Load(loaded.iter().copied().zip(0..).collect());
        let access = self.texel_access(frame, memory, &texels, at, op, site)?;
        self.push(Inst::Memory(access));
        for k in loaded.len()..4 {
            let one = k == 3;
            loaded.push(match loaded[0].scalar {
                Scalar::F32 => self.real(f32::from(u8::from(one)), None),
                scalar @ (Scalar::I32 | Scalar::U32 | Scalar::Bool) => self.word(u32::from(one), scalar),
            });
        }
        Ok(Some(loaded))
    }

    pub(super) fn store_texel(
        &mut self,
        frame: &mut Frame<'m>,
        image: Handle<Expression>,
        at: Coordinates,
        value: Handle<Expression>,
        span: naga::Span,
    ) -> Result<(), InterpError> {
        let (memory, texels) = self.storage(frame, image, span)?;
        let value = self.registers(frame, value)?;
        let site = self.statement_site(frame, span);
        let channels = texels.channels.iter().zip(value.iter());
        let kept: Vec<Register> = channels.map(|(channel, one)| self.kept(site, *channel, *one)).collect();
        let op = MemoryOp::Store(kept.into_iter().zip(0..).collect());
        let access = self.texel_access(frame, memory, &texels, at, op, site)?;
        self.push(Inst::Memory(access));
        Ok(())
    }

    /// What a channel keeps of a number.
    fn kept(&mut self, site: Site, channel: Channel, value: Register) -> Register {
        match channel {
            Channel::Float | Channel::Uint(32) | Channel::Sint(32) => value,
            Channel::Half | Channel::Small(_) => {
                let mut from = value;
                if channel != Channel::Half {
                    let zero = self.real(0.0, None);
                    from = self.real2(site, Binary::Max, value, zero);
                }
                let bits = self.words_of(site, ToWords::HalfBits, from, Scalar::U32);
                let mask = self.word(channel.half_bits(), Scalar::U32);
                let bits = self.word2(site, Word2::And, bits, mask, Scalar::U32);
                self.reals_of(site, FromWords::HalfBits, bits)
            }
            Channel::Unorm(_) | Channel::Snorm(_) => {
                let low = self.real(if matches!(channel, Channel::Snorm(_)) { -1.0 } else { 0.0 }, None);
                let (one, half, steps) = (self.real(1.0, None), self.real(0.5, None), self.real(channel.steps(), None));
                let raised = self.real2(site, Binary::Max, value, low);
                let clamped = self.real2(site, Binary::Min, raised, one);
                let scaled = self.real2(site, Binary::Multiply, clamped, steps);
                let shifted = self.real2(site, Binary::Add, scaled, half);
                let rounded = self.real1(site, Unary::Floor, shifted);
                self.real2(site, Binary::Divide, rounded, steps)
            }
            Channel::Uint(bits) | Channel::Sint(bits) => {
                let up = self.word(32 - bits, Scalar::U32);
                let raised = self.word2(site, Word2::ShiftLeft, value, up, value.scalar);
                let signed = matches!(channel, Channel::Sint(_));
                let back = if signed { Word2::ShiftRightSigned } else { Word2::ShiftRightUnsigned };
                self.word2(site, back, raised, up, value.scalar)
            }
        }
    }

    /// An atomic function on a texel, which has one channel of 32 bits.
    pub(super) fn atomic_texel(
        &mut self,
        frame: &mut Frame<'m>,
        image: Handle<Expression>,
        at: Coordinates,
        function: &AtomicFunction,
        value: Handle<Expression>,
        span: naga::Span,
    ) -> Result<(), InterpError> {
        let (memory, texels) = self.storage(frame, image, span)?;
        let value = self.single(frame, value)?;
        let (op, compare) = self.combine(frame, function)?;
        let site = self.statement_site(frame, span);
        let op = MemoryOp::Atomic { op, value, compare, before: None, exchanged: None };
        let access = self.texel_access(frame, memory, &texels, at, op, site)?;
        self.push(Inst::Memory(MemoryAccess { atomic: true, ..access }));
        Ok(())
    }

    /// Sizes and counts of a storage image, which has one level and one sample; `None` for a texture.
    pub(super) fn storage_query(
        &mut self,
        frame: &mut Frame<'m>,
        image: Handle<Expression>,
        query: ImageQuery,
    ) -> Result<Option<Vec<Register>>, InterpError> {
        let Some((memory, texels)) = self.texels(frame, image)? else { return Ok(None) };
        let plane = texels.axes - usize::from(texels.layered);
        let axes = match query {
            ImageQuery::NumLevels | ImageQuery::NumSamples => return Ok(Some(vec![self.word(1, Scalar::U32)])),
            ImageQuery::NumLayers => plane..texels.axes,
            ImageQuery::Size { .. } => 0..plane,
        };
        let side = |axis: usize| {
            let to = self.temporary();
            self.push(Inst::Length { memory, of: Extent::Side(axis), to });
            Register { scalar: Scalar::U32, reg: to }
        };
        Ok(Some(axes.map(side).collect()))
    }
}
