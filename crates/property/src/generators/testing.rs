//! Checks of what every generator promises, for the tests of crates that have some.

use std::ops::RangeInclusive;

use super::{Generator, Group, Options, RangeRule, Rows, float};
use crate::stream::mix_text;
use base::value::Shape;

/// Samples that [`reaches`] draws.
pub const SAMPLES: usize = 1 << 14;

/// Samples `0..n` of a group, each in a case of its own; the seed follows from the name of the generator.
pub fn draw(generator: &dyn Generator, group: &Group, n: usize) -> Vec<Vec<u32>> {
    let mut words = vec![0; group.words() * n];
    let whole = vec![std::ops::Range { start: 0, end: group.words() }];
    let key = mix_text(1, generator.name());
    let rows = Rows {
        words: &mut words,
        stride: group.words(),
        spans: &whole,
        key,
        exact_key: key,
        first_case: 0,
        first_invocation: 0,
        per_case: 1,
    };
    generator.fill_rows(group, rows);
    words.chunks(group.words()).map(<[u32]>::to_vec).collect()
}

/// Words as binary32 numbers.
pub fn floats(words: &[u32]) -> Vec<f32> {
    words.iter().map(|&w| float(w)).collect()
}

/// Whether a sample belongs to a class.
pub type Class<'a> = &'a dyn Fn(&[f32]) -> bool;

/// Draws [`SAMPLES`] samples and asks that each named class has at least so many of them, and less than half.
///
/// # Panics
/// When a class has too few samples or too many.
pub fn reaches(generator: &dyn Generator, group: &Group, classes: &[(&str, usize, Class<'_>)]) {
    let name = generator.name();
    let samples: Vec<Vec<f32>> = draw(generator, group, SAMPLES).iter().map(|s| floats(s)).collect();
    for (class, least, holds) in classes {
        let count = samples.iter().filter(|s| holds(s)).count();
        assert!(count >= *least, "{name}: {count} samples of class `{class}`, wanted {least}");
        assert!(count < SAMPLES / 2, "{name}: class `{class}` is not special, {count} samples");
    }
}

/// Asks for what [`Generator`] says of every generator: whatever it makes is admitted (samples, the simplest one for any
/// range, samples at edges), edges are the same each time, and simpler versions come to an end and are mostly admitted.
///
/// # Panics
/// When the generator breaks one of these, or does not take `shapes` and `options`.
pub fn keeps_its_promises(generator: &dyn Generator, shapes: &[Shape], options: &Options) {
    let name = generator.name();
    assert!(!generator.about().is_empty() && !generator.about().ends_with('.'), "{name}");
    let group = Group::new(generator, shapes, options.clone()).unwrap_or_else(|message| panic!("{message}"));
    let samples = draw(generator, &group, 2048);
    for sample in &samples {
        assert!(generator.admits(&group, sample), "{name}: {:?}", floats(sample));
    }
    let ranges = [None, Some([1.0, 3.0]), Some([-5.0, -2.0]), Some([0.0, 0.0])];
    let takes_none = generator.range() == RangeRule::None;
    for range in ranges.into_iter().filter(|range| range.is_none() || !takes_none) {
        let options = Options { range: range.or(options.range), ..options.clone() };
        let Ok(group) = Group::new(generator, shapes, options) else { continue };
        let mut words = vec![u32::MAX; group.words()];
        generator.simplest(&group, &mut words);
        assert!(generator.admits(&group, &words), "{name} {range:?}: {:?}", floats(&words));
    }
    let edges = generator.edges(&group, &samples[0]);
    assert!(edges.iter().all(|words| generator.admits(&group, words)), "{name}");
    assert_eq!(edges, generator.edges(&group, &samples[0]), "{name}");
    let (mut versions, mut admitted) = (0, 0);
    for sample in &samples[..64] {
        for k in 0.. {
            assert!(k < 1000, "{name} has no last version");
            let mut out = sample.clone();
            if !generator.simpler(&group, sample, k, &mut out) {
                break;
            }
            versions += 1;
            admitted += usize::from(generator.admits(&group, &out));
        }
    }
    assert!(versions == 0 || admitted * 4 > versions, "{name}: {admitted} of {versions}");
}

/// Asks that no word of a sample may be NaN, an infinity or a number outside of every range: one of `words`, all of
/// which are floats.
///
/// # Panics
/// When a sample with such a word is admitted.
pub fn refuses_odd_words(generator: &dyn Generator, group: &Group, words: RangeInclusive<usize>) {
    let good = draw(generator, group, 1).remove(0);
    for (i, bad) in words.flat_map(|i| [f32::NAN, f32::INFINITY, 1e6].map(|bad| (i, bad))) {
        let mut words = good.clone();
        words[i] = bad.to_bits();
        assert!(!generator.admits(group, &words), "{}: {bad} as word {i}", generator.name());
    }
}
