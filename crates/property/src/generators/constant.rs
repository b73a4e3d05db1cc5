//! `constant`: the same values in every sample.

use crate::sample::{decode, encode};
use base::value::{Scalar, Shape};

use super::{Generator, Group, Options, Place, RangeRule, Stream};

/// The values that the suite gives: one for all words, or one for each word.
pub struct Constant;

fn write(group: &Group, out: &mut [u32]) {
    let values = &group.options().values;
    for (i, (word, &scalar)) in out.iter_mut().zip(group.scalars()).enumerate() {
        let value = values.get(i).or(values.first()).copied().unwrap_or_default();
        *word = encode(value, scalar);
    }
}

impl Generator for Constant {
    fn name(&self) -> &str {
        "constant"
    }

    fn about(&self) -> &str {
        "the numbers of `values`: one for all components, or one for each"
    }

    fn range(&self) -> RangeRule {
        RangeRule::None
    }

    fn takes_values(&self) -> bool {
        true
    }

    fn takes_components(&self) -> bool {
        true
    }

    fn check(&self, shapes: &[Shape], options: &Options) -> Result<(), String> {
        let words: usize = shapes.iter().map(|s| s.words()).sum();
        let given = options.values.len();
        if given != 1 && given != words {
            return Err(format!("generator `constant` needs `values` with 1 or {words} numbers, not {given}"));
        }
        let scalars = shapes.iter().flat_map(|s| std::iter::repeat_n(s.scalar, s.words()));
        for (i, scalar) in scalars.enumerate() {
            let value = options.values.get(i).or(options.values.first()).copied().unwrap_or_default();
            let kept = decode(encode(value, scalar), scalar);
            if !kept.is_finite() || (scalar != Scalar::F32 && kept != value) {
                return Err(format!("{value} cannot be held by a component of type {}", Shape::vector(scalar, 1)));
            }
        }
        Ok(())
    }

    fn fill(&self, group: &Group, _place: Place, _stream: &mut Stream, out: &mut [u32]) {
        write(group, out);
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        let mut expected = vec![0; words.len()];
        write(group, &mut expected);
        group.fetch(&mut expected);
        expected == words
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        write(group, out);
    }
}
