//! `vector`: displacements, the zero vector among them.

use base::value::Shape;

use super::{Generator, Group, Options, Place, RangeRule, Role, Rows, Stream, every_shape, is_vector, spatial};

/// Vectors with components in a range and w = 0. Special: the zero vector, lattice vectors, axes,
/// the diagonal, edge values, all names equal.
pub struct Vector;

impl Generator for Vector {
    fn name(&self) -> &str {
        "vector"
    }

    fn about(&self) -> &str {
        "vectors with components in `range`, the zero vector among them; the fourth component is 0"
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
        spatial::fill(group, 0.0, place, stream, out);
    }

    fn fill_rows(&self, group: &Group, rows: Rows<'_>) {
        spatial::fill_rows(self, group, 0.0, rows);
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        spatial::admits(group, 0.0, words)
    }

    fn role(&self) -> Role {
        Role::Place
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        spatial::simplest(group, 0.0, out);
    }
}
