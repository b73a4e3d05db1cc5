//! Mutants through their suite: prepared like the shader itself, and held against the same formula on
//! the same inputs. What a mutant means is a matter of the shader and of no lane, so the interpreter
//! decides; only the relations between outputs are looked at on the lane.

use std::collections::BTreeSet;

use rayon::prelude::*;
use similar::TextDiff;

use super::operators::Operator;
use super::outcome::{Kill, Outcome, SuiteResult, Tested};
use super::{Mutant, MutateError, mutants};
use crate::shard::Shard;
use crate::suite::run::{Prepared, Probes, RunError, Trial, coverage, edges_of, prepare};
use crate::suite::{Stage, Suite};
use base::diagnostic::Severity;
use base::text::SourceFile;
use base::value::Batch;
use judge::profile::Promises;
use judge::verdict::{Failure, JudgeContext, Literals, Movement, What, judge_batch, movement, shader_deviation};
use lanes::{Lane, LaneError, Stage as LaneStage, interrupt};
use program::{Entry, Kernel, OutputLayout, Role, Written};
use property::{Sample, Sampler};
use syntax::interface::Storage;
use syntax::symbols::SymbolKind;
use syntax::{self, Shader};

/// Loop iterations of one invocation: far more than a shader of a suite needs, few enough that a
/// mutant which never ends costs a fraction of a second on a small batch. It must be less than 65535,
/// after which llvmpipe leaves a loop by itself, and goes on as if it had ended.
const FUEL: u32 = 1 << 14;
/// Invocations of the batches: most mutants die in a small one, and those that do not should not
/// pay for the overhead of many.
const STEPS: [usize; 3] = [256, 4096, 1 << 14];
/// Mutants that are prepared together, on all cores.
const CHUNK: usize = 16;

/// What a run is asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// Samples of a mutant that nothing kills; rounded up to whole cases.
    pub samples: u64,
    /// Seed of the inputs.
    pub seed: u64,
    /// Operators that make the mutants.
    pub operators: Vec<&'static Operator>,
    /// Which mutants are run: mutant `k` of a suite belongs to shard `k mod N`.
    pub shard: Shard,
}

/// A batch of inputs.
struct MutantStep {
    batch: Batch,
    /// Samples of the batches before.
    before: u64,
}

/// What every mutant of a suite is put to.
struct MutantRun<'a> {
    steps: Vec<MutantStep>,
    probes: Probes,
    seed: u64,
    /// Samples of a mutant that nothing kills.
    samples: u64,
    context: JudgeContext<'a>,
    layout: &'a OutputLayout,
    promises: &'a Promises,
}

/// Makes the mutants of a suite's shader and runs each on the compute stage of `lane`. `progress`
/// is told how many are done, and of how many.
///
/// # Errors
/// [`MutateError`] when the original does not pass, or cannot be run; nothing can be said then.
pub fn run(
    suite: &Suite,
    shader: &SourceFile,
    lane: &dyn Lane,
    request: &Request,
    progress: &mut dyn FnMut(usize, usize),
) -> Result<SuiteResult, MutateError> {
    let name = || suite.name.clone();
    let prepared = prepare(suite, shader)?;
    if prepared.program.is_large() {
        return Err(MutateError::Large { suite: name() });
    }
    let kernel = fuelled(&prepared)?;
    let lane_error = |source| MutateError::Lane { suite: name(), source };
    let promises = Promises::of_lane(lane.description());
    let mut trial = Trial::with_capacity(&prepared, lane, &kernel, &promises, STEPS[2]).map_err(lane_error)?;
    let probes = Probes::new(&prepared, request.seed);
    let steps = original(&mut trial, &probes, request)?;
    let (context, layout) = (trial.context(), &kernel.output);
    drop(trial);
    let shared =
        MutantRun { steps, probes, seed: request.seed, samples: request.samples, context, layout, promises: &promises };

    // A mutant of π that happens to be π in fewer digits is a mutant.
    let literals = prepared.oracle.rounded_constants().iter().map(|literal| literal.written).collect();
    let suite = &Suite { literals: Literals::Only(literals), ..suite.clone() };
    let stage = match suite.stage {
        Stage::Vertex => syntax::Stage::Vertex,
        Stage::Geometry => syntax::Stage::Geometry,
        Stage::Fragment => syntax::Stage::Fragment,
        Stage::Compute => syntax::Stage::Compute,
        Stage::Function => syntax::Stage::from_path(shader.name()).unwrap_or(syntax::Stage::Library),
    };
    let parsed = parsed(shader, stage, suite).shader;
    let written = written(&parsed);
    let mutants = mutants(&parsed, &entry_of(&prepared), &request.operators);
    let (index, count) = (request.shard.index() as usize, request.shard.count() as usize);
    let mutants: Vec<Mutant> = mutants.into_iter().skip(index).step_by(count).collect();
    let mut tested = Vec::with_capacity(mutants.len());
    progress(0, mutants.len());
    for chunk in mutants.chunks(CHUNK) {
        if interrupt::asked() {
            break;
        }
        let ready: Vec<Result<(Prepared, Kernel), Outcome>> =
            chunk.par_iter().map(|m| ready(suite, m, stage, &written)).collect();
        for (mutant, ready) in chunk.iter().zip(ready) {
            let (outcome, samples) = match ready {
                Ok((mutated, kernel)) if same_interface(&kernel, &prepared.compute) => {
                    match outcome(&mutated, &kernel, lane, &shared, mutant.identity) {
                        // A device that is given up because the run ends has not failed.
                        Err(_) if interrupt::asked() => break,
                        outcome => outcome.map_err(lane_error)?,
                    }
                }
                Ok(_) => (Outcome::Invalid("the interface of the shader changes".to_owned()), 0),
                Err(outcome) => (outcome, 0),
            };
            let at = shader.position(mutant.span.start);
            tested.push(Tested {
                operator: mutant.operator,
                what: mutant.what.clone(),
                line: at.line,
                column: at.column,
                diff: diff(shader, &mutant.shader),
                outcome,
                samples,
            });
            progress(tested.len(), mutants.len());
        }
    }
    let samples = shared.steps.iter().map(|s| s.batch.invocation_count() as u64).sum();
    Ok(SuiteResult { suite: name(), shader: shader.name().to_owned(), samples, tested })
}

/// The syntax tree of a text.
fn parsed(file: &SourceFile, stage: syntax::Stage, suite: &Suite) -> syntax::Parsed {
    match Written::of(file) {
        Written::Wgsl => Shader::parse_wgsl(file),
        Written::Glsl | Written::SpirV | Written::SpirVAssembly | Written::Hlsl | Written::Slang => {
            Shader::parse_with(file, stage, &suite.chosen)
        }
    }
}

/// The function of the text at which a program starts.
fn entry_of(prepared: &Prepared) -> String {
    let program = &prepared.program;
    match (&program.role, program.entry) {
        (Role::Function { name }, _) => name.clone(),
        (_, Entry::Point(index)) => program.module.entry_points[index].name.clone(),
        (_, Entry::Function(_)) => "main".to_owned(),
    }
}

/// A mutant made ready, or what became of it.
fn ready(
    suite: &Suite,
    mutant: &Mutant,
    stage: syntax::Stage,
    outputs: &BTreeSet<String>,
) -> Result<(Prepared, Kernel), Outcome> {
    let invalid = |error: &dyn std::fmt::Display| Outcome::Invalid(error.to_string());
    match prepare(suite, &mutant.shader) {
        Ok(prepared) => {
            let kernel = fuelled(&prepared).map_err(|e| invalid(&e))?;
            Ok((prepared, kernel))
        }
        Err(error) => {
            // GLSL may leave an output without a value. A suite cannot run such a shader, and says so.
            let parsed = parsed(&mutant.shader, stage, suite);
            let missing = outputs.difference(&written(&parsed.shader)).next().cloned();
            let broken = parsed.diagnostics.iter().any(|d| d.severity == Severity::Error);
            Err(match (missing, error) {
                (Some(name), _) if !broken => Outcome::Killed(Kill::MissingOutput(name)),
                (_, RunError::Shader { diagnostics, .. }) if !diagnostics.is_empty() => {
                    invalid(&diagnostics[0].message)
                }
                (_, error) => invalid(&error),
            })
        }
    }
}

/// Names of the outputs that a shader writes.
fn written(shader: &Shader) -> BTreeSet<String> {
    let output = |kind| matches!(kind, SymbolKind::Builtin | SymbolKind::Global(Storage::Out));
    let symbols = shader.symbols().filter(|(id, s)| output(s.kind) && shader.is_written(*id));
    symbols.map(|(_, s)| s.name.clone()).collect()
}

fn fuelled(prepared: &Prepared) -> Result<Kernel, MutateError> {
    let suite = || prepared.suite.name.clone();
    prepared.compute.clone().with_fuel(FUEL).map_err(|source| MutateError::Program { suite: suite(), source })
}

/// Batches and expected values are shared by all mutants, so all must read and write the same words.
fn same_interface(a: &Kernel, b: &Kernel) -> bool {
    a.invocation == b.invocation
        && a.case == b.case
        && a.output.vertex == b.output.vertex
        && a.output.max_vertices == b.output.max_vertices
}

/// Runs the original, which has to pass everything that mutants are put to.
fn original(trial: &mut Trial<'_>, probes: &Probes, request: &Request) -> Result<Vec<MutantStep>, MutateError> {
    let prepared = trial.prepared;
    let suite = || prepared.suite.name.clone();
    let fails = |why: String| MutateError::Original { suite: suite(), why };
    let lane = |source: LaneError| match source {
        LaneError::NotWritten { .. } if prepared.compute.has_loops() => {
            fails(format!("an invocation takes more than {FUEL} iterations of its loops"))
        }
        source => MutateError::Lane { suite: suite(), source },
    };
    let per_case =
        prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).clamp(1, trial.capacity());
    let sampler = Sampler::new(prepared.plan.clone(), request.seed);
    let cases = request.samples.div_ceil(per_case as u64).max(1);
    let (mut first, mut judged, mut steps) = (0, 0, Vec::new());
    // What was judged until the run is interrupted is enough to begin with; no mutant follows.
    while first < cases && !(judged > 0 && interrupt::asked()) {
        let size = STEPS[steps.len().min(STEPS.len() - 1)].min(trial.capacity());
        let count = ((size / per_case).max(1) as u64).min(cases - first);
        let batch = sampler.batch(first, count as usize, per_case);
        let actual = trial.run(&batch).map_err(lane)?;
        let verdicts = judge_batch(&trial.context(), &batch, &actual);
        if let Some(failure) = verdicts.failures.first() {
            return Err(fails(failure.deviation.to_string()));
        }
        judged += verdicts.agreed;
        steps.push(MutantStep { batch, before: first * per_case as u64 });
        first += count;
    }
    if judged == 0 {
        return Err(MutateError::Vacuous { suite: suite(), samples: cases * per_case as u64 });
    }
    if let Some(failure) = at_edges(prepared, &trial.context(), &prepared.compute.output, request.seed, request.samples)
    {
        return Err(fails(failure.deviation.to_string()));
    }
    if let Some(relation) = probes.first_broken(&trial.context()) {
        return Err(fails(format!("the relation `{relation}` does not hold")));
    }
    if !covers(trial, request.seed).map_err(lane)? {
        return Err(fails("segments of strands are not drawn".to_owned()));
    }
    Ok(steps)
}

fn covers(trial: &mut Trial<'_>, seed: u64) -> Result<bool, LaneError> {
    match trial.prepared.suite.strands {
        Some(strands) => Ok(coverage(trial, strands, seed)?.is_complete()),
        None => Ok(true),
    }
}

/// Puts a mutant to the test until something notices it; with the samples that this took.
fn outcome(
    prepared: &Prepared,
    kernel: &Kernel,
    lane: &dyn Lane,
    shared: &MutantRun<'_>,
    identity: Option<&'static str>,
) -> Result<(Outcome, u64), LaneError> {
    let oracle = prepared.oracle.clone().with_fuel(FUEL);
    let (reference, stage) = (&prepared.reference, LaneStage::Compute);
    let context = JudgeContext { oracle: &oracle, reference, promises: shared.promises, stage };
    let (mut moved, mut samples) = (Movement::default(), 0);
    for MutantStep { batch, before } in &shared.steps {
        if interrupt::asked() {
            return Err(LaneError::Unsupported("the run was interrupted".to_owned()));
        }
        samples = before + batch.invocation_count() as u64;
        if let Some(failure) = shader_deviation(&context, shared.layout, batch) {
            let at = failure.invocation as u64 + 1;
            return Ok((Outcome::Killed(kill(&failure)), before + at));
        }
        moved.merge(movement(&shared.context, &context, shared.layout, batch));
    }
    // A fault may bring an edge of its own, which only the mutant shows.
    if let Some(failure) = at_edges(prepared, &context, shared.layout, shared.seed, shared.samples) {
        let at = failure.invocation as u64 + 1;
        return Ok((Outcome::Killed(kill(&failure)), samples + at));
    }
    if moved.samples == 0 {
        return Ok((identity.map_or(Outcome::Unmoved, |why| Outcome::Equivalent(why.into())), samples));
    }
    let mut trial = match Trial::with_capacity(prepared, lane, kernel, shared.promises, STEPS[2]) {
        Ok(trial) => trial,
        Err(error @ (LaneError::Unsupported(_) | LaneError::Api(_))) => {
            return Ok((Outcome::Invalid(error.to_string()), 0));
        }
        // A driver or a translator that is lost says nothing of the mutant.
        Err(error) => return Err(error),
    };
    let kill = match related(&mut trial, shared) {
        Ok(kill) => kill,
        // An invocation that runs out of loop iterations writes no record.
        Err(LaneError::NotWritten { .. }) if kernel.has_loops() => Some(Kill::NotFinished),
        Err(error) => return Err(error),
    };
    Ok((kill.map_or(Outcome::Survived(moved), Outcome::Killed), samples))
}

/// How a deviation of the shader kills.
fn kill(failure: &Failure) -> Kill {
    let reported = failure.deviation.to_string();
    match failure.deviation.what {
        What::Value(_) | What::NotWritten { .. } => Kill::Formula(reported),
        What::VertexCount { .. } | What::Strip { .. } | What::TooManyVertices { .. } => Kill::Shape(reported),
        What::Endless => Kill::NotFinished,
    }
}

/// The first deviation among the samples at the edges of a shader.
fn at_edges(
    prepared: &Prepared,
    context: &JudgeContext<'_>,
    layout: &OutputLayout,
    seed: u64,
    samples: u64,
) -> Option<Failure> {
    let edges = edges_of(prepared, seed, samples);
    let batch = (!edges.samples.is_empty()).then(|| Sample::batch(&edges.samples))?;
    shader_deviation(context, layout, &batch)
}

/// What relations and coverage say of a mutant.
fn related(trial: &mut Trial<'_>, shared: &MutantRun<'_>) -> Result<Option<Kill>, LaneError> {
    if let Some(relation) = shared.probes.first_broken(&trial.context()) {
        return Ok(Some(Kill::Relation(relation.to_owned())));
    }
    Ok((!covers(trial, shared.seed)?).then_some(Kill::Coverage))
}

/// The fault of a mutant as a unified diff.
pub(crate) fn diff(original: &SourceFile, mutant: &SourceFile) -> String {
    TextDiff::from_lines(original.text(), mutant.text())
        .unified_diff()
        .context_radius(1)
        .header(original.name(), "mutant")
        .to_string()
}
