//! What a run reached of the questions that shaders ask.

use std::fmt::Write as _;

use serde_json::{Value, json};

use engine::suite::run::{Asked, Outcome, Reach, Report, Summary};

/// Comparisons that are named; the rest is counted.
const NAMED: usize = 4;

pub(super) fn json(reach: &Reach) -> Value {
    let asked = |asked: &Asked| {
        let Asked { at, text, expansion, operation, met, missed, comparison: _ } = asked;
        let mut value = json!({"at": at, "text": text, "operation": operation, "met": met, "missed": missed});
        super::json::expanded(&mut value, expansion.as_deref());
        value
    };
    let side =
        |comparison: bool| reach.asked.iter().filter(|a| a.comparison == comparison).map(asked).collect::<Value>();
    json!({
        "watched": reach.watched,
        "edges": reach.edges,
        "agreed": reach.agreed,
        "undetermined": reach.undetermined,
        "comparisons": side(true),
        "built_ins": side(false),
    })
}

/// What was reached of each suite, once: it is a property of the shader and its inputs, on whichever lane.
fn reached(summary: &Summary) -> Vec<(&Report, &Reach)> {
    let mut reports: Vec<(&Report, &Reach)> = Vec::new();
    for entry in &summary.entries {
        if let Outcome::Ran(report) = &entry.outcome
            && let Some(reach) = &report.reach
            && !reports.iter().any(|(known, _)| (&known.suite, &known.shader) == (&report.suite, &report.shader))
        {
            reports.push((report, reach));
        }
    }
    reports
}

/// What was reached together, in a line; none where the shaders ask nothing.
fn together(reports: &[(&Report, &Reach)]) -> Option<String> {
    let edges: u64 = reports.iter().map(|(_, reach)| reach.edges).sum();
    let sum = |of: fn(&Reach) -> (usize, usize)| {
        reports.iter().map(|(_, reach)| of(reach)).fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1))
    };
    let ((both, comparisons), (met, classes)) = (sum(Reach::comparisons), sum(Reach::classes));
    if edges == 0 && comparisons + classes == 0 {
        return None;
    }
    let mut parts = Vec::new();
    if comparisons > 0 {
        parts.push(format!("{both} of {comparisons} comparisons came out both ways"));
    }
    if classes > 0 {
        parts.push(format!("{met} of {classes} argument classes of built-in functions were met"));
    }
    parts.push(format!("{edges} more samples at edges"));
    Some(parts.join("; "))
}

/// The first few comparisons that came out one way alone, and a line that counts the rest.
fn one_sided(reports: &[(&Report, &Reach)]) -> Vec<String> {
    let all: Vec<_> =
        reports.iter().flat_map(|(report, reach)| reach.one_sided().map(move |asked| (report, asked))).collect();
    let mut lines: Vec<String> =
        all.iter().take(NAMED).map(|(report, asked)| format!("{}: {asked}", report.suite)).collect();
    if all.len() > NAMED {
        lines.push(format!("{} more comparisons came out one way; JSON lists them", all.len() - NAMED));
    }
    lines
}

/// A line for the whole run, and one for each comparison that came out one way alone.
pub(super) fn notes(summary: &Summary) -> String {
    let reports = reached(summary);
    let Some(together) = together(&reports) else { return String::new() };
    let mut text = format!("note: coverage: {together}\n");
    for line in one_sided(&reports) {
        let _ = writeln!(text, "note: {line}");
    }
    text
}

/// The same for the page of a CI job.
#[cfg(feature = "run")]
pub(super) fn markdown(summary: &Summary) -> String {
    let reports = reached(summary);
    let Some(together) = together(&reports) else { return String::new() };
    let mut text = format!("\nCoverage: {together}.\n");
    for (k, line) in one_sided(&reports).iter().enumerate() {
        let _ = writeln!(text, "{}- {line}", if k == 0 { "\n" } else { "" });
    }
    text
}

/// What was reached of one suite, as names and values; nothing where its shader asks nothing.
#[cfg(feature = "run")]
pub(crate) fn facts(reach: &Reach) -> Vec<(&'static str, String)> {
    let ((both, comparisons), (met, classes)) = (reach.comparisons(), reach.classes());
    let mut facts = Vec::new();
    if comparisons > 0 {
        facts.push(("comparisons both ways", format!("{both} of {comparisons}")));
    }
    if classes > 0 {
        facts.push(("argument classes met", format!("{met} of {classes}")));
    }
    facts
}
