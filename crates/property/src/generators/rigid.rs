//! `rigid`: rotations with translations.

use glam::DMat4;

use base::value::Shape;

use super::matrix::{self, SIMPLER_RIGID};
use super::{Generator, Group, Options, Place, RangeRule, SPECIAL, Stream, every_shape, is_mat4};

/// Rigid transforms: evenly spread rotations, translations with components in the range. Special:
/// the identity, pure translations, turns that map axes to axes, tiny rotations.
pub struct Rigid;

impl Generator for Rigid {
    fn name(&self) -> &str {
        "rigid"
    }

    fn about(&self) -> &str {
        "rotations followed by a translation with components in `range`"
    }

    fn range(&self) -> RangeRule {
        RangeRule::Default(-2.0, 2.0)
    }

    fn check(&self, shapes: &[Shape], _options: &Options) -> Result<(), String> {
        every_shape(self.name(), shapes, "mat4 and arrays of mat4", is_mat4)
    }

    fn fill(&self, group: &Group, place: Place, stream: &mut Stream, out: &mut [u32]) {
        let special = stream.one_in(SPECIAL);
        for element in group.elements() {
            let m = if place.exact {
                let turn = matrix::quarter_turns(stream);
                // Without a translation every second time: lattice points then stay lattice points.
                let moved = matrix::lattice(group.range(), stream);
                let origin = matrix::nearest_to_origin(group.range());
                matrix::with_translation(turn, if stream.bits() & 1 == 0 { moved } else { origin })
            } else if special {
                matrix::special_rigid(group.range(), stream)
            } else {
                matrix::rigid(group.range(), stream)
            };
            matrix::write(&m, &mut out[element.clone()]);
        }
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        group.elements().iter().all(|e| matrix::is_rigid(&matrix::read(&words[e.clone()]), group.range()))
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        let mut m = DMat4::IDENTITY;
        m.w_axis = matrix::nearest_to_origin(group.range()).extend(1.0);
        for element in group.elements() {
            matrix::write(&m, &mut out[element.clone()]);
        }
    }

    fn simpler(&self, group: &Group, words: &[u32], k: usize, out: &mut [u32]) -> bool {
        let Some(element) = group.elements().get(k / SIMPLER_RIGID) else { return false };
        let m = matrix::read(&words[element.clone()]);
        if let Some(m) = matrix::simpler_rigid(&m, group.range(), k % SIMPLER_RIGID) {
            matrix::write(&m, &mut out[element.clone()]);
        }
        true
    }
}
