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
use judge::verdict::{JudgeContext, Passes, WholeSurvey, judge_whole};
use lanes::{Lane, LaneError, Stage, interrupt};
use program::Kernel;
use program::interp::InterpError;
use property::{Sample, Sampler};

/// Samples whose bounds are surveyed.
const SURVEYED: u64 = 4;

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
    let mut judge = |counted: &mut Counted, number: u64, batch: &Batch| -> Result<(), LaneError> {
        let actual = runner.run(batch)?;
        let told = |error: InterpError| LaneError::Unsupported(error.locate(&prepared.program));
        let passes = Passes::new(context, batch);
        let mut verdict = judge_whole(&passes, &actual, suite.floors.undetermined).map_err(told)?;
        if number < surveyed {
            survey.see(&passes, &actual).map_err(told)?;
        }
        // What was cut short says nothing.
        if interrupt::asked() {
            return Ok(());
        }
        if let Some(failure) = verdict.failures.first() {
            counted.deviation.get_or_insert_with(|| (number, failure.deviation.clone()));
        }
        verdict.failures.clear();
        counted.add(prepared, number, (batch, &actual), verdict);
        Ok(())
    };
    for (k, sample) in given.iter().enumerate() {
        judge(&mut sampled.counted, k as u64, &Sample::batch(std::slice::from_ref(sample)))?;
    }
    while sampled.next < range.end {
        judge(&mut sampled.counted, given.len() as u64 + sampled.next, &sampler.batch(sampled.next, 1, 1))?;
        if interrupt::asked() {
            break;
        }
        sampled.next += 1;
        progress(sampled.next - range.start);
        if sampled.next < range.end && (share.save)(&sampled) == ControlFlow::Break(()) {
            return Ok(None);
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
