//! `interval`: numbers in a range.

use crate::math::wide;
use crate::value::{Scalar, Shape};

use super::{
    Generator, Group, Options, Place, Range, RangeRule, Role, Rows, SPECIAL, Stream, View, arrange, each_row,
    every_shape, mix, word,
};

/// Rows that are drawn side by side.
const ABREAST: usize = 16;

/// Numbers in a range, each component for itself.
pub struct Interval;

/// Fills rows whose words of the group lie from `at` on: the same bits as one by one. Ordinary numbers are drawn for
/// all rows in vectors, and rows with special ones are drawn again.
fn fill_abreast(group: &Group, at: usize, rows: Rows<'_>) {
    let Rows { words, stride, key, first_case, first_lane, per_case, .. } = rows;
    let (range, count) = (*group.range(), group.words());
    let (mut case, mut lane) = (first_case, first_lane);
    let mut case_seed = mix(key, case);
    let (mut keys, mut lanes, mut special) = ([0; ABREAST], [0; ABREAST], [false; ABREAST]);
    let mut drawn = [[0_u32; ABREAST]; ABREAST];
    for part in words.chunks_mut(stride * ABREAST) {
        let rows = part.len() / stride;
        for k in 0..rows {
            (keys[k], lanes[k]) = (case_seed, lane as u64);
            lane += 1;
            if lane == per_case {
                (lane, case) = (0, case.wrapping_add(1));
                case_seed = mix(key, case);
            }
        }
        wide(
            #[inline(always)]
            || {
                let mut streams = keys.map(Stream::new);
                for k in 0..ABREAST {
                    streams[k] = Stream::new(mix(keys[k], lanes[k]));
                }
                for k in 0..ABREAST {
                    special[k] = streams[k].one_in(SPECIAL);
                }
                for column in drawn.iter_mut().take(count) {
                    for k in 0..ABREAST {
                        column[k] = range.ordinary(streams[k].bits()).to_bits();
                    }
                }
            },
        );
        for (k, row) in part.chunks_exact_mut(stride).enumerate() {
            let out = &mut row[at..at + count];
            if special[k] {
                draw(range, &mut Stream::new(mix(keys[k], lanes[k])), out);
            } else {
                out.iter_mut().zip(&drawn).for_each(|(out, column)| *out = column[k]);
            }
            group.fetch(out);
        }
    }
}

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
        match rows.spans {
            // Longer groups have few rows, and their words side by side already.
            [span] if span.len() <= ABREAST => fill_abreast(group, span.start, rows),
            _ => each_row(self, group, rows),
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
