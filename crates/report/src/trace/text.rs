//! The trace for people: a row for each number of each expression.

use std::fmt::Write as _;

use super::{Summary, words};
use crate::word::shortened;
use base::text::counted;
use base::value::{F32Bits, Scalar};
use engine::trace::{StepReport, TraceReport};
use judge::trace::TracedValue;
use judge::verdict::diagnosis::in_one_line;

/// Characters of an expression that are shown.
const EXPRESSION: usize = 34;
/// Output words that are shown without `--all`.
const OUTPUTS: usize = 16;
/// Steps that are shown without `--all`; of a longer trace the first and the last round of each expression, and what is
/// marked.
const SHOWN: usize = 60;

/// The report. All steps stand in it where `all` says so, else those that outputs depend on.
pub fn text(summary: &Summary, all: bool, color: bool) -> String {
    let mut text = String::new();
    for (k, trace) in summary.traces.iter().enumerate() {
        if k > 0 {
            text.push('\n');
        }
        one(&mut text, trace, all, color);
    }
    for (function, why) in &summary.not_traced {
        let _ = writeln!(text, "not traced: `{function}`: {why}");
    }
    text
}

fn one(text: &mut String, trace: &TraceReport, all: bool, color: bool) {
    let [bold, bad, off] = if color { ["\u{1b}[1m", "\u{1b}[31m", "\u{1b}[0m"] } else { ["", "", ""] };
    let _ = writeln!(text, "{bold}{}: `{}`{off}\n  case       {}", trace.at, trace.function, trace.why);
    let mut label = "inputs";
    for input in &trace.inputs {
        let _ = writeln!(text, "  {label:<10} {} = {}", input.shown(), input.values());
        label = "";
    }
    if let Some((at, mark)) = trace.origin() {
        let step = &trace.steps[at];
        let place = step.place.as_ref().map_or_else(|| "a step".to_owned(), |place| place.to_string());
        let _ = writeln!(text, "  {bold}origin     {place}: {}{off}", words(mark, &trace.profile));
    }
    let shown = shown(&trace.steps, all);
    let table: Vec<Vec<Row>> = shown.iter().map(|&at| rows(&trace.steps[at], trace)).collect();
    let head = heads(trace);
    let mut widths = vec![0; head.len()];
    for row in table.iter().flatten().chain([&head]) {
        row.iter().zip(&mut widths).for_each(|(cell, width)| *width = cell.chars().count().max(*width));
    }
    text.push('\n');
    line(text, &head, &widths, "");
    let mut before = None;
    for (&at, own) in shown.iter().zip(&table) {
        if before.is_some_and(|before: usize| trace.steps[before + 1..at].iter().any(|step| step.feeds)) {
            text.push_str("  …\n");
        }
        before = Some(at);
        let marks: Vec<String> = trace.steps[at].marks.iter().map(|mark| words(mark, &trace.profile)).collect();
        let note = if marks.is_empty() { String::new() } else { format!("  {bad}◀ {}{off}", marks.join("; ")) };
        let marked = worst(&trace.steps[at]).min(own.len() - 1);
        for (k, row) in own.iter().enumerate() {
            line(text, row, &widths, if k == marked { &note } else { "" });
        }
    }
    text.push('\n');
    outputs(text, trace, all);
    tail(text, trace, shown.len(), all);
}

/// The number of a step that is the farthest off: one that is none, else the one that lost most bits.
fn worst(step: &StepReport) -> usize {
    let off = |value: &TracedValue| if value.fits() { value.lost() } else { f64::INFINITY };
    let all = step.values.iter().enumerate();
    all.max_by(|a, b| off(a.1).total_cmp(&off(b.1)).then(b.0.cmp(&a.0))).map_or(0, |(k, _)| k)
}

/// Place, expression, binary32, real numbers, bits lost; then a cell for each lane.
type Row = Vec<String>;

fn heads(trace: &TraceReport) -> Row {
    let real = format!("real numbers ± {}", trace.profile);
    let own = ["at", "expression", "binary32", &real, "bits lost"];
    own.into_iter().chain(trace.lanes.iter().map(|(lane, _)| *lane)).map(str::to_owned).collect()
}

fn line(text: &mut String, cells: &Row, widths: &[usize], note: &str) {
    let mut own = String::from(" ");
    for (cell, width) in cells.iter().zip(widths) {
        let _ = write!(own, " {cell:<width$} ");
    }
    text.push_str(own.trim_end());
    text.push_str(note);
    text.push('\n');
}

/// The steps that are shown, by number.
fn shown(steps: &[StepReport], all: bool) -> Vec<usize> {
    let needed: Vec<usize> =
        (0..steps.len()).filter(|&at| all || steps[at].feeds || !steps[at].marks.is_empty()).collect();
    if all || needed.len() <= SHOWN {
        return needed;
    }
    let stands_out = |step: &StepReport| step.round == 1 || step.round == step.rounds || !step.marks.is_empty();
    needed.into_iter().filter(|&at| stands_out(&steps[at])).collect()
}

fn rows(step: &StepReport, trace: &TraceReport) -> Vec<Row> {
    let at = step.place.as_ref().and_then(|place| place.at.position).map_or_else(String::new, |at| at.to_string());
    let round = if step.rounds > 1 { format!(" #{}", step.round) } else { String::new() };
    let wrote = match (&step.place, &step.event) {
        (_, Some(event)) if !event.starts_with("comparison") => event.clone(),
        (Some(place), _) => shortened(&in_one_line(&place.text), EXPRESSION),
        (None, event) => event.clone().unwrap_or_else(|| "(no text of the author's)".to_owned()),
    };
    let count = step.values.len();
    let comparison = step.event.as_deref() == Some("comparison");
    let name = |k: usize| match count {
        0 | 1 => String::new(),
        _ if comparison => ["left", "right"].get(k).map_or_else(String::new, |side| (*side).to_owned()),
        2..=4 => format!(".{}", ["x", "y", "z", "w"][k]),
        _ => format!("[{k}]"),
    };
    let lane = |values: &Option<Vec<u32>>, k: usize| {
        values.as_ref().and_then(|values| values.get(k)).map_or_else(|| "–".to_owned(), |bits| number(*bits))
    };
    let numbers = |k: usize| -> Row {
        let value = step.values.get(k);
        let cell = |f: fn(&TracedValue) -> String| value.map_or_else(String::new, f);
        let own = [cell(|value| number(value.binary32)), cell(real), cell(lost)];
        let beside = (0..trace.lanes.len()).map(|on| step.lanes.get(on).map_or_else(String::new, |own| lane(own, k)));
        own.into_iter().chain(beside).collect()
    };
    let all: Vec<Row> = (0..count.max(1)).map(numbers).collect();
    // Components that are the same stand in one row.
    let same = count > 1 && !comparison && all.iter().all(|own| *own == all[0]);
    let shown = if same { 1 } else { all.len() };
    let row = |(k, numbers): (usize, Row)| {
        let name = if same { "(each)".to_owned() } else { name(k) };
        let text = if k > 0 { name } else { format!("{wrote}{round}  {name}").trim_end().to_owned() };
        [if k == 0 { at.clone() } else { String::new() }, text].into_iter().chain(numbers).collect()
    };
    all.into_iter().take(shown).enumerate().map(row).collect()
}

/// A binary32, of which NaN is called so.
fn number(bits: u32) -> String {
    if f32::from_bits(bits).is_nan() { "NaN".to_owned() } else { F32Bits(bits).to_string() }
}

fn real(value: &TracedValue) -> String {
    let Some(real) = value.real else { return "–".to_owned() };
    let shown = if real.value.is_nan() { "NaN".to_owned() } else { engine::fuzz::decimal(real.value) };
    match real.bound {
        0.0 => shown,
        bound if bound.is_finite() => format!("{shown} ± {bound:.0e}"),
        _ if real.value.is_finite() => format!("{shown} ± any"),
        _ => shown,
    }
}

fn lost(value: &TracedValue) -> String {
    value.real.map_or_else(String::new, |_| format!("{:.1}", value.lost()))
}

fn outputs(text: &mut String, trace: &TraceReport, all: bool) {
    let shown = if all { trace.outputs.len() } else { trace.outputs.len().min(OUTPUTS) };
    for output in &trace.outputs[..shown] {
        let value = match output.scalar {
            Scalar::F32 if !output.value.is_written() => "not written".to_owned(),
            Scalar::F32 => format!("{}, in real numbers {}", number(output.value.binary32), real(&output.value)),
            scalar => crate::word::word(output.value.binary32, scalar),
        };
        let bits = match output.value.lost() {
            lost if lost >= 0.05 && output.scalar == Scalar::F32 => format!(", {lost:.1} bits lost"),
            _ => String::new(),
        };
        let _ = writeln!(text, "  {} = {value}{bits}", output.name);
    }
    if shown < trace.outputs.len() {
        let _ = writeln!(text, "  … and {} more; `--all` shows them", trace.outputs.len() - shown);
    }
}

/// What was left out, and lanes that did not run.
fn tail(text: &mut String, trace: &TraceReport, shown: usize, all: bool) {
    let needed = trace.steps.iter().filter(|step| step.feeds).count();
    let idle = trace.steps.len() - needed;
    if !all && needed > shown {
        let _ =
            writeln!(text, "note: {} of loops left out; `--all` shows them", counted((needed - shown) as u64, "step"));
    }
    if !all && idle > 0 {
        let steps = counted(idle as u64, "step");
        let _ = writeln!(text, "note: {steps} left out that no output depends on; `--all` shows them");
    }
    if trace.cut {
        let _ = writeln!(text, "note: the trace ends early: it has room for {} steps of these", trace.steps.len());
    }
    if trace.endless {
        text.push_str("note: a loop goes on for too long here and was left; what comes after it is not known\n");
    }
    if trace.forked && !trace.lanes.is_empty() {
        text.push_str("note: a decision may fall either way on a device, so that no lane is held against the bounds\n");
    }
    for (lane, why) in &trace.lanes {
        if let Some(why) = why {
            let _ = writeln!(text, "note: not run on `{lane}`: {why}");
        }
    }
}
