//! What a run reached of the questions that shaders ask.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::suite::run::{Asked, Outcome, Reach, Report, Summary};

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

/// A line for the whole run, and one for each comparison that came out one way alone. It is a property of the shader and
/// its inputs: a suite is counted once, on whichever lane.
pub(super) fn notes(summary: &Summary) -> String {
    let mut reports: Vec<(&Report, &Reach)> = Vec::new();
    for entry in &summary.entries {
        if let Outcome::Ran(report) = &entry.outcome
            && let Some(reach) = &report.reach
            && !reports.iter().any(|(known, _)| (&known.suite, &known.shader) == (&report.suite, &report.shader))
        {
            reports.push((report, reach));
        }
    }
    let edges: u64 = reports.iter().map(|(_, reach)| reach.edges).sum();
    let sum = |of: fn(&Reach) -> (usize, usize)| {
        reports.iter().map(|(_, reach)| of(reach)).fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1))
    };
    let ((both, comparisons), (met, classes)) = (sum(Reach::comparisons), sum(Reach::classes));
    if edges == 0 && comparisons + classes == 0 {
        return String::new();
    }
    let mut parts = Vec::new();
    if comparisons > 0 {
        parts.push(format!("{both} of {comparisons} comparisons came out both ways"));
    }
    if classes > 0 {
        parts.push(format!("{met} of {classes} argument classes of built-in functions were met"));
    }
    parts.push(format!("{edges} more samples at edges"));
    let mut text = format!("note: coverage: {}\n", parts.join("; "));
    let one_sided: Vec<_> =
        reports.iter().flat_map(|(report, reach)| reach.one_sided().map(move |asked| (report, asked))).collect();
    for (report, asked) in one_sided.iter().take(NAMED) {
        let _ = writeln!(text, "note: {}: {asked}", report.suite);
    }
    if one_sided.len() > NAMED {
        let _ = writeln!(text, "note: {} more comparisons came out one way; JSON lists them", one_sided.len() - NAMED);
    }
    text
}
