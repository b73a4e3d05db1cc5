//! A prepared suite on an open lane.

use crate::bound::profile::Rulings;
use crate::lane::{Actual, Lane, LaneError, Runner, Stage};
use crate::program::{Form, Kernel};
use crate::property::Sample;
use crate::value::Batch;
use crate::verdict::{Court, Verdict, judge_each};

use super::Prepared;

/// Invocations of one batch: full dispatches at little memory.
const BATCH: usize = 1 << 17;
/// Words of the largest buffer of a batch: 32 MiB.
const BATCH_WORDS: usize = 1 << 23;

/// A kernel of a suite on a lane.
pub struct Trial<'a> {
    /// The suite.
    pub prepared: &'a Prepared,
    /// What the lane is held against.
    rulings: &'a Rulings,
    stage: Stage,
    runner: Box<dyn Runner>,
}

impl<'a> Trial<'a> {
    /// Makes the kernel ready for large batches.
    ///
    /// # Errors
    /// [`LaneError`] when the lane refuses the kernel.
    pub fn new(
        prepared: &'a Prepared,
        lane: &dyn Lane,
        kernel: &Kernel,
        rulings: &'a Rulings,
    ) -> Result<Self, LaneError> {
        Self::with_capacity(prepared, lane, kernel, rulings, BATCH)
    }

    /// Makes the kernel ready for batches of at most `most` invocations.
    ///
    /// # Errors
    /// [`LaneError`] when the lane refuses the kernel.
    pub fn with_capacity(
        prepared: &'a Prepared,
        lane: &dyn Lane,
        kernel: &Kernel,
        rulings: &'a Rulings,
        most: usize,
    ) -> Result<Self, LaneError> {
        let widest = kernel.output.words().max(kernel.invocation.words()).max(kernel.case.words()).max(1);
        let capacity = most.min(BATCH_WORDS / widest).max(1);
        let stage = match kernel.form {
            Form::Compute => Stage::Compute,
            Form::Vertex { .. } => Stage::Vertex,
        };
        Ok(Self { prepared, rulings, stage, runner: lane.prepare(kernel, capacity)? })
    }

    /// What verdicts on the lane's outputs need.
    pub fn court(&self) -> Court<'a> {
        let Prepared { oracle, reference, .. } = self.prepared;
        Court { oracle, reference, rulings: self.rulings, stage: self.stage }
    }

    /// Most invocations of one batch.
    pub fn capacity(&self) -> usize {
        self.runner.capacity()
    }

    /// Runs a batch in one dispatch.
    ///
    /// # Errors
    /// [`LaneError`]; the outputs are then gone.
    pub fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        self.runner.run(batch)
    }

    /// Runs samples, each with uniforms of its own, in as few dispatches as fit, and hands each
    /// dispatch to `each` with the index of its first sample.
    ///
    /// # Errors
    /// [`LaneError`]; the outputs of the failing dispatch are then gone.
    pub fn run_samples(
        &mut self,
        samples: &[Sample],
        mut each: impl FnMut(usize, &Batch, &Actual),
    ) -> Result<(), LaneError> {
        let capacity = self.capacity();
        for (k, chunk) in samples.chunks(capacity).enumerate() {
            let batch = Sample::batch(chunk);
            let actual = self.run(&batch)?;
            each(k * capacity, &batch, &actual);
        }
        Ok(())
    }

    /// For each sample, whether it deviates.
    ///
    /// # Errors
    /// [`LaneError`]; there is no verdict then.
    pub fn deviates(&mut self, samples: &[Sample]) -> Result<Vec<bool>, LaneError> {
        let mut verdicts = Vec::with_capacity(samples.len());
        let court = self.court();
        self.run_samples(samples, |_, batch, actual| {
            let deviates = |verdict: Verdict| matches!(verdict, Verdict::Deviate(_));
            verdicts.extend(judge_each(&court, batch, actual).into_iter().map(deviates));
        })?;
        Ok(verdicts)
    }
}
