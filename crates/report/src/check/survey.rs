//! Bounds and warnings in reports.

use std::fmt::Write as _;

use serde_json::{Value, json};

use engine::suite::run::{Outcome, Summary};
use judge::verdict::{OfSample, Survey, Tightness, Worst};

/// A line for each warning.
pub(super) fn warnings(summary: &Summary) -> String {
    let mut text = String::new();
    for entry in &summary.entries {
        let Outcome::Ran(report) = &entry.outcome else { continue };
        for finding in report.warnings() {
            let _ =
                writeln!(text, "warning: {} on {}/{}: {}", report.suite, report.lane, report.stage, finding.message);
        }
    }
    text
}

/// The survey for programs.
pub(super) fn json(survey: &Survey) -> Value {
    let of_sample = |one: &OfSample| json!({"allowed": one.allowed, "as_written": one.as_written});
    let by_sample: Vec<Value> = survey.by_sample.iter().map(of_sample).collect();
    json!({
        "invocations": survey.invocations,
        "promise": tightness(&survey.promise),
        "measured": survey.measured.as_ref().map(tightness),
        "beyond_measured": {
            "samples": survey.beyond,
            "worst": survey.worst_beyond.as_ref().map(worst),
        },
        "as_written": survey.as_written.as_ref().map(tightness),
        "by_sample": by_sample,
    })
}

fn tightness(tightness: &Tightness) -> Value {
    let variables: Vec<Value> = tightness
        .variables
        .iter()
        .map(|variable| {
            json!({
                "name": variable.name,
                "words": variable.words,
                "median_over_largest": variable.median_over_largest,
            })
        })
        .collect();
    json!({
        "profile": tightness.profile,
        "words": tightness.words,
        "worst": tightness.worst.as_ref().map(worst),
        "median_relative": tightness.median_relative,
        "median_over_largest": tightness.median_over_largest(),
        "variables": variables,
    })
}

// JSON has no NaN and no infinity: they become null.
fn worst(worst: &Worst) -> Value {
    json!({
        "component": worst.component,
        "vertex": worst.vertex,
        "invocation": worst.invocation,
        "error": worst.error,
        "bound": worst.bound,
        "ratio": worst.ratio(),
    })
}
