//! One case of a function, from its inputs to its outputs: what each expression makes of it in binary32, in real numbers and
//! on lanes, and the first expression at which something goes wrong.

use crate::InputValue;
use crate::fuzz::{
    Domain, FunctionReport, Ready, Severity, Subject, batch_size, drawn, operation, place_of, scan, stream_key,
};
use base::value::{Batch, Scalar};
use judge::profile::Profile;
use judge::tape::Cause;
use judge::trace::{self, Traced, TracedReal, TracedStep, TracedValue};
use judge::verdict::diagnosis::{Place, in_one_line};
use lanes::{Lane, LaneError, LaneName, Stage, embedded};
use program::Probed;
use program::lower::Role;
use program::probe::{MAX_WORDS, Step, Trace, What};
use property::Sample;

/// Bits from which on the loss of an expression is told.
const LOSS: f64 = 1.0;

/// A case of a function.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its inputs.
    pub sample: Sample,
    /// Why this one, as a sentence without a full stop.
    pub why: String,
    /// The output that shows it, where there is one.
    pub output: Option<String>,
}

impl Case {
    /// The smallest case of the worst finding of a run of `fuzz` that has one; notes only where `notes` says so.
    pub fn of(report: &FunctionReport, ready: &Ready, notes: bool) -> Option<Self> {
        let told = report.findings.iter().filter(|own| !own.is_of_dispatch() && !own.inputs.is_empty());
        let finding = told.min_by_key(|own| own.severity).filter(|own| notes || own.severity != Severity::Note)?;
        let sample = sample(ready, finding.inputs.iter().flat_map(|input| input.bits.iter().copied()))?;
        let lane = finding.lane.map_or_else(String::new, |lane| format!(" on {lane}"));
        let severity = finding.severity.name();
        let why = format!("the smallest of a {severity}{lane}: {}", finding.message);
        Some(Self { sample, why, output: finding.output.clone() })
    }

    /// Of `samples` inputs of a domain, at most one batch, the ones that lose most bits.
    pub fn hardest(subject: &Subject, ready: &Ready, domain: &Domain, (samples, seed): (usize, u64)) -> Self {
        let samples = samples.min(batch_size(ready));
        let key = stream_key(seed, &subject.label);
        let batch = drawn(ready, domain, key, (0, samples), !domain.is_stated());
        let looks = scan(&ready.executable, &ready.kernel.output.vertex, &batch);
        let most = (0..looks.len()).max_by(|&a, &b| looks[a].error.total_cmp(&looks[b].error).then(b.cmp(&a)));
        let sample = Sample::of(&batch, most.unwrap_or(0));
        let why = format!("nothing was found; of {samples} inputs these are the ones that lose most bits");
        Self { sample, why, output: None }
    }
}

/// A sample with these words, those of the invocation first.
fn sample(ready: &Ready, words: impl Iterator<Item = u32>) -> Option<Sample> {
    let (invocation, case) = (&ready.kernel.invocation, &ready.kernel.case);
    let mut words: Vec<u32> = words.collect();
    if words.len() != invocation.words() + case.words() {
        return None;
    }
    let of_case = words.split_off(invocation.words());
    Some(Sample { invocation_record: invocation.clone(), case_record: case.clone(), invocation: words, case: of_case })
}

/// What is wrong at a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// It has no value, or an infinite one, in real numbers, and its operands have.
    NoValue(String),
    /// Its value fits binary32 in real numbers, or is too large for it by itself, and binary32 has none.
    Lost(String),
    /// This comparison falls otherwise in real numbers; or, behind a decision that is none of numbers, they take another step.
    Parts,
    /// A lane has what no conforming device may.
    Lane(LaneName),
    /// It loses more bits than any other, beside those that its operands had lost.
    Loses(f64),
}

/// One expression, run once.
#[derive(Clone, Debug)]
pub struct StepReport {
    /// Where it stands, with its text; `None` for what is no expression of the author's.
    pub place: Option<Place>,
    /// What it is, where it is no operation: a comparison, or the emission of a vertex.
    pub event: Option<String>,
    /// How many times it has run with this one.
    pub round: usize,
    /// How often it runs in all.
    pub rounds: usize,
    /// Its numbers, matrices column by column; of a comparison the two operands.
    pub values: Vec<TracedValue>,
    /// The same on each lane that goes this way, as bits.
    pub lanes: Vec<Option<Vec<u32>>>,
    /// Bits that strict binary32 has lost.
    pub lost: f64,
    /// The same without those that its operands had lost.
    pub own_loss: f64,
    /// True where the outputs depend on it, and for comparisons.
    pub feeds: bool,
    /// What is wrong.
    pub marks: Vec<Mark>,
}

/// An output word.
#[derive(Clone, Debug)]
pub struct OutputReport {
    /// Its name.
    pub name: String,
    /// As what its bits are read.
    pub scalar: Scalar,
    /// Its value in binary32 and, of what is no whole number, in real numbers.
    pub value: TracedValue,
}

/// A case with all its steps.
#[derive(Clone, Debug)]
pub struct TraceReport {
    /// Name of the function.
    pub function: String,
    /// `name:line:column`.
    pub at: String,
    /// Why this case.
    pub why: String,
    /// Its inputs.
    pub inputs: Vec<InputValue>,
    /// What was computed, in order.
    pub steps: Vec<StepReport>,
    /// True when steps at the end did not fit.
    pub cut: bool,
    /// True where a decision may fall either way on a device: no lane is held against bounds then.
    pub forked: bool,
    /// True where a loop went on for too long, so that what comes after it is not known.
    pub endless: bool,
    /// What came out.
    pub outputs: Vec<OutputReport>,
    /// Lanes whose values stand beside, with why one did not run.
    pub lanes: Vec<(LaneName, Option<String>)>,
    /// The profile that bounds are derived from.
    pub profile: String,
}

impl TraceReport {
    /// The step at which it goes wrong: the first without a value, else the first that real numbers or a lane part from, else
    /// the one that loses most.
    pub fn origin(&self) -> Option<(usize, &Mark)> {
        let rank = |mark: &Mark| match mark {
            Mark::NoValue(_) | Mark::Lost(_) => 0,
            Mark::Lane(_) => 1,
            Mark::Parts => 2,
            Mark::Loses(_) => 3,
        };
        let all = self.steps.iter().enumerate().flat_map(|(at, step)| step.marks.iter().map(move |mark| (at, mark)));
        all.min_by_key(|(at, mark)| (rank(mark), *at))
    }
}

/// How a case is traced.
pub struct Request<'a> {
    /// Lanes whose values stand beside.
    pub lanes: &'a [&'a dyn Lane],
    /// What bounds are derived from.
    pub profile: &'a Profile,
    /// Only what this output depends on: a variable, or a component of one.
    pub output: Option<&'a str>,
}

/// Traces a case of a function.
///
/// # Errors
/// Why it cannot be traced, in a sentence without a full stop; among these an output that it does not have.
pub fn run(subject: &Subject, ready: &Ready, case: &Case, request: &Request<'_>) -> Result<TraceReport, String> {
    let probed = ready.program.probed(MAX_WORDS).map_err(|error| error.to_string())?;
    let batch = Sample::batch(std::slice::from_ref(&case.sample));
    let outputs = match (request.output, &case.output) {
        // Of what a finding is about, its output; a vertex of a geometry stage has no name here.
        (None, Some(own)) => outputs(ready, &probed, Some(own)).or_else(|_| outputs(ready, &probed, None))?,
        (wanted, _) => outputs(ready, &probed, wanted)?,
    };
    let words: Vec<usize> = outputs.iter().map(|(word, ..)| *word).collect();
    let traced =
        trace::trace(&probed, (request.profile, Stage::Compute), &words, &batch).map_err(|error| error.to_string())?;
    // The interpreter is the column of binary32 already.
    let beside = request.lanes.iter().filter(|lane| lane.description().name != embedded::STRICT);
    let ran: Vec<(LaneName, Result<Trace<u32>, String>)> =
        beside.map(|lane| (lane.description().name, on_lane(*lane, &probed, &batch))).collect();
    let outputs = outputs
        .into_iter()
        .zip(&traced.outputs)
        .map(|((_, name, scalar), value)| OutputReport { name, scalar, value: *value })
        .collect();
    Ok(TraceReport {
        function: subject.label.clone(),
        at: subject.at.clone(),
        why: case.why.clone(),
        inputs: InputValue::all(&case.sample, &ready.program),
        steps: steps(&probed, &traced, &subject.at, &ran),
        cut: traced.cut,
        forked: traced.forked,
        endless: traced.endless,
        outputs,
        lanes: ran.into_iter().map(|(lane, ran)| (lane, ran.err())).collect(),
        profile: request.profile.name.clone(),
    })
}

/// The output words that are asked for, with their names and kinds of numbers; none for a geometry stage, whose vertices are
/// steps.
fn outputs(ready: &Ready, probed: &Probed, wanted: Option<&str>) -> Result<Vec<(usize, String, Scalar)>, String> {
    if let Role::Geometry(_) = ready.program.role {
        return match wanted {
            None => Ok(Vec::new()),
            Some(_) => Err("the outputs of a geometry stage are steps of its trace; leave out --output".to_owned()),
        };
    }
    let own = ready.program.output_layout().vertex;
    let layout = probed.program.output_layout().vertex;
    let mut all = Vec::new();
    for (k, field) in own.fields().iter().enumerate() {
        let at = layout.range(k);
        all.extend(own.range(k).zip(at).map(|(word, at)| (at, own.word_name(word), field.shape.scalar)));
    }
    let Some(wanted) = wanted else { return Ok(all) };
    let is_part =
        |name: &str| name.strip_prefix(wanted).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']));
    let chosen: Vec<_> = all.iter().filter(|(_, name, _)| is_part(name)).cloned().collect();
    if chosen.is_empty() {
        let names: Vec<&str> = own.fields().iter().map(|field| field.name.as_str()).collect();
        let hint = base::did_you_mean(wanted, names, "it has:");
        return Err(format!("there is no output `{wanted}`; {hint}"));
    }
    Ok(chosen)
}

/// What a lane computes on the way.
fn on_lane(lane: &dyn Lane, probed: &Probed, batch: &Batch) -> Result<Trace<u32>, String> {
    let stage = crate::fuzz::stage_of(lane, &probed.program);
    let kernel = crate::fuzz::kernel(&probed.program, stage).map_err(|error| error.to_string())?;
    let told = |error: LaneError| error.to_string();
    let actual = lane.prepare(&kernel, 1).map_err(told)?.run(batch).map_err(told)?;
    probed.trace::<u32>(actual.vertex(0, 0)).map_err(|error| error.to_string())
}

/// The steps; what stands at the name of the function is of a caller that is made up, and feeds nothing that is told.
fn steps(
    probed: &Probed,
    traced: &Traced,
    at_name: &str,
    lanes: &[(LaneName, Result<Trace<u32>, String>)],
) -> Vec<StepReport> {
    let mut rounds = vec![0; probed.points.len()];
    traced.steps.iter().for_each(|step| rounds[step.point] += 1);
    // How far each lane goes the same way.
    let same = |trace: &Trace<u32>| {
        let parted = trace.steps.iter().zip(&traced.steps).position(|(a, b)| a.point != b.point);
        parted.unwrap_or(trace.steps.len().min(traced.steps.len()))
    };
    let lanes: Vec<(LaneName, Option<&[Step<u32>]>)> = lanes
        .iter()
        .map(|(lane, trace)| (*lane, trace.as_ref().ok().map(|trace| &trace.steps[..same(trace)])))
        .collect();
    let most = traced.steps.iter().filter(|step| step.feeds).map(TracedStep::own_loss).fold(0.0, f64::max);
    // What decides stands before what differs, if it is a comparison of numbers.
    let is_comparison = |at: &usize| probed.points[traced.steps[*at].point].what == What::Comparison;
    let parts = traced.parted.map(|at| at.checked_sub(1).filter(is_comparison).unwrap_or(at));
    let mut accused: Vec<LaneName> = Vec::new();
    let (mut broken, mut loses) = (false, false);
    let mut reports = Vec::new();
    for (at, step) in traced.steps.iter().enumerate() {
        let point = &probed.points[step.point];
        let place = point.span.and_then(|span| place_of(&probed.program, span));
        let of_caller = place.as_ref().is_some_and(|place| place.at.to_string() == at_name);
        let on: Vec<Option<Vec<u32>>> =
            lanes.iter().map(|(_, steps)| Some(steps.as_ref()?.get(at)?.values.clone())).collect();
        let mut marks = Vec::new();
        marks.extend((parts == Some(at)).then_some(Mark::Parts));
        if step.feeds && point.what != What::Comparison {
            let wrote = place.as_ref().map(|place| place.text.as_str());
            let leaf = step.broken_leaf.and_then(|leaf| point.leaves.get(leaf)?.span);
            let leaf = leaf.map(|span| in_one_line(probed.program.file.slice(span)));
            let taken = || leaf.map(|leaf| Mark::NoValue(format!("it takes `{leaf}`, which has no finite value")));
            let wrong = wrong(step, wrote).or_else(|| taken().filter(|_| step.is_broken() && !broken));
            marks.extend(wrong.filter(|mark| matches!(mark, Mark::NoValue(_)) || !broken));
            broken |= step.is_broken();
            for ((lane, _), values) in lanes.iter().zip(&on) {
                if !traced.forked
                    && !accused.contains(lane)
                    && values.as_ref().is_some_and(|values| !allowed(step, values))
                {
                    accused.push(*lane);
                    marks.push(Mark::Lane(lane));
                }
            }
            let is_most = !broken && !loses && most >= LOSS && step.own_loss() >= most;
            loses |= is_most;
            marks.extend(is_most.then(|| Mark::Loses(step.own_loss())));
        }
        let event = match &point.what {
            What::Operation => None,
            What::Comparison => Some("comparison".to_owned()),
            What::Emitted { output } => Some(format!("EmitVertex: {output}")),
            What::EndPrimitive => Some("EndPrimitive".to_owned()),
        };
        reports.push(StepReport {
            place,
            event,
            round: step.round,
            rounds: rounds[step.point],
            values: step.values.clone(),
            lanes: on,
            lost: step.lost(),
            own_loss: step.own_loss(),
            feeds: step.feeds && !of_caller,
            marks,
        });
    }
    reports
}

/// True where a lane has what a conforming device may have.
fn allowed(step: &TracedStep, values: &[u32]) -> bool {
    let mut both = step.values.iter().zip(values);
    both.all(|(value, found)| value.real.is_none_or(|real| real.allows(f32::from_bits(*found))))
}

/// Why a step is the first without a finite value.
fn wrong(step: &TracedStep, wrote: Option<&str>) -> Option<Mark> {
    let named = |cause: &Cause| cause.op.map_or_else(|| "it".to_owned(), |op| operation(op, &cause.args, wrote));
    if let Some(cause) = &step.cause {
        let op = named(cause);
        return Some(match cause.value {
            value if value.is_nan() => Mark::NoValue(format!("{op} has no value")),
            value if value.is_infinite() => Mark::NoValue(format!("{op} is infinite")),
            _ => Mark::Lost(format!("{op} is too large for binary32")),
        });
    }
    let fits = |real: TracedReal| real.value.is_finite();
    let lost = |value: &TracedValue| !f32::from_bits(value.binary32).is_finite() && value.real.is_some_and(fits);
    step.values.iter().any(lost).then(|| Mark::Lost("binary32 has no number here, real numbers have one".to_owned()))
}
