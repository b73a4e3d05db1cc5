//! The main loop: batches of generated samples, streamed so that memory does not grow with them.

use super::survey::MOST;
use super::trial::Trial;
use super::{Report, Request};
use crate::lane::{Actual, LaneError};
use crate::program::Source;
use crate::property::{Sample, Sampler};
use crate::value::Batch;
use crate::verdict::{BatchVerdict, judge_batch, survey};

/// Runs saved samples. Gives those that fail.
pub fn replay(trial: &mut Trial<'_>, samples: &[Sample], report: &mut Report) -> Result<Vec<Sample>, LaneError> {
    let mut failing = Vec::new();
    let mut all = BatchVerdict::default();
    let court = trial.court();
    trial.run_samples(samples, |_, batch, actual| {
        let verdict = judge_batch(&court, batch, actual);
        failing.extend(verdict.failures.iter().map(|f| Sample::of(batch, f.invocation)));
        all.merge(verdict);
    })?;
    report.verdicts.merge(all);
    Ok(failing)
}

/// Runs generated samples. Gives the first few that fail.
pub fn sample(
    trial: &mut Trial<'_>,
    request: &Request,
    wanted: u64,
    report: &mut Report,
    progress: &mut dyn FnMut(u64),
) -> Result<Vec<Sample>, LaneError> {
    let prepared = trial.prepared;
    let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1);
    // Where each sample is run by itself, it has uniforms of its own as well.
    let alone = matches!(trial.source, Some(Source::Constants | Source::Uniforms)) && prepared.suite.strands.is_none();
    let per_case = if alone { 1 } else { per_case };
    // A case is never split over batches; the last case of a run may be shorter than asked for.
    let per_case = per_case.min(trial.capacity());
    let cases_per_batch = (trial.capacity() / per_case).max(1) as u64;
    let sampler = Sampler::new(prepared.plan.clone(), request.seed);
    let cases = wanted.div_ceil(per_case as u64);
    let mut failing = Vec::new();
    let court = trial.court();
    let batch_at = |first: u64| {
        let count = cases_per_batch.min(cases.saturating_sub(first));
        (count > 0).then(|| sampler.batch(first, count as usize, per_case))
    };
    // Three things go on at a time: the device runs a batch, the judge works on the one before, and
    // the inputs of the one after are made. Only as many batches are in memory, however many samples.
    let mut first = 0;
    let mut running = batch_at(first);
    let mut finished: Option<(Batch, Actual)> = None;
    while running.is_some() || finished.is_some() {
        let after = first + cases_per_batch;
        let (mut next, mut verdict, mut actual, mut surveyed) = (None, None, None, None);
        rayon::in_place_scope(|scope| {
            scope.spawn(|_| next = batch_at(after));
            if let Some((batch, actual)) = &finished {
                scope.spawn(|_| verdict = Some(judge_batch(&court, batch, actual)));
                if report.survey.is_none() {
                    scope.spawn(|_| surveyed = Some(survey(&court, batch, actual, MOST)));
                }
            }
            actual = running.as_ref().map(|batch| trial.run(batch));
        });
        if let (Some((batch, _)), Some(mut verdict)) = (finished.take(), verdict) {
            for failure in std::mem::take(&mut verdict.failures) {
                if failing.len() < KEPT {
                    failing.push(Sample::of(&batch, failure.invocation));
                }
            }
            report.verdicts.merge(verdict);
            report.survey = report.survey.take().or(surveyed);
            progress((first * per_case as u64).min(wanted));
        }
        if let (Some(batch), Some(actual)) = (running.take(), actual) {
            finished = Some((batch, actual?));
        }
        running = next;
        first = after;
    }
    Ok(failing)
}

/// Failing samples that are kept for shrinking.
const KEPT: usize = 16;
