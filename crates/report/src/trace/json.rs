//! The trace for programs. Keys may be added; none is renamed.

use serde::Serialize;

use super::{Summary, key, words};
use crate::fuzz::{Input, inputs};
use base::text::Location;
use base::value::F32Bits;
use engine::trace::{Mark, TraceReport};
use judge::trace::TracedValue;

#[derive(Serialize)]
struct Root<'a> {
    traces: Vec<TraceJson<'a>>,
    not_traced: Vec<NotTraced<'a>>,
}

#[derive(Serialize)]
struct NotTraced<'a> {
    function: &'a str,
    why: &'a str,
}

#[derive(Serialize)]
struct TraceJson<'a> {
    function: &'a str,
    at: &'a str,
    why: &'a str,
    inputs: Vec<Input<'a>>,
    profile: &'a str,
    lanes: Vec<Lane<'a>>,
    origin: Option<Origin<'a>>,
    steps: Vec<Step<'a>>,
    outputs: Vec<Output<'a>>,
    cut: bool,
    forked: bool,
    endless: bool,
}

#[derive(Serialize)]
struct Lane<'a> {
    lane: &'static str,
    not_run: Option<&'a str>,
}

/// The step at which it goes wrong.
#[derive(Serialize)]
struct Origin<'a> {
    step: usize,
    at: Option<&'a Location>,
    text: Option<&'a str>,
    #[serde(flatten)]
    mark: MarkJson,
}

#[derive(Serialize)]
struct MarkJson {
    kind: &'static str,
    message: String,
}

#[derive(Serialize)]
struct Step<'a> {
    at: Option<&'a Location>,
    text: Option<&'a str>,
    event: Option<&'a str>,
    round: usize,
    values: Vec<Value>,
    bits_lost: f64,
    own_bits_lost: f64,
    feeds: bool,
    marks: Vec<MarkJson>,
}

/// Numbers as text: JSON has neither NaN nor infinity.
#[derive(Serialize)]
struct Value {
    binary32: String,
    bits: String,
    real: Option<String>,
    bound: Option<String>,
    lanes: Vec<Option<String>>,
}

#[derive(Serialize)]
struct Output<'a> {
    name: &'a str,
    written: bool,
    #[serde(flatten)]
    value: Value,
    bits_lost: f64,
}

/// The report as one object, with a line break.
pub fn json(summary: &Summary) -> String {
    let not_traced = summary.not_traced.iter().map(|(function, why)| NotTraced { function, why }).collect();
    let root = Root { traces: summary.traces.iter().map(one).collect(), not_traced };
    serde_json::to_string_pretty(&root).unwrap_or_default() + "\n"
}

fn one(trace: &TraceReport) -> TraceJson<'_> {
    let mark = |mark: &Mark| MarkJson { kind: key(mark), message: words(mark, &trace.profile) };
    let at = |step: usize| trace.steps[step].place.as_ref();
    let steps = trace.steps.iter().map(|step| Step {
        at: step.place.as_ref().map(|place| &place.at),
        text: step.place.as_ref().map(|place| &*place.text),
        event: step.event.as_deref(),
        round: step.round,
        values: step.values.iter().enumerate().map(|(k, own)| value(own, lanes(&step.lanes, k))).collect(),
        bits_lost: step.lost,
        own_bits_lost: step.own_loss,
        feeds: step.feeds,
        marks: step.marks.iter().map(mark).collect(),
    });
    TraceJson {
        function: &trace.function,
        at: &trace.at,
        why: &trace.why,
        inputs: inputs(&trace.inputs),
        profile: &trace.profile,
        lanes: trace.lanes.iter().map(|(lane, why)| Lane { lane, not_run: why.as_deref() }).collect(),
        origin: trace.origin().map(|(step, own)| Origin {
            step,
            at: at(step).map(|place| &place.at),
            text: at(step).map(|place| &*place.text),
            mark: mark(own),
        }),
        steps: steps.collect(),
        outputs: trace
            .outputs
            .iter()
            .map(|output| Output {
                name: &output.name,
                written: output.value.is_written(),
                value: value(&output.value, Vec::new()),
                bits_lost: output.value.lost(),
            })
            .collect(),
        cut: trace.cut,
        forked: trace.forked,
        endless: trace.endless,
    }
}

fn lanes(all: &[Option<Vec<u32>>], component: usize) -> Vec<Option<String>> {
    all.iter().map(|values| Some(F32Bits(*values.as_ref()?.get(component)?).to_string())).collect()
}

fn value(own: &TracedValue, lanes: Vec<Option<String>>) -> Value {
    Value {
        binary32: F32Bits(own.binary32).to_string(),
        bits: format!("{:08x}", own.binary32),
        real: own.real.map(|real| format!("{:?}", real.value)),
        bound: own.real.map(|real| format!("{:?}", real.bound)),
        lanes,
    }
}
