//! Deviations of a lane: what its device computes on the way, operation by operation.

use super::shader::{self, written};
use super::{Diagnosis, Divergence, Origin, Place};
use crate::profile::{Op, Profile};
use crate::replay::{ReplayError, replay};
use crate::tape::{Fold, Model};
use crate::trace::Meant;
use crate::verdict::judge::{Deviation, agrees};
use crate::verdict::oracle::JudgeContext;
use base::value::Batch;
use program::interp::{self, OutputColumn};
use program::lane::{Actual, Lane, LaneError, Stage};
use program::probe::{Step, Trace};
use program::{Kernel, Probed, Program, ProgramError};

/// Words of a trace: some hundred operations.
const WORDS: u32 = 1 << 11;

/// A lane and the sample on which it deviates.
pub struct Suspected<'a> {
    /// What ran the sample.
    pub lane: &'a dyn Lane,
    /// The stage in which it ran.
    pub stage: Stage,
    /// Makes a kernel of this stage.
    pub kernel: &'a dyn Fn(&Program) -> Result<Kernel, ProgramError>,
    /// The sample, alone.
    pub batch: &'a Batch,
    /// How it deviates.
    pub deviation: &'a Deviation,
}

/// What explains that a lane deviates from the shader. What cannot be looked at (a program that cannot
/// be probed, a lane that refuses it) stays open.
///
/// # Errors
/// [`LaneError`] when the lane fails.
pub fn lane(context: &JudgeContext<'_>, program: &Program, suspected: &Suspected<'_>) -> Result<Diagnosis, LaneError> {
    let profile = context.promises.lenient();
    let written = written(context, program, suspected.batch, suspected.deviation);
    let mut diagnosis = Diagnosis { written, ..Diagnosis::default() };
    let mut built_in = None;
    if let Ok(probed) = program.probed(WORDS)
        && let Ok(kernel) = (suspected.kernel)(&probed.program)
        && let Some(actual) = run(suspected.lane, &kernel, suspected.batch)?
        && let Ok(trace) = probed.trace::<u32>(actual.vertex(0, 0))
    {
        diagnosis.divergence = divergence(&probed, &trace, profile, suspected);
        built_in = culprit(&probed, &trace, profile, suspected)?;
    }
    let left_out = if built_in.is_none() { left_out(context, program, profile, suspected) } else { None };
    let explained = |loses_precise: bool| regrouped(context, program, profile, suspected, loses_precise);
    diagnosis.origin = Some(match built_in.or(left_out) {
        Some(origin) => origin,
        // Where the profile allows another order, that alone explains nothing; and `precise` only what it alone forbids.
        None if explained(false) && profile.rearrangement => Origin::Miscompilation,
        None if explained(false) => Origin::Rearrangement,
        None if explained(true) => Origin::PreciseLost { front_end: suspected.lane.front_end(program) },
        None => Origin::Miscompilation,
    });
    Ok(diagnosis)
}

fn run(lane: &dyn Lane, kernel: &Kernel, batch: &Batch) -> Result<Option<Actual>, LaneError> {
    let mut runner = match lane.prepare(kernel, 1) {
        Ok(runner) => runner,
        Err(LaneError::Unsupported(_)) => return Ok(None),
        Err(error) => return Err(error),
    };
    runner.run(batch).map(Some)
}

/// The first operation that is outside of its promise when it runs alone.
fn culprit(
    probed: &Probed,
    trace: &Trace<u32>,
    profile: &Profile,
    suspected: &Suspected<'_>,
) -> Result<Option<Origin>, LaneError> {
    let applied = probed.applied(trace);
    let known: Vec<_> = applied.iter().filter_map(|a| Some((Op::by_name(a.name)?, a))).collect();
    let items: Vec<(Op, Vec<u32>)> = known.iter().map(|(op, a)| (*op, a.operands.clone())).collect();
    let replayed = match replay(suspected.lane, suspected.stage, profile, &items) {
        Ok(replayed) => replayed,
        Err(ReplayError::Lane(LaneError::Unsupported(_)) | ReplayError::Program(_)) => return Ok(None),
        Err(ReplayError::Lane(error)) => return Err(error),
    };
    let outside = replayed.into_iter().zip(known).find(|(replayed, _)| replayed.is_outside());
    Ok(outside.and_then(|(replayed, (op, applied))| {
        let judged = replayed.outcome.ok()?;
        Some(Origin::BuiltIn {
            op,
            operands: replayed.operands,
            result: judged.result,
            exact: judged.exact,
            factor: judged.factor().unwrap_or(f64::INFINITY),
            profile: profile.name.clone(),
            place: Some(place(probed, trace.steps[applied.step].point)),
        })
    }))
}

fn place(probed: &Probed, point: usize) -> Place {
    let file = &probed.program.file;
    let nowhere = || Place { at: file.name().into(), text: String::new(), line: String::new(), expansion: None };
    probed.points[point].span.map_or_else(nowhere, |span| Place::of(file, span))
}

/// The first step of the device's trace that is farther from the meaning than a device may be.
fn divergence(
    probed: &Probed,
    device: &Trace<u32>,
    profile: &Profile,
    suspected: &Suspected<'_>,
) -> Option<Divergence> {
    let executable = interp::compile(&probed.program).ok()?;
    let model = Model::Device { profile, stage: suspected.stage, rearranged: false };
    let mut meant = Meant::of(probed, &executable, model, suspected.batch).ok()?;
    let meaning = meant.trace.clone();
    let mut words = meant.words().collect::<Vec<usize>>().into_iter();
    let mut parted = None;
    let first = device.first_difference(&meaning, |step, real| {
        parted = words.next().and_then(|word| beyond(&mut meant, word, step, real));
        parted.is_none()
    })?;
    let step = device.steps.get(first).or(device.steps.last())?;
    let place = place(probed, step.point);
    let Some((component, bound, column)) = parted else {
        let (meaning, bound, condition) = (f64::NAN, 0.0, f64::NAN);
        return Some(Divergence { place, args: Vec::new(), meaning, bound, actual: 0, condition, path: true });
    };
    let tape = meant.tape();
    Some(Divergence {
        place,
        args: tape.arguments_of(column, 0),
        meaning: tape.values(column)[0],
        bound,
        actual: step.values[component],
        condition: tape.condition(column, 0),
        path: false,
    })
}

/// The first component of a step that is farther from its meaning than it may be, with the bound and
/// the column of its meaning.
fn beyond(
    meant: &mut Meant<'_, '_>,
    first: usize,
    step: &Step<u32>,
    real: &Step<f64>,
) -> Option<(usize, f64, crate::tape::Column)> {
    (0..step.values.len().min(real.values.len())).find_map(|k| {
        let column = meant.column(first + k)?;
        let tape = meant.tape();
        let actual = f64::from(f32::from_bits(step.values[k]));
        let bounds = tape.bounds(column, &mut |bound| agrees(actual, real.values[k], bound[0]));
        let bound = bounds.bound[0];
        // Where nothing is promised, nothing parts.
        let free = !bound.is_finite() || !real.values[k].is_finite() || tape.fork(0).is_some();
        (!free && !agrees(actual, real.values[k], bound)).then_some((k, bound, column))
    })
}

/// A pair of operations whose rounding a compiler leaves out, where that explains the output and what is promised does not.
fn left_out(
    context: &JudgeContext<'_>,
    program: &Program,
    profile: &Profile,
    suspected: &Suspected<'_>,
) -> Option<Origin> {
    let value = suspected.deviation.value()?;
    let model = Model::Device { profile, stage: suspected.stage, rearranged: profile.rearrangement };
    let layout = program.output_layout();
    let word = (0..layout.vertex.words()).find(|&word| layout.vertex.word_name(word) == value.component)?;
    Fold::ALL.into_iter().find_map(|fold| {
        let mut machine = context.oracle.tape_folding(model, fold);
        machine.run_some(suspected.batch, &[0]);
        let sites = machine.as_domain().folded()?;
        let explains = match machine.output(value.vertex.unwrap_or(0), word) {
            OutputColumn::Real(&column) => {
                let meaning = machine.as_domain().values(column)[0];
                let bounds = machine.domain().bounds(column, &mut |_| false);
                agrees(f64::from(f32::from_bits(value.actual)), meaning, bounds.bound[0])
            }
            OutputColumn::Word(words) => words[0] == value.actual,
        };
        let places = sites.map(|site| shader::place(context, program, site));
        explains.then_some(Origin::RoundingLeftOut { there: places[0].clone(), back: places[1].clone() })
    })
}

/// True when another order of sums and products explains the output; also of those that are `precise` where that is lost.
fn regrouped(
    context: &JudgeContext<'_>,
    program: &Program,
    profile: &Profile,
    suspected: &Suspected<'_>,
    loses_precise: bool,
) -> bool {
    let Some(value) = suspected.deviation.value() else { return false };
    let model = Model::Device { profile, stage: suspected.stage, rearranged: true };
    let mut machine =
        if loses_precise { context.oracle.tape_without_precise(model) } else { context.oracle.tape(model) };
    machine.run_some(suspected.batch, &[0]);
    let layout = program.output_layout();
    let word = (0..layout.vertex.words()).find(|&word| layout.vertex.word_name(word) == value.component);
    let Some(word) = word else { return false };
    let OutputColumn::Real(&column) = machine.output(value.vertex.unwrap_or(0), word) else { return false };
    let actual = f64::from(f32::from_bits(value.actual));
    let bounds = machine.domain().bounds(column, &mut |_| false);
    agrees(actual, value.meaning, bounds.bound[0])
}
