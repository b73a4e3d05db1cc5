//! The relations that suites can name, one family a file. None of them uses a formula: they compare
//! outputs with each other, or with inputs that an output must equal.
//!
//! Related inputs are exact in binary32: points are moved to a grid, and maps exchange and reverse
//! axes, scale by powers of two and shift by integers. What a lane may be off is carried through a
//! relation's arithmetic as a radius, so that a claim's slack is never chosen.

mod blending;
#[cfg(test)]
mod faults;
mod hair;
mod joints;
mod morph;
mod projection;
mod segment;
mod spline;
mod surface;
#[cfg(test)]
mod testing;
mod weight;

use property::Relation;

/// All relations, in the order of the manual.
pub static ALL: &[&dyn Relation] = &[
    &projection::PROJECTION_LAST,
    &surface::SURFACE_SEAM,
    &surface::SPHERE_RADIUS,
    &surface::SPHERE_POLES,
    &surface::SPHERE_ANTIPODE,
    &surface::CYLINDER_RADIUS,
    &surface::CYLINDER_HEIGHT,
    &surface::CYLINDER_STRAIGHT,
    &morph::MORPH_ENDS,
    &morph::MORPH_ON_SEGMENT,
    &morph::MORPH_SWAPPED,
    &morph::MORPH_AFFINE,
    &morph::TARGETS_BASE,
    &morph::TARGETS_SINGLE,
    &morph::TARGETS_PERMUTED,
    &morph::TARGETS_LINEAR,
    &joints::JOINTS_REST,
    &joints::JOINTS_OWN_PART,
    &joints::JOINTS_COMMON_MOTION,
    &joints::JOINTS_FOLLOW,
    &joints::JOINTS_COLLAPSE,
    &blending::BLEND_REST,
    &blending::BLEND_COMMON_MOTION,
    &blending::TWO_BONES_SWAPPED,
    &blending::TWO_BONES_HULL,
    &blending::TWO_BONES_RAW_WEIGHTS,
    &blending::SKINNING_PERMUTED,
    &blending::SKINNING_ADDITIVE,
    &blending::SKINNING_HULL,
    &blending::SKINNING_WEIGHTS,
    &blending::SKINNING_NEAREST,
    &hair::HAIR_STRIP,
    &hair::HAIR_UNIT,
    &hair::HAIR_TANGENT,
    &hair::HAIR_VIEW,
    &hair::HAIR_LIGHT,
    &hair::HAIR_REVERSED,
    &hair::HAIR_AFFINE,
    &hair::HAIR_COLLINEAR,
    &hair::HAIR_C1,
    &spline::HERMITE_TANGENTS,
    &spline::HERMITE_REVERSED,
    &spline::HERMITE_AFFINE,
    &spline::HERMITE_COLLINEAR,
    &spline::SPLINE_ENDS,
    &spline::SPLINE_REVERSED,
    &spline::SPLINE_AFFINE,
    &spline::SPLINE_COLLINEAR,
    &spline::SPLINE_C1,
    &spline::CATMULL_ROM_TANGENTS,
    &spline::CATMULL_ROM_DERIVATIVE,
    &spline::CARDINAL_IS_CATMULL_ROM,
    &spline::CARDINAL_POLYLINE,
    &spline::CARDINAL_TANGENTS,
    &spline::KOCHANEK_BARTELS_IS_CATMULL_ROM,
    &spline::KOCHANEK_BARTELS_POLYLINE,
    &spline::KOCHANEK_BARTELS_BIAS,
    &spline::KOCHANEK_BARTELS_CORNER,
    &segment::SEGMENT_NOT_NEGATIVE,
    &segment::SEGMENT_ZERO_ON_IT,
    &segment::SEGMENT_CASES,
    &segment::SEGMENT_SWAPPED,
    &segment::SEGMENT_NO_FARTHER,
    &segment::SEGMENT_SPLIT,
    &segment::SEGMENT_LIPSCHITZ,
    &segment::SEGMENT_DEGENERATE,
    &segment::SEGMENT_RIGID,
    &weight::WEIGHT_ONE_AT_ZERO,
    &weight::WEIGHT_RANGE,
    &weight::WEIGHT_FALLS,
    &weight::WEIGHT_SQUARES,
];

/// All relations.
pub fn all() -> &'static [&'static dyn Relation] {
    ALL
}

/// The relation called `name`.
pub fn by_name(name: &str) -> Option<&'static dyn Relation> {
    all().iter().copied().find(|r| r.name() == name)
}
