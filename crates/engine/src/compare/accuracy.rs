//! Which of two functions a device can compute more accurately: the bounds of both, by a profile.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::ReadyPair;
use crate::InputValue;
use base::value::{Batch, Scalar, ulp_at};
use judge::profile::Profile;
use judge::verdict::{Limiter, Limits};
use lanes::Stage;
use program::interp::SLOTS;
use property::Sample;

/// A bound that is smaller by less than this part counts as the same.
const ALIKE: f64 = 0.01;

/// Chunks that one machine does at least.
const CHUNKS: usize = 8;

/// The bounds of two functions by one profile. Bounds of a variable are taken relative to its largest component, and of a
/// sample the widest counts.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Accuracy {
    /// Name of the profile.
    pub profile: String,
    /// Samples in which both have a bound.
    pub compared: u64,
    /// Of these, the samples in which the first, and those in which the second has the smaller bound.
    pub better: [u64; 2],
    /// Samples in which only the first, and those in which only the second has a bound.
    pub alone: [u64; 2],
    /// Median of the bound of the first ÷ that of the second.
    #[serde(with = "crate::bits")]
    pub median_ratio: Option<f64>,
    /// The sample with the widest bound of each.
    pub widest: [Option<Worst>; 2],
    /// The sample in which the first gains most, and that in which the second does; nothing where none does.
    pub gains: [Option<Worst>; 2],
}

/// A sample and a figure of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Worst {
    /// The inputs of the first function.
    pub inputs: Vec<InputValue>,
    /// The bounds of both in ULP of the largest component of the variable.
    #[serde(with = "crate::bits")]
    pub ulp: [f64; 2],
}

/// The widest bound of a sample: as part of the variable, and in ULP.
#[derive(Clone, Copy, Default)]
struct AccuracyBound {
    relative: f64,
    ulp: f64,
}

/// Bounds as they are gathered.
pub(super) struct Gauge<'a> {
    pair: &'a ReadyPair<'a>,
    profile: &'a Profile,
    ratios: Vec<f64>,
    accuracy: Accuracy,
    /// The sample with the widest bound of either.
    widest: Option<(f64, Sample)>,
}

impl<'a> Gauge<'a> {
    pub(super) fn new(pair: &'a ReadyPair<'a>, profile: &'a Profile) -> Self {
        let accuracy = Accuracy {
            profile: profile.name.clone(),
            compared: 0,
            better: [0; 2],
            alone: [0; 2],
            median_ratio: None,
            widest: [None, None],
            gains: [None, None],
        };
        Self { pair, profile, ratios: Vec::new(), accuracy, widest: None }
    }

    /// Takes the samples of a batch in, as both functions get them.
    pub(super) fn see(&mut self, batch: &Batch, fed: &Batch) {
        let bounds = [bounds(self, 0, batch), bounds(self, 1, fed)];
        for k in 0..batch.invocation_count() {
            let both = [bounds[0][k], bounds[1][k]];
            let known = both.map(|bound| bound.relative.is_finite());
            let most = (0..2).filter(|&side| known[side]).map(|side| both[side].ulp).fold(0.0, f64::max);
            if most > self.widest.as_ref().map_or(0.0, |(widest, _)| *widest) {
                self.widest = Some((most, Sample::of(batch, k)));
            }
            let accuracy = &mut self.accuracy;
            let worst = || Worst {
                inputs: InputValue::all(&Sample::of(batch, k), &self.pair.sides[0].program),
                ulp: both.map(|bound| bound.ulp),
            };
            for side in 0..2 {
                if known[side] {
                    keep(&mut accuracy.widest[side], |kept| both[side].ulp > kept.ulp[side], &worst);
                }
                accuracy.alone[side] += u64::from(known[side] && !known[1 - side]);
            }
            if known != [true, true] {
                continue;
            }
            accuracy.compared += 1;
            let ratio = both[0].relative / both[1].relative;
            // Both are exact.
            let ratio = if both[0].relative == both[1].relative { 1.0 } else { ratio };
            self.ratios.push(ratio);
            for (side, gain) in [1.0 / ratio, ratio].into_iter().enumerate() {
                if gain > 1.0 + ALIKE {
                    accuracy.better[side] += 1;
                    let of = |kept: &Worst| kept.ulp[1 - side] / kept.ulp[side];
                    keep(&mut accuracy.gains[side], |kept| gain > of(kept) * (1.0 + ALIKE), &worst);
                }
            }
        }
    }

    /// The sample with the widest bound of either.
    pub(super) fn widest(&mut self) -> Option<Sample> {
        self.widest.take().map(|(_, sample)| sample)
    }

    pub(super) fn finish(mut self) -> Accuracy {
        let middle = self.ratios.len() / 2;
        let median = (!self.ratios.is_empty()).then(|| *self.ratios.select_nth_unstable_by(middle, f64::total_cmp).1);
        Accuracy { median_ratio: median, ..self.accuracy }
    }
}

/// Puts a new one in the place of one that is less.
fn keep(kept: &mut Option<Worst>, more: impl Fn(&Worst) -> bool, new: &dyn Fn() -> Worst) {
    if kept.as_ref().is_none_or(more) {
        *kept = Some(new());
    }
}

/// The widest bound of each sample of a side, over the outputs that both have; infinite where nothing bounds one of them.
fn bounds(gauge: &Gauge<'_>, side: usize, batch: &Batch) -> Vec<AccuracyBound> {
    let pair = gauge.pair;
    let (oracle, record) = (&pair.oracles[side], &pair.sides[side].kernel.output.vertex);
    let ranges: Vec<_> =
        pair.reference.pairs().into_iter().map(|both| if side == 0 { both.0 } else { both.1 }).collect();
    let reals: Vec<_> = ranges.into_iter().filter(|range| record.scalar_of(range.start) == Scalar::F32).collect();
    let chunks: Vec<Vec<AccuracyBound>> = (0..batch.invocation_count().div_ceil(SLOTS))
        .into_par_iter()
        .with_min_len(CHUNKS)
        .map_init(
            || (Limiter::new(oracle, gauge.profile, Stage::Compute), Limits::default()),
            |(limiter, limits), chunk| {
                limiter.look(batch, chunk * SLOTS, limits);
                (0..limits.slots).map(|slot| widest(limits, &reals, slot)).collect()
            },
        )
        .collect();
    chunks.into_iter().flatten().collect()
}

fn widest(limits: &Limits, ranges: &[std::ops::Range<usize>], slot: usize) -> AccuracyBound {
    if limits.reasons[slot].is_some() {
        return AccuracyBound { relative: f64::INFINITY, ulp: f64::INFINITY };
    }
    let mut widest = AccuracyBound::default();
    for range in ranges {
        let at = |word: usize| word * SLOTS + slot;
        let size = range.clone().fold(0.0_f64, |size, word| size.max(limits.values[at(word)].abs()));
        let bound = range.clone().fold(0.0_f64, |most, word| most.max(limits.bounds[at(word)]));
        let relative = if bound == 0.0 { 0.0 } else { bound / size };
        if relative > widest.relative {
            widest = AccuracyBound { relative, ulp: bound / ulp_at(size) };
        }
    }
    widest
}

/// How far a sample is apart in both functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Apart {
    /// By no more than devices that keep a profile may be off in both together.
    Within,
    /// Where nothing bounds a device.
    Unbounded,
    /// By more than that.
    Beyond,
}

/// How far some samples are apart, each by the word that says most, and the values of the word that is farthest apart.
pub(super) fn apart(pair: &ReadyPair<'_>, profile: &Profile, samples: &[Sample]) -> Vec<(Apart, Option<Farthest>)> {
    let mut all = Vec::with_capacity(samples.len());
    let mut limiters = pair.oracles.each_ref().map(|oracle| Limiter::new(oracle, profile, Stage::Compute));
    let mut limits = [Limits::default(), Limits::default()];
    let words: Vec<(usize, usize)> =
        pair.reference.pairs().into_iter().flat_map(|(own, other)| own.zip(other)).collect();
    for chunk in samples.chunks(SLOTS) {
        let batch = Sample::batch(chunk);
        let fed = pair.fed(&batch);
        for (side, batch) in [&batch, &fed].into_iter().enumerate() {
            limiters[side].look(batch, 0, &mut limits[side]);
        }
        let of_word = |own: usize, other: usize| {
            let (x, y) = (limits[0].values[own], limits[1].values[other]);
            let allowed = limits[0].bounds[own] + limits[1].bounds[other];
            match () {
                () if x.is_nan() != y.is_nan() || (x - y).abs() > allowed => Apart::Beyond,
                () if x != y && !(x.is_nan() && y.is_nan()) && !allowed.is_finite() => Apart::Unbounded,
                () => Apart::Within,
            }
        };
        for slot in 0..limits[0].slots {
            let grade = words.iter().map(|&(own, other)| of_word(own * SLOTS + slot, other * SLOTS + slot)).max();
            let farthest = words.iter().map(|&(own, other)| {
                let values = [limits[0].values[own * SLOTS + slot], limits[1].values[other * SLOTS + slot]];
                Farthest { word: own, values }
            });
            let far = |one: &Farthest| (one.values[0] - one.values[1]).abs();
            let farthest = farthest.filter(|one| far(one).is_finite()).max_by(|a, b| far(a).total_cmp(&far(b)));
            all.push((grade.unwrap_or(Apart::Within), farthest));
        }
    }
    all
}

/// The word of an output that is farthest apart, with its value in real numbers in each of the two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Farthest {
    pub word: usize,
    pub values: [f64; 2],
}
