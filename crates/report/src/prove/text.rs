//! The report for people: a line for each memory, then why, or with what.

use std::fmt::Write as _;

use super::Summary;
use base::text::counted;
use engine::InputValue;
use engine::prove::{Judged, ProofReport, Verdict};
use judge::verdict::diagnosis::Place;

use crate::word::shortened;

/// Characters of an expression that are shown.
const EXPRESSION: usize = 48;

/// The report.
pub fn text(summary: &Summary, color: bool) -> String {
    let mut text = String::new();
    for kernel in &summary.kernels {
        one(&mut text, kernel, color);
    }
    for (function, why) in &summary.not_run {
        let _ = writeln!(text, "not run: `{function}`: {why}\n");
    }
    let [verified, undecided, faults] = summary.counts();
    let all = verified + undecided + faults;
    let memories = if all == 1 { "1 memory".to_owned() } else { format!("{all} memories") };
    let kernels = counted(summary.kernels.len() as u64, "kernel");
    let _ = write!(text, "{memories} of {kernels}: {verified} verified for all sizes");
    if undecided > 0 {
        let _ = write!(text, ", {undecided} not decided");
    }
    if faults > 0 {
        let _ = write!(text, ", {} at fault", faults);
    }
    text.push('\n');
    text
}

fn one(text: &mut String, kernel: &ProofReport, color: bool) {
    let [bold, off] = if color { ["\u{1b}[1m", "\u{1b}[0m"] } else { ["", ""] };
    let _ = writeln!(text, "{bold}{}: `{}`{off}", kernel.at, kernel.function);
    let width = kernel.memories.iter().map(|own| own.name.chars().count()).max().unwrap_or(0).max(8);
    for own in &kernel.memories {
        memory(text, own, width);
    }
    if kernel.memories.is_empty() {
        let _ = writeln!(text, "  it touches no memory by an index");
    }
    let verified = kernel.memories.iter().any(|own| matches!(own.verdict, Verdict::Verified { .. }));
    for assumption in kernel.assumptions.iter().filter(|_| verified) {
        let _ = writeln!(text, "  assumed: {assumption}");
    }
    for place in &kernel.idle {
        let _ = writeln!(text, "  note: without the barrier {}, the same is verified", told(place));
    }
    text.push('\n');
}

fn memory(text: &mut String, own: &Judged, width: usize) {
    let name = &own.name;
    let mut line = |what: &str| {
        let _ = writeln!(text, "  {name:<width$}  {what}");
    };
    match &own.verdict {
        Verdict::Verified { conditions } if conditions.is_empty() => line("verified for all sizes"),
        Verdict::Verified { conditions } => {
            line(&format!("verified for all sizes, if {}", conditions.join(" and ")));
        }
        Verdict::Undecided { why, place, example } => {
            let at = place.as_ref().map_or_else(String::new, |place| format!(" ({})", told(place)));
            line(&format!("not decided: {why}{at}"));
            if let Some(finding) = example {
                let _ = writeln!(text, "  {:<width$}    depends on the host: {}", "", finding.message);
                with(text, &finding.inputs, width);
            }
        }
        Verdict::Fault(finding) => {
            line(&format!("fault: {}", finding.message));
            if let Some(place) = &finding.place {
                let _ = writeln!(text, "  {:<width$}    at {}", "", told(place));
            }
            with(text, &finding.inputs, width);
        }
    }
    if own.contradicted {
        let _ = writeln!(text, "  {:<width$}    the proof says otherwise: a defect of shadercheck, please report", "");
    }
}

/// What the host does in a dispatch that shows it.
fn with(text: &mut String, inputs: &[InputValue], width: usize) {
    let all: Vec<String> = inputs.iter().map(|own| format!("{} = {}", own.name, own.decimal.join(", "))).collect();
    if !all.is_empty() {
        let _ = writeln!(text, "  {:<width$}    with {}", "", all.join("; "));
    }
}

fn told(place: &Place) -> String {
    format!("{} `{}`", place.at, shortened(&place.text, EXPRESSION))
}
