//! A run of suites as services see it: a lane is a group of tests, and a suite a test in it.

use std::fmt::Write as _;

use super::items::{self, Told};
use super::not_run::NotRun;
use crate::ci::{Item, Run, Status as TestStatus, Test, escaped};
use base::diagnostic::Severity;
use engine::suite::run::{Entry, Expectation, Outcome, Standing, Status, Summary};

/// A run for the formats of [`crate::ci`].
pub fn ci(summary: &Summary) -> Run {
    let outcome = match summary.status() {
        Status::Pass => "passed",
        Status::Fail => "failed",
        Status::Broken if summary.totals().judged > 0 => "is incomplete",
        Status::Broken => "could not run",
    };
    let lanes = summary.shortcomings().into_iter().map(|(lane, why)| Test {
        group: lane.to_string(),
        name: "the lane".to_owned(),
        status: TestStatus::Broken(vec![lost(&why)]),
        ..Test::default()
    });
    Run {
        outcome: outcome.to_owned(),
        summary: table(summary),
        rest: rest(summary),
        items: items::all(summary),
        tests: summary.entries.iter().map(test).chain(lanes).collect(),
    }
}

/// A lane that was to run, and did not.
fn lost(why: &str) -> Item {
    Item {
        severity: Severity::Error,
        code: "lane".to_owned(),
        about: items::about("lane").unwrap_or_default(),
        message: why.to_owned(),
        details: String::new(),
        file: String::new(),
        at: None,
        identity: why.to_owned(),
    }
}

fn test(entry: &Entry) -> Test {
    let group = entry.on.map_or_else(|| "not run".to_owned(), |(lane, stage)| format!("{lane}/{stage}"));
    let all = items::of_entry(entry).into_iter().map(|Told { item, .. }| item);
    let (errors, warnings): (Vec<_>, Vec<_>) = all.partition(|item| item.severity == Severity::Error);
    let status = match &entry.outcome {
        Outcome::Ran(_) if !errors.is_empty() => TestStatus::Failed(errors),
        _ if !errors.is_empty() => TestStatus::Broken(errors),
        Outcome::Ran(_) if entry.standing() == Standing::NotRun => {
            TestStatus::Skipped(format!("not run: {}", entry.not_run().unwrap_or_default()))
        }
        Outcome::Ran(report) if !report.known.is_empty() => expected(&report.known[0].expectation),
        Outcome::KnownFailure { expectation, .. } => expected(expectation),
        Outcome::Ran(_) | Outcome::Refused(_) | Outcome::LaneFailed(_) => TestStatus::Passed,
    };
    let mut test = Test {
        group,
        name: entry.suite.clone(),
        file: entry.shader.clone(),
        status,
        warnings: warnings.iter().map(|item| item.details.trim().to_owned()).collect(),
        ..Test::default()
    };
    if let Outcome::Ran(report) = &entry.outcome {
        let verdicts = &report.verdicts;
        let weak = if entry.standing() == Standing::Weak { "weak: " } else { "" };
        test.output = format!(
            "{weak}{} judged, {} agreed, {} deviated, {} undetermined",
            report.judged(),
            verdicts.agreed,
            verdicts.deviated,
            verdicts.undetermined_count()
        );
        let facts = report.reach.as_ref().map(super::reach::facts).unwrap_or_default();
        test.properties = facts.into_iter().map(|(name, value)| (name.to_string(), value)).collect();
    }
    test
}

/// The formats have no word for a failure that is expected; other tools tell it as a test that is skipped.
fn expected(expectation: &Expectation) -> TestStatus {
    TestStatus::Skipped(format!("known failure: {expectation}"))
}

/// Totals, and a table of suites and lanes.
fn table(summary: &Summary) -> String {
    let totals = summary.totals();
    let mut text = format!(
        "{} samples judged, {} agreed, **{} deviated**, {} undetermined.\n\n",
        totals.judged, totals.agreed, totals.deviated, totals.undetermined
    );
    // Writing into a String does not fail.
    text.push_str("| | suite | lane | judged | deviated | undetermined | largest error |\n");
    text.push_str("|---|---|---|---:|---:|---:|---:|\n");
    for entry in &summary.entries {
        let on = entry.on.map_or_else(|| "-".to_owned(), |(lane, stage)| format!("{lane}/{stage}"));
        let rest = match &entry.outcome {
            Outcome::Ran(_) if entry.standing() == Standing::NotRun => "- | - | - | -".to_owned(),
            Outcome::Ran(report) => {
                let verdicts = &report.verdicts;
                let worst = if verdicts.agreed > 0 { format!("{:.1} ULP", verdicts.max_ulp) } else { "-".to_owned() };
                let undetermined = verdicts.undetermined_count();
                format!("{} | {} | {undetermined} | {worst}", report.judged(), verdicts.deviated)
            }
            Outcome::Refused(_) | Outcome::LaneFailed(_) | Outcome::KnownFailure { .. } => "- | - | - | -".to_owned(),
        };
        let mark = match entry.standing() {
            standing @ (Standing::Failed | Standing::LaneFailed) => format!("**{}**", standing.word()),
            standing => standing.word().to_owned(),
        };
        let _ = writeln!(text, "| {mark} | `{}` | {on} | {rest} |", entry.suite.replace('|', "\\|"));
    }
    text + &super::reach::markdown(summary)
}

/// Failures that are expected, and what did not run.
fn rest(summary: &Summary) -> String {
    let mut text = String::new();
    let known = summary.known();
    if !known.is_empty() {
        let _ = write!(text, "\n### Known failures\n\n");
        for (entry, kind, message, expectation) in known {
            let on = entry.on.map_or_else(String::new, |(lane, stage)| format!(" on {lane}/{stage}"));
            let _ = writeln!(
                text,
                "- `{}`{on}, {kind}: {}; {}",
                entry.suite,
                escaped(message),
                escaped(&expectation.to_string())
            );
        }
    }
    not_run(&mut text, summary);
    for (name, why) in &summary.unavailable {
        let _ = writeln!(text, "\nLane `{name}` did not run: {why}");
    }
    for (_, shortcoming) in summary.shortcomings() {
        let _ = writeln!(text, "\n**Incomplete**: {}", escaped(&shortcoming));
    }
    text
}

/// Suites of which a lane judged no sample, by lane and reason.
fn not_run(text: &mut String, summary: &Summary) {
    let all = super::not_run::by_cause(summary);
    if all.is_empty() {
        return;
    }
    let _ = write!(text, "\n### Not run\n\n");
    for NotRun { lane, why, suites } in all {
        let suites: Vec<String> = suites.iter().map(|suite| format!("`{suite}`")).collect();
        let _ = writeln!(text, "- on {lane}: {}: {}", escaped(&why), suites.join(", "));
    }
}
