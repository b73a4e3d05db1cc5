//! Figures about bounds: how large they are beside values, and beside the errors that were made.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

use base::value::Record;

/// Largest error ÷ bound below which bounds tell nothing.
const VACUOUS: f64 = 1e-3;

/// Words that it takes to say so.
const ENOUGH: u64 = 1000;

/// How tight the bounds by one profile are. Words count whose bound is finite and on whose way no
/// comparison could have gone otherwise; those without any error, whose bound is 0 as well, count for
/// nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tightness {
    /// Name of the profile.
    pub profile: String,
    /// Number of words.
    pub words: u64,
    /// The word with the largest error ÷ bound.
    pub worst: Option<Worst>,
    /// Median of bound ÷ largest component of the variable.
    #[serde(with = "base::value::exact::option")]
    pub median_relative: Option<f64>,
    /// The same for each output variable, beside the errors that were seen.
    pub variables: Vec<VariableTightness>,
}

/// How tight the bounds of an output variable are, over all its components and vertices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariableTightness {
    /// Name of the variable.
    pub name: String,
    /// Number of words.
    pub words: u64,
    /// Median over the words of bound ÷ largest error, the error being the largest of the words whose
    /// bounds are alike: of one binade, relative to the largest component of the variable. Bounds
    /// differ by orders of magnitude where values cancel, and so do errors; over all words at once the
    /// median of the one and the largest of the other would say nothing of each other. Infinite where
    /// most words have no error.
    #[serde(with = "base::value::exact")]
    pub median_over_largest: f64,
}

/// A word with its error and bound, in the unit of the output.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Worst {
    /// Name of the component.
    pub component: String,
    /// Vertex, for a geometry stage.
    pub vertex: Option<usize>,
    /// Index of the invocation in its batch.
    pub invocation: usize,
    /// Distance of the lane from what the shader means; NaN when the lane gave NaN.
    #[serde(with = "base::value::exact")]
    pub error: f64,
    /// How far the lane may be off.
    #[serde(with = "base::value::exact")]
    pub bound: f64,
}

impl Worst {
    /// Error ÷ bound; infinite for NaN, and for an error where none is allowed.
    pub fn ratio(&self) -> f64 {
        ratio(self.error, self.bound)
    }
}

impl Tightness {
    /// True when the bounds are so wide that nothing that runs is near to them.
    pub fn is_vacuous(&self) -> bool {
        self.words >= ENOUGH && self.worst.as_ref().is_some_and(|worst| worst.ratio() < VACUOUS)
    }

    /// Median bound ÷ largest error of the variable with the widest bounds, of those that had errors;
    /// [`VariableTightness`] has the unit.
    pub fn median_over_largest(&self) -> Option<f64> {
        let ratios = self.variables.iter().map(|variable| variable.median_over_largest);
        ratios.filter(|ratio| ratio.is_finite()).max_by(f64::total_cmp)
    }
}

/// Error ÷ bound; infinite for NaN, and for an error where none is allowed.
fn ratio(error: f64, bound: f64) -> f64 {
    if error.is_nan() || (error > 0.0 && bound == 0.0) { f64::INFINITY } else { error / bound }
}

/// Of two words the one with the larger error ÷ bound; the earlier one of equals.
pub(super) fn keep_worse(kept: &mut Option<Worst>, new: Option<Worst>) {
    if let Some(new) = new
        && kept.as_ref().is_none_or(|kept| new.ratio() > kept.ratio())
    {
        *kept = Some(new);
    }
}

/// A word that was looked at.
pub(super) struct Word {
    /// Its number in the record.
    pub word: usize,
    /// Its variable.
    pub field: usize,
    pub error: f64,
    pub bound: f64,
    /// Largest component of the variable.
    pub size: f64,
}

impl Word {
    pub(super) fn worst(&self, record: &Record, vertex: Option<usize>, invocation: usize) -> Worst {
        let &Self { word, error, bound, .. } = self;
        Worst { component: record.word_name(word), vertex, invocation, error, bound }
    }
}

/// Words whose bounds are alike.
#[derive(Clone, Copy, Debug, Default)]
struct Binade {
    words: u64,
    /// Largest error ÷ bound.
    largest: f64,
}

/// Bounds and errors as they are gathered.
#[derive(Clone, Default)]
pub(super) struct Gauge {
    words: u64,
    worst: Option<Worst>,
    /// Bounds relative to the variable's largest component.
    relative: Vec<f64>,
    /// By variable: bounds of one binade relative to the variable's largest component.
    fields: Vec<BTreeMap<i64, Binade>>,
}

impl Gauge {
    /// Takes a word in; `name` is asked for what a report shows, of the worst word alone.
    pub(super) fn see(&mut self, word: &Word, name: impl Fn(&Word) -> Worst) {
        let &Word { field, error, bound, size, .. } = word;
        if !bound.is_finite() || (error == 0.0 && bound == 0.0) {
            return;
        }
        self.words += 1;
        if self.worst.as_ref().is_none_or(|worst| ratio(error, bound) > worst.ratio()) {
            self.worst = Some(name(word));
        }
        if size > 0.0 {
            self.relative.push(bound / size);
            if self.fields.len() <= field {
                self.fields.resize_with(field + 1, Default::default);
            }
            let binade = self.fields[field].entry(exponent(bound / size)).or_default();
            binade.words += 1;
            binade.largest = binade.largest.max(ratio(error, bound));
        }
    }

    /// Adds what comes after.
    pub(super) fn merge(&mut self, later: Self) {
        let Self { words, worst, relative, fields } = later;
        self.words += words;
        keep_worse(&mut self.worst, worst);
        self.relative.extend(relative);
        if self.fields.len() < fields.len() {
            self.fields.resize_with(fields.len(), Default::default);
        }
        for (field, later) in self.fields.iter_mut().zip(fields) {
            for (exponent, Binade { words, largest }) in later {
                let binade = field.entry(exponent).or_default();
                binade.words += words;
                binade.largest = binade.largest.max(largest);
            }
        }
    }

    pub(super) fn read(self, profile: &str, record: &Record) -> Tightness {
        let variable = |(field, binades): (usize, BTreeMap<i64, Binade>)| {
            let words = binades.values().map(|binade| binade.words).sum();
            let name = record.fields()[field].name.clone();
            Some(VariableTightness { name, words, median_over_largest: median_margin(binades)? })
        };
        Tightness {
            profile: profile.to_owned(),
            words: self.words,
            worst: self.worst,
            median_relative: median(self.relative),
            variables: self.fields.into_iter().enumerate().filter_map(variable).collect(),
        }
    }
}

/// The exponent of a positive number.
fn exponent(x: f64) -> i64 {
    x.log2().floor() as i64
}

/// The median over all words of what the largest error of their binade leaves: bound ÷ error.
fn median_margin(binades: BTreeMap<i64, Binade>) -> Option<f64> {
    let mut binades: Vec<Binade> = binades.into_values().collect();
    binades.sort_by(|a, b| b.largest.total_cmp(&a.largest));
    let middle = binades.iter().map(|binade| binade.words).sum::<u64>() / 2;
    let mut before = 0;
    let at_middle = binades.iter().find(|binade| {
        before += binade.words;
        before > middle
    });
    at_middle.map(|binade| 1.0 / binade.largest)
}

/// The middle one; of an even number the larger of the two in the middle.
fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::value::{Field, Shape};

    fn record() -> Record {
        let field = |name: &str, shape| Field { name: name.into(), shape };
        Record::new(vec![field("d", Shape::FLOAT), field("e", Shape::FLOAT)])
    }

    fn gauge(words: &[(usize, f64, f64, f64)]) -> Gauge {
        let record = record();
        let mut gauge = Gauge::default();
        for (k, &(field, error, bound, size)) in words.iter().enumerate() {
            let word = Word { word: field, field, error, bound, size };
            gauge.see(&word, |word| word.worst(&record, None, k));
        }
        gauge
    }

    #[test]
    fn figures_are_of_words_with_a_bound() {
        let words = [
            (0, 1.0, 4.0, 0.5),
            (0, 3.0, 6.0, 2.0),
            (0, 0.0, 5.0, 1.0),
            (1, 0.0, 0.0, 1.0),
            (1, 9.0, f64::INFINITY, 1.0),
            (1, 0.0, 8.0, 0.0),
        ];
        let tightness = gauge(&words).read("p", &record());
        assert_eq!((tightness.profile.as_str(), tightness.words), ("p", 4));
        let worst = tightness.worst.as_ref().unwrap();
        assert_eq!((worst.component.as_str(), worst.invocation, worst.ratio()), ("d", 1, 0.5));
        // 8, 3 and 5.
        assert_eq!(tightness.median_relative, Some(5.0));
        // Relative to the variable the bounds are 8, 3 and 5: three binades.
        let [d] = &tightness.variables[..] else { panic!("{:?}", tightness.variables) };
        assert_eq!((d.name.as_str(), d.words, d.median_over_largest), ("d", 3, 4.0));
        assert_eq!(tightness.median_over_largest(), Some(4.0));
        assert_eq!(gauge(&[]).read("p", &record()).median_over_largest(), None);
    }

    #[test]
    fn parts_add_up_to_the_whole() {
        let words: Vec<_> =
            (0..9).map(|k| (k % 2, f64::from(k as u8 * 5 % 7), 9.0 - f64::from(k as u8), 3.0)).collect();
        for at in 0..=9 {
            let mut parts = gauge(&words[..at]);
            // The worst word keeps the number of its own part.
            parts.merge(gauge(&words[at..]));
            let (mut parts, mut whole) = (parts.read("p", &record()), gauge(&words).read("p", &record()));
            for worst in [&mut parts.worst, &mut whole.worst] {
                worst.as_mut().unwrap().invocation = 0;
            }
            assert_eq!(parts, whole, "{at}");
        }
    }

    #[test]
    fn nan_and_errors_without_a_bound_are_infinitely_bad() {
        for (error, bound) in [(f64::NAN, 1.0), (1e-9, 0.0)] {
            let tightness = gauge(&[(0, 0.5, 1.0, 1.0), (0, error, bound, 1.0)]).read("p", &record());
            assert_eq!(tightness.worst.unwrap().ratio(), f64::INFINITY);
        }
        let lost = gauge(&[(0, f64::NAN, 1.0, 1.0), (0, 0.5, 1.0, 1.0)]).read("p", &record());
        assert_eq!(lost.variables[0].median_over_largest, 0.0);
    }

    #[test]
    fn errors_are_compared_with_bounds_of_their_own_binade() {
        // Most bounds are 2 times the largest error of their like. One sample cancels: its bound and
        // its error are a million times those of the others.
        let mut words = vec![(0, 0.25, 1.0, 1.0); 9];
        words.push((0, 0.5, 1.0, 1.0));
        words.push((0, 1e5, 1e6, 1.0));
        assert_eq!(gauge(&words).read("p", &record()).median_over_largest(), Some(2.0));
        // Without an error nothing is to be compared.
        assert_eq!(gauge(&[(0, 0.0, 1.0, 1.0)]).read("p", &record()).median_over_largest(), None);
    }

    #[test]
    fn bounds_are_vacuous_when_many_words_are_far_below_them() {
        let many = |count: usize, error: f64| gauge(&vec![(0, error, 1.0, 1.0); count]).read("p", &record());
        assert!(many(1000, 0.999e-3).is_vacuous());
        assert!(!many(999, 0.999e-3).is_vacuous(), "too few to tell");
        assert!(!many(1000, 1e-3).is_vacuous());
        let mut words = vec![(0, 0.0, 1.0, 1.0); 1000];
        assert!(gauge(&words).read("p", &record()).is_vacuous());
        words[500].1 = 0.5;
        assert!(!gauge(&words).read("p", &record()).is_vacuous(), "one word is near its bound");
    }
}
