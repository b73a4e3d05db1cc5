//! Findings: what a report shows a person.

use super::trial::{Trial, batch_of};
use super::{Report, Request};
use crate::lane::LaneError;
use crate::property::shrink::{self, Shrunk};
use crate::property::{Sample, regressions};
use crate::suite::Suite;
use crate::verdict::{Deviation, Reason, Verdict, What, judge_each};

/// What a finding is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FindingKind {
    /// Outputs deviate from the formula.
    Deviation,
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
    /// The lane is worse than its device was measured to be, and keeps what is promised: a warning.
    Quality,
    /// The bounds are so wide that they test little: a warning.
    VacuousBound,
}

impl FindingKind {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deviation => "deviation",
            Self::Relation => "relation",
            Self::Translation => "translation",
            Self::Coverage => "coverage",
            Self::Floor => "floor",
            Self::Vacuous => "vacuous",
            Self::Quality => "quality",
            Self::VacuousBound => "vacuous_bound",
        }
    }

    /// True for what does not make a run fail.
    pub fn is_warning(self) -> bool {
        match self {
            Self::Quality | Self::VacuousBound => true,
            Self::Deviation | Self::Relation | Self::Translation | Self::Coverage | Self::Floor | Self::Vacuous => {
                false
            }
        }
    }
}

/// Something that is wrong.
#[derive(Clone, Debug)]
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
#[derive(Clone, Debug)]
pub struct Case {
    /// The inputs, uniforms last.
    pub inputs: Vec<InputValue>,
    /// How the sample deviates.
    pub deviation: Option<Deviation>,
    /// Rounds of shrinking.
    pub rounds: usize,
    /// Candidates that were tried.
    pub tried: usize,
}

/// One input of a case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputValue {
    /// Name, with the type before it.
    pub name: String,
    /// The words.
    pub bits: Vec<u32>,
    /// The values in decimal, in the order of the words.
    pub decimal: Vec<String>,
}

/// A case for a report.
pub(super) fn case(shrunk: &Shrunk, deviation: Option<Deviation>) -> Case {
    let sample = &shrunk.sample;
    let mut inputs = Vec::new();
    for (record, words) in [(&sample.invocation_record, &sample.invocation), (&sample.case_record, &sample.case)] {
        for (k, field) in record.fields().iter().enumerate() {
            let bits = words[record.range(k)].to_vec();
            let decimal = bits.iter().map(|&w| regressions::decimal(w, field.shape.scalar)).collect();
            inputs.push(InputValue { name: format!("{} {}", field.shape, field.name), bits, decimal });
        }
    }
    Case { inputs, deviation, rounds: shrunk.rounds, tried: shrunk.tried }
}

/// The command that runs one sample again.
pub(super) fn reproduce(request: &Request, report: &Report, sample: &Sample) -> String {
    format!(
        "shadercheck check {} --lane {} --stage {} --case '{}'",
        request.arguments,
        report.lane,
        report.stage,
        regressions::inputs_text(sample)
    )
}

/// Samples that are shrunk; the rest is counted.
const SHRUNK: usize = 8;

/// Samples that were asked for one by one: they are reported as they are.
pub(super) fn as_given(samples: Vec<Sample>) -> Vec<Shrunk> {
    let given =
        |sample: Sample| Shrunk { original: sample.clone(), sample, rounds: 0, tried: 0, accepted: 0, minimal: false };
    samples.into_iter().map(given).collect()
}

/// Shrinks the failing samples, all together, and reports each kind of deviation once.
pub(super) fn deviations(
    trial: &mut Trial<'_>,
    failing: Vec<Sample>,
    request: &Request,
    report: &mut Report,
) -> Result<(), LaneError> {
    if failing.is_empty() {
        return Ok(());
    }
    let plan = trial.prepared.plan.clone();
    let first: Vec<Sample> = failing.into_iter().take(SHRUNK).collect();
    let mut oracle = |samples: &[Sample]| trial.deviates(samples);
    let shrunk = if request.replay_only { as_given(first) } else { shrink::shrink(first, &*plan, &mut oracle)? };
    let samples: Vec<Sample> = shrunk.iter().map(|s| s.sample.clone()).collect();
    let batch = batch_of(&samples);
    let actual = trial.run(&batch)?;
    let verdicts = judge_each(&trial.court(), &batch, &actual);
    let mut shown: Vec<(String, Sample)> = Vec::new();
    for (shrunk, verdict) in shrunk.iter().zip(verdicts) {
        let Verdict::Deviate(deviation) = verdict else {
            // The same inputs gave another answer: nothing that was found may get lost over it.
            report.findings.push(Finding {
                kind: FindingKind::Deviation,
                message: "a sample failed, and passed when it was run again: the lane is not deterministic".to_owned(),
                case: Some(case(shrunk, None)),
                count: 1,
                reproduce: Some(reproduce(request, report, &shrunk.sample)),
            });
            continue;
        };
        let what = kind_of(&deviation);
        if shown.iter().any(|(w, s)| *w == what || *s == shrunk.sample) {
            continue;
        }
        report.findings.push(Finding {
            kind: FindingKind::Deviation,
            message: deviation.to_string(),
            count: report.verdicts.deviated,
            reproduce: Some(reproduce(request, report, &shrunk.sample)),
            case: Some(case(shrunk, Some(deviation))),
        });
        shown.push((what, shrunk.sample.clone()));
    }
    report.failing.extend(shown.into_iter().map(|(_, s)| s));
    Ok(())
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

/// Findings about the run itself: too little judged, too much undetermined, segments not drawn.
pub(super) fn shortfalls(suite: &Suite, request: &Request, wanted: u64, report: &mut Report) {
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
    if request.replay_only {
        return;
    }
    let least = suite.floors.judged_of(wanted.min(suite.samples), suite.samples);
    if judged < least {
        floor(format!("only {judged} samples were judged; the suite asks for {least}"), judged);
    }
    let undetermined = report.verdicts.undetermined_count();
    let share = undetermined as f64 / seen.max(1) as f64;
    if share > suite.floors.undetermined {
        floor(
            format!(
                "{:.1} % of the samples are undetermined ({reasons}); the suite allows {:.1} %",
                100.0 * share,
                100.0 * suite.floors.undetermined
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
