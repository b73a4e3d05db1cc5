//! `markdown`: a summary for the page of a CI job.

use std::fmt::Write;

use super::Format;
use super::items;
use super::not_run::NotRun;
use base::diagnostic::Severity;
use engine::suite::run::{Outcome, Standing, Status, Summary};

/// The format.
pub const FORMAT: Format = Format {
    name: "markdown",
    summary: "A summary for the page of a CI job",
    file: "summary.md",
    write: |summary| Ok(markdown(summary)),
};

/// Findings that are shown in full.
const SHOWN: usize = 20;

/// Totals, a table of suites and lanes, and the findings.
fn markdown(summary: &Summary) -> String {
    let totals = summary.totals();
    let word = match summary.status() {
        Status::Pass => "passed",
        Status::Fail => "failed",
        Status::Broken if totals.judged > 0 => "is incomplete",
        Status::Broken => "could not run",
    };
    let mut text = format!(
        "## shadercheck {word}\n\n{} samples judged, {} agreed, **{} deviated**, {} undetermined.\n\n",
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
    text.push_str(&super::reach::markdown(summary));
    let all = items::all(summary);
    for (severity, title) in [(Severity::Error, "Findings"), (Severity::Warning, "Warnings")] {
        let of: Vec<_> = all.iter().filter(|item| item.severity == severity).collect();
        if of.is_empty() {
            continue;
        }
        let _ = write!(text, "\n### {title}\n");
        for item in of.iter().take(SHOWN) {
            // A fence that is longer than any in the text.
            let fence = "`".repeat(3 + item.details.matches("```").count());
            let _ = write!(
                text,
                "\n<details><summary>{}</summary>\n\n{fence}text\n{}\n{fence}\n</details>\n",
                escaped(&item.message),
                item.details.trim()
            );
        }
        if of.len() > SHOWN {
            let _ = writeln!(text, "\n{} more are in the other reports.", of.len() - SHOWN);
        }
    }
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

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
