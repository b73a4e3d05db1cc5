//! The report for people: a line for each suite and lane, findings, totals.

use std::fmt::Write as _;

use super::block::one;
use crate::diagnostics;
use base::diagnostic::Lang;
use base::text::counted;
use engine::InputValue;
use engine::suite::run::{Entry, Finding, Outcome, Report, RunError, Standing, Status, Summary};
use judge::verdict::Reason;

/// Colours of a terminal; empty strings elsewhere.
pub(super) struct Style {
    pub good: &'static str,
    pub weak: &'static str,
    pub bad: &'static str,
    pub bold: &'static str,
    pub off: &'static str,
}

impl Style {
    pub(super) fn new(color: bool) -> Self {
        if color {
            let (good, weak, bad) = ("\u{1b}[32m", "\u{1b}[33m", "\u{1b}[31m");
            Self { good, weak, bad, bold: "\u{1b}[1m", off: "\u{1b}[0m" }
        } else {
            Self { good: "", weak: "", bad: "", bold: "", off: "" }
        }
    }

    /// The colour of what a suite came to.
    pub(super) fn of(&self, standing: Standing) -> &'static str {
        match standing {
            Standing::Passed | Standing::Known => self.good,
            Standing::NotRun | Standing::Weak => self.weak,
            Standing::Failed | Standing::LaneFailed => self.bad,
        }
    }
}

/// One line for a suite on a lane, with its line break.
pub fn line(entry: &Entry, color: bool) -> String {
    line_with(entry, None, color)
}

/// The same for a suite that is refused as `first` was, another variant of it.
pub fn line_as(entry: &Entry, first: &str, color: bool) -> String {
    line_with(entry, Some(format!("the same as {first}")), color)
}

/// What a refusal says whichever variant of its suite it is about; `None` for a suite that ran.
pub fn refusal(entry: &Entry) -> Option<(String, String)> {
    let Outcome::Refused(error) = &entry.outcome else { return None };
    let base = entry.suite.split_once('[')?.0.to_owned();
    Some((base.clone(), error.to_string().replace(&entry.suite, &base)))
}

fn line_with(entry: &Entry, instead: Option<String>, color: bool) -> String {
    let style = Style::new(color);
    let source = match &entry.outcome {
        Outcome::Ran(report) => report.source,
        Outcome::Refused(_) | Outcome::LaneFailed(_) | Outcome::KnownFailure { .. } => None,
    };
    let on = match (entry.on, source) {
        // The longest name of a source is longer than that of a stage.
        (Some((lane, _)), Some(source)) => format!("{:<17}", format!("{lane}/{}", source.name())),
        (Some((lane, stage)), None) => format!("{lane}/{stage}"),
        (None, _) => String::new(),
    };
    let text = match &entry.outcome {
        Outcome::Ran(report) => entry.not_run().unwrap_or_else(|| counts(report)),
        Outcome::Refused(error) => instead.unwrap_or_else(|| error.to_string()),
        Outcome::LaneFailed(message) | Outcome::KnownFailure { message, .. } => message.clone(),
    };
    let standing = entry.standing();
    let mark = standing.word();
    // A mark that is longer than usual takes its room from the blanks behind the name.
    let room = MARK.max(mark.len() + 1);
    let name = (MARK + NAME).saturating_sub(room);
    let blanks = room - mark.len();
    format!("{}{mark}{}{:blanks$}{:<name$} {on:<15}  {text}\n", style.of(standing), style.off, "", entry.suite)
}

/// Characters of a mark and the blanks behind it, and of the name of a suite.
const MARK: usize = 6;
const NAME: usize = 16;

/// Verdicts of a suite on a lane, counted.
fn counts(report: &Report) -> String {
    let verdicts = &report.verdicts;
    // Without a sample that agrees there is no error to tell.
    let worst = if verdicts.agreed > 0 { format!("{:.1}", verdicts.max_ulp) } else { "-".to_owned() };
    let checked: u64 = report.relations.iter().map(|(_, n)| n).sum();
    format!(
        "{:>8} judged  {:>8} agreed  {:>6} deviated  {:>6} undetermined  max {worst:>5} ULP  {} ({checked})",
        report.judged(),
        verdicts.agreed,
        verdicts.deviated,
        verdicts.undetermined_count(),
        counted(report.relations.len() as u64, "relation"),
    )
}

/// Everything that is wrong with the suite and lane of `entries[at]`; empty when nothing is. Findings
/// that the same suite has shown on an earlier lane or stage are not told again.
pub fn finding(entries: &[Entry], at: usize, color: bool) -> String {
    let entry = &entries[at];
    let mut text = String::new();
    match &entry.outcome {
        Outcome::Ran(report) => {
            let on = self::on(report);
            if let Some(earlier) = entries[..at].iter().find_map(|e| same_findings(e, report)) {
                let style = Style::new(color);
                let many = if report.errors().len() == 1 { "finding" } else { "findings" };
                let _ = writeln!(
                    text,
                    "\n{}{on}: the same {} {many} as on {}{}",
                    style.bold,
                    report.errors().len(),
                    place(earlier),
                    style.off
                );
                return text;
            }
            let errors = report.errors();
            for (k, finding) in errors.iter().enumerate() {
                let inputs = |f: &Finding| f.case.as_ref().map(|c| c.inputs.clone());
                let reported = inputs(finding).is_some() && errors[..k].iter().any(|f| inputs(f) == inputs(finding));
                one(&mut text, &on, &report.shader, finding, reported, color);
            }
        }
        Outcome::Refused(RunError::Shader { diagnostics, .. }) => {
            for diagnostic in diagnostics {
                text.push('\n');
                text.push_str(&diagnostics::text(diagnostic, Lang::En, color));
            }
            let _ = writeln!(
                text,
                "\nhelp: `shadercheck lint {}` tells more, and repairs what is often wrong",
                entry.shader
            );
        }
        Outcome::Refused(_) | Outcome::LaneFailed(_) | Outcome::KnownFailure { .. } => {}
    }
    text
}

/// What kept suites from running, for which a table has no room.
pub fn not_run(summary: &Summary, color: bool) -> String {
    let style = Style::new(color);
    let mut text = String::new();
    for entry in &summary.entries {
        let on = entry.on.map_or_else(String::new, |(lane, stage)| format!(" on {lane}/{stage}"));
        let why = match &entry.outcome {
            Outcome::LaneFailed(message) => format!("the lane failed: {message}"),
            // Diagnostics follow.
            Outcome::Refused(RunError::Shader { .. }) | Outcome::Ran(_) | Outcome::KnownFailure { .. } => continue,
            Outcome::Refused(error) => error.to_string(),
        };
        let _ = writeln!(text, "\n{}{}{on}: {why}{}", style.bold, entry.suite, style.off);
    }
    let notes = super::notes::not_run(summary);
    if !notes.is_empty() {
        let _ = write!(text, "\n{notes}");
    }
    text
}

/// Lane, stage and source of a report.
pub(super) fn place(report: &Report) -> String {
    let source = report.source.map_or_else(String::new, |source| format!(", {}", source.phrase()));
    format!("{}/{}{source}", report.lane, report.stage)
}

/// Suite, lane, stage and source of a report.
fn on(report: &Report) -> String {
    format!("{} on {}", report.suite, place(report))
}

/// The report of `entry` when it is of the same suite and shader and found exactly the same.
fn same_findings<'e>(entry: &'e Entry, report: &Report) -> Option<&'e Report> {
    let Outcome::Ran(earlier) = &entry.outcome else { return None };
    let reported = |r: &Report| -> Vec<(String, Option<Vec<InputValue>>)> {
        r.errors().iter().map(|f| (f.message.clone(), f.case.as_ref().map(|c| c.inputs.clone()))).collect()
    };
    let same =
        earlier.suite == report.suite && earlier.shader == report.shader && reported(earlier) == reported(report);
    (same && !report.errors().is_empty()).then_some(&**earlier)
}

/// The last lines: what lanes were held against, lanes that are missing, facts about coverage, totals.
pub fn totals(summary: &Summary, color: bool) -> String {
    let style = Style::new(color);
    let mut text = super::survey::warnings(summary);
    text.push_str(&super::notes::of_suites(summary));
    text.push_str(&end(summary, &style));
    text
}

/// The same where a table stands before it: what suites have in common is told once, and the rest is in the other
/// formats.
pub fn brief(summary: &Summary, color: bool) -> String {
    let style = Style::new(color);
    let mut text = super::survey::warnings(summary);
    let mut by_reason = [0; Reason::ALL.len()];
    for entry in &summary.entries {
        if let Outcome::Ran(report) = &entry.outcome {
            by_reason.iter_mut().zip(report.verdicts.undetermined).for_each(|(sum, n)| *sum += n);
        }
    }
    let some = Reason::ALL.iter().zip(by_reason).filter(|(_, n)| *n > 0);
    let parts: Vec<String> = some.map(|(reason, n)| format!("{n} {reason}")).collect();
    if !parts.is_empty() {
        let _ = writeln!(text, "note: undetermined: {}; `--plain` tells where", parts.join(", "));
    }
    text.push_str(&end(summary, &style));
    text
}

/// The last lines of both.
fn end(summary: &Summary, style: &Style) -> String {
    let mut text = super::notes::of_lanes(summary);
    text.push_str(&super::translations::notes(summary));
    text.push_str(&super::reach::notes(summary));
    for (name, why) in &summary.unavailable {
        let _ = writeln!(text, "note: lane `{name}` did not run: {why}");
    }
    let known = summary.known();
    for (entry, kind, message, expectation) in &known {
        let on = entry.on.map_or_else(String::new, |(lane, stage)| format!(" on {lane}/{stage}"));
        let _ = writeln!(text, "known: {}{on}: {kind}: {message}; expected: {expectation}", entry.suite);
    }
    for stale in &summary.stale {
        let _ = writeln!(text, "note: {stale}");
    }
    let t = summary.totals();
    let (word, paint) = match summary.status() {
        Status::Pass => ("pass", style.good),
        Status::Fail => ("fail", style.bad),
        Status::Broken if t.judged > 0 => ("incomplete", style.bad),
        Status::Broken => ("not run", style.bad),
    };
    let failures = match known.len() {
        0 => String::new(),
        1 => ", 1 known failure".to_owned(),
        n => format!(", {n} known failures"),
    };
    let _ = writeln!(
        text,
        "{paint}{word}{}: {} judged, {} agreed, {} deviated, {} undetermined, {} unsupported{failures}",
        style.off, t.judged, t.agreed, t.deviated, t.undetermined, t.unsupported
    );
    text
}
