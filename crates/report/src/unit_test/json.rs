//! For programs. Keys may be added; none is renamed.

use serde::Serialize;

use super::{Summary, TestReport};
use engine::unit_test::{Expectation, Kind, OnLane, Verdict};
use judge::trace::TracedReal;

#[derive(Serialize)]
struct Root<'s> {
    files: Vec<FileJson<'s>>,
    profile: &'s str,
    passed: u64,
    failed: u64,
    not_run: u64,
}

#[derive(Serialize)]
struct FileJson<'s> {
    file: &'s str,
    notes: &'s [String],
    errors: Vec<String>,
    tests: Vec<TestJson<'s>>,
}

#[derive(Serialize)]
struct TestJson<'s> {
    name: &'s str,
    line: usize,
    column: usize,
    /// `passed`, `failed` or `not_run`.
    outcome: &'static str,
    not_run: Option<&'s str>,
    expectations: Vec<ExpectationJson<'s>>,
    lanes_not_run: Vec<NotRun<'s>>,
}

#[derive(Serialize)]
struct NotRun<'s> {
    lane: &'s str,
    why: &'s str,
}

#[derive(Serialize)]
struct ExpectationJson<'s> {
    line: Option<usize>,
    column: Option<usize>,
    kind: &'static str,
    relative: Option<f64>,
    absolute: Option<f64>,
    ulp: Option<f64>,
    verdict: &'static str,
    /// How many times what devices may be off fits into the tolerance; `null` where nothing can be off.
    room: Option<f64>,
    /// Each component.
    actual: Vec<RealJson>,
    expected: Vec<RealJson>,
    lanes: Vec<LaneJson<'s>>,
}

/// Numbers as text: JSON has neither NaN nor infinity.
#[derive(Serialize)]
struct RealJson {
    real: String,
    bound: String,
}

#[derive(Serialize)]
struct LaneJson<'s> {
    lane: &'s str,
    holds: bool,
    conforms: bool,
    actual: Vec<String>,
    expected: Vec<String>,
    words: [u32; 2],
}

/// The report as one object, with a line break.
pub fn json(summary: &Summary) -> String {
    let totals = summary.totals();
    let files = summary.files.iter().map(|file| FileJson {
        file: file.file.name(),
        notes: &file.notes,
        errors: file
            .errors
            .iter()
            .map(|error| format!("{}: {}", error.file.locate(error.span.start), error.message))
            .collect(),
        tests: file
            .tests
            .iter()
            .map(|test| {
                let at = |offset| file.file.position(offset);
                one(summary, test, &at)
            })
            .collect(),
    });
    let root = Root {
        files: files.collect(),
        profile: &summary.profile,
        passed: totals.passed,
        failed: totals.failed,
        not_run: totals.not_run,
    };
    serde_json::to_string_pretty(&root).unwrap_or_default() + "\n"
}

fn one<'s>(summary: &Summary, test: &'s TestReport, at: &dyn Fn(usize) -> base::text::Position) -> TestJson<'s> {
    let position = at(test.span.start);
    let (outcome, ran) = match &test.outcome {
        Err(_) => ("not_run", None),
        Ok(ran) if summary.fails(test) => ("failed", Some(ran)),
        Ok(ran) => ("passed", Some(ran)),
    };
    TestJson {
        name: &test.name,
        line: position.line,
        column: position.column,
        outcome,
        not_run: test.outcome.as_ref().err().map(String::as_str),
        expectations: ran.iter().flat_map(|ran| &ran.expectations).map(|own| expectation(own, at)).collect(),
        lanes_not_run: ran.iter().flat_map(|ran| &ran.not_run).map(|(lane, why)| NotRun { lane, why }).collect(),
    }
}

fn expectation<'s>(own: &'s Expectation, at: &dyn Fn(usize) -> base::text::Position) -> ExpectationJson<'s> {
    let place = own.site.map(|site| at(site.start));
    let (kind, relative, absolute, ulp) = match own.kind {
        Kind::Condition => ("condition", None, None, None),
        Kind::Equal => ("equal", None, None, None),
        Kind::Near { relative, absolute } => ("near", Some(relative), Some(absolute), None),
        Kind::Ulp(most) => ("ulp", None, None, Some(most)),
    };
    let (verdict, room) = match own.verdict {
        Verdict::Holds { room } => ("holds", room.is_finite().then_some(room)),
        Verdict::Fails => ("fails", None),
        Verdict::MayFail { apart, allowed, .. } => ("may_fail", Some(allowed / apart)),
        Verdict::Undecided => ("undecided", None),
        Verdict::NoValue => ("no_value", None),
        Verdict::Unpromised => ("unpromised", None),
    };
    let real = |real: &TracedReal| RealJson { real: real.value.to_string(), bound: format!("{:e}", real.bound) };
    ExpectationJson {
        line: place.map(|place| place.line),
        column: place.map(|place| place.column),
        kind,
        relative,
        absolute,
        ulp,
        verdict,
        room,
        actual: own.real.iter().map(|(actual, _)| real(actual)).collect(),
        expected: own.real.iter().map(|(_, expected)| real(expected)).collect(),
        lanes: own.lanes.iter().map(lane).collect(),
    }
}

fn lane(own: &OnLane) -> LaneJson<'_> {
    let shown = |all: &[f32]| all.iter().map(|x| format!("{x:?}")).collect();
    LaneJson {
        lane: own.lane,
        holds: own.holds,
        conforms: !own.deviates,
        actual: shown(&own.found.actual),
        expected: shown(&own.found.expected),
        words: own.found.words,
    }
}
