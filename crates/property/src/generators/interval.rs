//! `interval`: numbers in a range.

use base::value::{Scalar, Shape};

use super::{
    Generator, Group, Options, Place, Range, RangeRule, Role, Rows, SPECIAL, Stream, View, abreast, arrange, each_row,
    every_shape, word,
};

/// Numbers in a range, each component for itself.
pub struct Interval;

/// Draws one sample.
#[inline]
fn draw(range: Range, stream: &mut Stream, out: &mut [u32]) {
    if stream.one_in(SPECIAL) {
        // One component is special for sure, the others every second time.
        let certain = stream.below(out.len());
        for (i, word) in out.iter_mut().enumerate() {
            let (choice, bits) = (stream.bits(), stream.bits());
            let special = i == certain || choice & 1 == 0;
            *word = if special { range.special(bits) } else { range.ordinary(bits) }.to_bits();
        }
    } else {
        for word in out.iter_mut() {
            *word = range.ordinary(stream.bits()).to_bits();
        }
    }
}

impl Generator for Interval {
    fn name(&self) -> &str {
        "interval"
    }

    fn about(&self) -> &str {
        "numbers in `range`, each component for itself"
    }

    fn range(&self) -> RangeRule {
        RangeRule::Required
    }

    fn takes_components(&self) -> bool {
        true
    }

    fn check(&self, shapes: &[Shape], _options: &Options) -> Result<(), String> {
        every_shape(self.name(), shapes, "floats, vectors, matrices and arrays of them", |s| s.scalar == Scalar::F32)
    }

    #[inline]
    fn fill(&self, group: &Group, _place: Place, stream: &mut Stream, out: &mut [u32]) {
        draw(*group.range(), stream, out);
    }

    fn fill_rows(&self, group: &Group, rows: Rows<'_>) {
        if abreast::fits(&rows) {
            abreast::fill(self, group, rows, |_| {});
        } else {
            each_row(self, group, rows);
        }
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        (0..words.len()).all(|i| group.word_in_range(words, i))
    }

    fn role(&self) -> Role {
        Role::Axis
    }

    fn arrange(&self, group: &Group, view: &View, out: &mut [u32]) {
        let count = out.len();
        for (k, word_out) in out.iter_mut().enumerate() {
            *word_out = word(arrange::wave(group.range(), k, count, view.frame));
        }
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        out.fill(group.range().clamp(0.0).to_bits());
    }
}
