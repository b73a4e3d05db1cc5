//! The formulas of the shipped suites for numbers of any kind: what reference data are computed with, in
//! some 100 bits and rounded once.
//!
//! They are written from the mathematics a second time, apart from `formula`, and in forms in which
//! little cancels: a distance to a line is a quotient of determinants and no difference of vectors. Tests
//! hold them against `formula`, and their values against numbers of 400 bits.

mod blending;
mod curve;
mod hair;
pub mod quick;
mod surface;
#[cfg(test)]
mod tests;
mod vector;

use number::twofold::Real;

pub use vector::Words;

/// What is special about a set of inputs.
#[derive(Clone, Copy, Debug)]
pub struct Marks<R: Real> {
    /// The nearest point of a segment is one of its ends.
    pub segment_end: R::Mask,
    /// A segment of length 0, two nodes at one place, or a direction of the zero vector.
    pub degenerate: R::Mask,
}

impl<R: Real> Marks<R> {
    /// Nothing is special.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn none() -> Self {
        let nowhere = R::exact(1.0).is_zero();
        Self { segment_end: nowhere, degenerate: nowhere }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn segment_end(&mut self, mask: R::Mask) {
        self.segment_end = R::or(self.segment_end, mask);
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn degenerate(&mut self, mask: R::Mask) {
        self.degenerate = R::or(self.degenerate, mask);
    }
}

/// A formula that can be computed exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exact {
    /// Section 9.1, the sphere.
    Sphere,
    /// Section 9.1, the cylinder.
    Cylinder,
    /// (72)
    Morph,
    /// (73), (74)
    MorphTargets,
    /// Section 9.3.1.
    Joints,
    /// (75)
    TwoBones,
    /// (76), (79), (80), (81)
    Skinning,
    /// The strand of hair.
    Hair,
    /// A cubic by ends and tangents.
    Hermite,
    /// Catmull-Rom, with its derivative.
    CatmullRom,
    /// A Cardinal spline.
    Cardinal,
    /// A Kochanek-Bartels spline.
    KochanekBartels,
    /// (78), (79)
    SegmentDistance,
    /// (80)
    BoneWeight,
}

impl Exact {
    /// All of them, in the order of [`crate::formula`]'s list.
    pub const ALL: [Self; 14] = [
        Self::Sphere,
        Self::Cylinder,
        Self::Morph,
        Self::MorphTargets,
        Self::Joints,
        Self::TwoBones,
        Self::Skinning,
        Self::Hair,
        Self::Hermite,
        Self::CatmullRom,
        Self::Cardinal,
        Self::KochanekBartels,
        Self::SegmentDistance,
        Self::BoneWeight,
    ];

    /// Name, as suites write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Cylinder => "cylinder",
            Self::Morph => "morph",
            Self::MorphTargets => "morph_targets",
            Self::Joints => "joints",
            Self::TwoBones => "two_bones",
            Self::Skinning => "skinning",
            Self::Hair => "hair",
            Self::Hermite => "hermite",
            Self::CatmullRom => "catmull_rom",
            Self::Cardinal => "cardinal",
            Self::KochanekBartels => "kochanek_bartels",
            Self::SegmentDistance => "segment_distance",
            Self::BoneWeight => "bone_weight",
        }
    }

    /// The formula of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|exact| exact.name() == name)
    }

    /// Words of its outputs, of all vertices together.
    pub fn outputs(self) -> usize {
        match self {
            Self::Hair => hair::VERTICES * hair::WORDS,
            Self::TwoBones => 12,
            Self::CatmullRom => 8,
            Self::SegmentDistance | Self::BoneWeight => 1,
            Self::Sphere
            | Self::Cylinder
            | Self::Morph
            | Self::MorphTargets
            | Self::Joints
            | Self::Skinning
            | Self::Hermite
            | Self::Cardinal
            | Self::KochanekBartels => 4,
        }
    }

    /// Computes the outputs for inputs in the order of the formula's list. Where there is no value, NaN.
    ///
    /// # Panics
    /// When `out` is not as long as [`Exact::outputs`] says: a defect of the caller.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn evaluate<R: Real, W: Words<R>>(self, words: &W, out: &mut [R]) -> Marks<R> {
        assert_eq!(out.len(), self.outputs(), "outputs of another formula");
        let mut marks = Marks::none();
        match self {
            Self::Sphere => surface::sphere(words, out),
            Self::Cylinder => surface::cylinder(words, out),
            Self::Morph => blending::morph(words, out),
            Self::MorphTargets => blending::morph_targets(words, out),
            Self::Joints => blending::joints(words, out),
            Self::TwoBones => blending::two_bones(words, out),
            Self::Skinning => blending::skinning(words, out, &mut marks),
            Self::Hair => hair::hair(words, out, &mut marks),
            Self::Hermite => curve::hermite(words, out),
            Self::CatmullRom => curve::catmull_rom(words, out, &mut marks),
            Self::Cardinal => curve::cardinal(words, out, &mut marks),
            Self::KochanekBartels => curve::kochanek_bartels(words, out, &mut marks),
            Self::SegmentDistance => out[0] = blending::segment_distance(words, &mut marks),
            Self::BoneWeight => out[0] = blending::bone_weight(words),
        }
        marks
    }
}
