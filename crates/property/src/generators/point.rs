//! `point`: points in a box.

use base::value::Shape;

use super::{
    Generator, Group, Options, Place, RangeRule, Role, Rows, Stream, View, arrange, every_shape, is_vector, spatial,
    word,
};

/// Points in a box, with w = 1. Special: the origin, lattice points, points on an axis or the
/// diagonal, corners of the box, edge values, all names at one place.
pub struct Point;

impl Generator for Point {
    fn name(&self) -> &str {
        "point"
    }

    fn about(&self) -> &str {
        "points with coordinates in `range`; the fourth component is 1"
    }

    fn range(&self) -> RangeRule {
        RangeRule::Default(-2.0, 2.0)
    }

    fn takes_components(&self) -> bool {
        true
    }

    fn check(&self, shapes: &[Shape], _options: &Options) -> Result<(), String> {
        every_shape(self.name(), shapes, "vec2, vec3, vec4 and arrays of them", is_vector)
    }

    #[inline]
    fn fill(&self, group: &Group, place: Place, stream: &mut Stream, out: &mut [u32]) {
        spatial::fill(group, 1.0, place, stream, out);
    }

    fn fill_rows(&self, group: &Group, rows: Rows<'_>) {
        spatial::fill_rows(self, group, 1.0, rows);
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        spatial::admits(group, 1.0, words)
    }

    fn role(&self) -> Role {
        Role::Shape
    }

    fn arrange(&self, group: &Group, view: &View, out: &mut [u32]) {
        for (k, element) in group.elements().iter().enumerate() {
            let point = arrange::shape(group.range(), view.shape + k, view.at).to_array();
            for (at, c) in element.clone().zip(point) {
                out[at] = word(c);
            }
        }
        spatial::set_w(group, 1.0, out);
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        spatial::simplest(group, 1.0, out);
    }
}
