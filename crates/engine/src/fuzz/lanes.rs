//! A function on one lane: verdicts on its outputs, blame, and whether equal inputs give equal outputs.

use super::domain::{Domain, Shrinking, Within};
use super::finding::{Finding, FuzzFindingKind, LaneReport, Part, Severity};
use super::stage;
use super::subject::Ready;
use crate::InputValue;
use crate::activity::{self, shrink};
use crate::elsewhere::{self, Word};
use base::value::{Batch, Scalar};
use judge::profile::Promises;
use judge::verdict::diagnosis::{self, Diagnosis, Suspected};
use judge::verdict::{
    BatchVerdict, Fence, Fenced, JudgeContext, Oracle, Reason, Reference, Verdict, What, judge_batch, judge_each,
};
use lanes::{Actual, Lane, LaneError, LaneName, Runner, Stage, interrupt};
use program::Program;
use property::Sample;

/// Failing samples that are shrunk.
const SHRUNK: usize = 4;

/// What is told of invocations that disturb each other.
const DISTURB: &str =
    "invocations disturb each other: what the same inputs give depends on those beside them, each time alike";

/// A function on a lane.
pub struct OnLane<'a> {
    lane: &'a dyn Lane,
    stage: Stage,
    promises: &'a Promises,
    ready: &'a Ready,
    reference: &'a Reference,
    oracle: &'a Oracle,
    runner: Result<Fence<'a>, String>,
    verdicts: BatchVerdict,
    arbitrary: BatchVerdict,
    failing: Vec<Sample>,
    unstable: Vec<Sample>,
    unstable_count: u64,
    /// The first dispatch in which a sample deviated or differed from its twin, with that sample and what it gave.
    odd: Option<Odd>,
    failed: Option<String>,
}

/// A sample of a dispatch with what it gave there.
struct Odd {
    batch: Batch,
    /// It and its twin, or it alone.
    places: Vec<usize>,
    gave: Vec<Vec<u32>>,
}

/// Dispatches in which a sample has to give the same again.
const AGAIN: usize = 3;
/// Dispatches in which the place is sought whose outputs a sample gets, where it gets those of another.
const ROTATIONS: usize = 12;

impl<'a> OnLane<'a> {
    /// Makes the function ready for batches of `capacity` samples.
    pub fn new(
        (lane, promises): (&'a dyn Lane, &'a Promises),
        ready: &'a Ready,
        (reference, oracle): (&'a Reference, &'a Oracle),
        capacity: usize,
    ) -> Self {
        let stage = stage::stage_of(lane, &ready.program);
        let prepared = match stage {
            Stage::Compute => lane.prepare(&ready.kernel, capacity),
            stage => stage::kernel(&ready.program, stage)
                .map_err(|error| LaneError::Unsupported(error.to_string()))
                .and_then(|kernel| lane.prepare(&kernel, capacity)),
        };
        let (runner, failed) = match prepared {
            Ok(runner) => (Ok(Fence::new(runner, oracle, &ready.kernel.output)), None),
            Err(error @ LaneError::Unsupported(_)) => (Err(error.to_string()), None),
            // A lane that fails before it runs anything fails all the same.
            Err(error) => (Err(error.to_string()), Some(error.to_string())),
        };
        Self {
            lane,
            stage,
            promises,
            ready,
            reference,
            oracle,
            runner,
            verdicts: BatchVerdict::default(),
            arbitrary: BatchVerdict::default(),
            failing: Vec::new(),
            unstable: Vec::new(),
            unstable_count: 0,
            odd: None,
            failed,
        }
    }

    fn context(&self) -> JudgeContext<'a> {
        JudgeContext { oracle: self.oracle, reference: self.reference, promises: self.promises, stage: self.stage }
    }

    fn dispatch(&mut self, batch: &Batch) -> Option<Actual> {
        let runner = self.runner.as_mut().ok()?;
        match runner.run(batch) {
            Ok(actual) => Some(actual),
            // A device that is given up because the run ends has not failed.
            Err(_) if interrupt::asked() => None,
            Err(error) => {
                self.failed.get_or_insert(error.to_string());
                None
            }
        }
    }

    /// The failure of the lane at a sample whose behaviour is undefined, if there was one.
    pub fn fenced(&self) -> Option<(LaneName, Fenced)> {
        let fenced = self.runner.as_ref().ok()?.found()?;
        Some((self.lane.description().name, fenced.clone()))
    }

    /// Counts samples whose loops go on for too long: nothing is known of them.
    pub fn leave_out(&mut self, count: u64, part: Part) {
        if self.runner.is_ok() {
            self.of(part).leave_open(Reason::LongLoop, count);
        }
    }

    /// Runs samples at edges: those that deviate count, and no others.
    pub fn run_edges(&mut self, batch: &Batch, part: Part) {
        let before = self.of(part).clone();
        self.run(batch, &[], part);
        let verdicts = self.of(part);
        let BatchVerdict { deviated, shader_deviated, .. } = *verdicts;
        *verdicts = BatchVerdict { deviated, shader_deviated, ..before };
    }

    fn of(&mut self, part: Part) -> &mut BatchVerdict {
        match part {
            Part::Realistic => &mut self.verdicts,
            Part::Arbitrary => &mut self.arbitrary,
        }
    }

    /// Runs a batch of one part of the run. Each pair of samples in `twins` has the same inputs.
    pub fn run(&mut self, batch: &Batch, twins: &[(usize, usize)], in_part: Part) {
        let Ok(runner) = &self.runner else { return };
        if self.failed.is_some() {
            return;
        }
        let (count, capacity) = (batch.invocation_count(), runner.capacity().max(1));
        let mut outputs: Vec<Vec<u32>> = vec![Vec::new(); if twins.is_empty() { 0 } else { count }];
        for first in (0..count).step_by(capacity) {
            let part = part_of(batch, first, capacity.min(count - first));
            let part = part.as_ref().unwrap_or(batch);
            let Some(actual) = self.dispatch(part) else { return };
            let verdict = judge_batch(&self.context(), part, &actual);
            if let (Some(failure), None) = (verdict.failures.first(), &self.odd) {
                let places = vec![failure.invocation];
                self.odd = Some(Odd { batch: part.clone(), gave: vec![words_of(&actual, places[0])], places });
            }
            let room = 16_usize.saturating_sub(self.failing.len());
            self.failing.extend(verdict.failures.iter().take(room).map(|f| Sample::of(part, f.invocation)));
            self.of(in_part).merge(verdict);
            for &(a, b) in twins {
                for k in [a, b].into_iter().filter(|k| (first..first + capacity).contains(k)) {
                    outputs[k] = words_of(&actual, k - first);
                }
            }
        }
        for &(a, b) in twins {
            if outputs[a] != outputs[b] {
                self.unstable_count += 1;
                if self.unstable.is_empty() {
                    self.unstable.push(Sample::of(batch, a));
                    let first = a / capacity * capacity;
                    if b / capacity * capacity == first && self.odd.is_none() {
                        let part = part_of(batch, first, capacity.min(count - first)).unwrap_or_else(|| batch.clone());
                        let gave = vec![outputs[a].clone(), outputs[b].clone()];
                        self.odd = Some(Odd { batch: part, places: vec![a - first, b - first], gave });
                    }
                }
            }
        }
    }

    /// Whether the lane takes the function, or fails on it before it runs.
    pub fn runs(&self) -> bool {
        self.runner.is_ok() || self.failed.is_some()
    }

    /// What the lane gave, and what is wrong with it. `reproduce` makes the command for a sample.
    pub fn finish(mut self, domain: &Domain, reproduce: &dyn Fn(&Sample) -> String) -> (LaneReport, Vec<Finding>) {
        let name = self.lane.description().name;
        let part =
            if self.verdicts.deviated == 0 && self.arbitrary.deviated > 0 { Part::Arbitrary } else { Part::Realistic };
        let disturbed = self.disturbed();
        let mut findings = Vec::new();
        let blank = |kind, message| Finding {
            kind,
            severity: Severity::Finding,
            part,
            cause: None,
            message,
            place: None,
            lane: Some(name),
            count: 0,
            counting: 0,
            inputs: Vec::new(),
            output: None,
            meaning: None,
            found: None,
            scalar: Scalar::F32,
            condition: None,
            worst: None,
            also: Vec::new(),
            diagnosis: None,
            reproduce: None,
            own_translator: false,
            better: None,
        };
        if let Some(sample) = self.unstable.first() {
            findings.push(Finding {
                count: self.unstable_count,
                inputs: InputValue::all(sample, &self.ready.program),
                reproduce: Some(reproduce(sample)),
                ..match disturbed {
                    true => blank(FuzzFindingKind::Disturbed, DISTURB.to_owned()),
                    false => blank(
                        FuzzFindingKind::NotDeterministic,
                        "the same inputs give different outputs in one dispatch".to_owned(),
                    ),
                }
            });
        }
        if !self.failing.is_empty() {
            match self.deviations(domain, reproduce, &blank, disturbed) {
                Ok(found) => findings.extend(found),
                Err(_) if interrupt::asked() => {
                    let message = "samples deviate; the run was interrupted before they were looked into".to_owned();
                    findings.push(Finding {
                        count: self.verdicts.deviated + self.arbitrary.deviated,
                        ..blank(FuzzFindingKind::LaneDeviation, message)
                    });
                }
                Err(error) => {
                    self.failed.get_or_insert(error.to_string());
                }
            }
        }
        if let Some(error) = &self.failed {
            findings.push(blank(FuzzFindingKind::LaneFailed, error.clone()));
        }
        let not_run = self.runner.err();
        (LaneReport { lane: name, verdicts: self.verdicts, arbitrary: self.arbitrary, not_run }, findings)
    }

    /// Whether what was odd comes of the samples beside it: the same dispatch gives the same again, each time, and in one that
    /// holds nothing but the sample it gives something else.
    fn disturbed(&mut self) -> bool {
        let Some(Odd { batch, places, gave }) = self.odd.take().filter(|_| !interrupt::asked()) else { return false };
        let Ok(runner) = &mut self.runner else { return false };
        let sample = Sample::of(&batch, places[0]);
        let alone = Sample::batch(&vec![sample; batch.invocation_count()]);
        let mut run = |batch: &Batch| {
            let actual = runner.run(batch).ok()?;
            Some(places.iter().map(|&k| words_of(&actual, k)).collect::<Vec<_>>())
        };
        let mut odd = None;
        for _ in 0..AGAIN {
            let Some(right) = run(&alone) else { return false };
            if run(&batch).as_ref() != Some(&gave) {
                return false;
            }
            odd = (0..places.len()).find_map(|k| {
                let differs = right[k].iter().zip(&gave[k]).position(|(a, b)| a != b)?;
                Some((places[k], differs))
            });
        }
        // The words of the first vertex stand behind the number of vertices and its strip.
        let words = self.ready.kernel.output.vertex.words();
        odd.is_some_and(|(at, differs)| {
            differs.checked_sub(HEADER).is_some_and(|word| word < words && !self.is_swapped(&batch, at, word))
        })
    }

    /// True where a sample that gives something else beside others gives what is meant in another place of the dispatch, the
    /// same one whatever stands there: memory is addressed wrongly.
    fn is_swapped(&mut self, batch: &Batch, at: usize, word: usize) -> bool {
        let Ok(runner) = &mut self.runner else { return false };
        let scalar = self.ready.kernel.output.vertex.scalar_of(word);
        let count = batch.invocation_count();
        let mut from: Vec<usize> = (0..count).filter(|&k| k != at).collect();
        for shift in 0..ROTATIONS {
            // The others in turn, with the sample in its place.
            let order = (0..count).map(|k| if k == at { at } else { (k + shift) % count });
            let turned = batch.apart(order);
            let Ok(actual) = runner.run(&turned) else { return false };
            if actual.stored(at) == 0 {
                return true;
            }
            let found = actual.vertex(at, 0)[word];
            from =
                elsewhere::that_mean(&self.ready.executable, &turned, Word { vertex: 0, word, scalar }, found, &from);
        }
        !from.is_empty()
    }

    /// Shrinks the failing samples together, and tells each kind of deviation once.
    fn deviations(
        &mut self,
        domain: &Domain,
        reproduce: &dyn Fn(&Sample) -> String,
        blank: &dyn Fn(FuzzFindingKind, String) -> Finding,
        disturbed: bool,
    ) -> Result<Vec<Finding>, LaneError> {
        let context = self.context();
        let Ok(runner) = &mut self.runner else { return Ok(Vec::new()) };
        let first: Vec<Sample> = self.failing.iter().take(SHRUNK).cloned().collect();
        let mut deviates = |samples: &[Sample]| -> Result<Vec<bool>, LaneError> {
            if interrupt::asked() {
                return Err(LaneError::Unsupported("the run was interrupted".to_owned()));
            }
            let mut all = Vec::with_capacity(samples.len());
            for chunk in samples.chunks(runner.capacity().max(1)) {
                let batch = Sample::batch(chunk);
                let actual = runner.run(&batch)?;
                let verdicts = judge_each(&context, &batch, &actual);
                all.extend(verdicts.iter().map(|v| matches!(v, Verdict::Deviate(_))));
            }
            Ok(all)
        };
        let _doing = activity::doing(format!("looks into deviations on {}", self.lane.description().name));
        let shrunk = shrink(first, &Shrinking { domain, within: Within::Laws }, &mut deviates)?;
        let samples: Vec<Sample> = shrunk.into_iter().map(|s| s.sample).collect();
        let mut findings: Vec<Finding> = Vec::new();
        let mut reported: Vec<(String, Sample)> = Vec::new();
        for sample in samples {
            let batch = Sample::batch(std::slice::from_ref(&sample));
            let actual = runner.run(&batch)?;
            let Some(Verdict::Deviate(deviation)) = judge_each(&context, &batch, &actual).pop() else {
                // Message once, as a lane that gives different outputs for the same inputs is.
                let kind = if disturbed { FuzzFindingKind::Disturbed } else { FuzzFindingKind::NotDeterministic };
                if let Some(reported) = findings.iter_mut().find(|reported| reported.kind == kind) {
                    reported.count += 1;
                    continue;
                }
                if !self.unstable.is_empty() {
                    continue;
                }
                let message = match disturbed {
                    true => DISTURB.to_owned(),
                    false => "a sample deviated, and agreed when it was run again".to_owned(),
                };
                findings.push(Finding {
                    count: 1,
                    inputs: InputValue::all(&sample, &self.ready.program),
                    reproduce: Some(reproduce(&sample)),
                    ..blank(kind, message)
                });
                continue;
            };
            let output = match &deviation.what {
                What::Value(value) => value.component.clone(),
                What::NotWritten { component, .. } => component.clone(),
                What::VertexCount { .. } | What::Strip { .. } | What::TooManyVertices { .. } | What::Endless => {
                    "vertices".to_owned()
                }
            };
            if reported.iter().any(|(o, s)| *o == output || *s == sample) {
                continue;
            }
            let stage = self.stage;
            let kernel = |program: &Program| stage::kernel(program, stage);
            let suspected = Suspected { lane: self.lane, stage, kernel: &kernel, batch: &batch, deviation: &deviation };
            let diagnosis =
                diagnosis::lane(&context, &self.ready.program, &suspected).unwrap_or_else(|_| Diagnosis::default());
            let own = stage::is_of_own_translator(self.lane, &self.ready.program, &batch, &diagnosis);
            findings.push(Finding {
                own_translator: own,
                count: self.verdicts.deviated + self.arbitrary.deviated,
                inputs: InputValue::all(&sample, &self.ready.program),
                output: Some(output.clone()),
                meaning: deviation.value().map(|v| v.meaning),
                found: deviation.value().map(|v| v.actual),
                scalar: deviation.value().map_or(Scalar::F32, |v| v.scalar),
                diagnosis: Some(diagnosis),
                reproduce: Some(reproduce(&sample)),
                ..blank(FuzzFindingKind::LaneDeviation, deviation.to_string())
            });
            reported.push((output, sample));
        }
        Ok(findings)
    }
}

/// A part of a batch; `None` for all of it.
fn part_of(batch: &Batch, first: usize, count: usize) -> Option<Batch> {
    if first == 0 && count == batch.invocation_count() {
        return None;
    }
    let (invocation, case) = (batch.invocation_record.clone(), batch.case_record.clone());
    let mut part = Batch::with_capacity(invocation, case, 1, count);
    for k in first..first + count {
        part.invocations.extend_from_slice(batch.invocation(k));
        part.cases.extend_from_slice(batch.case_of(k));
    }
    Some(part)
}

/// Words of [`words_of`] in front of the first vertex.
const HEADER: usize = 2;

/// Everything that an invocation wrote; any NaN is as good as any other.
fn words_of(actual: &Actual, invocation: usize) -> Vec<u32> {
    let record = &actual.layout().vertex;
    let mut words = vec![actual.emitted(invocation)];
    for vertex in 0..actual.stored(invocation) {
        words.push(actual.strip(invocation, vertex));
        for (word, &bits) in actual.vertex(invocation, vertex).iter().enumerate() {
            let nan = record.scalar_of(word) == Scalar::F32 && f32::from_bits(bits).is_nan();
            words.push(if nan { f32::NAN.to_bits() } else { bits });
        }
    }
    words
}
