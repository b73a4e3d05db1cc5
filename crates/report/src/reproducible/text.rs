//! The report for people: a line for each output, then what leaves it open.

use std::fmt::Write as _;

use super::{Summary, of_place};
use base::text::counted;
use engine::reproducible::{Apart, BitsReport, OutputBits, Standing};

/// Places of an output that are shown.
const SHOWN: usize = 6;

/// The report.
pub fn text(summary: &Summary, color: bool) -> String {
    let mut text = String::new();
    for function in &summary.functions {
        one(&mut text, function, color);
    }
    for (function, why) in &summary.not_run {
        let _ = writeln!(text, "not run: `{function}`: {why}\n");
    }
    lanes(&mut text, &summary.functions);
    let [fixed, edges, precise, free, unknown] = summary.counts();
    let all = fixed + edges + precise + free + unknown;
    let _ = write!(
        text,
        "{} of {}: {} fixed",
        counted(all as u64, "output"),
        counted(summary.functions.len() as u64, "function"),
        fixed + edges
    );
    for (count, what) in [(precise, "fixed if `precise`"), (free, "free"), (unknown, "not decided")] {
        if count > 0 {
            let _ = write!(text, ", {count} {what}");
        }
    }
    text.push('\n');
    text
}

fn one(text: &mut String, function: &BitsReport, color: bool) {
    let [bold, off] = if color { ["\u{1b}[1m", "\u{1b}[0m"] } else { ["", ""] };
    let left_out = match function.left_out {
        0 => String::new(),
        some => format!(", {some} left out for a loop that goes on for too long"),
    };
    let inputs = counted(function.samples, "input");
    let _ = writeln!(
        text,
        "{bold}{}: `{}`{off}  {inputs}{left_out}, by {}",
        function.at, function.function, function.profile
    );
    let width = function.outputs.iter().map(|output| output.name.chars().count()).max().unwrap_or(0).max(8);
    for output in &function.outputs {
        self::output(text, (function, output), width, color);
    }
    if !function.sampled.is_empty() {
        let names: Vec<String> = function.sampled.iter().map(|name| format!("`{name}`")).collect();
        let _ = writeln!(
            text,
            "  {:<width$}  of {} one texel is taken for each sample: what a filter gives is left to devices",
            "",
            names.join(", ")
        );
    }
    text.push('\n');
}

/// Lanes that did not run functions: each once for each reason.
fn lanes(text: &mut String, functions: &[BitsReport]) {
    let mut absent: Vec<(&str, &str, u64)> = Vec::new();
    let all = functions.iter().flat_map(|function| &function.lanes);
    for (lane, why) in all.filter_map(|own| Some((own.lane, own.not_run.as_deref()?))) {
        match absent.iter_mut().find(|(name, reason, _)| (*name, *reason) == (lane, why)) {
            Some((.., count)) => *count += 1,
            None => absent.push((lane, why, 1)),
        }
    }
    for (lane, why, count) in absent {
        let _ = writeln!(text, "`{lane}` did not run {}: {why}", counted(count, "function"));
    }
}

fn output(text: &mut String, (function, output): (&BitsReport, &OutputBits), width: usize, color: bool) {
    let paint = |code: &'static str| if color { code } else { "" };
    let (good, bad, weak, off) = (paint("\u{1b}[32m"), paint("\u{1b}[31m"), paint("\u{1b}[33m"), paint("\u{1b}[0m"));
    let spread = match &output.spread {
        Some((ulp, _)) if *ulp >= ALL && ulp.is_finite() => "two devices may differ in all digits".to_owned(),
        Some((ulp, _)) if ulp.is_finite() => format!("two devices may be {} ULP apart", short(*ulp)),
        Some(_) => "nothing bounds how far two devices may be apart".to_owned(),
        None => "two devices may differ".to_owned(),
    };
    let standing = output.standing();
    let says = match standing {
        Standing::Fixed => format!("{good}fixed{off}: the same bits on every conforming device"),
        Standing::FixedButForEdges => {
            format!("{good}fixed{off}, but for {}", counted(output.edges, "input"))
        }
        Standing::FixedByPrecise if function.has_precise => {
            format!("{weak}fixed if `precise`{off}; as it stands, {spread}")
        }
        Standing::FixedByPrecise => format!("{bad}free{off}: {spread}"),
        Standing::Free => format!("{bad}free{off}: {spread}"),
        Standing::Unknown => format!("{weak}not decided{off}: a comparison lies nearer than rounding"),
    };
    let _ = writeln!(text, "  {:<width$}  {says}", output.name);
    let mut note = |line: &str| {
        let _ = writeln!(text, "  {:<width$}    {line}", "");
    };
    for place in output.places.iter().take(SHOWN) {
        let often = match place.samples {
            all if all == function.samples => String::new(),
            some => format!(" ({some} of {})", function.samples),
        };
        note(&format!("{}{often}", of_place(place)));
    }
    if output.places.len() > SHOWN {
        note(&format!("and {} more", counted((output.places.len() - SHOWN) as u64, "place")));
    }
    if standing == Standing::Free && function.has_precise {
        let pinned = output.places.iter().filter(|place| place.freedom.is_pinned_by_precise()).count();
        if pinned > 0 {
            note(&format!("`precise` takes away {pinned} of {}", output.places.len()));
        }
    }
    if output.unknown > 0 && standing != Standing::Unknown {
        note(&format!("{} not decided", counted(output.unknown, "input")));
    }
    on_lanes(&mut note, &output.apart);
}

/// Where lanes differ; those that differ alike share a line.
fn on_lanes(note: &mut dyn FnMut(&str), all: &[Apart]) {
    let mut told: Vec<(Vec<String>, String)> = Vec::new();
    for apart in all.iter().filter(|apart| apart.fixed == 0) {
        let says = format!("other bits than strict binary32 for {}{}", counted(apart.samples, "input"), far(apart.ulp));
        let lane = format!("`{}`", apart.lane);
        match told.iter_mut().find(|(_, own)| *own == says) {
            Some((lanes, _)) => lanes.push(lane),
            None => told.push((vec![lane], says)),
        }
    }
    for (lanes, says) in told {
        note(&format!("{} {} {says}", lanes.join(", "), if lanes.len() == 1 { "has" } else { "have" }));
    }
    for apart in all.iter().filter(|apart| apart.fixed > 0) {
        note(&format!(
            "`{}` (by {}) has other bits for {}{}, {} of them where no device may: a fault of it or of what translates for \
             it, or sums that are not rounded to nearest",
            apart.lane,
            apart.front_end,
            counted(apart.samples, "input"),
            far(apart.ulp),
            apart.fixed
        ));
        note(&format!("reproduce  {}", apart.reproduce));
    }
}

fn far(ulp: f64) -> String {
    match ulp {
        ulp if !ulp.is_finite() => String::new(),
        ulp if ulp >= ALL => ", in all digits".to_owned(),
        ulp => format!(", by up to {} ULP", short(ulp)),
    }
}

/// ULP from which on no digit is left.
const ALL: f64 = (1 << 23) as f64;

/// A number as people read it.
fn short(x: f64) -> String {
    if x >= 100.0 { crate::word::readable(x.round()) } else { format!("{}", (x * 10.0).round() / 10.0) }
}
