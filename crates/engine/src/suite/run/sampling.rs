//! The main loop: batches of generated samples, streamed so that memory does not grow with them.

use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

use super::part::Counted;
use super::survey::MOST;
use super::trial::Trial;
use super::{Request, Share};
use base::value::Batch;
use judge::verdict::{Judges, judge_batch, survey};
use lanes::{Actual, LaneError, interrupt};
use program::InputSource;
use property::{Sample, Sampler};

/// How far the samples of a part of a run are done.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Sampled {
    /// The first case that is still to do.
    pub(super) next: u64,
    pub(super) counted: Counted,
}

/// Runs saved samples, the first of which has the number `first` in the run.
pub fn replay(trial: &mut Trial<'_>, samples: &[Sample], first: u64) -> Result<Counted, LaneError> {
    let mut counted = Counted::default();
    let (context, prepared) = (trial.context(), trial.prepared);
    trial.run_samples(samples, |at, batch, actual| {
        let verdict = judge_batch(&context, batch, actual);
        counted.add(prepared, first + at as u64, (batch, actual), verdict);
    })?;
    Ok(counted)
}

/// Runs the generated samples of a part of a run; `before` samples are numbered before them. Gives nothing
/// when it was stopped.
pub fn sample(
    trial: &mut Trial<'_>,
    request: &Request,
    (wanted, before): (u64, u64),
    share: &mut Share<'_>,
    progress: &mut dyn FnMut(u64),
) -> Result<Option<Counted>, LaneError> {
    let prepared = trial.prepared;
    let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1);
    // Where each sample is run by itself, it has uniforms of its own as well.
    let alone = matches!(trial.source, Some(InputSource::Constants | InputSource::Uniforms))
        && prepared.suite.strands.is_none();
    let per_case = if alone { 1 } else { per_case };
    // A case is never split over batches; the last case of a run may be shorter than asked for.
    let per_case = per_case.min(trial.capacity());
    let cases_per_batch = (trial.capacity() / per_case).max(1) as u64;
    let sampler = Sampler::new(prepared.plan.clone(), request.seed);
    let cases = wanted.div_ceil(per_case as u64);
    let part = share.shard.range(cases);
    let mut sampled = share.resume.take().unwrap_or(Sampled { next: part.start, counted: Counted::default() });
    let context = trial.context();
    let judges = Judges::new(&context);
    let batch_at = |first: u64| {
        let count = cases_per_batch.min(part.end.saturating_sub(first));
        (count > 0).then(|| sampler.batch(first, count as usize, per_case))
    };
    // The survey is of the first samples of the run, also where the first part has fewer of its own.
    let surveyed = cases.min((MOST as u64).div_ceil(per_case as u64));
    if share.shard.is_first() && part.end < surveyed && sampled.counted.survey.is_none() {
        let batch = sampler.batch(0, surveyed as usize, per_case);
        let actual = trial.run(&batch)?;
        sampled.counted.survey = Some(survey(&context, &batch, &actual, MOST));
    }
    // Three things go on at a time: the device runs a batch, the judge works on the one before, and
    // the inputs of the one after are made. Only as many batches are in memory, however many samples.
    let mut first = sampled.next;
    let mut running = batch_at(first);
    let mut finished: Option<(Batch, Actual)> = None;
    while running.is_some() || finished.is_some() {
        let after = first + cases_per_batch;
        let (mut next, mut verdict, mut actual, mut surveyed) = (None, None, None, None);
        let wants_survey = sampled.counted.survey.is_none() && share.shard.is_first() && sampled.next == 0;
        rayon::in_place_scope(|scope| {
            scope.spawn(|_| next = batch_at(after));
            if let Some((batch, actual)) = &finished {
                scope.spawn(|_| verdict = Some(judges.judge(batch, actual)));
                if wants_survey {
                    scope.spawn(|_| surveyed = Some(survey(&context, batch, actual, MOST)));
                }
            }
            actual = running.as_ref().map(|batch| trial.run(batch));
        });
        if let (Some((batch, actual)), Some(verdict)) = (finished.take(), verdict) {
            // What is handed over has to be whole; the judge looks at no more when the run is to end.
            if interrupt::asked() && !share.partial {
                return Ok(None);
            }
            sampled.counted.add(prepared, before + sampled.next * per_case as u64, (&batch, &actual), verdict);
            sampled.counted.survey = sampled.counted.survey.take().or(surveyed);
            sampled.next += batch.case_count() as u64;
            progress(((sampled.next - part.start) * per_case as u64).min(wanted));
            if sampled.next < part.end && (share.save)(&sampled) == ControlFlow::Break(()) {
                return Ok(None);
            }
        }
        if interrupt::asked() && share.partial {
            break;
        }
        if let (Some(batch), Some(actual)) = (running.take(), actual) {
            match actual {
                Ok(actual) => finished = Some((batch, actual)),
                // A device that is given up because the run ends has not failed.
                Err(_) if interrupt::asked() && share.partial => break,
                Err(error) => return Err(error),
            }
        }
        running = next;
        first = after;
    }
    Ok(Some(sampled.counted))
}
