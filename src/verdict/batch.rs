//! Verdicts on whole batches, on all cores.

use rayon::prelude::*;

use super::expected::{Expected, Reference};
use super::judge::{Deviation, Reason, Verdict, judge_sample};
use super::tolerance::Tolerance;
use crate::lane::Actual;
use crate::value::Batch;

/// An invocation that deviates.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Its index in the batch.
    pub invocation: usize,
    /// How it deviates.
    pub deviation: Deviation,
}

/// The verdicts on a batch, counted.
#[derive(Clone, Debug, Default)]
pub struct BatchVerdict {
    /// Invocations that agree.
    pub agreed: u64,
    /// Invocations that deviate.
    pub deviated: u64,
    /// Undetermined invocations, by reason: domain, ill-conditioned, underflow.
    pub undetermined: [u64; 3],
    /// Largest error of an invocation that agrees, in ULP.
    pub max_ulp: f64,
    /// The first few failures, in the order of the batch.
    pub failures: Vec<Failure>,
}

/// Failures that are kept: enough to shrink, few enough to hold when everything fails.
const KEPT: usize = 16;

impl BatchVerdict {
    /// All undetermined invocations.
    pub fn undetermined_count(&self) -> u64 {
        self.undetermined.iter().sum()
    }

    /// All invocations that were looked at.
    pub fn seen(&self) -> u64 {
        self.agreed + self.deviated + self.undetermined_count()
    }

    /// Adds the verdicts on what comes after.
    pub fn merge(&mut self, later: Self) {
        let Self { agreed, deviated, undetermined, max_ulp, failures } = later;
        self.agreed += agreed;
        self.deviated += deviated;
        self.undetermined.iter_mut().zip(undetermined).for_each(|(sum, n)| *sum += n);
        self.max_ulp = self.max_ulp.max(max_ulp);
        let room = KEPT.saturating_sub(self.failures.len());
        self.failures.extend(failures.into_iter().take(room));
    }

    fn count(&mut self, invocation: usize, verdict: Verdict) {
        match verdict {
            Verdict::Agree { ulp } => {
                self.agreed += 1;
                self.max_ulp = self.max_ulp.max(ulp);
            }
            Verdict::Undetermined(reason) => {
                let at = match reason {
                    Reason::Domain => 0,
                    Reason::IllConditioned => 1,
                    Reason::Underflow => 2,
                };
                self.undetermined[at] += 1;
            }
            Verdict::Deviate(deviation) => {
                self.deviated += 1;
                if self.failures.len() < KEPT {
                    self.failures.push(Failure { invocation, deviation });
                }
            }
        }
    }
}

/// Invocations that one thread judges at a time.
pub(super) const CHUNK: usize = 4096;

/// Judges every invocation of a batch.
///
/// # Panics
/// When `actual` is not of this batch: a defect of the caller.
pub fn judge_batch(reference: &Reference, batch: &Batch, actual: &Actual, tolerance: &Tolerance) -> BatchVerdict {
    let count = batch.invocation_count();
    assert_eq!(actual.count(), count, "outputs of another batch");
    let chunks: Vec<BatchVerdict> = (0..count.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(count);
            judge_range(reference, batch, actual, tolerance, range)
        })
        .collect();
    let mut all = BatchVerdict::default();
    for chunk in chunks {
        all.merge(chunk);
    }
    all
}

/// Judges a single invocation of a batch.
pub fn judge_one(
    reference: &Reference,
    batch: &Batch,
    actual: &Actual,
    invocation: usize,
    tolerance: &Tolerance,
) -> Verdict {
    let mut inputs = reference.scratch();
    reference.read_case(batch, invocation / batch.per_case, &mut inputs);
    reference.read_invocation(batch, invocation, &mut inputs);
    let mut expected = Expected::default();
    reference.eval(&inputs, &mut expected);
    judge_sample(reference, &inputs, &expected, actual, invocation, tolerance)
}

fn judge_range(
    reference: &Reference,
    batch: &Batch,
    actual: &Actual,
    tolerance: &Tolerance,
    range: std::ops::Range<usize>,
) -> BatchVerdict {
    let mut verdict = BatchVerdict::default();
    let mut inputs = reference.scratch();
    let mut expected = Expected::default();
    let mut case = usize::MAX;
    for invocation in range {
        if invocation / batch.per_case != case {
            case = invocation / batch.per_case;
            reference.read_case(batch, case, &mut inputs);
        }
        reference.read_invocation(batch, invocation, &mut inputs);
        reference.eval(&inputs, &mut expected);
        verdict.count(invocation, judge_sample(reference, &inputs, &expected, actual, invocation, tolerance));
    }
    verdict
}
