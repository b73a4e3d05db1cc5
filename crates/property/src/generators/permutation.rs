//! `permutation`: the numbers of places, in some order.

use base::value::{Scalar, Shape};

use super::{Generator, Group, Options, Place, RangeRule, SPECIAL, Stream, every_shape};

/// The whole numbers from 0 to one less than an array has elements, each once. Special: in order, and in the opposite order.
pub struct Permutation;

impl Generator for Permutation {
    fn name(&self) -> &str {
        "permutation"
    }

    fn about(&self) -> &str {
        "the whole numbers from 0 to one less than an array has elements, each once, in any order"
    }

    fn range(&self) -> RangeRule {
        RangeRule::None
    }

    fn check(&self, shapes: &[Shape], _options: &Options) -> Result<(), String> {
        every_shape(self.name(), shapes, "arrays of int and uint", |s| {
            s.columns == 1 && s.rows == 1 && matches!(s.scalar, Scalar::I32 | Scalar::U32)
        })
    }

    fn fill(&self, group: &Group, _place: Place, stream: &mut Stream, out: &mut [u32]) {
        self.simplest(group, out);
        let (special, turned) = (stream.one_in(SPECIAL), stream.bits() & 1 == 0);
        let mut from = 0;
        for shape in group.shapes() {
            let own = &mut out[from..from + shape.words()];
            from += own.len();
            match (special, turned) {
                (true, true) => own.reverse(),
                (true, false) => {}
                (false, _) => (1..own.len()).rev().for_each(|k| own.swap(k, stream.below(k + 1))),
            }
        }
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        let mut from = 0;
        group.shapes().iter().all(|shape| {
            let own = &words[from..from + shape.words()];
            from += own.len();
            let mut seen = vec![false; own.len()];
            own.iter().all(|&n| seen.get_mut(n as usize).is_some_and(|seen| !std::mem::replace(seen, true)))
        })
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        let mut from = 0;
        for shape in group.shapes() {
            let own = &mut out[from..from + shape.words()];
            from += own.len();
            own.iter_mut().zip(0..).for_each(|(word, k)| *word = k);
        }
    }

    /// All in order, or the number of one more place in it.
    fn simpler(&self, group: &Group, words: &[u32], k: usize, out: &mut [u32]) -> bool {
        if k == 0 {
            self.simplest(group, out);
            return true;
        }
        let mut from = 0;
        for shape in group.shapes() {
            let own = from..from + shape.words();
            from = own.end;
            let wrong: Vec<usize> = own.clone().filter(|&at| words[at] as usize != at - own.start).take(64).collect();
            if let Some(&at) = wrong.get(k - 1) {
                let home = (at - own.start) as u32;
                if let Some(other) = words[own.clone()].iter().position(|&word| word == home) {
                    out.swap(at, own.start + other);
                }
                return true;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::super::testing;
    use super::*;

    const SHAPE: Shape = Shape::vector(Scalar::U32, 1);

    #[test]
    fn every_number_stands_there_once_and_every_order_comes() {
        let group = Group::new(&Permutation, &[SHAPE.array_of(4)], Options::default()).unwrap();
        let all: HashSet<Vec<u32>> = testing::draw(&Permutation, &group, 4096).into_iter().collect();
        assert_eq!(all.len(), 24);
        for wrong in [[0, 1, 2, 2], [1, 2, 3, 4], [u32::MAX, 0, 1, 2]] {
            assert!(!Permutation.admits(&group, &wrong), "{wrong:?}");
        }
    }

    #[test]
    fn numbers_that_are_not_whole_are_refused() {
        assert!(Group::new(&Permutation, &[Shape::FLOAT.array_of(3)], Options::default()).is_err());
    }
}
