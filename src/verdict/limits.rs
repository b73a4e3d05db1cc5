//! How far a device may be from what the author of a program wrote, without a lane: for data that others
//! compare their results with.

use super::judge::{Doubt, Reason};
use super::oracle::Oracle;
use crate::bound::profile::Profile;
use crate::bound::tape::{Model, Tape};
use crate::interp::{Binary64, LANES, Machine, Number, OutputColumn};
use crate::lane::Stage;
use crate::value::{Batch, Scalar};

/// Bounds of up to [`LANES`] invocations.
#[derive(Clone, Debug, Default)]
pub struct Limits {
    /// Invocations.
    pub lanes: usize,
    /// What the program means in binary64: by vertex, then by word of its outputs, then by lane.
    pub values: Vec<f64>,
    /// How far a device may be from that, in the same order; infinite where nothing bounds it.
    pub bounds: Vec<f64>,
    /// Why some output of a lane has no bound.
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
        let lanes = machine.run(batch, first);
        let (room, width) = (machine.room(), machine.width());
        limits.lanes = lanes;
        limits.values.clear();
        limits.bounds.clear();
        limits.reasons.clear();
        limits.reasons.extend((0..lanes).map(|lane| machine.domain().fork(lane).map(|_| Reason::Branch)));
        for vertex in 0..room {
            for word in 0..width {
                let column = match machine.output(vertex, word) {
                    OutputColumn::Real(&column) => column,
                    OutputColumn::Word(words) => {
                        let words = *words;
                        let open = |lane: usize| limits.reasons.get(lane).is_some_and(Option::is_some);
                        let bound = |lane: usize| if open(lane) { f64::INFINITY } else { 0.0 };
                        limits.bounds.extend((0..LANES).map(bound));
                        limits.values.extend(words.iter().map(|&w| <f64 as Number>::exact(w, Scalar::I32)));
                        continue;
                    }
                };
                let tape = machine.domain();
                limits.values.extend_from_slice(tape.values(column));
                let bounds = tape.bounds(column, &mut |_| false);
                let at = limits.bounds.len();
                limits.bounds.extend_from_slice(&bounds.bound[..]);
                for lane in 0..lanes {
                    let open = tape.fork(lane).is_some();
                    let loose = !limits.bounds[at + lane].is_finite() || !tape.values(column)[lane].is_finite();
                    if open || loose {
                        limits.bounds[at + lane] = f64::INFINITY;
                    }
                    if loose && limits.reasons[lane].is_none() {
                        limits.reasons[lane] = Some(Doubt::by(tape.cause(column, lane)).reason);
                    }
                }
            }
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

    /// The outputs of the invocations from `first` on: by vertex, then by word, then by lane. Whole
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
