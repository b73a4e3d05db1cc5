//! One operation on a lane: what feeds it, and the tallies of what it gives.

use std::ops::Range;

use rayon::prelude::*;

use base::value::Batch;
use judge::profile::Op;
use judge::single::{Inputs, kernel};
use lanes::{Actual, Lane, Runner};

use super::{CalibrateError, FINITE, Judge, Tally};

/// Invocations of one dispatch.
pub(super) const DISPATCH: usize = 1 << 17;
/// Invocations of a sweep that one thread takes at a time: a part of a binade.
const PART: usize = 1 << 14;
/// First word of the numbers with a minus sign.
const NEGATIVE: u64 = 0x8000_0000;

/// A kernel on a lane with what feeds it.
pub(super) struct MeasuredDevice {
    runner: Box<dyn Runner>,
    /// A batch without invocations.
    empty: Batch,
    op: Op,
    /// True for the kernel in which an invocation computes the results for a word and those behind it.
    sweeps: bool,
}

impl MeasuredDevice {
    pub(super) fn new(lane: &dyn Lane, op: Op, sweeps: bool) -> Result<Self, CalibrateError> {
        let kernel = if sweeps { kernel::sweep(op)? } else { kernel::pointwise(op)? };
        let empty = Batch::with_capacity(kernel.invocation.clone(), kernel.case.clone(), 1, DISPATCH);
        Ok(Self { runner: lane.prepare(&kernel, DISPATCH)?, empty, op, sweeps })
    }

    /// The tally of samples `range`, or of the words of a sweep.
    pub(super) fn block(&mut self, judge: &Judge<'_>, range: Range<u64>) -> Result<Tally, CalibrateError> {
        let mut tally = Tally::default();
        if self.sweeps {
            let firsts = range.step_by(kernel::SWEEP).map(swept);
            self.words(judge, firsts, &mut |parts| {
                parts.iter().for_each(|(_, part)| tally.merge(part));
                Ok(())
            })?;
            return Ok(tally);
        }
        let (inputs, arity) = (Inputs::new(self.op), self.op.arity().unwrap_or(1));
        let mut samples = range.map(|k| inputs.at(k));
        let judged = |batch: &Batch, actual: &Actual| {
            judge.tally(batch.invocation_count(), |k| {
                let mut arguments = [0; 3];
                let record = batch.invocation(k);
                arguments[..record.len()].copy_from_slice(record);
                (arguments, actual.vertex(k, 0)[0])
            })
        };
        self.pipelined(
            &mut |words, count| words.extend(samples.by_ref().take(count).flat_map(|at| at.into_iter().take(arity))),
            &judged,
            &mut |part| {
                tally.merge(&part);
                Ok(())
            },
        )?;
        Ok(tally)
    }

    /// Computes the results for words and the [`kernel::SWEEP`] − 1 words behind each, with the kernel of a sweep. `taken`
    /// gets the tallies of each dispatch, each of one bin, with the bin. Words of one bin ascend.
    pub(super) fn words(
        &mut self,
        judge: &Judge<'_>,
        mut firsts: impl Iterator<Item = u32>,
        taken: &mut dyn FnMut(Vec<(usize, Tally)>) -> Result<(), CalibrateError>,
    ) -> Result<(), CalibrateError> {
        let column = self.op.column().unwrap_or(|_, exact| exact.fill(f64::NAN));
        let judged = |batch: &Batch, actual: &Actual| -> Vec<(usize, Tally)> {
            let mut begin = 0;
            let mut parts: Vec<(usize, &[u32])> = Vec::new();
            for bin in batch.invocations.chunk_by(|a, b| a >> 23 == b >> 23) {
                for part in bin.chunks(PART) {
                    parts.push((begin, part));
                    begin += part.len();
                }
            }
            let tally = |(begin, part): (usize, &[u32])| {
                let mut results = Vec::with_capacity(part.len() * kernel::SWEEP);
                (begin..begin + part.len()).for_each(|k| results.extend_from_slice(actual.vertex(k, 0)));
                let bin = part.first().map_or(0, |word| (word >> 23) as usize);
                (bin, judge.tally_neighbours(part, &results, column))
            };
            parts.into_par_iter().map(tally).collect()
        };
        self.pipelined(&mut |words, count| words.extend(firsts.by_ref().take(count)), &judged, taken)
    }

    /// Runs what `fill` writes, dispatch after dispatch, until it writes nothing; its number is the most invocations. What the
    /// device gave last is judged while it computes the next.
    fn pipelined<T: Send>(
        &mut self,
        fill: &mut dyn FnMut(&mut Vec<u32>, usize),
        judged: &(dyn Fn(&Batch, &Actual) -> T + Sync),
        taken: &mut dyn FnMut(T) -> Result<(), CalibrateError>,
    ) -> Result<(), CalibrateError> {
        // A power of two, so that no part of a sweep crosses from one binade to the next.
        let count = 1 << self.runner.capacity().max(1).ilog2();
        let mut last: Option<(Batch, Actual)> = None;
        let mut spare = self.empty.clone();
        loop {
            let mut part = None;
            let next = rayon::in_place_scope(|scope| {
                if let Some((batch, actual)) = &last {
                    scope.spawn(|_| part = Some(judged(batch, actual)));
                }
                spare.invocations.clear();
                fill(&mut spare.invocations, count);
                (!spare.invocations.is_empty()).then(|| self.runner.run(&spare))
            });
            part.map_or(Ok(()), &mut *taken)?;
            let free = last.take().map(|(batch, _)| batch);
            let Some(actual) = next else { return Ok(()) };
            let filled = std::mem::replace(&mut spare, free.unwrap_or_else(|| self.empty.clone()));
            last = Some((filled, actual?));
        }
    }
}

/// The `k`-th finite number: those with a plus sign first.
pub(super) fn swept(k: u64) -> u32 {
    (if k < FINITE { k } else { k - FINITE + NEGATIVE }) as u32
}
