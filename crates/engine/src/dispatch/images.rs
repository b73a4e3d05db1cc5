//! What a host binds as images and textures: as many texels along each axis as the dispatch has elements.
//!
//! Where a shader asks for the sizes of several images, these may differ. So some dispatches have images of which every
//! other one is smaller: whoever guards a store by the size of another image than the one that is written shows there.

use std::sync::Arc;

use program::interp::group::{Access, Buffer, Channel, Incident, MemoryShape, Texels, Wrong, apart};
use program::interp::{self, Executable};
use program::texture::{Dimension, Image};

use super::Dispatched;

/// Texels along an axis that no invocation is counted along.
const FEW: u32 = 3;

/// Texels of an image at most.
const MOST: u32 = 1 << 20;

impl Dispatched {
    /// Width, height, and depth or layers of an image for so many elements.
    fn sides(&self, items: [u32; 3], axes: usize) -> [u32; 3] {
        let side = |axis: usize| match axis {
            _ if axis >= axes => 1,
            _ if axis == 0 || self.size[axis] > 1 || self.axes.contains(&axis) => items[axis],
            _ => FEW,
        };
        std::array::from_fn(side)
    }

    /// The sides of the image that a memory is. `smaller` says of which images: those with even numbers, or with odd ones.
    pub(super) fn sides_of(&self, memory: usize, items: [u32; 3], smaller: Option<usize>) -> [u32; 3] {
        let memories = self.executable.memories();
        let Some(texels) = &memories[memory].image else { return [0; 3] };
        let number = memories[..memory].iter().filter(|shape| shape.image.is_some()).count();
        let mut sides = self.sides(items, texels.axes);
        // It may be a cube.
        if texels.is_in_buffer() && texels.axes == 3 {
            sides[2] = sides[2].max(6);
        }
        if smaller == Some(number % 2) {
            sides.iter_mut().take(2).for_each(|side| *side = side.div_ceil(2));
        }
        let plane = sides[0].saturating_mul(sides[1]).max(1);
        sides[2] = sides[2].min(MOST / plane).max(1);
        sides
    }

    /// What is run for so many elements: the stage with textures of that size.
    pub(super) fn executable_for(&self, items: [u32; 3]) -> Arc<Executable> {
        if self.program.textures.is_empty() {
            return self.executable.clone();
        }
        let mut program = self.program.clone();
        for texture in &mut program.textures {
            let kind = texture.kind;
            let [width, height, layers] = self.sides(items, 3);
            let usual = kind.usual_size()[2];
            let size = match kind.dimension {
                Dimension::D1 => [width, 1, 1],
                Dimension::D2 if kind.arrayed => [width, height, layers],
                Dimension::D2 => [width, height, 1],
                Dimension::D3 => [width, height, layers],
                Dimension::Cube => [width.max(height), width.max(height), usual],
            };
            texture.contents = Arc::new(Image::procedural_of(&texture.name, kind, size));
        }
        // It was compiled before with textures of other sizes.
        interp::compile_dispatch(&program).map_or_else(|_| self.executable.clone(), Arc::new)
    }

    /// Which images are smaller than the others, in one dispatch after the other.
    pub(super) fn smaller_images(&self) -> &'static [usize] {
        if self.uses.sizes.len() > 1 { &[0, 1] } else { &[] }
    }

    /// For a store outside of an image under a guard by the size of another image alone, that image. The stage asks for the
    /// size of its own as well, so that both may differ.
    pub(super) fn guarded_by(&self, incident: &Incident, groups: [u32; 3]) -> Option<&MemoryShape> {
        let own = incident.memory? as usize;
        let (index, _) = incident.index?;
        let memories = self.executable.memories();
        let store = incident.what == Wrong::Outside && incident.who.access == Access::Write;
        if !store || !memories[own].is_image() || !self.uses.sizes.contains(&(own as u32)) {
            return None;
        }
        let sources = self.depends.of(incident.who.site);
        if sources.has_size(own) {
            return None;
        }
        // What is scaled on its way is guarded in its own way.
        let (group, local) = (apart(incident.who.group, groups), apart(incident.who.local, self.size));
        let is_number = (0..3).any(|axis| group[axis] * self.size[axis] + local[axis] == index);
        let mut others = memories.iter().enumerate().filter(|(k, shape)| shape.image.is_some() && sources.has_size(*k));
        others.next().filter(|_| is_number).map(|(_, shape)| shape)
    }
}

/// Puts the size in front of an image that lies in a buffer.
pub(super) fn write_size(words: &mut [u32], sides: [u32; 3]) {
    let size = [sides[0], sides[1], sides[2], 1];
    words.iter_mut().zip(size).for_each(|(word, side)| *word = side);
}

/// What a channel of an image holds: numbers of its format, from 0 on.
pub(super) fn held(texels: &Texels, channel: usize, word: u32) -> u32 {
    match texels.channels.get(channel) {
        Some(channel @ (Channel::Uint(_) | Channel::Sint(_))) => channel.kept(word),
        Some(channel) => channel.kept(f32::from_bits(word).abs().to_bits()),
        None => word,
    }
}

/// The author's words for a texel: `` `image` at (3, 2) ``.
pub(super) fn texel(shape: &MemoryShape, word: u32, buffer: &Buffer) -> Option<String> {
    let at: Vec<String> = shape.texel(word, buffer.sides)?.iter().map(u32::to_string).collect();
    Some(format!("`{}` at ({})", shape.name, at.join(", ")))
}

/// The sides of an image, for a report.
pub(super) fn sides_shown(shape: &MemoryShape, buffer: &Buffer) -> Option<(String, Vec<u32>)> {
    let texels = shape.image.as_ref()?;
    Some((format!("size of `{}`", shape.name), buffer.sides[..texels.axes].to_vec()))
}
