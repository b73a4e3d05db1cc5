//! `sorted`: numbers in ascending order.

use base::value::{Scalar, Shape};

use super::array::{Array, block, inside, sort, whole_ends};
use super::{Generator, Group, Options, Place, RangeRule, Stream, every_shape};
use crate::sample::decode;

/// Arrays whose elements do not fall, drawn like those of `array` and sorted: runs of equal elements are among them.
pub struct Sorted;

impl Generator for Sorted {
    fn name(&self) -> &str {
        "sorted"
    }

    fn about(&self) -> &str {
        "numbers in `range` that do not fall from one element of an array to the next, runs of equal ones among them"
    }

    fn range(&self) -> RangeRule {
        RangeRule::Required
    }

    fn check(&self, shapes: &[Shape], options: &Options) -> Result<(), String> {
        let numbers = |s: &Shape| s.columns == 1 && s.rows == 1 && s.scalar != Scalar::Bool;
        every_shape(self.name(), shapes, "arrays of numbers", numbers)?;
        whole_ends(self.name(), shapes, options)
    }

    fn fill(&self, group: &Group, place: Place, stream: &mut Stream, out: &mut [u32]) {
        Array.fill(group, place, stream, out);
        sort(group, out, false);
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        let range = group.options().range.unwrap_or_default();
        let mut from = 0;
        group.shapes().iter().all(|shape| {
            let own = &words[from..from + shape.words()];
            from += shape.words();
            own.iter().all(|&word| inside(group, range, word, shape.scalar))
                && own.windows(2).all(|pair| decode(pair[0], shape.scalar) <= decode(pair[1], shape.scalar))
        })
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        Array.simplest(group, out);
    }

    /// Blocks that are all their first element, or all their last one.
    fn simpler(&self, _group: &Group, words: &[u32], k: usize, out: &mut [u32]) -> bool {
        let Some(block) = block(k / 2, out.len()) else { return false };
        if let (Some(&first), Some(&last)) = (words[block.clone()].first(), words[block.clone()].last()) {
            out[block].fill(if k.is_multiple_of(2) { first } else { last });
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing;
    use super::*;

    fn options() -> Options {
        Options { range: Some([-3.0, 5.0]), ..Options::default() }
    }

    #[test]
    fn elements_never_fall_and_repeat_at_times() {
        let group = Group::new(&Sorted, &[Shape::FLOAT.array_of(12)], options()).unwrap();
        testing::reaches(
            &Sorted,
            &group,
            &[("runs", 1000, &|s| s.windows(2).any(|w| w[0] == w[1])), ("equal", 500, &|s| s[0] == s[11])],
        );
        let fell = [1.0f32, 0.5].map(f32::to_bits);
        let pair = Group::new(&Sorted, &[Shape::FLOAT.array_of(2)], options()).unwrap();
        assert!(!Sorted.admits(&pair, &fell) && Sorted.admits(&pair, &[fell[1], fell[0]]));
    }

    #[test]
    fn vectors_have_no_order() {
        assert!(Group::new(&Sorted, &[Shape::VEC4.array_of(3)], options()).is_err());
    }
}
