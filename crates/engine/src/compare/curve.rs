//! Both functions over one of their inputs, while the others stay at the sample that shows most: what a chart is drawn from.

use std::ops::Range;

use super::{ReadyPair, drawn};
use crate::InputValue;
use crate::fuzz::Domain;
use base::value::{Batch, Record, Scalar, ulp_at};
use judge::profile::Profile;
use judge::verdict::{Limiter, Limits};
use lanes::Stage;
use program::interp::SLOTS;
use property::Sample;

/// Points of a curve.
const POINTS: usize = 512;

/// Samples from which the range of an input is taken.
const LOOKED_AT: usize = 1 << 10;

/// Of these, the part at either end that is left out: a few numbers far away would leave no room for the others.
const OUTLYING: f64 = 0.02;

/// Components of inputs of which each gets a curve.
const COMPONENTS: usize = 4;

/// Both functions over a component of an input.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The component that varies: `x`, `v.y`.
    pub input: String,
    /// The component of an output: that in which the two differ most.
    pub output: String,
    /// The inputs of the first function where it stands still; the one that varies is among them.
    pub fixed: Vec<InputValue>,
    /// Points from left to right.
    pub points: Vec<Point>,
    /// What bounds are derived from.
    pub profile: String,
}

/// A place of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The value of the input.
    pub at: f64,
    /// What both mean in real numbers; NaN where one has no value.
    pub values: [f64; 2],
    /// How far a device may be off in each, in ULP of the largest component of the variable; `None` where nothing bounds it.
    pub bounds: [Option<f64>; 2],
}

/// A component of a record: its name, whether it is of a case, and its word.
#[derive(Clone)]
struct Component {
    name: String,
    of_case: bool,
    word: usize,
}

/// Curves over the first components of the inputs, around a sample.
pub(super) fn curves(
    pair: &ReadyPair<'_>,
    profile: &Profile,
    domain: &Domain,
    key: u64,
    around: &Sample,
) -> Vec<Curve> {
    let numbers = |record: &Record, of_case: bool| -> Vec<Component> {
        let fields = record.fields().iter().enumerate().filter(|(_, field)| field.shape.scalar == Scalar::F32);
        let words = fields.flat_map(|(k, field)| {
            let first = record.range(k).start;
            (0..field.shape.words()).map(move |word| Component {
                name: format!("{}{}", field.name, field.shape.component_name(word)),
                of_case,
                word: first + word,
            })
        });
        words.collect()
    };
    let ready = pair.sides[0];
    let samples = drawn(ready, domain, key, (0, LOOKED_AT), !domain.is_stated());
    let all = [numbers(&ready.kernel.invocation, false), numbers(&ready.kernel.case, true)].concat();
    all.iter().take(COMPONENTS).filter_map(|component| curve(pair, profile, &samples, around, component)).collect()
}

fn curve(
    pair: &ReadyPair<'_>,
    profile: &Profile,
    samples: &Batch,
    around: &Sample,
    component: &Component,
) -> Option<Curve> {
    let [low, high] = range(samples, component, around)?;
    let mut varied: Vec<Sample> = Vec::with_capacity(POINTS);
    for k in 0..POINTS {
        let mut sample = around.clone();
        // The number that a device gets.
        let at = (low + (high - low) * k as f64 / (POINTS - 1) as f64) as f32;
        let words = if component.of_case { &mut sample.case } else { &mut sample.invocation };
        words[component.word] = at.to_bits();
        varied.push(sample);
    }
    let batch = Sample::batch(&varied);
    let sides = [looked(pair, 0, profile, &batch), looked(pair, 1, profile, &pair.fed(&batch))];
    let pairs = pair.reference.pairs();
    let words = pairs.iter().flat_map(|(own, other)| own.clone().zip(other.clone()).map(move |at| (at, own, other)));
    let record = &pair.sides[0].kernel.output.vertex;
    let (at, own, other) = words
        .filter(|((own, _), _, _)| record.scalar_of(*own) == Scalar::F32)
        .max_by(|(a, ..), (b, ..)| apart(&sides, *a).total_cmp(&apart(&sides, *b)))?;
    let points = (0..POINTS).map(|k| {
        let words = if component.of_case { &varied[k].case } else { &varied[k].invocation };
        let values = [sides[0][k].values[at.0], sides[1][k].values[at.1]];
        let bounds = [sides[0][k].ulp(at.0, own), sides[1][k].ulp(at.1, other)];
        Point { at: f64::from(f32::from_bits(words[component.word])), values, bounds }
    });
    Some(Curve {
        input: component.name.clone(),
        output: named(record, at.0),
        fixed: InputValue::all(around, &pair.sides[0].program),
        points: points.collect(),
        profile: profile.name.clone(),
    })
}

/// The ends of what a component takes; `None` where it takes one value.
fn range(samples: &Batch, component: &Component, around: &Sample) -> Option<[f64; 2]> {
    let number = |words: &[u32]| f64::from(f32::from_bits(words[component.word]));
    let of = |k: usize| if component.of_case { samples.case_of(k) } else { samples.invocation(k) };
    let mut all: Vec<f64> = (0..samples.invocation_count()).map(|k| number(of(k))).filter(|x| x.is_finite()).collect();
    all.sort_by(f64::total_cmp);
    let outlying = (all.len() as f64 * OUTLYING) as usize;
    let here = number(if component.of_case { &around.case } else { &around.invocation });
    let (low, high) = (*all.get(outlying)?, *all.get(all.len() - 1 - outlying)?);
    let (low, high) = if here.is_finite() { (low.min(here), high.max(here)) } else { (low, high) };
    (low < high).then_some([low, high])
}

/// The outputs of a sample with their bounds, word by word.
struct Looked {
    values: Vec<f64>,
    bounds: Vec<f64>,
    bounded: bool,
}

impl Looked {
    fn ulp(&self, word: usize, variable: &Range<usize>) -> Option<f64> {
        let size = self.values[variable.clone()].iter().fold(0.0_f64, |size, value| size.max(value.abs()));
        let ulp = self.bounds[word] / ulp_at(size);
        (self.bounded && ulp.is_finite()).then_some(ulp)
    }
}

fn looked(pair: &ReadyPair<'_>, side: usize, profile: &Profile, batch: &Batch) -> Vec<Looked> {
    let mut limiter = Limiter::new(&pair.oracles[side], profile, Stage::Compute);
    let words = pair.sides[side].kernel.output.vertex.words();
    let (mut limits, mut all) = (Limits::default(), Vec::new());
    for first in (0..batch.invocation_count()).step_by(SLOTS) {
        limiter.look(batch, first, &mut limits);
        for slot in 0..limits.slots {
            let of = |from: &[f64]| (0..words).map(|word| from[word * SLOTS + slot]).collect();
            let bounded = limits.reasons[slot].is_none();
            all.push(Looked { values: of(&limits.values), bounds: of(&limits.bounds), bounded });
        }
    }
    all
}

/// How far a component of both is apart at most, as a part of its size.
fn apart(sides: &[Vec<Looked>; 2], (own, other): (usize, usize)) -> f64 {
    let points = sides[0].iter().zip(&sides[1]).map(|(a, b)| (a.values[own], b.values[other]));
    let far = |(a, b): (f64, f64)| if a == b { 0.0 } else { (a - b).abs() / a.abs().max(b.abs()) };
    points.map(far).filter(|far| far.is_finite()).fold(0.0, f64::max)
}

/// The name of a word of an output: `return.x`.
pub(super) fn named(record: &Record, word: usize) -> String {
    let field = (0..record.fields().len()).find(|&k| record.range(k).contains(&word));
    field.map_or_else(String::new, |k| {
        let field = &record.fields()[k];
        format!("{}{}", field.name, field.shape.component_name(word - record.range(k).start))
    })
}
