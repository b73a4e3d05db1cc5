//! `array`: the contents of buffers, drawn as a whole.

use base::value::{Scalar, Shape};

use super::{Generator, Group, Options, Place, RangeRule, Stream, every_shape};
use crate::sample::{decode, encode};

/// Numbers in a range, drawn together. Half of the samples are spread over the range like those of `interval` and `index`. The
/// others have a structure at which sums, sorts and scans go wrong: a bell curve around the middle, magnitudes of all
/// sizes, pairs that cancel, ascending, descending, all equal, nearly all zero, a single element.
pub struct Array;

/// Structures that are drawn as often as each other.
const STRUCTURES: usize = 8;

/// Elements that are no zero in a sparse array: one in so many.
const SPARSE: usize = 16;

/// Numbers whose mean is nearly normal.
const BELL: usize = 12;

/// A number of the range: for whole numbers a whole one.
fn draw(group: &Group, scalar: Scalar, stream: &mut Stream) -> f64 {
    let [lo, hi] = group.options().range.unwrap_or_default();
    match scalar {
        Scalar::F32 => f64::from(group.range().ordinary(stream.bits())),
        Scalar::I32 | Scalar::U32 | Scalar::Bool => {
            let count = (hi.floor() - lo.ceil()) as u64 + 1;
            lo.ceil() + (((stream.bits() >> 32) * count) >> 32) as f64
        }
    }
}

/// The sum of uniform numbers, scaled so that its standard deviation is a sixth of the range.
fn bell(group: &Group, stream: &mut Stream) -> f64 {
    let (middle, half) = group.range().middle();
    let sum: f64 = (0..BELL).map(|_| stream.unit() - 0.5).sum();
    middle + half / 3.0 * sum
}

impl Array {
    /// One word of the range.
    fn word(group: &Group, value: f64, scalar: Scalar) -> u32 {
        let [lo, hi] = group.options().range.unwrap_or_default();
        match scalar {
            Scalar::F32 => group.range().clamp(value as f32).to_bits(),
            Scalar::I32 | Scalar::U32 | Scalar::Bool => encode(value.clamp(lo.ceil(), hi.floor()), scalar),
        }
    }
}

impl Generator for Array {
    fn name(&self) -> &str {
        "array"
    }

    fn about(&self) -> &str {
        "contents of a buffer, numbers in `range`: spread evenly, or as a bell curve, of all magnitudes, cancelling, sorted \
         either way, equal, sparse, or one alone"
    }

    fn range(&self) -> RangeRule {
        RangeRule::Required
    }

    fn check(&self, shapes: &[Shape], options: &Options) -> Result<(), String> {
        every_shape(self.name(), shapes, "numbers, vectors and matrices, and arrays of them", |_| true)?;
        whole_ends(self.name(), shapes, options)
    }

    fn fill(&self, group: &Group, _place: Place, stream: &mut Stream, out: &mut [u32]) {
        let (kind, bits) = (stream.below(2 * STRUCTURES), stream.bits());
        let scalars = group.scalars();
        let equal = draw(group, scalars.first().copied().unwrap_or(Scalar::F32), stream);
        let alone = stream.below(out.len());
        for k in 0..out.len() {
            let scalar = scalars[k];
            let value = match kind {
                0 => bell(group, stream),
                // The special values of a range have all magnitudes.
                1 if scalar == Scalar::F32 => f64::from(group.range().special(stream.bits())),
                2 if k % 2 == 1 => -decode(out[k - 1], scalar),
                3 => equal,
                4 if !stream.one_in(SPARSE) => 0.0,
                5 if k != alone => 0.0,
                _ => draw(group, scalar, stream),
            };
            out[k] = Self::word(group, value, scalar);
        }
        if kind == 6 || kind == 7 {
            sort(group, out, kind == 7);
        }
        if kind == 2 && bits & 1 == 0 {
            // What cancels stands far apart.
            let half = out.len() / 2;
            out[half..].reverse();
        }
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        let range = group.options().range.unwrap_or_default();
        words.iter().zip(group.scalars()).all(|(&word, &scalar)| inside(group, range, word, scalar))
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        for (word, &scalar) in out.iter_mut().zip(group.scalars()) {
            *word = Self::word(group, 0.0, scalar);
        }
    }

    /// Blocks of the simplest value, large ones first.
    fn simpler(&self, group: &Group, _words: &[u32], k: usize, out: &mut [u32]) -> bool {
        let Some(block) = block(k, out.len()) else { return false };
        for (word, &scalar) in out[block.clone()].iter_mut().zip(&group.scalars()[block]) {
            *word = Self::word(group, 0.0, scalar);
        }
        true
    }
}

/// True for a word of a range.
pub(super) fn inside(group: &Group, [lo, hi]: [f64; 2], word: u32, scalar: Scalar) -> bool {
    match scalar {
        Scalar::F32 => group.range().contains(f32::from_bits(word)),
        Scalar::Bool => word <= 1 && (lo..=hi).contains(&f64::from(word)),
        Scalar::I32 | Scalar::U32 => (lo..=hi).contains(&decode(word, scalar)),
    }
}

/// Refuses ranges without a whole number for inputs that hold whole numbers, and ends that they do not hold.
pub(super) fn whole_ends(name: &str, shapes: &[Shape], options: &Options) -> Result<(), String> {
    let [lo, hi] = options.range.unwrap_or_default();
    for shape in shapes {
        let (least, most) = match shape.scalar {
            Scalar::F32 => continue,
            Scalar::I32 => (f64::from(i32::MIN), f64::from(i32::MAX)),
            Scalar::U32 => (0.0, f64::from(u32::MAX)),
            Scalar::Bool => (0.0, 1.0),
        };
        if lo < least || hi > most {
            return Err(format!("range [{lo}, {hi}] does not fit {shape}, which holds {least} to {most}"));
        }
        if lo.ceil() > hi.floor() {
            return Err(format!("generator `{name}` needs a range with a whole number for {shape}, not [{lo}, {hi}]"));
        }
    }
    Ok(())
}

/// Sorts the words of each name for itself by their values.
pub(super) fn sort(group: &Group, out: &mut [u32], falling: bool) {
    let mut from = 0;
    for shape in group.shapes() {
        let words = &mut out[from..from + shape.words()];
        words.sort_by(|&a, &b| decode(a, shape.scalar).total_cmp(&decode(b, shape.scalar)));
        if falling {
            words.reverse();
        }
        from += shape.words();
    }
}

/// Block number `k` of a list of so many words: all of it, its halves, quarters, and so on to 64 parts.
pub(super) fn block(k: usize, len: usize) -> Option<std::ops::Range<usize>> {
    let parts = (k + 1).checked_next_power_of_two()?;
    let parts = if parts > k + 1 { parts / 2 } else { parts };
    let which = k + 1 - parts;
    (parts <= 64 && parts <= len.max(1)).then(|| which * len / parts..(which + 1) * len / parts)
}

#[cfg(test)]
mod tests {
    use super::super::testing;
    use super::*;

    const N: usize = 24;

    fn group(scalar: Scalar, range: [f64; 2]) -> Group {
        let options = Options { range: Some(range), ..Options::default() };
        Group::new(&Array, &[Shape::vector(scalar, 1).array_of(N as u32)], options).unwrap()
    }

    #[test]
    fn every_structure_is_reached() {
        let rising = |s: &[f32]| s.windows(2).all(|w| w[0] <= w[1]) && s[0] < s[N - 1];
        let zeros = |s: &[f32]| s.iter().filter(|&&x| x == 0.0).count();
        testing::reaches(
            &Array,
            &group(Scalar::F32, [-2.0, 2.0]),
            &[
                ("ascending", 500, &|s| rising(s)),
                ("descending", 500, &|s| rising(&s.iter().map(|x| -x).collect::<Vec<_>>())),
                ("equal", 500, &|s| s.iter().all(|&x| x == s[0])),
                ("sparse", 300, &|s| (N / 2..N - 1).contains(&zeros(s))),
                ("one alone", 500, &|s| zeros(s) == N - 1),
                ("cancelling", 500, &|s| s.iter().sum::<f32>() == 0.0 && zeros(s) < N / 2),
                ("magnitudes", 500, &|s| s.iter().any(|x| x.abs() < 1e-5 && *x != 0.0) && s.contains(&2.0)),
            ],
        );
    }

    #[test]
    fn whole_numbers_reach_both_ends_and_nothing_else() {
        for scalar in [Scalar::I32, Scalar::U32] {
            let samples = testing::draw(&Array, &group(scalar, [0.0, 3.0]), 512);
            let words: Vec<u32> = samples.concat();
            assert!((0..=3).all(|n| words.contains(&n)) && words.iter().all(|&w| w <= 3));
        }
        let options = Options { range: Some([0.2, 0.8]), ..Options::default() };
        let message = Group::new(&Array, &[Shape::vector(Scalar::U32, 1)], options).unwrap_err();
        assert_eq!(message, "generator `array` needs a range with a whole number for uint, not [0.2, 0.8]");
    }

    #[test]
    fn blocks_go_from_the_whole_to_small_parts() {
        let all: Vec<_> = (0..).map_while(|k| block(k, 8)).collect();
        assert_eq!(all[..3], [0..8, 0..4, 4..8]);
        assert_eq!((all.len(), all[14].clone()), (15, 7..8));
        assert_eq!((0..).map_while(|k| block(k, 1000)).count(), 127);
    }
}
