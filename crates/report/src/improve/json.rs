//! The report for programs. Keys may be added; none is renamed.

use serde::Serialize;

use super::Summary;
use engine::improve::{Lost, OnDevice, Proposal, Report, Source};

#[derive(Serialize)]
struct Root<'a> {
    status: &'static str,
    seed: u64,
    profile: &'a str,
    files: Vec<File<'a>>,
}

#[derive(Serialize)]
struct File<'a> {
    file: &'a str,
    expressions: Vec<Expression<'a>>,
    not_run: Vec<NotRun<'a>>,
    patch: Option<&'a str>,
    written: bool,
}

#[derive(Serialize)]
struct NotRun<'a> {
    function: &'a str,
    why: &'a str,
}

#[derive(Serialize)]
struct Expression<'a> {
    function: &'a str,
    at: &'a str,
    text: &'a str,
    inputs: Vec<Input<'a>>,
    inlined: &'a [String],
    lost: Bits,
    operations: f64,
    points: usize,
    without_value: usize,
    pole: Option<Vec<Value<'a>>>,
    failed: Option<&'a str>,
    proposals: Vec<Formula<'a>>,
    refused: Vec<Refused<'a>>,
}

#[derive(Serialize)]
struct Input<'a> {
    name: &'a str,
    from: f32,
    to: f32,
    taken_for: Option<&'a str>,
}

#[derive(Serialize)]
struct Bits {
    mean: f64,
    worst: f64,
}

#[derive(Serialize)]
struct Value<'a> {
    input: &'a str,
    value: f32,
}

#[derive(Serialize)]
struct Refused<'a> {
    text: &'a str,
    why: &'a str,
}

#[derive(Serialize)]
struct Formula<'a> {
    text: &'a str,
    lost: Bits,
    devices: Vec<Device<'a>>,
    operations: f64,
    proof: Proof,
    worse: Option<Worse<'a>>,
    bound_ratio: Option<f64>,
    bound_tighter: u64,
    bound_wider: u64,
    distinct: Option<[u64; 2]>,
    reversed: Option<[u64; 2]>,
    lanes: Vec<Lane<'a>>,
    plot: Plot<'a>,
}

#[derive(Serialize)]
struct Device<'a> {
    name: &'a str,
    of: &'static str,
    before: Bits,
    after: Bits,
}

#[derive(Serialize)]
struct Proof {
    points: usize,
    many_bits: usize,
    open: usize,
    rounded: usize,
    won: usize,
}

#[derive(Serialize)]
struct Worse<'a> {
    share: f64,
    at: Vec<Value<'a>>,
    before: f64,
    after: f64,
}

#[derive(Serialize)]
struct Lane<'a> {
    lane: &'a str,
    not_run: Option<&'a str>,
    samples: u64,
    same: u64,
    farthest_ulp: Option<f64>,
}

#[derive(Serialize)]
struct Plot<'a> {
    input: &'a str,
    from: f32,
    to: Vec<f32>,
    before: Vec<f64>,
    after: Vec<f64>,
}

/// The report.
pub fn json(summary: &Summary) -> String {
    let (better, _) = summary.counts();
    let root = Root {
        status: if better > 0 { "improved" } else { "clean" },
        seed: summary.seed,
        profile: &summary.profile,
        files: summary
            .files
            .iter()
            .map(|file| File {
                file: &file.file,
                expressions: file.expressions.iter().map(expression).collect(),
                not_run: file.not_run.iter().map(|(function, why)| NotRun { function, why }).collect(),
                patch: file.patch.as_deref(),
                written: file.written,
            })
            .collect(),
    };
    serde_json::to_string_pretty(&root).unwrap_or_default() + "\n"
}

fn bits(lost: Lost) -> Bits {
    Bits { mean: lost.mean, worst: lost.worst }
}

fn point(at: &[(String, f32)]) -> Vec<Value<'_>> {
    at.iter().map(|(input, value)| Value { input, value: *value }).collect()
}

fn expression(report: &Report) -> Expression<'_> {
    Expression {
        function: &report.function,
        at: &report.at,
        text: &report.text,
        inputs: report
            .inputs
            .iter()
            .map(|one| Input {
                name: &one.name,
                from: one.range[0],
                to: one.range[1],
                taken_for: one.taken_for.as_deref(),
            })
            .collect(),
        inlined: &report.inlined,
        lost: bits(report.lost),
        operations: report.operations,
        points: report.points.0,
        without_value: report.points.1,
        pole: report.pole.as_deref().map(point),
        failed: report.failed.as_deref(),
        proposals: report.proposals.iter().map(formula).collect(),
        refused: report.refused.iter().map(|(text, why)| Refused { text, why }).collect(),
    }
}

fn device(on: &OnDevice) -> Device<'_> {
    let of = match on.source {
        Source::Promise => "promise",
        Source::Measurement => "measurement",
        Source::Lane => "lane",
    };
    Device { name: &on.name, of, before: bits(on.lost[0]), after: bits(on.lost[1]) }
}

fn formula(one: &Proposal) -> Formula<'_> {
    let bounds = one.compared.accuracy.first();
    let resolution = one.compared.resolution.as_ref();
    Formula {
        text: &one.text,
        lost: bits(one.lost),
        devices: one.devices.iter().map(device).collect(),
        operations: one.operations,
        proof: Proof {
            points: one.proof.points,
            many_bits: one.proof.many_bits,
            open: one.proof.open,
            rounded: one.proof.rounded,
            won: one.proof.won,
        },
        worse: one.worse.as_ref().map(|(share, at, [before, after])| Worse {
            share: *share,
            at: point(at),
            before: *before,
            after: *after,
        }),
        bound_ratio: bounds.and_then(|bounds| bounds.median_ratio).map(|ratio| 1.0 / ratio),
        bound_tighter: bounds.map_or(0, |bounds| bounds.better[1]),
        bound_wider: bounds.map_or(0, |bounds| bounds.better[0]),
        distinct: resolution.map(|[before, after]| [before.distinct, after.distinct]),
        reversed: resolution.map(|[before, after]| [before.reversed, after.reversed]),
        lanes: one
            .compared
            .lanes
            .iter()
            .map(|lane| Lane {
                lane: lane.lane,
                not_run: lane.not_run.as_deref(),
                samples: lane.samples,
                same: lane.same,
                farthest_ulp: lane.farthest.as_ref().map(|(far, _)| *far).filter(|far| far.is_finite()),
            })
            .collect(),
        plot: Plot {
            input: &one.plot.input,
            from: one.plot.from,
            to: one.plot.places.iter().map(|(to, _)| *to).collect(),
            before: one.plot.places.iter().map(|(_, lost)| lost[0]).collect(),
            after: one.plot.places.iter().map(|(_, lost)| lost[1]).collect(),
        },
    }
}
