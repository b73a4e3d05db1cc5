//! Textures that the harness supplies: what a sampler of a shader is bound to when it is run.
//!
//! Every texture has one level, is sampled with the nearest texel and clamped to its edge; a sampler with
//! a comparison asks whether the reference is at most the depth of the texel (`GL_LEQUAL`).
//!
//! A coordinate chooses an integer. Where rounding may choose another one, the decision is open like that of a
//! comparison.

mod image;

use std::fmt;
use std::sync::Arc;

use naga::{GlobalVariable, Handle, ImageClass, ImageDimension, ScalarKind};
use serde::{Deserialize, Serialize};

pub use image::{Image, Picture};

/// How many coordinates a texture has, and what they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Dimension {
    /// One coordinate.
    D1,
    /// Two coordinates.
    D2,
    /// Three coordinates.
    D3,
    /// A direction.
    Cube,
}

/// What a texel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Texel {
    /// Four binary32 numbers.
    Float,
    /// Four signed integers.
    Int,
    /// Four unsigned integers.
    Uint,
    /// A depth from 0 to 1, in steps of 1/65535.
    Depth,
}

/// What kind of texture a sampler takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct TextureKind {
    /// Its coordinates.
    pub dimension: Dimension,
    /// Whether it has layers.
    pub arrayed: bool,
    /// What its texels hold.
    pub texel: Texel,
}

impl TextureKind {
    /// The kind of an image of a module; `None` for one that the harness does not supply.
    pub(crate) fn of(dim: ImageDimension, arrayed: bool, class: ImageClass) -> Option<Self> {
        let texel = match class {
            ImageClass::Sampled { kind: ScalarKind::Float, multi: false } => Texel::Float,
            ImageClass::Sampled { kind: ScalarKind::Sint, multi: false } => Texel::Int,
            ImageClass::Sampled { kind: ScalarKind::Uint, multi: false } => Texel::Uint,
            ImageClass::Depth { multi: false } => Texel::Depth,
            ImageClass::Sampled { .. }
            | ImageClass::Depth { multi: true }
            | ImageClass::Storage { .. }
            | ImageClass::External => return None,
        };
        let dimension = match dim {
            ImageDimension::D1 => Dimension::D1,
            ImageDimension::D2 => Dimension::D2,
            ImageDimension::D3 => Dimension::D3,
            ImageDimension::Cube => Dimension::Cube,
        };
        // No API has layers of these, or compares in them.
        let odd = matches!((dimension, arrayed), (Dimension::D1 | Dimension::D3, true))
            || (texel == Texel::Depth && matches!(dimension, Dimension::D1 | Dimension::D3));
        (!odd).then_some(Self { dimension, arrayed, texel })
    }

    /// Width, height, and depth or layers of the texture that stands in where nothing else is asked for.
    /// The sides differ, so that coordinates in the wrong order show.
    pub fn usual_size(self) -> [u32; 3] {
        match (self.dimension, self.arrayed) {
            (Dimension::D1, _) => [16, 1, 1],
            (Dimension::D2, false) => [16, 8, 1],
            (Dimension::D2, true) => [16, 8, 3],
            (Dimension::D3, _) => [8, 4, 2],
            (Dimension::Cube, false) => [4, 4, 6],
            (Dimension::Cube, true) => [4, 4, 12],
        }
    }
}

impl fmt::Display for TextureKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let dimension = match self.dimension {
            Dimension::D1 => "1D",
            Dimension::D2 => "2D",
            Dimension::D3 => "3D",
            Dimension::Cube => "cube",
        };
        let array = if self.arrayed { " array" } else { "" };
        let texel = match self.texel {
            Texel::Float => "float",
            Texel::Int => "int",
            Texel::Uint => "uint",
            Texel::Depth => "depth",
        };
        write!(f, "{dimension}{array}, {texel}")
    }
}

/// A sampler of a program, with what it is bound to.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The way to the sampler as the author writes it, such as `material.diffuse` or `maps[2]`.
    pub name: String,
    /// What kind of texture it takes.
    pub kind: TextureKind,
    /// The image in the module.
    pub image: Handle<GlobalVariable>,
    /// The sampler in the module.
    pub sampler: Option<Handle<GlobalVariable>>,
    /// What it is bound to.
    pub contents: Arc<Image>,
}

impl fmt::Display for Texture {
    /// `diffuse: 2D, float, 16 x 8, procedural`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height, layers] = self.contents.size();
        write!(f, "{}: {}, {width} x {height}", self.name, self.kind)?;
        if layers > 1 {
            write!(f, " x {layers}")?;
        }
        write!(f, ", {}", self.contents.about())
    }
}
