//! Storage images: memory of texels, whose size the host states. What is outside of one reads as 0 and is not written
//! (WGSL, 17.7; Vulkan with robust access), so that no index is called wrong there.

use naga::{Expression, Handle, ImageQuery, TypeInner};

use super::super::code::{Inst, Register, Word2};
use super::super::domain::Site;
use super::super::group::{MemoryAccess, MemoryOp, Step};
use super::{Compiler, Frame, InterpError};
use base::value::Scalar;

impl<'m> Compiler<'m> {
    /// The memory behind a storage image, with its axes; none for a texture.
    pub(super) fn storage_image(&self, frame: &Frame<'m>, image: Handle<Expression>) -> Option<(u32, usize)> {
        let Expression::GlobalVariable(global) = frame.function.expressions[image] else { return None };
        let index = self.subject.shared.iter().position(|own| *own == global)?;
        let axes = self.executable.memories.get(index)?.image?;
        Some((index as u32, axes))
    }

    fn extent(&mut self, memory: u32, axis: u8) -> Register {
        let to = Register { scalar: Scalar::U32, reg: self.temporary() };
        self.push(Inst::Extent { memory, axis, to: to.reg });
        to
    }

    /// The number of a texel; one that no image has where it is outside.
    fn texel_number(
        &mut self,
        frame: &mut Frame<'m>,
        site: Site,
        (memory, axes): (u32, usize),
        (coordinate, layer): (Handle<Expression>, Option<Handle<Expression>>),
    ) -> Result<Step, InterpError> {
        let mut at = self.registers(frame, coordinate)?.to_vec();
        if let Some(layer) = layer {
            at.push(self.single(frame, layer)?);
        }
        let (mut inside, mut number) = (self.word(1, Scalar::Bool), self.word(0, Scalar::U32));
        for (axis, &at) in at.iter().enumerate().take(axes).rev() {
            let extent = self.extent(memory, axis as u8);
            // A negative number is a large one without a sign.
            let within = self.word2(site, Word2::LessUnsigned, at, extent, Scalar::Bool);
            inside = self.word2(site, Word2::And, inside, within, Scalar::Bool);
            let row = self.word2(site, Word2::MultiplyUnsigned, number, extent, Scalar::U32);
            number = self.word2(site, Word2::AddUnsigned, row, at, Scalar::U32);
        }
        let none = self.word(u32::MAX, Scalar::U32);
        let number = self.select(inside, number, none);
        Ok(Step { reg: number.reg, stride: 4, len: None, site })
    }

    fn texel(memory: u32, step: Step, op: MemoryOp, site: Site) -> Inst {
        Inst::Memory(MemoryAccess { memory, offset: 0, steps: vec![step], op, atomic: false, quiet: true, site })
    }

    /// The four components of a texel.
    pub(super) fn load_texel(
        &mut self,
        frame: &mut Frame<'m>,
        site: Site,
        image: (u32, usize),
        at: (Handle<Expression>, Option<Handle<Expression>>),
    ) -> Result<Vec<Register>, InterpError> {
        let step = self.texel_number(frame, site, image, at)?;
        let array = self.executable.memories[image.0 as usize].array.as_ref();
        let scalars: Vec<Scalar> = array.map(|a| a.leaves.iter().map(|leaf| leaf.scalar).collect()).unwrap_or_default();
        let parts: Vec<(Register, u32)> =
            (0..).zip(scalars).map(|(k, scalar)| (Register { scalar, reg: self.temporary() }, k)).collect();
        let loaded = parts.iter().map(|(to, _)| *to).collect();
        self.push(Self::texel(image.0, step, MemoryOp::Load(parts), site));
        Ok(loaded)
    }

    /// Writes a texel.
    pub(super) fn store_texel(
        &mut self,
        frame: &mut Frame<'m>,
        image: (u32, usize),
        at: (Handle<Expression>, Option<Handle<Expression>>),
        value: Handle<Expression>,
    ) -> Result<(), InterpError> {
        let site = self.statement_site(frame, frame.span);
        let step = self.texel_number(frame, site, image, at)?;
        let value = self.registers(frame, value)?.to_vec();
        self.push(Self::texel(image.0, step, MemoryOp::Store(value.into_iter().zip(0..).collect()), site));
        Ok(())
    }

    /// Its size, or the number of its layers.
    pub(super) fn image_extent(
        &mut self,
        frame: &Frame<'m>,
        image: Handle<Expression>,
        memory: u32,
        query: ImageQuery,
    ) -> Vec<Register> {
        let axes = match frame.info[image].ty.inner_with(&self.module.types) {
            TypeInner::Image { dim: naga::ImageDimension::D1, .. } => 1,
            TypeInner::Image { dim: naga::ImageDimension::D3, .. } => 3,
            _ => 2,
        };
        match query {
            ImageQuery::Size { .. } => (0..axes).map(|axis| self.extent(memory, axis)).collect(),
            ImageQuery::NumLayers => vec![self.extent(memory, axes)],
            ImageQuery::NumLevels | ImageQuery::NumSamples => vec![self.word(1, Scalar::U32)],
        }
    }
}
