//! Suites about large dispatches: each sample is one, run by itself and judged word by word.
//!
//! What goes wrong at a large size alone is told with the word at which it shows. Nothing is shrunk: the other sizes of the
//! suite are smaller.

mod budget;
mod laws;

use std::ops::ControlFlow;

pub use budget::Budget;
use laws::Laws;

use super::finding::{self, Finding, FindingKind};
use super::part::{Counted, Part, Terms};
use super::sampling::Sampled;
use super::{Prepared, Request, Share, relate};
use base::value::Batch;
use judge::verdict::{BatchVerdict, JudgeContext, Passes, WholeSurvey, judge_whole};
use lanes::{Actual, Lane, LaneError, Runner, Stage, interrupt};
use program::Kernel;
use program::interp::InterpError;
use property::{Sample, Sampler};
use rayon::prelude::*;

/// Samples whose bounds are surveyed.
const SURVEYED: u64 = 4;

/// What a dispatch gave on the lane, the verdict on it, and what it gave in the interpreter where that is surveyed.
type Judged<'b> = (Actual, BatchVerdict, Option<Passes<'b>>);

/// Runs dispatches one after the other and judges them side by side: one alone is too little for all cores. What the
/// interpreter gave is kept of the first `surveyed` alone, since it takes much memory.
fn judge<'b>(
    runner: &mut dyn Runner,
    context: JudgeContext<'b>,
    batches: &'b [Batch],
    (open, surveyed): (f64, u64),
) -> Result<Vec<Result<Judged<'b>, InterpError>>, LaneError> {
    let actuals = batches.iter().map(|batch| runner.run(batch)).collect::<Result<Vec<_>, _>>()?;
    let one = |(k, (batch, actual)): (usize, (&'b Batch, Actual))| {
        let passes = Passes::new(context, batch);
        let verdict = judge_whole(&passes, &actual, open)?;
        Ok((actual, verdict, ((k as u64) < surveyed).then_some(passes)))
    };
    Ok(batches.par_iter().zip(actuals).enumerate().map(one).collect())
}

/// Runs a part of the samples, and those that failed before.
pub(super) fn run(
    prepared: &Prepared,
    lane: &dyn Lane,
    (kernel, stage): (&Kernel, Stage),
    wanted: u64,
    request: &Request,
    share: &mut Share<'_>,
    progress: &mut dyn FnMut(u64),
) -> Result<Option<Part>, LaneError> {
    let mut runner = lane.prepare(kernel, 1)?;
    let mut part = Part::new(prepared, lane.description().name, (stage, None), 0);
    let (oracle, reference) = (prepared.oracle_of(lane), &prepared.reference);
    let context = JudgeContext { oracle, reference, promises: &request.promises, stage };
    let sampler = Sampler::new(prepared.plan.clone(), request.seed);
    let budget = Budget::of(&context, (prepared, &|| sampler.batch(0, 1, 1)), request, wanted)?;
    let wanted = budget.samples;
    let once = share.shard.is_first();
    let suite = &prepared.suite;
    let given: Vec<Sample> = match once {
        true if request.replay_only => request.replay.clone(),
        true => request.replay.iter().chain(&prepared.rows).cloned().collect(),
        false => Vec::new(),
    };
    part.replayed = if once { request.replay.len() as u64 } else { 0 };
    let makes_samples = prepared.plan.makes_samples();
    let range = if request.replay_only || !makes_samples { 0..0 } else { share.shard.range(wanted) };
    let mut sampled = share.resume.take().unwrap_or(Sampled { next: range.start, counted: Counted::default() });
    let surveyed = if once && sampled.counted.survey.is_none() { SURVEYED } else { 0 };
    let mut survey = WholeSurvey::default();
    let told = |error: InterpError| LaneError::Unsupported(error.locate(&prepared.program));
    // False for a dispatch that was cut short, which says nothing.
    let mut count =
        |counted: &mut Counted, number: u64, batch: &Batch, judged: Judged<'_>| -> Result<bool, LaneError> {
            let (actual, mut verdict, passes) = judged;
            if let Some(passes) = passes {
                survey.see(&passes, &actual).map_err(told)?;
            }
            if interrupt::asked() {
                return Ok(false);
            }
            if let Some(failure) = verdict.failures.first() {
                counted.deviation.get_or_insert_with(|| (number, failure.deviation.clone()));
            }
            verdict.failures.clear();
            counted.add(prepared, number, (batch, &actual), verdict);
            Ok(true)
        };
    let open = suite.floors.undetermined;
    let together = rayon::current_num_threads();
    let given: Vec<Batch> = given.iter().map(|sample| Sample::batch(std::slice::from_ref(sample))).collect();
    let mut number = 0;
    for some in given.chunks(together) {
        let judged = judge(&mut *runner, context, some, (open, surveyed.saturating_sub(number)))?;
        for (judged, batch) in judged.into_iter().zip(some) {
            count(&mut sampled.counted, number, batch, judged.map_err(told)?)?;
            number += 1;
        }
    }
    'all: while sampled.next < range.end {
        let some = sampled.next..range.end.min(sampled.next + together as u64);
        let first = given.len() as u64 + sampled.next;
        let batches: Vec<Batch> = some.map(|number| sampler.batch(number, 1, 1)).collect();
        let judged = judge(&mut *runner, context, &batches, (open, surveyed.saturating_sub(first)))?;
        for (judged, batch) in judged.into_iter().zip(&batches) {
            let number = given.len() as u64 + sampled.next;
            if !count(&mut sampled.counted, number, batch, judged.map_err(told)?)? {
                break 'all;
            }
            sampled.next += 1;
            progress(sampled.next - range.start);
            if sampled.next < range.end && (share.save)(&sampled) == ControlFlow::Break(()) {
                return Ok(None);
            }
        }
    }
    if sampled.next < range.end && !share.partial {
        return Ok(None);
    }
    if once && !interrupt::asked() && !prepared.relations.is_empty() {
        let mut related = request.replay.clone();
        if !request.replay_only {
            related.extend(relate::samples(prepared, request.seed, budget.related));
        }
        Laws { prepared, context, runner: &mut *runner }.check(&related, request, &mut part)?;
    }
    part.budget = (once && !request.replay_only && makes_samples).then_some(budget);
    sampled.counted.survey = sampled.counted.survey.take().or(survey.read(&context, &kernel.output.vertex));
    if let Some((number, deviation)) = &sampled.counted.deviation {
        part.findings.push(Finding {
            kind: FindingKind::Deviation,
            message: format!("{}, in sample {number}", deviation.message(reference.noun())),
            case: None,
            count: sampled.counted.verdicts.deviated,
            reproduce: Some(finding::rerun(request, &part)),
        });
    }
    let terms = Terms {
        least: suite.floors.judged_of(wanted.min(suite.samples), suite.samples).min(wanted),
        undetermined: suite.floors.undetermined,
        makes_samples,
        replay_only: request.replay_only,
    };
    Ok(Some(part.end(sampled.counted, ([Vec::new(), Vec::new()], Vec::new()), Some(terms))))
}
