//! The report for programs. Keys may be added; none is renamed.

use serde::Serialize;
use serde_json::{Map, Value};

use super::Summary;
use crate::fuzz::{Input, inputs};
use crate::reproducible::Place;
use engine::compare::{Accuracy, Compared, OnLane, Resolution, SameBits, Unlike, Unpaired, Worst};

#[derive(Serialize)]
struct Root<'a> {
    status: &'static str,
    first: &'a str,
    second: &'a str,
    seed: u64,
    pairs: Vec<Pair<'a>>,
    /// Functions that have no partner, by name.
    only_in_first: Vec<&'a str>,
    only_in_second: Vec<&'a str>,
    unpaired: Vec<Alone<'a>>,
}

/// A function without a partner.
#[derive(Serialize)]
pub(super) struct Alone<'a> {
    text: &'static str,
    function: &'a str,
    at: &'a str,
    why: &'a str,
}

#[derive(Serialize)]
pub(super) struct Pair<'a> {
    first: Function<'a>,
    second: Function<'a>,
    not_compared: Option<&'a str>,
    outputs_of_one: &'a [String],
    samples: u64,
    equal: u64,
    unlike: u64,
    beyond_bounds: u64,
    without_bounds: u64,
    weak: Option<&'static str>,
    undetermined: Map<String, Value>,
    smallest: Option<Smallest<'a>>,
    accuracy: Vec<Bounds<'a>>,
    resolution: Option<[Distinct; 2]>,
    lanes: Vec<Outputs<'a>>,
    /// For each output, where that was asked for.
    same_bits: Vec<Bits<'a>>,
}

/// Samples by what is known of the bits of an output, and what is left to devices in each of the two.
#[derive(Serialize)]
struct Bits<'a> {
    output: &'a str,
    holds: bool,
    same: u64,
    other: u64,
    open: u64,
    inputs: Option<Vec<Input<'a>>>,
    reproduce: Option<&'a str>,
    first: Vec<Place<'a>>,
    second: Vec<Place<'a>>,
}

#[derive(Serialize)]
struct Function<'a> {
    function: &'a str,
    at: &'a str,
}

#[derive(Serialize)]
struct Smallest<'a> {
    inputs: Vec<Input<'a>>,
    output: &'a str,
    message: &'a str,
    /// As text: JSON has neither NaN nor infinity.
    first: Option<String>,
    second: Option<String>,
    realistic: bool,
    reproduce: &'a str,
}

#[derive(Serialize)]
struct Bounds<'a> {
    profile: &'a str,
    samples: u64,
    first_tighter: u64,
    second_tighter: u64,
    only_first_bounded: u64,
    only_second_bounded: u64,
    median_ratio: Option<f64>,
    widest_first: Option<Sample<'a>>,
    widest_second: Option<Sample<'a>>,
    gain_first: Option<Sample<'a>>,
    gain_second: Option<Sample<'a>>,
}

#[derive(Serialize)]
struct Sample<'a> {
    inputs: Vec<Input<'a>>,
    /// As text: a bound may be infinite.
    ulp_first: String,
    ulp_second: String,
}

#[derive(Serialize)]
struct Distinct {
    inputs: u64,
    distinct: u64,
    reversed: u64,
}

#[derive(Serialize)]
struct Outputs<'a> {
    lane: &'a str,
    not_run: Option<&'a str>,
    samples: u64,
    same_bits: u64,
    /// As text: infinite where only one gives a number.
    farthest_ulp: Option<String>,
    farthest_inputs: Option<Vec<Input<'a>>>,
}

/// The report as one object, with a line break.
pub fn json(summary: &Summary) -> String {
    let fails = summary.pairs.iter().any(|pair| pair.unlike.0 > 0 || !pair.same_bits.iter().all(SameBits::holds))
        || !summary.pairs.iter().any(Compared::is_known);
    let names = |side: usize| summary.unpaired[side].iter().map(|one| one.function.as_str()).collect();
    let root = Root {
        status: if fails { "fail" } else { "pass" },
        first: &summary.texts[0],
        second: &summary.texts[1],
        seed: summary.seed,
        pairs: summary.pairs.iter().map(pair).collect(),
        only_in_first: names(0),
        only_in_second: names(1),
        unpaired: (0..2).flat_map(|side| summary.unpaired[side].iter().map(move |one| alone(side, one))).collect(),
    };
    // Strings, numbers and lists: there is nothing that could not be written.
    let mut text = serde_json::to_string_pretty(&root).unwrap_or_default();
    text.push('\n');
    text
}

pub(super) fn alone(side: usize, one: &Unpaired) -> Alone<'_> {
    let why = one.why.as_deref().unwrap_or("the other text has no function of this name");
    Alone { text: ["first", "second"][side], function: &one.function, at: &one.at, why }
}

pub(super) fn pair(pair: &Compared) -> Pair<'_> {
    let function = |side: usize| Function { function: &pair.functions[side], at: &pair.at[side] };
    Pair {
        first: function(0),
        second: function(1),
        not_compared: pair.not_compared.as_deref(),
        outputs_of_one: &pair.alone,
        samples: pair.samples,
        equal: pair.equal,
        unlike: pair.unlike.0,
        beyond_bounds: pair.unlike.1,
        without_bounds: pair.unbounded,
        weak: pair.weak().map(judge::verdict::Reason::name),
        undetermined: pair.undetermined.iter().map(|(reason, n)| (reason.name().to_owned(), (*n).into())).collect(),
        smallest: pair.smallest.as_ref().map(smallest),
        accuracy: pair.accuracy.iter().map(bounds).collect(),
        resolution: pair.resolution.as_ref().map(|both| both.each_ref().map(distinct)),
        lanes: pair.lanes.iter().map(outputs).collect(),
        same_bits: pair.same_bits.iter().map(bits).collect(),
    }
}

fn bits(of: &SameBits) -> Bits<'_> {
    let places = |side: usize| of.places[side].iter().map(Place::of).collect();
    Bits {
        output: &of.output,
        holds: of.holds(),
        same: of.same,
        other: of.other,
        open: of.open,
        inputs: of.first.as_ref().map(|(own, _)| inputs(own)),
        reproduce: of.first.as_ref().map(|(_, command)| command.as_str()),
        first: places(0),
        second: places(1),
    }
}

fn smallest(found: &Unlike) -> Smallest<'_> {
    let number = |side: usize| found.values.map(|values| format!("{:?}", values[side]));
    Smallest {
        inputs: inputs(&found.inputs),
        output: &found.output,
        message: &found.message,
        first: number(0),
        second: number(1),
        realistic: found.realistic,
        reproduce: &found.reproduce,
    }
}

fn bounds(of: &Accuracy) -> Bounds<'_> {
    Bounds {
        profile: &of.profile,
        samples: of.compared,
        first_tighter: of.better[0],
        second_tighter: of.better[1],
        only_first_bounded: of.alone[0],
        only_second_bounded: of.alone[1],
        median_ratio: of.median_ratio,
        widest_first: of.widest[0].as_ref().map(sample),
        widest_second: of.widest[1].as_ref().map(sample),
        gain_first: of.gains[0].as_ref().map(sample),
        gain_second: of.gains[1].as_ref().map(sample),
    }
}

fn sample(worst: &Worst) -> Sample<'_> {
    let [first, second] = worst.ulp.map(|ulp| format!("{ulp:?}"));
    Sample { inputs: inputs(&worst.inputs), ulp_first: first, ulp_second: second }
}

fn distinct(of: &Resolution) -> Distinct {
    Distinct { inputs: of.inputs, distinct: of.distinct, reversed: of.reversed }
}

fn outputs(lane: &OnLane) -> Outputs<'_> {
    Outputs {
        lane: lane.lane,
        not_run: lane.not_run.as_deref(),
        samples: lane.samples,
        same_bits: lane.same,
        farthest_ulp: lane.farthest.as_ref().map(|(far, _)| format!("{far:?}")),
        farthest_inputs: lane.farthest.as_ref().map(|(_, at)| inputs(at)),
    }
}
