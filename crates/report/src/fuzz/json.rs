//! The report for programs. Keys may be added; none is renamed.

use serde::Serialize;

use super::Summary;
use base::text::Location;
use engine::InputValue;
use engine::fuzz::{Finding, FunctionReport, LaneReport};
use judge::verdict::Reason;

#[derive(Serialize)]
struct Root<'a> {
    status: &'static str,
    seed: u64,
    lanes: Vec<Lane<'a>>,
    files: Vec<File<'a>>,
}

#[derive(Serialize)]
struct Lane<'a> {
    name: &'a str,
    driver: &'a str,
}

#[derive(Serialize)]
struct File<'a> {
    file: &'a str,
    notes: &'a [String],
    errors: Vec<Error>,
    functions: Vec<Function<'a>>,
}

#[derive(Serialize)]
struct Error {
    at: String,
    code: &'static str,
    message: String,
}

#[derive(Serialize)]
struct Function<'a> {
    function: &'a str,
    at: &'a str,
    samples: u64,
    arbitrary: u64,
    edges: u64,
    dispatches: u64,
    not_dispatched: Option<&'a str>,
    not_run: Option<&'a str>,
    /// What leaves most samples undetermined.
    #[serde(skip_serializing_if = "Option::is_none")]
    weak: Option<&'static str>,
    inputs: Vec<Domain<'a>>,
    /// Inputs that are in [0, 1] in every sample, as their names say.
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    presumed: &'a [String],
    textures: &'a [String],
    max_error: f64,
    lanes: Vec<OnLane>,
    findings: Vec<FindingJson<'a>>,
}

#[derive(Serialize)]
struct Domain<'a> {
    input: &'a str,
    domain: Vec<String>,
    taken_for: Option<&'a str>,
}

#[derive(Serialize)]
struct OnLane {
    lane: &'static str,
    not_run: Option<String>,
    agreed: u64,
    deviated: u64,
    undetermined: u64,
    undetermined_by: serde_json::Map<String, serde_json::Value>,
    max_ulp: f64,
    arbitrary: Counts,
}

/// Samples of the second part of a run.
#[derive(Serialize)]
struct Counts {
    agreed: u64,
    deviated: u64,
    undetermined: u64,
}

#[derive(Serialize)]
struct FindingJson<'a> {
    kind: &'static str,
    severity: &'static str,
    part: &'static str,
    group: Option<&'a str>,
    message: &'a str,
    at: Option<&'a Location>,
    text: Option<&'a str>,
    #[serde(rename = "macro", skip_serializing_if = "Option::is_none")]
    expansion: Option<&'a str>,
    lane: Option<&'static str>,
    samples: u64,
    counting: u64,
    inputs: Vec<Input<'a>>,
    output: Option<&'a str>,
    /// As text: JSON has neither NaN nor infinity.
    meaning: Option<String>,
    found_bits: Option<String>,
    condition: Option<f64>,
    worst: Option<Worst<'a>>,
    /// Other places of the same cause.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    also: Vec<Also<'a>>,
    cause: Option<String>,
    reproduce: Option<&'a str>,
    /// A formula that `improve` writes.
    #[serde(skip_serializing_if = "Option::is_none")]
    better: Option<&'a str>,
}

#[derive(Serialize)]
struct Also<'a> {
    at: &'a Location,
    text: &'a str,
    samples: u64,
}

#[derive(Serialize)]
struct Worst<'a> {
    error: f64,
    inputs: Vec<Input<'a>>,
}

/// An input with its bits and as decimals.
#[derive(Serialize)]
pub(crate) struct Input<'a> {
    /// With its type before it, as GLSL writes it.
    name: &'a str,
    /// The same as the author's language declares it.
    declared: &'a str,
    bits: Vec<String>,
    values: &'a [String],
}

/// The report as one object, with a line break.
pub fn json(summary: &Summary) -> String {
    let totals = summary.totals();
    let root = Root {
        status: if totals.findings + totals.broken > 0 || !summary.shortcomings().is_empty() { "fail" } else { "pass" },
        seed: summary.seed,
        lanes: summary.lanes.iter().map(|d| Lane { name: d.name, driver: &d.driver }).collect(),
        files: summary
            .files
            .iter()
            .map(|file| File {
                file: &file.file,
                notes: &file.notes,
                errors: file
                    .errors
                    .iter()
                    .map(|d| Error { at: d.file.locate(d.span.start), code: d.code.0, message: d.message.to_string() })
                    .collect(),
                functions: file.functions.iter().map(function).collect(),
            })
            .collect(),
    };
    // Strings, numbers and lists: there is nothing that could not be written.
    let mut text = serde_json::to_string_pretty(&root).unwrap_or_default();
    text.push('\n');
    text
}

fn function(report: &FunctionReport) -> Function<'_> {
    Function {
        function: &report.function,
        at: &report.at,
        samples: report.samples,
        arbitrary: report.arbitrary,
        edges: report.edges,
        dispatches: report.dispatches,
        not_dispatched: report.not_dispatched.as_deref(),
        not_run: report.not_run.as_deref(),
        weak: report.weak().map(Reason::name),
        inputs: report
            .inputs
            .iter()
            .enumerate()
            .map(|(k, (input, laws))| Domain {
                input,
                domain: laws.iter().map(ToString::to_string).collect(),
                taken_for: report.taken_for.get(k).and_then(Option::as_deref),
            })
            .collect(),
        presumed: &report.presumed,
        textures: &report.textures,
        max_error: report.max_error,
        lanes: report.lanes.iter().map(on_lane).collect(),
        findings: report.findings.iter().map(found).collect(),
    }
}

fn on_lane(lane: &LaneReport) -> OnLane {
    let v = &lane.verdicts;
    let reasons = Reason::ALL.iter().zip(v.undetermined);
    let reasons = reasons.filter(|(reason, n)| **reason != Reason::Undefined || *n > 0);
    OnLane {
        lane: lane.lane,
        not_run: lane.not_run.clone(),
        agreed: v.agreed,
        deviated: v.deviated,
        undetermined: v.undetermined_count(),
        undetermined_by: reasons.map(|(reason, n)| (reason.name().to_owned(), n.into())).collect(),
        max_ulp: v.max_ulp,
        arbitrary: Counts {
            agreed: lane.arbitrary.agreed,
            deviated: lane.arbitrary.deviated,
            undetermined: lane.arbitrary.undetermined_count(),
        },
    }
}

fn found(finding: &Finding) -> FindingJson<'_> {
    let place = finding.place.as_ref();
    FindingJson {
        kind: finding.kind.name(),
        severity: finding.severity.name(),
        part: finding.part.name(),
        group: finding.cause.as_deref(),
        message: &finding.message,
        at: place.map(|place| &place.at),
        text: place.map(|place| place.text.as_str()),
        expansion: place.and_then(|place| place.expansion.as_deref()),
        lane: finding.lane,
        samples: finding.count,
        counting: finding.counting,
        inputs: inputs(&finding.inputs),
        output: finding.output.as_deref(),
        meaning: finding.meaning.map(|m| format!("{m:?}")),
        found_bits: finding.found.map(|b| format!("{b:08x}")),
        condition: finding.condition,
        worst: finding.worst.as_ref().map(|(error, worst)| Worst { error: *error, inputs: inputs(worst) }),
        also: finding.also.iter().map(|(at, samples)| Also { at: &at.at, text: &at.text, samples: *samples }).collect(),
        cause: finding.diagnosis.as_ref().and_then(|d| d.origin.as_ref()).map(ToString::to_string),
        reproduce: finding.reproduce.as_deref(),
        better: finding.better.as_deref(),
    }
}

/// The inputs of a sample.
pub(crate) fn inputs(values: &[InputValue]) -> Vec<Input<'_>> {
    let input = |input: &'_ InputValue| input.bits.iter().map(|b| format!("{b:08x}")).collect();
    values
        .iter()
        .map(|value| Input { name: &value.name, declared: value.shown(), bits: input(value), values: &value.decimal })
        .collect()
}
