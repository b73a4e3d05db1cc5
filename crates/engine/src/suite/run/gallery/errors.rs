//! Errors and bounds, counted by their size.

use std::collections::BTreeMap;

use super::measured;
use base::value::Record;
use judge::verdict::{Closeup, Verdict};

/// Exponent of the smallest errors that are told apart, in ULP.
pub const SMALLEST: i32 = -10;
/// Exponent of the largest ones.
pub const LARGEST: i32 = 26;

/// Errors of output words, by powers of two in ULP of the largest component of the variable.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Errors {
    /// Samples that were looked at.
    pub samples: u64,
    /// Words that were looked at.
    pub words: u64,
    /// Words without any error: of samples that agree, that are undetermined, and that deviate.
    pub exact: [u64; 3],
    /// Words by the exponent of their error, in the same three parts.
    pub by_error: BTreeMap<i32, [u64; 3]>,
    /// Words that are no numbers and should be.
    pub lost: u64,
    /// Words by the exponents of their bound and of their error, where there are both.
    pub by_bound: BTreeMap<(i32, i32), u64>,
    /// Words with an error beyond their bound.
    pub beyond: u64,
    /// Words about whose error nothing is promised, and nothing was measured.
    pub unbounded: u64,
}

impl Errors {
    pub(super) fn add(&mut self, closeup: &Closeup, record: &Record) {
        let part = match closeup.verdict {
            Verdict::Agree(_) => 0,
            Verdict::Undetermined(_) => 1,
            Verdict::Deviate(_) => 2,
        };
        self.samples += 1;
        for word in closeup.vertices.iter().flat_map(|words| measured(words, record)) {
            self.words += 1;
            if !word.bound.is_finite() {
                self.unbounded += 1;
            }
            if word.error.is_nan() {
                self.lost += 1;
            } else if word.error == 0.0 {
                self.exact[part] += 1;
            } else {
                let error = exponent(word.error);
                self.by_error.entry(error).or_default()[part] += 1;
                if word.bound.is_finite() && word.bound > 0.0 {
                    *self.by_bound.entry((exponent(word.bound), error)).or_default() += 1;
                }
                if word.bound.is_finite() && word.error > word.bound {
                    self.beyond += 1;
                }
            }
        }
    }
}

/// The exponent of a positive number, within what is told apart.
fn exponent(x: f64) -> i32 {
    (x.log2().floor() as i32).clamp(SMALLEST, LARGEST)
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::value::{Field, Shape};
    use judge::verdict::{Doubt, Promise, Reason, Seen};

    #[test]
    fn every_word_is_counted_once_where_it_belongs() {
        let record = Record::new(vec![Field { name: "d".into(), shape: Shape::VEC2 }]);
        let seen = |actual: f64, promised: f64| Seen {
            expected: f64::NAN,
            meaning: 1.0,
            actual,
            promised,
            measured: f64::INFINITY,
        };
        let ulp = f64::from(f32::EPSILON);
        let mut errors = Errors::default();
        let mut add = |verdict, a: Seen, b: Seen| {
            errors.add(&Closeup { verdict, vertices: vec![vec![a, b]] }, &record);
        };
        add(Verdict::Agree(Promise::Text), seen(1.0, ulp), seen(1.0 + ulp, 3.0 * ulp));
        add(
            Verdict::Undetermined(Doubt::of(Reason::Branch)),
            seen(f64::NAN, ulp),
            seen(1.0 + 5.0 * ulp, f64::INFINITY),
        );
        add(Verdict::Undetermined(Doubt::of(Reason::Branch)), seen(1.0, 0.0), seen(3.0, 2.0 * ulp));
        assert_eq!((errors.samples, errors.words, errors.lost, errors.exact), (3, 6, 1, [1, 1, 0]));
        assert_eq!(errors.by_error, BTreeMap::from([(0, [1, 0, 0]), (2, [0, 1, 0]), (24, [0, 1, 0])]));
        assert_eq!(errors.by_bound, BTreeMap::from([((1, 0), 1), ((1, 24), 1)]));
        assert_eq!((errors.beyond, errors.unbounded), (1, 1));
    }
}
