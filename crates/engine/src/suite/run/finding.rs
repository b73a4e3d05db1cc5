//! Findings: what a report shows a person.

use std::borrow::Cow;

use super::part::{Failing, Shown, Terms};
use super::position::{self, Place, Tied};
use super::trial::Trial;
use super::{Part, Prepared, Report, Request, Way, repeat};
use crate::suite::Suite;
use crate::{InputValue, activity};
use judge::verdict::diagnosis::{self, Diagnosis, Suspected};
use judge::verdict::{Blame, Deviation, Reason, Verdict, What, judge_each};
use lanes::{Lane, LaneError, Stage as LaneStage};
use program::{InputSource, Port, Program};
use property::shrink::Shrunk;
use property::{Sample, regressions};
use serde::{Deserialize, Serialize};

/// What a finding is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum FindingKind {
    /// Outputs deviate from the formula.
    Deviation,
    /// An output of the shader depends on a value that the language leaves undefined.
    Undefined,
    /// The same, for inputs whose values were guessed: a warning.
    Guessed,
    /// The same inputs gave other outputs: a fault of the lane.
    Flaky,
    /// A relation between outputs does not hold.
    Relation,
    /// A translation means something else than the shader.
    Translation,
    /// Parts of what should be drawn are not.
    Coverage,
    /// Fewer samples were judged, or more left undetermined, than the suite allows.
    Floor,
    /// Something that was asked for tested nothing.
    Vacuous,
    /// An expected failure did not come.
    UnexpectedPass,
    /// The lane is worse than its device was measured to be, and keeps what is promised: a warning.
    Quality,
    /// The bounds are so wide that they test little: a warning.
    VacuousBound,
    /// Real numbers are fine and binary32 is not: a weakness of the shader, and a warning.
    Range,
    /// A literal is a known constant in few digits, and is judged as the constant: a warning.
    RoundedLiteral,
}

impl FindingKind {
    /// All kinds.
    pub const ALL: [Self; 14] = [
        Self::Deviation,
        Self::Undefined,
        Self::Guessed,
        Self::Flaky,
        Self::Relation,
        Self::Translation,
        Self::Coverage,
        Self::Floor,
        Self::Vacuous,
        Self::UnexpectedPass,
        Self::Quality,
        Self::VacuousBound,
        Self::Range,
        Self::RoundedLiteral,
    ];

    /// What it means, in a sentence.
    pub fn about(self) -> &'static str {
        match self {
            Self::Deviation => "Outputs deviate from what is expected, or from what the shader means.",
            Self::Undefined => "An output of the shader depends on a value that the language leaves undefined.",
            Self::Guessed => "An output depends on an undefined value, for inputs whose values were guessed.",
            Self::Flaky => "The same inputs gave other outputs when they ran again: a fault of the lane.",
            Self::Relation => "A relation between outputs does not hold.",
            Self::Translation => "A translation means something else than the shader.",
            Self::Coverage => "Parts of what should be drawn are not.",
            Self::Floor => "Too few samples were judged, or too many left undetermined.",
            Self::Vacuous => "Something that was asked for tested nothing.",
            Self::UnexpectedPass => "An expected failure did not come.",
            Self::Quality => "The lane is worse than its device was measured to be, and keeps what is promised.",
            Self::VacuousBound => "The bounds are so wide that they test little.",
            Self::Range => "Real numbers are fine and binary32 is not.",
            Self::RoundedLiteral => "A literal is a known constant in few digits, and is judged as the constant.",
        }
    }

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deviation => "deviation",
            Self::Undefined => "undefined",
            Self::Guessed => "guessed",
            Self::Flaky => "flaky",
            Self::Relation => "relation",
            Self::Translation => "translation",
            Self::Coverage => "coverage",
            Self::Floor => "floor",
            Self::Vacuous => "vacuous",
            Self::UnexpectedPass => "unexpected_pass",
            Self::Quality => "quality",
            Self::VacuousBound => "vacuous_bound",
            Self::Range => "range",
            Self::RoundedLiteral => "rounded_literal",
        }
    }

    /// True for what does not make a run fail.
    pub fn is_warning(self) -> bool {
        match self {
            Self::Guessed | Self::Quality | Self::VacuousBound | Self::Range | Self::RoundedLiteral => true,
            Self::Deviation
            | Self::Undefined
            | Self::Flaky
            | Self::Relation
            | Self::Translation
            | Self::Coverage
            | Self::Floor
            | Self::Vacuous
            | Self::UnexpectedPass => false,
        }
    }
}

/// Something that is wrong.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Finding {
    /// What it is about.
    pub kind: FindingKind,
    /// What is wrong, in a sentence without a full stop.
    pub message: String,
    /// The simplest sample that shows it.
    pub case: Option<Case>,
    /// Samples that show it.
    pub count: u64,
    /// A command that shows it again.
    pub reproduce: Option<String>,
}

/// The inputs that show a finding.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Case {
    /// The inputs, uniforms last.
    pub inputs: Vec<InputValue>,
    /// How the sample deviates.
    pub deviation: Option<Deviation>,
    /// What the shader was compared with, in a word: `formula`, `reference`.
    pub against: Cow<'static, str>,
    /// Where that comes from, as far as it could be found out.
    pub diagnosis: Diagnosis,
    /// Rounds of shrinking.
    pub rounds: usize,
    /// Candidates that were tried.
    pub tried: usize,
}

/// A case for a report.
pub(super) fn case(program: &Program, shrunk: &Shrunk, deviation: Option<Deviation>) -> Case {
    let inputs = InputValue::all(&shrunk.sample, program);
    let diagnosis = Diagnosis::default();
    Case { inputs, deviation, against: "formula".into(), diagnosis, rounds: shrunk.rounds, tried: shrunk.tried }
}

/// The command that runs one sample again.
pub(super) fn reproduce(request: &Request, (lane, way): (&str, Way), sample: &Sample) -> String {
    let inputs = regressions::inputs_text(sample);
    format!("shadercheck check {} --lane {lane} {} --case '{inputs}'", request.arguments, argument(way))
}

/// The arguments that choose the stage or the source of inputs.
fn argument((stage, source): Way) -> String {
    match source {
        Some(source) if source != InputSource::Storage => format!("--sources {}", source.name()),
        Some(_) | None => format!("--stage {stage}"),
    }
}

/// Flaky samples are told once.
const FLAKY: &str = "flaky";

/// Samples that fail by their place are told once.
const POSITION: &str = "position";

/// A finding about a sample that deviates by its place in a buffer. It takes the whole batch to show it again.
pub(super) fn tied(request: &Request, part: &Part, sample: &Sample, tied: Tied, prepared: &Prepared) -> Finding {
    let Tied { position, deviation, .. } = tied;
    let against = prepared.reference.noun();
    let message = deviation.message(against);
    let shrunk = unshrunk(sample.clone());
    let diagnosis = Diagnosis { position: Some(position), ..Diagnosis::default() };
    Finding {
        kind: FindingKind::Deviation,
        message,
        case: Some(Case { diagnosis, against: against.into(), ..case(&prepared.program, &shrunk, Some(deviation)) }),
        count: 0,
        reproduce: Some(rerun(request, part)),
    }
}

/// The command that does the same run again.
pub(super) fn rerun(request: &Request, part: &Part) -> String {
    let samples = request.samples.map_or_else(String::new, |samples| format!(" --samples {samples}"));
    // A number of samples goes before an eighth of them.
    let quick = if request.quick && request.samples.is_none() { " --quick" } else { "" };
    let (arguments, lane, way) = (&request.arguments, part.lane, argument((part.stage, part.source)));
    format!("shadercheck check {arguments} --lane {lane} {way} --seed {}{samples}{quick}", request.seed)
}

/// Samples that were asked for one by one: they are reported as they are.
pub(super) fn as_given(samples: Vec<Sample>) -> Vec<Shrunk> {
    samples.into_iter().map(unshrunk).collect()
}

/// A sample as it is.
pub(super) fn unshrunk(sample: Sample) -> Shrunk {
    Shrunk { original: sample.clone(), sample, rounds: 0, tried: 0, accepted: 0, minimal: false }
}

/// Shrinks the failing samples, all together, and reports each kind of deviation once.
pub(super) fn deviations(
    trial: &mut Trial<'_>,
    lane: &dyn Lane,
    failing: &[Failing],
    request: &Request,
    part: &Part,
) -> Result<Vec<Shown>, LaneError> {
    if failing.is_empty() {
        return Ok(Vec::new());
    }
    let plan = trial.prepared.plan.clone();
    let against = trial.prepared.reference.noun();
    let first: Vec<Sample> = failing.iter().map(|failing| failing.sample(&plan)).collect();
    let prints: Vec<u64> = failing.iter().map(|failing| failing.print).collect();
    let mut shown: Vec<Shown> = Vec::new();
    let mut tied: Option<Tied> = None;
    let (mut steady, mut numbers, mut of_shader) = (Vec::new(), Vec::new(), Vec::new());
    for ((sample, failing), again) in first.iter().zip(failing).zip(repeat::again(trial, &first, &prints)?) {
        let number = failing.number;
        // A shader that is wrong is wrong on a flaky lane too.
        if !again.is_flaky() || again.is_shader() {
            steady.push(sample.clone());
            numbers.push(number);
            of_shader.push(again.is_shader());
        }
        if again.is_flaky() && !again.is_shader() {
            let place = Place::of(failing);
            if place.is_some_and(|place| tied.as_ref().is_some_and(|tied| tied.explains(place))) {
                continue;
            }
            let found = place.map(|place| position::probe(trial, request, sample, place)).transpose()?.flatten();
            if let Some(found) = found {
                let words = [&sample.case[..], &sample.invocation[..]].concat();
                let finding = self::tied(request, part, sample, found.clone(), trial.prepared);
                shown.push(Shown { number, alike: Some(POSITION.to_owned()), words, finding, sample: None });
                tied = Some(found);
                continue;
            }
        }
        if again.is_flaky() {
            let words = [&sample.case[..], &sample.invocation[..]].concat();
            let finding = again.finding(&trial.prepared.program, request, part, &unshrunk(sample.clone()));
            shown.push(Shown { number, alike: Some(FLAKY.to_owned()), words, finding, sample: None });
        }
    }
    let disturbed = tied.as_ref().is_some_and(|tied| tied.position.disturbed);
    if disturbed {
        // What depends on others each time differs from place to place, and is no chance.
        shown.retain(|shown| shown.alike.as_deref() != Some(FLAKY));
        // What was disturbed in every run is explained as well.
        for k in (0..of_shader.len()).rev().filter(|&k| !of_shader[k]) {
            steady.remove(k);
            numbers.remove(k);
        }
    }
    if steady.is_empty() {
        return Ok(shown);
    }
    let first = steady;
    // On a flaky lane only what is wrong whatever the lane gives is made simpler.
    let flaky = !shown.is_empty();
    let counts = |d: &Deviation| !flaky || d.blame == Blame::Shader;
    let mut oracle = |samples: &[Sample]| trial.deviates(samples, &counts);
    let shrunk = if request.replay_only { as_given(first) } else { activity::shrink(first, &*plan, &mut oracle)? };
    let samples: Vec<Sample> = shrunk.iter().map(|s| s.sample.clone()).collect();
    let batch = Sample::batch(&samples);
    let actual = trial.run(&batch)?;
    let verdicts = judge_each(&trial.context(), &batch, &actual);
    for ((shrunk, verdict), number) in shrunk.iter().zip(verdicts).zip(numbers) {
        let words = [&shrunk.sample.case[..], &shrunk.sample.invocation[..]].concat();
        let Verdict::Deviate(deviation) = verdict else {
            // The same inputs gave another answer: nothing that was found may get lost over it.
            let finding = Finding {
                kind: FindingKind::Flaky,
                message: "flaky: a sample failed, and passed when it was run again: the lane is not deterministic"
                    .to_owned(),
                case: Some(case(&trial.prepared.program, shrunk, None)),
                count: 1,
                reproduce: Some(reproduce(request, part.on(), &shrunk.sample)),
            };
            let reported = shown.iter().any(|s| s.alike.as_deref() == Some(FLAKY));
            // A lane that answers by place gives the sample another answer where it is run alone: no chance.
            if !reported && tied.is_none() {
                shown.push(Shown { number, alike: Some(FLAKY.to_owned()), words, finding, sample: None });
            }
            continue;
        };
        let what = kind_of(&deviation);
        let same = |s: &Shown| s.alike.as_ref().is_some_and(|alike| *alike == what || s.words == words);
        if shown.iter().any(same) {
            continue;
        }
        let diagnosis = diagnose(trial, lane, &shrunk.sample, &deviation)?;
        let finding = Finding {
            kind: FindingKind::Deviation,
            message: deviation.message(against),
            // Known when all parts of the run are.
            count: 0,
            reproduce: Some(reproduce(request, part.on(), &shrunk.sample)),
            case: Some(Case {
                diagnosis,
                against: against.into(),
                ..case(&trial.prepared.program, shrunk, Some(deviation))
            }),
        };
        shown.push(Shown { number, alike: Some(what), words, finding, sample: Some(shrunk.sample.clone()) });
    }
    shown.sort_by_key(|shown| shown.number);
    Ok(shown)
}

/// Where the deviation of a sample comes from.
fn diagnose(
    trial: &Trial<'_>,
    lane: &dyn Lane,
    sample: &Sample,
    deviation: &Deviation,
) -> Result<Diagnosis, LaneError> {
    let (context, prepared) = (trial.context(), trial.prepared);
    let batch = Sample::batch(std::slice::from_ref(sample));
    match deviation.blame {
        Blame::Shader => Ok(diagnosis::shader(&context, &prepared.program, &batch, deviation)),
        Blame::Lane => {
            let vertex = prepared.vertex.is_some();
            let kernel = |program: &Program| match (trial.source, context.stage) {
                (Some(source @ (InputSource::Constants | InputSource::Uniforms)), _) => {
                    program.kernel_from(source, &batch)
                }
                (Some(source @ InputSource::Attributes), _) if !vertex => program.kernel_from(source, &batch),
                (_, LaneStage::Compute) => program.compute_kernel(),
                (_, LaneStage::Vertex) => program.vertex_kernel(&components(&prepared.suite, program)),
                (_, LaneStage::Geometry) => program.geometry_kernel(),
            };
            let suspected = Suspected { lane, stage: context.stage, kernel: &kernel, batch: &batch, deviation };
            diagnosis::lane(&context, &prepared.program, &suspected)
        }
    }
}

/// How many floats the host feeds for each attribute.
pub(super) fn components(suite: &Suite, program: &Program) -> Vec<u8> {
    let of = |port: &Port| suite.components(&port.field.name).unwrap_or(port.field.shape.rows);
    program.inputs.iter().map(of).collect()
}

/// Deviations that are told once: the same component, or the same kind of shape.
fn kind_of(deviation: &Deviation) -> String {
    let what = match &deviation.what {
        What::Value(value) => value.component.as_str(),
        What::NotWritten { component, .. } => component.as_str(),
        What::VertexCount { .. } => "count",
        What::Strip { .. } => "strip",
        What::TooManyVertices { .. } => "limit",
        What::Endless => "loop",
    };
    format!("{} {what}", deviation.blame.name())
}

/// Share of the samples that leave the range of binary32 before that is told as a finding: inputs that
/// are subnormal themselves come by chance.
const RANGE_SHARE: f64 = 1e-3;

/// Where samples leave the range of binary32 although their values in real numbers are fine.
pub(super) fn ranges(report: &mut Report) {
    let seen = report.verdicts.seen();
    for doubtful in report.doubts.iter().filter(|doubtful| doubtful.reason.is_range()) {
        if doubtful.count as f64 > RANGE_SHARE * seen as f64 {
            report.findings.push(Finding {
                kind: FindingKind::Range,
                message: format!("outside of the range of binary32: {doubtful}"),
                case: None,
                count: doubtful.count,
                reproduce: None,
            });
        }
    }
}

/// Findings about the run itself: too little judged, too much undetermined, segments not drawn.
pub(super) fn shortfalls(terms: &Terms, report: &mut Report) {
    if let Some(coverage) = &report.coverage
        && !coverage.is_complete()
    {
        report.findings.push(Finding {
            kind: FindingKind::Coverage,
            message: coverage.to_string(),
            case: None,
            count: coverage.missing() as u64,
            reproduce: None,
        });
    }
    let mut floor = |message: String, count| {
        let kind = FindingKind::Floor;
        report.findings.push(Finding { kind, message, case: None, count, reproduce: None });
    };
    let judged = report.verdicts.agreed + report.verdicts.deviated;
    let seen = report.verdicts.seen();
    let reasons = reasons(&report.verdicts.undetermined);
    if judged == 0 {
        floor(format!("no sample was judged: of {seen}, all are undetermined ({reasons})"), seen);
        return;
    }
    if terms.replay_only {
        return;
    }
    let least = terms.least;
    // What is stated one by one is no part of a number of samples to be made.
    if judged < least && terms.makes_samples {
        floor(format!("only {judged} samples were judged; the suite asks for {least}"), judged);
    }
    let undetermined = report.verdicts.undetermined_count();
    let share = undetermined as f64 / seen.max(1) as f64;
    if share > terms.undetermined {
        floor(
            format!(
                "{:.1} % of the samples are undetermined ({reasons}); the suite allows {:.1} %",
                100.0 * share,
                100.0 * terms.undetermined
            ),
            undetermined,
        );
    }
}

/// Undetermined samples by reason, those reasons left out that there are none of.
fn reasons(undetermined: &[u64]) -> String {
    let some = Reason::ALL.iter().zip(undetermined).filter(|(_, n)| **n > 0);
    let parts: Vec<String> = some.map(|(reason, n)| format!("{n} {reason}")).collect();
    parts.join(", ")
}
