//! What a formula reads and writes.

use glam::{DMat4, DVec2, DVec3, DVec4};

/// Kind of one input or output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Float,
    /// An integer, held in a binary64.
    Int,
    /// Two components.
    Vec2,
    /// Three components.
    Vec3,
    /// Four components.
    Vec4,
    /// Sixteen components, column by column.
    Mat4,
}

impl Kind {
    /// Number of components.
    pub const fn words(self) -> usize {
        match self {
            Self::Float | Self::Int => 1,
            Self::Vec2 => 2,
            Self::Vec3 => 3,
            Self::Vec4 => 4,
            Self::Mat4 => 16,
        }
    }
}

/// A named input or output of a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Param {
    /// Name in the shader; `return` for the value of a function.
    pub name: &'static str,
    /// Kind of the value, or of an element.
    pub kind: Kind,
    /// Number of elements when it is an array.
    pub array: Option<usize>,
}

impl Param {
    /// A value that is no array.
    pub const fn new(name: &'static str, kind: Kind) -> Self {
        Self { name, kind, array: None }
    }

    /// An array of `len` elements.
    pub const fn array(name: &'static str, kind: Kind, len: usize) -> Self {
        Self { name, kind, array: Some(len) }
    }

    /// Words of the whole value.
    pub const fn words(&self) -> usize {
        match self.array {
            Some(len) => self.kind.words() * len,
            None => self.kind.words(),
        }
    }
}

/// The inputs of one evaluation: words in the order of the formula's inputs, without padding.
#[derive(Clone, Copy, Debug)]
pub struct Args<'a> {
    words: &'a [f64],
    params: &'a [Param],
}

impl<'a> Args<'a> {
    /// Inputs described by `params`. `words` holds exactly their words.
    ///
    /// # Panics
    /// When the number of words is not that of the parameters: a defect of the caller.
    pub fn new(params: &'a [Param], words: &'a [f64]) -> Self {
        debug_assert_eq!(words.len(), params.iter().map(Param::words).sum::<usize>());
        Self { words, params }
    }

    /// Words of the input with this index.
    pub fn words(&self, index: usize) -> &'a [f64] {
        let at: usize = self.params[..index].iter().map(Param::words).sum();
        &self.words[at..at + self.params[index].words()]
    }

    /// A number.
    pub fn float(&self, index: usize) -> f64 {
        self.words(index)[0]
    }

    /// An integer, as `usize`; negative ones become 0.
    pub fn count(&self, index: usize) -> usize {
        self.words(index)[0] as usize
    }

    /// Two components.
    pub fn vec2(&self, index: usize) -> DVec2 {
        DVec2::from_slice(self.words(index))
    }

    /// Three components.
    pub fn vec3(&self, index: usize) -> DVec3 {
        DVec3::from_slice(self.words(index))
    }

    /// Four components.
    pub fn vec4(&self, index: usize) -> DVec4 {
        DVec4::from_slice(self.words(index))
    }

    /// Element `k` of an array of numbers.
    pub fn float_at(&self, index: usize, k: usize) -> f64 {
        self.words(index)[k]
    }

    /// Element `k` of an array of four-component vectors.
    pub fn vec4_at(&self, index: usize, k: usize) -> DVec4 {
        DVec4::from_slice(&self.words(index)[4 * k..])
    }

    /// A matrix.
    pub fn mat4(&self, index: usize) -> DMat4 {
        DMat4::from_cols_slice(self.words(index))
    }

    /// Element `k` of an array of matrices.
    pub fn mat4_at(&self, index: usize, k: usize) -> DMat4 {
        DMat4::from_cols_slice(&self.words(index)[16 * k..])
    }
}

/// Vertices that a geometry stage emits for one primitive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Emission {
    /// Words of all vertices, one vertex after the other, each with the formula's outputs in order.
    pub words: Vec<f64>,
    /// For each vertex, the number of its strip, counted from 0.
    pub strips: Vec<u32>,
    strip: u32,
}

impl Emission {
    /// Emits a vertex with these words.
    pub fn emit(&mut self, words: &[f64]) {
        self.words.extend_from_slice(words);
        self.strips.push(self.strip);
    }

    /// Ends the strip.
    pub fn end_strip(&mut self) {
        self.strip += 1;
    }

    /// Forgets all vertices, for the next primitive.
    pub fn clear(&mut self) {
        self.words.clear();
        self.strips.clear();
        self.strip = 0;
    }
}
