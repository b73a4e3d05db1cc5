//! `direction`: vectors of length one.

use base::value::Shape;

use super::{
    Generator, Group, Options, Place, RangeRule, SPECIAL, Stream, every_shape, float, is_vector, spatial, word,
};

/// Directions, evenly spread, of length one to within the rounding of their components; w = 0.
/// Special: the axes with both signs, the diagonals of two axes.
pub struct Direction;

/// How far the squared length may be from one: three components rounded to 2^-24 each.
const SLACK: f64 = 4e-7;

/// A direction in `n` dimensions (2 or 3), from square roots alone so that it is the same on every
/// machine.
fn even(n: usize, stream: &mut Stream) -> [f64; 3] {
    loop {
        let mut v = [0.0; 3];
        for c in &mut v[..n] {
            *c = stream.between(-1.0, 1.0);
        }
        let square: f64 = v.iter().map(|c| c * c).sum();
        if (1e-6..=1.0).contains(&square) {
            return v.map(|c| c / square.sqrt());
        }
    }
}

impl Generator for Direction {
    fn name(&self) -> &str {
        "direction"
    }

    fn about(&self) -> &str {
        "vectors of length one; the fourth component is 0"
    }

    fn range(&self) -> RangeRule {
        RangeRule::None
    }

    fn check(&self, shapes: &[Shape], _options: &Options) -> Result<(), String> {
        every_shape(self.name(), shapes, "vec2, vec3, vec4 and arrays of them", is_vector)
    }

    fn fill(&self, group: &Group, _place: Place, stream: &mut Stream, out: &mut [u32]) {
        let special = stream.one_in(SPECIAL);
        for element in group.elements() {
            let n = element.len().min(3);
            let v = if special {
                let (axis, sign) = (stream.below(n), stream.bits());
                let mut v = [0.0; 3];
                v[axis] = if sign & 1 == 0 { 1.0 } else { -1.0 };
                if sign & 6 == 0 {
                    v[axis] *= 0.5f64.sqrt();
                    v[(axis + 1) % n] = 0.5f64.sqrt();
                }
                v
            } else {
                even(n, stream)
            };
            for (i, &c) in v[..n].iter().enumerate() {
                out[element.start + i] = word(c);
            }
        }
        spatial::set_w(group, 0.0, out);
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        group.elements().iter().all(|element| {
            let v = &words[element.clone()];
            let square: f64 = v.iter().take(3).map(|&c| f64::from(float(c)).powi(2)).sum();
            (square - 1.0).abs() <= SLACK && v.get(3).is_none_or(|&w| float(w) == 0.0)
        })
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        out.fill(0);
        for element in group.elements() {
            out[element.start] = word(1.0);
        }
    }

    fn simpler(&self, group: &Group, _words: &[u32], k: usize, out: &mut [u32]) -> bool {
        // Six axes for each element.
        let Some(element) = group.elements().get(k / 6) else { return false };
        let axis = k % 3;
        if axis < element.len() {
            out[element.clone()].fill(0);
            out[element.start + axis] = word(if k % 6 < 3 { 1.0 } else { -1.0 });
        }
        true
    }
}
