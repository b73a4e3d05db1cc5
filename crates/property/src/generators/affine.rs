//! `affine`: invertible affine maps.

use glam::{DMat3, DMat4, DVec3};

use base::value::Shape;

use super::matrix::{self, with_translation};
use super::{Generator, Group, Options, Place, RangeRule, SPECIAL, Stream, every_shape, is_mat4};

/// Affine maps that stretch by factors between 1/2 and 2 along three orthogonal axes, mirror every
/// second time, and translate within the range. Special: the identity, powers of two on the
/// diagonal, mirrors, shears, pure translations.
pub struct Affine;

/// Admitted determinants: those of `fill` lie between 1/8 and 8.
const DETERMINANT: std::ops::RangeInclusive<f64> = 0.1..=10.0;

fn special(group: &Group, stream: &mut Stream) -> DMat4 {
    let origin = matrix::nearest_to_origin(group.range());
    let signs = matrix::lattice(&super::Range::new(-1.0, 1.0), stream);
    match stream.below(5) {
        0 => with_translation(DMat3::IDENTITY, origin),
        1 => with_translation(DMat3::from_diagonal(DVec3::from_array(signs.to_array().map(|s| s.exp2()))), origin),
        2 => {
            let mirror = signs.to_array().map(|s| if s < 0.0 { -1.0 } else { 1.0 });
            with_translation(DMat3::from_diagonal(DVec3::from_array(mirror)), origin)
        }
        3 => {
            let shear = DMat3::from_cols(DVec3::X, DVec3::new(signs.x, 1.0, 0.0), DVec3::new(signs.y, signs.z, 1.0));
            with_translation(shear, origin)
        }
        _ => with_translation(DMat3::IDENTITY, matrix::point(group.range(), stream)),
    }
}

impl Generator for Affine {
    fn name(&self) -> &str {
        "affine"
    }

    fn about(&self) -> &str {
        "invertible affine maps: stretched by 1/2 to 2, mirrored or not, translated within `range`"
    }

    fn range(&self) -> RangeRule {
        RangeRule::Default(-2.0, 2.0)
    }

    fn check(&self, shapes: &[Shape], _options: &Options) -> Result<(), String> {
        every_shape(self.name(), shapes, "mat4 and arrays of mat4", is_mat4)
    }

    fn fill(&self, group: &Group, _place: Place, stream: &mut Stream, out: &mut [u32]) {
        let is_special = stream.one_in(SPECIAL);
        for element in group.elements() {
            let m = if is_special {
                special(group, stream)
            } else {
                let (before, after) = (matrix::rotation(stream), matrix::rotation(stream));
                let mut stretch = || stream.between(0.5, 2.0);
                let mut stretch = DVec3::new(stretch(), stretch(), stretch());
                if stream.bits() & 1 == 0 {
                    stretch.x = -stretch.x;
                }
                let linear = DMat3::from_quat(after) * DMat3::from_diagonal(stretch) * DMat3::from_quat(before);
                with_translation(linear, matrix::point(group.range(), stream))
            };
            matrix::write(&m, &mut out[element.clone()]);
        }
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        group.elements().iter().all(|e| {
            let m = matrix::read(&words[e.clone()]);
            let t = m.w_axis.truncate().to_array();
            matrix::is_affine(&m)
                && DETERMINANT.contains(&DMat3::from_mat4(m).determinant().abs())
                && t.iter().all(|&c| group.range().contains(c as f32))
        })
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        super::rigid::Rigid.simplest(group, out);
    }

    fn simpler(&self, group: &Group, words: &[u32], k: usize, out: &mut [u32]) -> bool {
        super::rigid::Rigid.simpler(group, words, k, out)
    }
}
