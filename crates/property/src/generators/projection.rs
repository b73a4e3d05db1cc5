//! `projection`: matrices from model to clip coordinates.

use glam::{DMat4, DVec4};

use base::value::Shape;

use super::{Generator, Group, Options, Place, RangeRule, SPECIAL, Stream, every_shape, is_mat4, matrix};

/// Perspective (three times of four) or parallel projections after a rigid view transform with its
/// translation in the range. Special: the identity, projections without a view transform, a view
/// transform without a projection.
pub struct Projection;

/// Entries above this are not those of a sensible projection, and would hide everything else.
const LARGEST: f64 = 4096.0;

/// OpenGL's frustum matrix with depth -1 to 1, for a viewer at the origin looking along -z.
fn perspective(stream: &mut Stream) -> DMat4 {
    let (focal, aspect) = (stream.between(0.5, 4.0), stream.between(0.5, 2.0));
    let near = stream.between(0.1, 1.0);
    let far = near * stream.between(2.0, 100.0);
    let depth = near - far;
    DMat4::from_cols(
        DVec4::new(focal / aspect, 0.0, 0.0, 0.0),
        DVec4::new(0.0, focal, 0.0, 0.0),
        DVec4::new(0.0, 0.0, (far + near) / depth, -1.0),
        DVec4::new(0.0, 0.0, 2.0 * far * near / depth, 0.0),
    )
}

fn parallel(stream: &mut Stream) -> DMat4 {
    let mut scale = || stream.between(0.125, 2.0);
    let mut m = DMat4::from_diagonal(DVec4::new(scale(), scale(), -scale(), 1.0));
    m.w_axis.z = stream.between(-1.0, 1.0);
    m
}

impl Generator for Projection {
    fn name(&self) -> &str {
        "projection"
    }

    fn about(&self) -> &str {
        "perspective and parallel projections of views that are rigid, with translations in `range`"
    }

    fn range(&self) -> RangeRule {
        RangeRule::Default(-2.0, 2.0)
    }

    fn check(&self, shapes: &[Shape], _options: &Options) -> Result<(), String> {
        every_shape(self.name(), shapes, "mat4 and arrays of mat4", is_mat4)
    }

    fn fill(&self, group: &Group, _place: Place, stream: &mut Stream, out: &mut [u32]) {
        let special = stream.one_in(SPECIAL);
        for element in group.elements() {
            let m = match (special, stream.below(4)) {
                (true, 0) => DMat4::IDENTITY,
                (true, 1) => perspective(stream),
                (true, 2) => parallel(stream),
                (true, _) => matrix::special_rigid(group.range(), stream),
                (false, 0) => parallel(stream) * matrix::rigid(group.range(), stream),
                (false, _) => perspective(stream) * matrix::rigid(group.range(), stream),
            };
            matrix::write(&m, &mut out[element.clone()]);
        }
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        group.elements().iter().all(|e| {
            let m = matrix::read(&words[e.clone()]);
            m.to_cols_array().iter().all(|c| c.abs() <= LARGEST) && m.row(3) != DVec4::ZERO
        })
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        for element in group.elements() {
            matrix::write(&DMat4::IDENTITY, &mut out[element.clone()]);
        }
    }

    fn simpler(&self, group: &Group, words: &[u32], k: usize, out: &mut [u32]) -> bool {
        let Some(element) = group.elements().get(k / 3) else { return false };
        let mut m = matrix::read(&words[element.clone()]);
        match k % 3 {
            0 => m = DMat4::IDENTITY,
            // Without the divide.
            1 => (m.x_axis.w, m.y_axis.w, m.z_axis.w, m.w_axis.w) = (0.0, 0.0, 0.0, 1.0),
            // Without the translation.
            _ => m.w_axis = DVec4::W,
        }
        matrix::write(&m, &mut out[element.clone()]);
        true
    }
}
