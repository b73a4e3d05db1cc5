//! Whether the judge is sound: a device that keeps its promise, however badly it behaves within it, must
//! never be accused.
//!
//! Suites run on lanes that err as far as a profile allows, each by a strategy of its own, and are judged
//! by the text of that profile alone: no conformance suite and no measurement hides a wrong accusation.

use std::sync::Arc;

use rayon::prelude::*;

use crate::adversary::{Adversary, Fault, Strategy};
use base::text::{Assembly, SourceFile, Span};
use judge::profile::{Flush, Profile, Promises, by_name};
use judge::verdict::{Deviation, JudgeContext, Oracle, Reason, Used, judge_batch, used};
use lanes::{LaneError, Stage};
use program::interp::SLOTS;
use program::{Manners, ProgramError};
use property::{Sample, Sampler, mix};
use syntax::Shader;
use syntax::precision::Precisions;

use super::trial::Trial;
use super::{Prepared, RunError};
use crate::suite::Suite;

/// Most samples of one suite on one lane: the next ones are judged on lanes with other seeds, which
/// rearrange in another way.
const SHARE: u64 = 1024;

/// Violations that are kept.
const KEPT: usize = 32;

/// What a run is asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// Samples in total, spread evenly over suites and lanes; at least one for each.
    pub samples: u64,
    /// Seed of the inputs and of the lanes.
    pub seed: u64,
    /// Profiles that lanes keep.
    pub profiles: Vec<&'static Profile>,
    /// Strategies of the lanes.
    pub strategies: Vec<Strategy>,
    /// A fault in every lane.
    pub fault: Option<Fault>,
    /// Lanes do what is `mediump` as badly as GLSL ES and Vulkan allow, and are judged by that: suites as of [`halved`].
    pub lowered: bool,
}

impl Request {
    /// All strategies, by Vulkan, its conformance suite, WGSL and strict binary32.
    pub fn new(samples: u64, seed: u64) -> Self {
        let profiles = ["vulkan-1.4", "vulkan-cts", "wgsl", "binary32"].into_iter().filter_map(by_name).collect();
        Self { samples, seed, profiles, strategies: Strategy::ALL.to_vec(), fault: None, lowered: false }
    }
}

/// A suite whose shader has `mediump` numbers wherever it states no precision.
///
/// # Errors
/// As of [`prepare`](super::prepare).
pub fn halved(suite: &Suite, shader: &SourceFile) -> Result<Prepared, RunError> {
    let mut text = Assembly::new();
    let start = shader.text().find("#version").and_then(|at| Some(at + shader.text()[at..].find('\n')? + 1));
    text.copy(shader, Span::new(0, start.unwrap_or(0)));
    text.insert("precision mediump float;\n", shader, start.unwrap_or(0));
    text.copy(shader, Span::new(start.unwrap_or(0), shader.text().len()));
    let file = text.finish(shader.name());
    let mut prepared = super::prepare(suite, &file)?;
    let parsed = Shader::parse(&prepared.program.file, suite.stage.of_text().unwrap_or(syntax::Stage::Library));
    let manners = Manners::by(&parsed.shader, &Precisions::stated(&parsed.shader));
    prepared.program.manners = Arc::new(manners);
    let wrong = |source| RunError::Program { suite: suite.name.clone(), source };
    prepared.compute = prepared.program.compute_kernel().map_err(wrong)?;
    let oracle = Oracle::lowered(&prepared.program);
    prepared.lowered =
        Some(oracle.map_err(|error| wrong(ProgramError::Unsupported { what: error.locate(&prepared.program) }))?);
    Ok(prepared)
}

/// How a lane behaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Behaviour {
    /// What it keeps, and is judged by.
    pub profile: &'static Profile,
    /// By which stage's rules it flushes subnormal numbers. In the vertex stage it flushes whatever it
    /// may, in the compute stage some.
    pub stage: Stage,
    /// Which error it takes where the profile leaves it a choice.
    pub strategy: Strategy,
    /// Whether it regroups sums and products.
    pub rearranges: bool,
    /// Whether it does what is `mediump` in less than binary32.
    pub lowers: bool,
}

impl Behaviour {
    /// All that differ, by some profiles and strategies.
    pub fn all(profiles: &[&'static Profile], strategies: &[Strategy]) -> Vec<Self> {
        let mut all = Vec::new();
        for &profile in profiles {
            for stage in [Stage::Compute, Stage::Vertex] {
                if stage == Stage::Vertex && (profile.compute, profile.vertex) == (Flush::Never, Flush::Never) {
                    continue;
                }
                for &strategy in strategies {
                    all.push(Self { profile, stage, strategy, rearranges: false, lowers: false });
                    if profile.rearrangement {
                        all.push(Self { profile, stage, strategy, rearranges: true, lowers: false });
                    }
                }
            }
        }
        all
    }

    /// What the lane is by, where the profile leaves it a choice that the strategy does not make.
    fn device(&self) -> Profile {
        let mut profile = self.profile.clone();
        if self.stage == Stage::Vertex && profile.vertex == Flush::May {
            profile.vertex = Flush::Must;
        }
        profile
    }
}

/// A wrong accusation.
#[derive(Clone, Debug)]
pub struct Violation {
    /// Name of the suite.
    pub suite: String,
    /// The simulated device that was accused.
    pub behaviour: Behaviour,
    /// Seed of the lane.
    pub seed: u64,
    /// The component; empty where it is no value that is wrong.
    pub component: String,
    /// The error over its bound; infinite for what is no number.
    pub ratio: f64,
    /// What the judge said.
    pub deviation: Deviation,
    /// The inputs.
    pub sample: Sample,
}

/// What came of one behaviour on one suite.
#[derive(Clone, Debug)]
pub struct Row {
    /// Index of the suite among those that ran.
    pub suite: usize,
    /// How the lane behaved.
    pub behaviour: Behaviour,
    /// Samples with a verdict, violations included.
    pub judged: u64,
    /// Samples that are inconclusive, in the order of [`Reason::ALL`].
    pub undetermined: [u64; Reason::ALL.len()],
    /// Samples that the judge holds against the lane or the shader.
    pub violations: u64,
    /// The largest error over its bound, among a part of the samples.
    pub used: Option<Used>,
}

impl Row {
    fn merge(&mut self, later: Self) {
        let Self { suite: _, behaviour: _, judged, undetermined, violations, used } = later;
        self.judged += judged;
        self.undetermined.iter_mut().zip(undetermined).for_each(|(sum, n)| *sum += n);
        self.violations += violations;
        if let Some(used) = used
            && self.used.as_ref().is_none_or(|most| used.part > most.part)
        {
            self.used = Some(used);
        }
    }
}

/// What came of all of them.
#[derive(Clone, Debug, Default)]
pub struct Soundness {
    /// One row for each suite and behaviour, those of one suite together.
    pub rows: Vec<Row>,
    /// The first few violations.
    pub violations: Vec<Violation>,
}

impl Soundness {
    /// Samples with a verdict.
    pub fn judged(&self) -> u64 {
        self.rows.iter().map(|row| row.judged).sum()
    }

    /// Samples that are inconclusive.
    pub fn undetermined(&self) -> u64 {
        self.rows.iter().flat_map(|row| row.undetermined).sum()
    }

    /// Samples that are held against a lane or a shader.
    pub fn violations(&self) -> u64 {
        self.rows.iter().map(|row| row.violations).sum()
    }
}

/// Runs suites on lanes of all behaviours that a request names, and judges them. `progress` is told now
/// and then how many samples are done.
///
/// # Errors
/// [`LaneError`] when a lane refuses a shader or fails.
pub fn check(suites: &[Prepared], request: &Request, progress: &mut dyn FnMut(u64)) -> Result<Soundness, LaneError> {
    let behaviours: Vec<Behaviour> = Behaviour::all(&request.profiles, &request.strategies)
        .into_iter()
        .map(|behaviour| Behaviour { lowers: request.lowered, ..behaviour })
        .collect();
    let jobs: Vec<(usize, Behaviour)> =
        (0..suites.len()).flat_map(|suite| behaviours.iter().map(move |&behaviour| (suite, behaviour))).collect();
    let mut soundness = Soundness::default();
    let Some(count) = Some(jobs.len() as u64).filter(|&count| count > 0) else { return Ok(soundness) };
    let rounds = request.samples.div_ceil(count * SHARE).max(1);
    let share = request.samples.div_ceil(count * rounds).max(1);
    let mut done = 0;
    for round in 0..rounds {
        // Neighbouring jobs are of one suite, and suites differ in what they cost.
        let found: Result<Vec<_>, LaneError> = jobs
            .par_iter()
            .enumerate()
            .with_max_len(1)
            .map(|(job, &(suite, behaviour))| {
                let seed = mix(mix(request.seed, round), job as u64);
                run(&suites[suite], suite, behaviour, seed, share, request.fault)
            })
            .collect();
        for (job, (row, violations)) in found?.into_iter().enumerate() {
            done += row.judged + row.undetermined.iter().sum::<u64>();
            let room = KEPT.saturating_sub(soundness.violations.len());
            soundness.violations.extend(violations.into_iter().take(room));
            match soundness.rows.get_mut(job) {
                Some(sum) => sum.merge(row),
                None => soundness.rows.push(row),
            }
        }
        progress(done);
    }
    Ok(soundness)
}

/// One suite on one lane.
fn run(
    prepared: &Prepared,
    suite: usize,
    behaviour: Behaviour,
    seed: u64,
    samples: u64,
    fault: Option<Fault>,
) -> Result<(Row, Vec<Violation>), LaneError> {
    let Behaviour { profile, stage, strategy, rearranges, lowers } = behaviour;
    let mut lane = Adversary::lane(&behaviour.device(), stage, strategy, seed, rearranges);
    if lowers {
        lane = lane.lowering();
    }
    if let Some(fault) = fault {
        lane = lane.with_fault(fault);
    }
    let promises = Promises { text: profile, conformance: None, measured: None };
    let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1);
    let cases = samples.div_ceil(per_case as u64) as usize;
    let batch = Sampler::new(Arc::clone(&prepared.plan), seed).batch(0, cases, per_case);
    let count = batch.invocation_count();
    let mut trial = Trial::with_capacity(prepared, &lane, &prepared.compute, &promises, count)?;
    let actual = trial.run(&batch)?;
    // The lane runs the compute form whatever the stage is whose rules it follows.
    let own = trial.context();
    let oracle = prepared.lowered.as_ref().filter(|_| lowers).unwrap_or(own.oracle);
    let context = JudgeContext { stage, oracle, ..own };
    let verdict = judge_batch(&context, &batch, &actual);
    let violations = verdict.failures.iter().map(|failure| {
        let deviation = failure.deviation.clone();
        let value = deviation.value();
        let ratio = value.map_or(f64::INFINITY, |value| {
            let off = (f64::from(f32::from_bits(value.actual)) - value.meaning).abs() / value.bound;
            if off.is_nan() { f64::INFINITY } else { off }
        });
        Violation {
            suite: prepared.suite.name.clone(),
            behaviour,
            seed,
            component: value.map_or_else(String::new, |value| value.component.clone()),
            ratio,
            sample: Sample::of(&batch, failure.invocation),
            deviation,
        }
    });
    let row = Row {
        suite,
        behaviour,
        judged: verdict.agreed + verdict.deviated,
        undetermined: verdict.undetermined,
        violations: verdict.deviated,
        used: used(&context, rearranges, &batch, &actual, 0..count.min(SLOTS)),
    };
    Ok((row, violations.collect()))
}
