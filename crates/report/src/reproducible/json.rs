//! The report for programs. Keys may be added; none is renamed.

use serde::Serialize;

use super::{Summary, key, kind, words};
use crate::fuzz::{Input, inputs};
use base::text::Location;
use engine::reproducible::{BitsReport, FreePlace, OutputBits};

#[derive(Serialize)]
struct Root<'a> {
    functions: Vec<Function<'a>>,
    not_run: Vec<NotRun<'a>>,
}

#[derive(Serialize)]
struct NotRun<'a> {
    function: &'a str,
    why: &'a str,
}

#[derive(Serialize)]
struct Function<'a> {
    function: &'a str,
    at: &'a str,
    profile: &'a str,
    samples: u64,
    left_out: u64,
    outputs: Vec<Output<'a>>,
    lanes: Vec<Lane<'a>>,
    /// Textures of which samples are taken: what a filter gives is left to devices.
    sampled: &'a [String],
}

#[derive(Serialize)]
struct Lane<'a> {
    lane: &'static str,
    not_run: Option<&'a str>,
}

/// Samples by what is known of them, and what leaves them open.
#[derive(Serialize)]
struct Output<'a> {
    name: &'a str,
    standing: &'static str,
    fixed: u64,
    fixed_by_precise: u64,
    edges: u64,
    free: u64,
    unknown: u64,
    /// `null` where nothing is free, and where nothing bounds it.
    spread_ulp: Option<f64>,
    spread_inputs: Option<Vec<Input<'a>>>,
    places: Vec<Place<'a>>,
    lanes: Vec<Differing<'a>>,
}

/// What leaves an output open.
#[derive(Serialize)]
pub(crate) struct Place<'a> {
    kind: &'static str,
    message: String,
    at: Option<&'a Location>,
    text: Option<&'a str>,
    samples: u64,
}

impl<'a> Place<'a> {
    pub(crate) fn of(own: &'a FreePlace) -> Self {
        let at = own.place.as_ref();
        Self {
            kind: kind(own.freedom),
            message: words(own),
            at: at.map(|at| &at.at),
            text: at.map(|at| &*at.text),
            samples: own.samples,
        }
    }
}

#[derive(Serialize)]
struct Differing<'a> {
    lane: &'static str,
    front_end: &'a str,
    samples: u64,
    fixed: u64,
    /// `null` for whole numbers, and where only one is a number.
    ulp: Option<f64>,
    inputs: Vec<Input<'a>>,
    reproduce: &'a str,
}

/// The report as one object, with a line break.
pub fn json(summary: &Summary) -> String {
    let not_run = summary.not_run.iter().map(|(function, why)| NotRun { function, why }).collect();
    let root = Root { functions: summary.functions.iter().map(one).collect(), not_run };
    serde_json::to_string_pretty(&root).unwrap_or_default() + "\n"
}

fn one(function: &BitsReport) -> Function<'_> {
    Function {
        function: &function.function,
        at: &function.at,
        profile: &function.profile,
        samples: function.samples,
        left_out: function.left_out,
        outputs: function.outputs.iter().map(output).collect(),
        lanes: function.lanes.iter().map(|own| Lane { lane: own.lane, not_run: own.not_run.as_deref() }).collect(),
        sampled: &function.sampled,
    }
}

fn output(output: &OutputBits) -> Output<'_> {
    let finite = |ulp: f64| ulp.is_finite().then_some(ulp);
    let lanes = output.apart.iter().map(|apart| Differing {
        lane: apart.lane,
        front_end: &apart.front_end,
        samples: apart.samples,
        fixed: apart.fixed,
        ulp: finite(apart.ulp),
        inputs: inputs(&apart.inputs),
        reproduce: &apart.reproduce,
    });
    Output {
        name: &output.name,
        standing: key(output.standing()),
        fixed: output.fixed,
        fixed_by_precise: output.pinned,
        edges: output.edges,
        free: output.free,
        unknown: output.unknown,
        spread_ulp: output.spread.as_ref().and_then(|(ulp, _)| finite(*ulp)),
        spread_inputs: output.spread.as_ref().map(|(_, own)| inputs(own)),
        places: output.places.iter().map(Place::of).collect(),
        lanes: lanes.collect(),
    }
}
