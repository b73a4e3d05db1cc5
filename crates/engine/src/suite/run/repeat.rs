//! The same inputs again: a lane gives the same bits, or it is flaky.
//!
//! What differs from run to run says nothing about a shader, and cannot be shrunk: it is told as a fault of the
//! lane and of its driver.

use serde::{Deserialize, Serialize};

use super::finding::{self, Finding, FindingKind};
use super::position::{self, Place};
use super::trial::{Among, Trial};
use super::{Part, Request};
use base::value::{Batch, Scalar};
use judge::verdict::{Blame, Deviation, Verdict, dependences, judge_at};
use lanes::{Actual, LaneError};
use program::Program;
use property::shrink::Shrunk;
use property::{Sample, Sampler};

/// How often a failing sample is run again.
const RUNS: u64 = Among::ALL.len() as u64;
/// Samples of each run that are run twice, whatever their verdict.
const CHECKED: usize = 256;

/// What came of running the first samples twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Repeated {
    /// Samples that were run twice.
    pub samples: u64,
    /// Samples with other bits the second time.
    pub different: u64,
}

/// A number that two outputs share when their bits are the same. Words that nobody wrote are alike, and so are all
/// NaN: their payloads are nobody's result.
pub(super) fn print(actual: &Actual, invocation: usize) -> u64 {
    let record = &actual.layout().vertex;
    let mut sum = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |word: u32| sum = (sum ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(17);
    add(actual.emitted(invocation));
    add(actual.ended_strips(invocation));
    for vertex in 0..actual.stored(invocation) {
        if actual.layout().max_vertices.is_some() {
            add(actual.strip(invocation, vertex));
        }
        for (k, &word) in actual.vertex(invocation, vertex).iter().enumerate() {
            if actual.is_unwritten(word) {
                add(0x7fc0_0001);
            } else if record.scalar_of(k) == Scalar::F32 && f32::from_bits(word).is_nan() {
                add(0x7fc0_0000);
            } else {
                add(word);
            }
        }
    }
    sum
}

/// What came of running a failing sample again.
pub(super) struct Again {
    /// Runs with other bits than the first.
    other: u64,
    /// True when these runs agree with each other.
    steady: bool,
    /// How the sample deviates in the first run in which it does.
    deviation: Option<Deviation>,
}

impl Again {
    /// True when the same inputs give other outputs: without reason, or only once.
    pub(super) fn is_flaky(&self) -> bool {
        !self.steady || self.deviation.is_none()
    }

    /// True when the shader is wrong, whatever the lane gives.
    pub(super) fn is_shader(&self) -> bool {
        self.deviation.as_ref().is_some_and(|deviation| deviation.blame == Blame::Shader)
    }

    /// The finding about a flaky sample.
    pub(super) fn finding(self, program: &Program, request: &Request, part: &Part, shrunk: &Shrunk) -> Finding {
        Finding {
            kind: FindingKind::Flaky,
            message: format!(
                "flaky: {} of {RUNS} runs of the same inputs gave other bits than the first: the lane is not deterministic",
                self.other
            ),
            case: Some(finding::case(program, shrunk, self.deviation)),
            count: 0,
            reproduce: Some(finding::reproduce(request, part.on(), &shrunk.sample)),
        }
    }
}

/// Runs failing samples again; `first` is what they gave when they failed.
///
/// # Errors
/// [`LaneError`] when the lane fails.
pub(super) fn again(trial: &mut Trial<'_>, samples: &[Sample], first: &[u64]) -> Result<Vec<Again>, LaneError> {
    let context = trial.context();
    let mut runs: Vec<Vec<u64>> = vec![Vec::new(); samples.len()];
    let mut deviations: Vec<Option<Deviation>> = vec![None; samples.len()];
    let reversed: Vec<Sample> = samples.iter().rev().cloned().collect();
    // Each time in other places and beside others: what depends on these is no property of the inputs.
    for (round, among) in Among::ALL.into_iter().enumerate() {
        let back = round % 2 == 1;
        trial.run_among(if back { &reversed } else { samples }, among, |sample, place, batch, actual| {
            let sample = if back { samples.len() - 1 - sample } else { sample };
            runs[sample].push(print(actual, place));
            if let Verdict::Deviate(deviation) = judge_at(&context, batch, actual, place) {
                deviations[sample].get_or_insert(deviation);
            }
        })?;
    }
    let one = |((runs, deviation), first): ((Vec<u64>, Option<Deviation>), &u64)| Again {
        other: runs.iter().filter(|print| *print != first).count() as u64,
        steady: runs.iter().all(|print| *print == runs[0]),
        deviation,
    };
    Ok(runs.into_iter().zip(deviations).zip(first).map(one).collect())
}

/// Runs the first samples of a run twice and compares the bits, whether the samples agree or not.
///
/// # Errors
/// [`LaneError`] when the lane fails.
pub(super) fn check(trial: &mut Trial<'_>, request: &Request, part: &mut Part) -> Result<(), LaneError> {
    let prepared = trial.prepared;
    let few = |samples: &[Sample]| Sample::batch(&samples[..samples.len().min(CHECKED).min(trial.capacity())]);
    let batch: Batch = if request.replay_only && !request.replay.is_empty() {
        few(&request.replay)
    } else if prepared.plan.makes_samples() {
        let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1);
        let per_case = per_case.min(trial.capacity()).min(CHECKED);
        let samples = CHECKED.min(trial.capacity()).min(request.samples_of(&prepared.suite) as usize).max(1);
        Sampler::new(prepared.plan.clone(), request.seed).batch(0, (samples / per_case).max(1), per_case)
    } else if prepared.rows.is_empty() {
        return Ok(());
    } else {
        few(&prepared.rows)
    };
    let count = batch.invocation_count();
    let prints = |trial: &mut Trial<'_>| -> Result<Vec<Option<u64>>, LaneError> {
        let actual = trial.run(&batch)?;
        Ok((0..count).map(|k| (!actual.is_absent(k)).then(|| print(&actual, k))).collect())
    };
    let (one, two) = (prints(trial)?, prints(trial)?);
    let mut other: Vec<usize> =
        (0..count).filter(|&k| one[k].is_some() && two[k].is_some() && one[k] != two[k]).collect();
    if !other.is_empty() {
        // What is undefined may differ from one run to the next.
        let undefined = dependences(&prepared.oracle, &batch);
        other.retain(|&k| undefined[k].is_none());
    }
    part.repeated = Some(Repeated { samples: count as u64, different: other.len() as u64 });
    let Some(&first) = other.first() else { return Ok(()) };
    let sample = Sample::of(&batch, first);
    let place = Place { at: first, count, per_case: batch.per_case };
    if let Some(tied) = position::probe(trial, request, &sample, place)? {
        part.findings.push(finding::tied(request, part, &sample, tied, prepared));
        return Ok(());
    }
    let shrunk = finding::unshrunk(sample);
    part.findings.push(Finding {
        kind: FindingKind::Flaky,
        message: format!(
            "flaky: {} of {count} samples gave other bits when the same batch ran again: the lane is not deterministic",
            other.len()
        ),
        case: Some(finding::case(&prepared.program, &shrunk, None)),
        count: other.len() as u64,
        reproduce: Some(finding::reproduce(request, part.on(), &shrunk.sample)),
    });
    Ok(())
}
