//! What memory that invocations share looks like.

use std::sync::Arc;

use super::super::halved;
use super::texels::Texels;
use base::value::Scalar;

/// Who sees a memory, and what may be done with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Space {
    /// The invocations of a workgroup.
    Workgroup,
    /// All invocations, and the host.
    Storage {
        /// Whether invocations may write it.
        writes: bool,
    },
    /// What the host gives all invocations to read: uniform buffers and push constants.
    Uniform,
}

/// A scalar in memory. A word is as long as the shortest scalar of its memory: see [`MemoryShape::unit`].
#[derive(Clone, Debug, PartialEq)]
pub struct Leaf {
    /// Names of the members on the way to it; `[]` stands for an index.
    pub name: Arc<str>,
    /// Words from the beginning of the memory, or of the element.
    pub offset: u32,
    /// Its type.
    pub scalar: Scalar,
    /// True for a number of 16 bits.
    pub short: bool,
    /// For a component of a vector or matrix, which one.
    pub component: Option<u32>,
    /// Lengths of the arrays of fixed size on the way to it, outermost first.
    pub lens: Arc<[u32]>,
}

impl Leaf {
    /// The name with an index for each array: those of the element number `before` of this name.
    fn with_indices(&self, before: u32) -> String {
        let mut rest = before;
        let mut indices: Vec<u32> = Vec::new();
        for len in self.lens.iter().rev() {
            indices.push(rest % len.max(&1));
            rest /= len.max(&1);
        }
        indices.iter().rev().fold(self.name.to_string(), |name, index| name.replacen("[]", &format!("[{index}]"), 1))
    }
}

/// An array that is as long as its memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Its name, where it is a member.
    pub name: String,
    /// Words in front of its first element.
    pub offset: u32,
    /// Words from one element to the next.
    pub stride: u32,
    /// The scalars of one element.
    pub leaves: Vec<Leaf>,
}

/// A variable in memory that invocations share.
#[derive(Clone, Debug, PartialEq)]
pub struct MemoryShape {
    /// Name of the variable.
    pub name: String,
    /// Who sees it.
    pub space: Space,
    /// Bytes of a word: 4, or 2 where numbers of 16 bits are in it. A number that is longer is told by its first word.
    pub unit: u32,
    /// Words without the elements of `array`.
    pub words: u32,
    /// The scalars in front of `array`.
    pub fixed: Vec<Leaf>,
    /// What is at its end, where its size is left to the host.
    pub array: Option<Array>,
    /// For an image, what its elements are.
    pub image: Option<Texels>,
}

impl MemoryShape {
    /// True for an array that is as long as its host makes it.
    pub fn is_open(&self) -> bool {
        self.array.is_some() && self.image.is_none()
    }

    /// True for an image with a type of its own, which lies in no buffer.
    pub fn is_image(&self) -> bool {
        self.image.as_ref().is_some_and(|texels| !texels.is_in_buffer())
    }

    /// Coordinates of the texel at a word of an image with these sides.
    pub fn texel(&self, word: u32, sides: [u32; 3]) -> Option<Vec<u32>> {
        let (texels, array) = (self.image.as_ref()?, self.array.as_ref()?);
        let mut rest = word.checked_sub(array.offset)? / array.stride;
        let mut coordinates = Vec::new();
        for side in &sides[..texels.axes] {
            coordinates.push(rest % side.max(&1));
            rest /= side.max(&1);
        }
        Some(coordinates)
    }

    /// Words with so many elements in the array.
    pub fn words_with(&self, elements: u32) -> usize {
        let array =
            self.array.as_ref().map_or(0, |array| array.offset as usize + array.stride as usize * elements as usize);
        (self.words as usize).max(array)
    }

    /// Brings what a host gives to the nearest numbers of binary16, and to the low bits of whole numbers, where memory
    /// holds such.
    pub(super) fn narrow(&self, words: &mut [u32]) {
        let end = words.len() as u32;
        let mut each = |leaf: &Leaf, at: u32| {
            if let Some(word) = words.get_mut((at + leaf.offset) as usize).filter(|_| leaf.short) {
                *word = match leaf.scalar {
                    Scalar::F32 => halved(f32::from_bits(*word)).to_bits(),
                    Scalar::I32 => i32::from(*word as i16).cast_unsigned(),
                    Scalar::U32 | Scalar::Bool => *word & 0xffff,
                };
            }
        };
        self.fixed.iter().for_each(|leaf| each(leaf, 0));
        if let Some(array) = self.array.as_ref().filter(|array| array.leaves.iter().any(|leaf| leaf.short)) {
            (array.offset..end).step_by(array.stride as usize).for_each(|at| {
                array.leaves.iter().for_each(|leaf| each(leaf, at));
            });
        }
    }

    /// What stands at a word: the index in the array, where it lies in it, and the scalar.
    pub fn at(&self, word: u32) -> Option<(Option<u32>, &Leaf)> {
        if let Some(array) = self.array.as_ref().filter(|array| word >= array.offset) {
            let (index, rest) = ((word - array.offset) / array.stride, (word - array.offset) % array.stride);
            return array.leaves.iter().find(|leaf| leaf.offset == rest).map(|leaf| (Some(index), leaf));
        }
        let k = self.fixed.binary_search_by_key(&word, |leaf| leaf.offset).ok()?;
        Some((None, &self.fixed[k]))
    }

    /// The author's words for the place of a word: `particles[3].position`.
    pub fn place(&self, word: u32) -> String {
        let Some((index, leaf)) = self.at(word) else { return format!("{} at byte {}", self.name, self.unit * word) };
        let array = self.array.as_ref().filter(|_| index.is_some());
        let mut text = self.name.clone();
        let dot = |text: &mut String, part: &str| {
            if !part.is_empty() {
                if !text.is_empty() && !part.starts_with('[') {
                    text.push('.');
                }
                text.push_str(part);
            }
        };
        match (array, index) {
            (Some(array), Some(index)) => {
                dot(&mut text, &array.name);
                text.push_str(&format!("[{index}]"));
                let same =
                    array.leaves.iter().filter(|other| other.name == leaf.name && other.component == leaf.component);
                let before = same.take_while(|other| other.offset < leaf.offset).count();
                let whole = leaf.with_indices(before as u32);
                dot(&mut text, whole.strip_prefix(&array.name[..]).unwrap_or(&whole).trim_start_matches('.'));
            }
            _ => {
                // Which element it is follows from the elements of the same name in front of it.
                let same =
                    self.fixed.iter().filter(|other| other.name == leaf.name && other.component == leaf.component);
                let before = same.take_while(|other| other.offset < word).count();
                dot(&mut text, &leaf.with_indices(before as u32));
            }
        }
        if let Some(k) = leaf.component {
            text.push_str([".x", ".y", ".z", ".w"].get(k as usize).copied().unwrap_or(""));
        }
        text
    }
}
