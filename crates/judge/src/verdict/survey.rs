//! How tight bounds are: for part of a batch every output word gets its full bound, by the promise and
//! by the measured profile of the device, beside the error that the lane made.

use serde::{Deserialize, Serialize};

use super::judge::agrees;
use super::observe::{Slack, slack_of};
use super::oracle::JudgeContext;
use super::parallel::parts;
use super::tightness::{Gauge, Tightness, Word, Worst, keep_worse};
use crate::profile::grid::MIN_NORMAL;
use crate::tape::Tape;
use base::value::Batch;
use program::interp::{Machine, OutputColumn, SLOTS};
use program::lane::Actual;

/// Bounds of a part of a batch, and what the lane made of them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Survey {
    /// Invocations that were looked at: the first of the batch.
    pub invocations: u64,
    /// By the most lenient promise of the API, rearranged where it allows that: the bound by which a
    /// lane is blamed.
    pub promise: Tightness,
    /// By the measured profile of the device, where there is one.
    pub measured: Option<Tightness>,
    /// Invocations with a word beyond its measured bound and none beyond its promise. Where nothing is
    /// promised, no promise is broken.
    pub beyond: u64,
    /// The word of these that is farthest beyond the measured bound, in multiples of it.
    pub worst_beyond: Option<Worst>,
    /// Of large dispatches, the tightest bounds again for the order in which sums and products are written, whether or not
    /// the API holds a device to it.
    #[serde(default)]
    pub as_written: Option<Tightness>,
    /// Of large dispatches, how tight the bounds of each are.
    #[serde(default)]
    pub by_sample: Vec<OfSample>,
}

/// How tight the bounds of one large dispatch are: [`Tightness::median_over_largest`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OfSample {
    /// By the tightest profile there is; for any order of sums and products where it leaves that open.
    #[serde(with = "base::value::exact::option")]
    pub allowed: Option<f64>,
    /// For the order written.
    #[serde(with = "base::value::exact::option")]
    pub as_written: Option<f64>,
}

impl Survey {
    /// By the tightest bound there is: measured where the device has a profile, else promised.
    pub fn tightest(&self) -> &Tightness {
        self.measured.as_ref().unwrap_or(&self.promise)
    }
}

/// Looks at the first `most` invocations of a batch. Words that are no numbers are left out, as are
/// those that the shader leaves without a value, those of variables below the normal range, and
/// those of lanes that emit other vertices than they should: the judge tells of these.
///
/// # Panics
/// When `actual` is not of this batch: a defect of the caller.
pub fn survey(context: &JudgeContext<'_>, batch: &Batch, actual: &Actual, most: usize) -> Survey {
    assert_eq!(actual.count(), batch.invocation_count(), "outputs of another batch");
    let count = actual.count().min(most);
    let chunks = parts(
        count.div_ceil(SLOTS),
        || Surveyor::new(context),
        |surveyor, chunk| surveyor.look(batch, actual, chunk * SLOTS..((chunk + 1) * SLOTS).min(count)),
    );
    let mut all = Tally::default();
    chunks.into_iter().for_each(|chunk| all.merge(chunk));
    let record = &actual.layout().vertex;
    let promises = context.promises;
    let Tally { promise, measured, beyond, worst_beyond } = all;
    Survey {
        invocations: count as u64,
        promise: promise.read(&promises.lenient().name, record),
        measured: promises.measured.as_ref().map(|profile| measured.read(&profile.name, record)),
        beyond,
        worst_beyond,
        as_written: None,
        by_sample: Vec::new(),
    }
}

#[derive(Default)]
struct Tally {
    promise: Gauge,
    measured: Gauge,
    beyond: u64,
    worst_beyond: Option<Worst>,
}

impl Tally {
    fn merge(&mut self, later: Self) {
        let Self { promise, measured, beyond, worst_beyond } = later;
        self.promise.merge(promise);
        self.measured.merge(measured);
        self.beyond += beyond;
        keep_worse(&mut self.worst_beyond, worst_beyond);
    }
}

/// What one thread looks with.
struct Surveyor<'a> {
    promise: Machine<'a, Tape<'a>>,
    measured: Option<Machine<'a, Tape<'a>>>,
}

impl<'a> Surveyor<'a> {
    fn new(context: &JudgeContext<'a>) -> Self {
        Self {
            promise: context.oracle.tape(context.lenient()),
            measured: context.measured().map(|model| context.oracle.tape(model)),
        }
    }

    fn look(&mut self, batch: &Batch, actual: &Actual, range: std::ops::Range<usize>) -> Tally {
        let first = range.start;
        let promised = slack_of(&mut self.promise, batch, first);
        let measured: Option<Slack> = self.measured.as_mut().map(|machine| slack_of(machine, batch, first));
        let values = values(&mut self.promise);
        let mut tally = Tally::default();
        for invocation in range {
            let slot = invocation - first;
            let machine = &self.promise;
            let stored = if machine.is_emitting() { machine.emitted()[slot] as usize } else { 1 };
            if stored != actual.stored(invocation) {
                continue;
            }
            // A word beyond its promise makes the invocation a deviation, whatever the others are.
            let (mut broken, mut beyond): (bool, Option<Worst>) = (false, None);
            for vertex in 0..stored {
                let record = &actual.layout().vertex;
                for field in 0..record.fields().len() {
                    let at = |word: usize| vertex * machine.width() + word;
                    let value = |word: usize| values[at(word)].as_ref().map(|column| column[slot]);
                    let size = record.range(field).filter_map(value).fold(0.0_f64, |m, v| m.max(v.abs()));
                    if size > 0.0 && size < MIN_NORMAL {
                        continue;
                    }
                    for word in record.range(field) {
                        let Some(value) = value(word).filter(|v| v.is_finite()) else { continue };
                        let found = f64::from(f32::from_bits(actual.vertex(invocation, vertex)[word]));
                        let seen = |bound: f64| Word { word, field, error: (found - value).abs(), bound, size };
                        let on = actual.layout().max_vertices.map(|_| vertex);
                        let promised = seen(promised[slot][at(word)]);
                        let name = |seen: &Word| seen.worst(record, on, invocation);
                        tally.promise.see(&promised, name);
                        broken |= promised.bound.is_finite() && !agrees(promised.error, 0.0, promised.bound);
                        let Some(measured) = &measured else { continue };
                        let measured = seen(measured[slot][at(word)]);
                        tally.measured.see(&measured, name);
                        if measured.bound.is_finite() && !agrees(measured.error, 0.0, measured.bound) {
                            keep_worse(&mut beyond, Some(name(&measured)));
                        }
                    }
                }
            }
            if !broken && beyond.is_some() {
                tally.beyond += 1;
                keep_worse(&mut tally.worst_beyond, beyond);
            }
        }
        tally
    }
}

/// The exact values of the outputs that are real numbers, by vertex, then by word of the record.
fn values(machine: &mut Machine<'_, Tape<'_>>) -> Vec<Option<[f64; SLOTS]>> {
    let (room, width) = (machine.room(), machine.width());
    let mut values = Vec::with_capacity(room * width);
    for vertex in 0..room {
        for word in 0..width {
            values.push(match machine.output(vertex, word) {
                OutputColumn::Real(&column) => Some(*machine.domain().values(column)),
                OutputColumn::Word(_) => None,
            });
        }
    }
    values
}
