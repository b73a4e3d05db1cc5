//! The report for people: a line for each pair, then what differs and which of the two is the more accurate.

use std::fmt::Write as _;

use super::Summary;
use crate::word::readable;
use engine::InputValue;
use engine::compare::{Accuracy, Compared, OnLane, Resolution, SameBits, Unlike, Worst};

/// The report.
pub fn text(summary: &Summary, color: bool) -> String {
    let paint = |code: &'static str| if color { code } else { "" };
    let (good, bad, weak, off) = (paint("\u{1b}[32m"), paint("\u{1b}[31m"), paint("\u{1b}[33m"), paint("\u{1b}[0m"));
    let mut text = format!("first   {}\nsecond  {}\n", summary.texts[0], summary.texts[1]);
    for pair in &summary.pairs {
        let name = name(pair);
        let (mark, paint, says) = match (&pair.not_compared, pair.unlike.0) {
            (Some(why), _) => ("--    ", weak, format!("not compared: {why}")),
            (None, 0) if pair.weak().is_some() => ("weak  ", weak, equal(pair)),
            (None, 0) if !pair.is_known() => ("--    ", weak, equal(pair)),
            (None, 0) => ("equal ", good, equal(pair)),
            (None, _) => ("UNLIKE", bad, unlike(pair)),
        };
        let _ = writeln!(text, "\n{paint}{mark}{off}  {name:<20} {says}");
        if pair.is_known() {
            if let Some(smallest) = &pair.smallest {
                difference(&mut text, smallest);
            }
            details(&mut text, pair);
        }
    }
    let mut unpaired = summary.unpaired.iter().flatten().filter_map(|one| Some((one, one.why.as_ref()?))).peekable();
    if unpaired.peek().is_some() {
        text.push('\n');
    }
    for (one, why) in unpaired {
        let _ = writeln!(text, "{weak}--    {off}  {:<20} no partner: {why}", one.function);
    }
    // What a lane does not run is said once, whatever the number of functions.
    let mut not_run: Vec<(&str, Vec<&str>)> = Vec::new();
    for lane in summary.pairs.iter().flat_map(|pair| &pair.lanes) {
        let Some(why) = lane.not_run.as_deref() else { continue };
        match not_run.iter_mut().find(|(known, _)| *known == why) {
            Some((_, lanes)) if lanes.contains(&lane.lane) => {}
            Some((_, lanes)) => lanes.push(lane.lane),
            None => not_run.push((why, vec![lane.lane])),
        }
    }
    if !not_run.is_empty() {
        text.push('\n');
    }
    for (why, lanes) in not_run {
        let _ = writeln!(text, "not run on {}: {why}", lanes.join(", "));
    }
    let compared = summary.pairs.iter().filter(|pair| pair.is_known()).count();
    let differ = summary.pairs.iter().filter(|pair| pair.unlike.0 > 0).count();
    let rest = summary.pairs.len() - compared;
    let few = summary.pairs.iter().filter(|pair| pair.is_known() && pair.weak().is_some()).count();
    let few = if few == 0 { String::new() } else { format!(", {few} weak") };
    let _ = write!(text, "\n{compared} compared, {differ} unlike{few}, {rest} not compared");
    for (which, names) in ["first", "second"].iter().zip(&summary.unpaired) {
        let names: Vec<&str> = names.iter().filter(|one| one.why.is_none()).map(|one| one.function.as_str()).collect();
        if !names.is_empty() {
            let _ = write!(text, "; only in the {which}: {}", names.join(", "));
        }
    }
    text.push('\n');
    text
}

/// The functions of a pair: one name where they have one.
pub(super) fn name(pair: &Compared) -> String {
    match &pair.functions {
        [a, b] if a == b => a.clone(),
        [a, b] => format!("{a} = {b}"),
    }
}

pub(super) fn equal(pair: &Compared) -> String {
    let open: u64 = pair.undetermined.iter().map(|(_, count)| count).sum();
    let mut text = format!("{} of {} samples mean the same", pair.equal, pair.samples);
    if open > 0 {
        let reasons: Vec<String> =
            pair.undetermined.iter().map(|(reason, count)| format!("{count} {}", reason.name())).collect();
        let _ = write!(text, ", {open} undetermined ({})", reasons.join(", "));
    }
    text
}

pub(super) fn unlike(pair: &Compared) -> String {
    let (all, beyond) = pair.unlike;
    let open = pair.unbounded;
    let hidden = match (beyond, open) {
        (0, 0) => ", by no more than a conforming device may be off".to_owned(),
        (beyond, _) if beyond == all => String::new(),
        (0, open) if open == all => ", where nothing bounds what a conforming device may be off".to_owned(),
        (beyond, 0) => format!(", {beyond} of them by more than a conforming device may be off"),
        (beyond, open) => {
            format!(", {beyond} of them by more than a conforming device may be off, {open} where nothing bounds that")
        }
    };
    format!("{all} of {} samples mean something else{hidden}", pair.samples)
}

pub(super) fn difference(text: &mut String, smallest: &Unlike) {
    let _ = writeln!(text, "  differs    {}", smallest.message);
    if let Some([a, b]) = smallest.values
        && a.is_finite()
        && b.is_finite()
    {
        let _ = writeln!(
            text,
            "             by {}, {} of the larger",
            readable((a - b).abs()),
            readable((a - b).abs() / a.abs().max(b.abs()))
        );
    }
    let any = if smallest.realistic { "" } else { " (inputs of any size)" };
    let _ = writeln!(text, "  smallest   {}{any}", inputs(&smallest.inputs));
    let _ = writeln!(text, "  reproduce  {}", smallest.reproduce);
}

fn details(text: &mut String, pair: &Compared) {
    if !pair.alone.is_empty() {
        let _ = writeln!(text, "  outputs    only one of the two has {}", pair.alone.join(", "));
    }
    for accuracy in &pair.accuracy {
        bounds(text, accuracy);
    }
    if let Some([a, b]) = &pair.resolution {
        let of = |r: &Resolution| format!("{} of {}, {} steps reversed", r.distinct, r.inputs, r.reversed);
        let _ = writeln!(text, "  distinct   outputs of neighbouring inputs: first {}; second {}", of(a), of(b));
    }
    for lane in pair.lanes.iter().filter(|lane| lane.not_run.is_none()) {
        on_lane(text, lane);
    }
    for bits in &pair.same_bits {
        same_bits(text, bits);
    }
}

/// Operations of each side that are shown.
const PLACES: usize = 4;

pub(super) fn same_bits(text: &mut String, bits: &SameBits) {
    let SameBits { output, same, other, open, first, places } = bits;
    let all = same + other + open;
    let says = if bits.holds() {
        format!("the same on every conforming device in all {all} samples")
    } else {
        format!(
            "the same on every conforming device in {same} of {all} samples, {other} differ in strict binary32, {open} are left to devices"
        )
    };
    let _ = writeln!(text, "  same bits  `{output}`: {says}");
    if let Some((at, reproduce)) = first {
        let _ = writeln!(text, "             other bits at {}\n             reproduce  {reproduce}", inputs(at));
    }
    if bits.holds() {
        return;
    }
    for (which, places) in ["first", "second"].iter().zip(places) {
        for place in places.iter().take(PLACES) {
            let _ = writeln!(text, "             {which}: {}", crate::reproducible::of_place(place));
        }
        if places.len() > PLACES {
            let _ = writeln!(text, "             {which}: and {} more", places.len() - PLACES);
        }
    }
}

fn bounds(text: &mut String, accuracy: &Accuracy) {
    let Accuracy { profile, compared, better, alone, median_ratio, widest, gains } = accuracy;
    let at_most = |worst: &Option<Worst>, side: usize| match worst {
        Some(worst) => format!("{} ULP at {}", readable(worst.ulp[side]), inputs(&worst.inputs)),
        None => "none".to_owned(),
    };
    let part = |count: u64| 100.0 * count as f64 / (*compared).max(1) as f64;
    let median = median_ratio.map_or_else(String::new, |ratio| format!("; median first / second {ratio:.3}"));
    let _ = writeln!(
        text,
        "  bounds     by {profile}: the first is tighter in {:.1} % of {compared} samples, the second in {:.1} %{median}",
        part(better[0]),
        part(better[1])
    );
    for (which, count) in ["first", "second"].iter().zip(alone) {
        if *count > 0 {
            let _ = writeln!(text, "             {count} samples have a bound in the {which} alone");
        }
    }
    let _ = writeln!(text, "             widest: first {}", at_most(&widest[0], 0));
    let _ = writeln!(text, "             widest: second {}", at_most(&widest[1], 1));
    for (side, gain) in gains.iter().enumerate() {
        if let Some(Worst { inputs: at, ulp }) = gain {
            let which = ["first", "second"][side];
            let _ = writeln!(
                text,
                "             the {which} gains most at {}: {} against {} ULP",
                inputs(at),
                readable(ulp[side]),
                readable(ulp[1 - side])
            );
        }
    }
}

fn on_lane(text: &mut String, lane: &OnLane) {
    let says = match &lane.farthest {
        None if lane.samples == 0 => "no sample that means the same in both was run".to_owned(),
        None => format!("{} samples, all with the same bits", lane.samples),
        Some((far, at)) => {
            let far = if far.is_finite() { format!("{far} ULP apart") } else { "a number and none".to_owned() };
            format!("{} of {} samples with the same bits; at most {far} at {}", lane.same, lane.samples, inputs(at))
        }
    };
    let _ = writeln!(text, "  {:<10} {says}", lane.lane);
}

/// Inputs that are shown; a command has all of them.
const INPUTS: usize = 8;

/// `float x = 1.0; vec2 v = 1.0, 2.0`, or `x: f32 = 1.0; v: vec2f = 1.0, 2.0`
fn inputs(values: &[InputValue]) -> String {
    let one = |input: &InputValue| format!("{} = {}", input.shown(), input.values());
    let rest = values.len().saturating_sub(INPUTS);
    let more = if rest > 0 { format!("; … ({rest} more inputs)") } else { String::new() };
    let shown: Vec<String> = values.iter().take(INPUTS).map(one).collect();
    format!("{}{more}", shown.join("; "))
}
