//! How far a device may be from what the author of a program wrote, without a lane: for data that others
//! compare their results with.

use super::judge::{Doubt, Reason};
use super::oracle::Oracle;
use super::reference::{Evaluator, Expected, Reference};
use crate::profile::Profile;
use crate::tape::{Cause, Model, Share, Tape};
use base::value::{Batch, Scalar};
use program::interp::{Binary64, Machine, Number, OutputColumn, SLOTS};
use program::lane::Stage;

/// Bounds of up to [`SLOTS`] invocations.
#[derive(Clone, Debug, Default)]
pub struct Limits {
    /// Invocations.
    pub slots: usize,
    /// What the program means in binary64: by vertex, then by word of its outputs, then by slot.
    pub values: Vec<f64>,
    /// How far a device may be from that, in the same order; infinite where nothing bounds it.
    pub bounds: Vec<f64>,
    /// Why some output of a slot has no bound.
    pub reasons: Vec<Option<Reason>>,
}

/// Gives bounds by a profile.
pub struct Limiter<'a> {
    machine: Machine<'a, Tape<'a>>,
}

impl<'a> Limiter<'a> {
    /// Bounds for devices that keep a profile, with sums and products regrouped where it allows that.
    pub fn new(oracle: &'a Oracle, profile: &'a Profile, stage: Stage) -> Self {
        let model = Model::Device { profile, stage, rearranged: profile.rearrangement };
        Self { machine: oracle.authored_tape(model) }
    }

    /// Words of one vertex.
    pub fn width(&self) -> usize {
        self.machine.width()
    }

    /// Bounds of the invocations from `first` on.
    pub fn look(&mut self, batch: &Batch, first: usize, limits: &mut Limits) {
        let machine = &mut self.machine;
        let slots = machine.run(batch, first);
        let (room, width) = (machine.room(), machine.width());
        limits.slots = slots;
        limits.values.clear();
        limits.bounds.clear();
        limits.reasons.clear();
        limits.reasons.extend((0..slots).map(|slot| open(machine.domain(), slot)));
        for vertex in 0..room {
            for word in 0..width {
                let column = match machine.output(vertex, word) {
                    OutputColumn::Real(&column) => column,
                    OutputColumn::Word(words) => {
                        let words = *words;
                        let open = |slot: usize| limits.reasons.get(slot).is_some_and(Option::is_some);
                        let bound = |slot: usize| if open(slot) { f64::INFINITY } else { 0.0 };
                        limits.bounds.extend((0..SLOTS).map(bound));
                        limits.values.extend(words.iter().map(|&w| <f64 as Number>::exact(w, Scalar::I32)));
                        continue;
                    }
                };
                let tape = machine.domain();
                limits.values.extend_from_slice(tape.values(column));
                let bounds = tape.bounds(column, &mut |_| false);
                let at = limits.bounds.len();
                limits.bounds.extend_from_slice(&bounds.bound[..]);
                for slot in 0..slots {
                    let open = tape.fork(slot).is_some();
                    let loose = !limits.bounds[at + slot].is_finite() || !tape.values(column)[slot].is_finite();
                    if open || loose {
                        limits.bounds[at + slot] = f64::INFINITY;
                    }
                    if loose && limits.reasons[slot].is_none() {
                        limits.reasons[slot] = Some(Doubt::by(tape.cause(column, slot)).reason);
                    }
                }
            }
        }
    }
}

/// What a bound of the last look is made of.
impl Limiter<'_> {
    /// The operations with the largest parts of the bound of an output word, largest first.
    pub fn shares(&mut self, (vertex, word): (usize, usize), slot: usize, most: usize) -> Vec<Share> {
        let OutputColumn::Real(&column) = self.machine.output(vertex, word) else { return Vec::new() };
        self.machine.domain().shares(column, slot, most)
    }

    /// The first operation on the way to an output word whose error is more than `limit` of its size, with its relative
    /// condition number.
    pub fn culprit(&self, (vertex, word): (usize, usize), slot: usize, limit: f64) -> Option<(Cause, f64)> {
        let OutputColumn::Real(&column) = self.machine.output(vertex, word) else { return None };
        self.machine.as_domain().culprit(column, slot, limit)
    }
}

/// Why a slot has no bounds: it was given up in a very long loop, or a comparison could go either way.
fn open(tape: &Tape<'_>, slot: usize) -> Option<Reason> {
    match (tape.given_up(slot), tape.fork(slot)) {
        (Some(_), _) => Some(Reason::LongLoop),
        (None, Some(_)) => Some(Reason::Branch),
        (None, None) => None,
    }
}

/// How far binary64 may be off where it gives what a program means.
pub struct Roundoff<'a> {
    machine: Machine<'a, Tape<'a>>,
}

impl<'a> Roundoff<'a> {
    /// For a program.
    pub fn new(oracle: &'a Oracle) -> Self {
        Self { machine: oracle.ideal_tape() }
    }

    /// Bounds on the error of the outputs of the invocations from `first` on: by vertex, then by word, then by
    /// slot. Infinite where nothing bounds it, and where a comparison could go either way.
    pub fn look(&mut self, batch: &Batch, first: usize, slack: &mut Vec<f64>) {
        let machine = &mut self.machine;
        machine.run(batch, first);
        slack.clear();
        for vertex in 0..machine.room() {
            for word in 0..machine.width() {
                let column = match machine.output(vertex, word) {
                    OutputColumn::Real(&column) => Some(column),
                    OutputColumn::Word(_) => None,
                };
                let tape = machine.domain();
                let bounds = column.map(|column| *tape.bounds(column, &mut |_| false).bound);
                slack.extend((0..SLOTS).map(|slot| match (tape.fork(slot), &bounds) {
                    (Some(_), _) => f64::INFINITY,
                    (None, Some(bounds)) if bounds[slot].is_nan() => f64::INFINITY,
                    (None, Some(bounds)) => bounds[slot],
                    (None, None) => 0.0,
                }));
            }
        }
    }
}

/// Sees the place of an invocation, what is expected of it, and how far each word may be off.
pub type Each<'e> = &'e mut dyn FnMut(usize, &[f64], &[f64]);

/// Gives what a reference expects, with how far the expectation itself may be off.
pub struct Wanted<'a> {
    evaluator: Evaluator<'a>,
    expected: Expected,
}

impl<'a> Wanted<'a> {
    /// For a reference.
    pub fn new(reference: &'a Reference) -> Self {
        Self { evaluator: Evaluator::bounded(reference), expected: Expected::default() }
    }

    /// Calls `each` with the place of each of these invocations, at most [`SLOTS`] of them, its expected words
    /// (empty where nothing is expected), and how far each of them may be off.
    pub fn look(&mut self, batch: &Batch, first: usize, count: usize, each: Each<'_>) {
        let invocations: Vec<usize> = (first..first + count).collect();
        self.evaluator.turn_to(batch, &invocations);
        for (slot, &invocation) in invocations.iter().enumerate() {
            self.evaluator.expected(batch, invocation, slot, &mut self.expected);
            each(slot, &self.expected.words, &self.expected.slack);
        }
    }
}

/// Gives what a program means in binary64, with its literals as they were written.
pub struct Meant<'a> {
    machine: Machine<'a, Binary64>,
}

impl<'a> Meant<'a> {
    /// For a program.
    pub fn new(oracle: &'a Oracle) -> Self {
        Self { machine: oracle.ideal_or_meaning() }
    }

    /// The outputs of the invocations from `first` on: by vertex, then by word, then by slot. Whole
    /// numbers are given as they are, and `scalars` says by word what they stand for.
    pub fn look(&mut self, batch: &Batch, first: usize, scalars: &[Scalar], values: &mut Vec<f64>) {
        let machine = &mut self.machine;
        machine.run(batch, first);
        values.clear();
        for vertex in 0..machine.room() {
            for word in 0..machine.width() {
                match machine.output(vertex, word) {
                    OutputColumn::Real(column) => values.extend_from_slice(column.values()),
                    OutputColumn::Word(words) => {
                        values.extend(words.iter().map(|&w| <f64 as Number>::exact(w, scalars[word])));
                    }
                }
            }
        }
    }
}
