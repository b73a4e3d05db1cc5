//! A run of `fuzz` as services see it: a file is a group of tests, and a function a test in it.

use std::fmt::Write as _;

use super::text::{block, is_unstated, totals};
use super::{FileReport, Summary};
use crate::ci::{Item, Run, Status, Test, place as place_of};
use base::diagnostic::Severity;
use engine::fuzz::{self, Finding, FunctionReport};

/// A run for the formats of [`crate::ci`].
pub fn ci(summary: &Summary) -> Run {
    let counts = summary.totals();
    let failed = counts.findings + counts.broken > 0;
    let outcome = match (failed, summary.shortcomings().is_empty()) {
        (true, _) => "failed",
        (false, false) => "is incomplete",
        (false, true) if counts.run == 0 => "could not run",
        (false, true) => "passed",
    };
    Run {
        outcome: format!("fuzz {outcome}"),
        summary: table(summary),
        rest: rest(summary),
        items: summary.files.iter().flat_map(items).collect(),
        tests: summary.files.iter().flat_map(tests).collect(),
    }
}

/// What is wrong in a file: why it does not compile, and findings and warnings in its functions. One cause that arbitrary
/// inputs alone show comes once, at its first place.
fn items(file: &FileReport) -> Vec<Item> {
    let errors = file.errors.iter().map(Item::of);
    let mut causes: Vec<&str> = Vec::new();
    let mut found = Vec::new();
    for function in &file.functions {
        for finding in function.findings.iter().filter(|found| found.severity != fuzz::Severity::Note) {
            if let Some(cause) = finding.cause.as_deref().filter(|_| is_unstated(finding)) {
                if causes.contains(&cause) {
                    continue;
                }
                causes.push(cause);
            }
            found.push(item(file, function, finding));
        }
    }
    errors.chain(found).collect()
}

fn item(file: &FileReport, function: &FunctionReport, finding: &Finding) -> Item {
    let on = finding.lane.map_or_else(String::new, |lane| format!(" on {lane}"));
    let name = &function.function;
    let place = finding.place.as_ref().map(|place| &place.at);
    let position = place.and_then(|at| at.position).map(|at| (at.line, at.column));
    Item {
        severity: severity(finding),
        code: finding.kind.name().to_owned(),
        about: finding.kind.about(),
        message: format!("{name}{on}: {}", finding.message),
        details: block(function, finding),
        file: place.map_or_else(|| file.file.clone(), |at| at.file.clone()),
        at: position.or_else(|| place_of(&function.at).1),
        identity: format!("{name}: {}", finding.message),
    }
}

fn severity(finding: &Finding) -> Severity {
    match finding.severity {
        fuzz::Severity::Finding => Severity::Error,
        fuzz::Severity::Warning => Severity::Warning,
        fuzz::Severity::Note => Severity::Info,
    }
}

fn tests(file: &FileReport) -> Vec<Test> {
    let group = file.file.clone();
    let broken = (!file.errors.is_empty()).then(|| Test {
        group: group.clone(),
        name: "compiles".to_owned(),
        file: group.clone(),
        status: Status::Broken(file.errors.iter().map(Item::of).collect()),
        ..Test::default()
    });
    let function = |function: &FunctionReport| {
        let items = function.findings.iter().filter(|found| found.severity != fuzz::Severity::Note);
        let items = items.map(|found| item(file, function, found));
        let (errors, warnings): (Vec<Item>, Vec<Item>) = items.partition(|item| item.severity == Severity::Error);
        let status = match &function.not_run {
            _ if !errors.is_empty() => Status::Failed(errors),
            Some(why) => Status::Skipped(format!("not run: {why}")),
            None if !function.ran() => Status::Skipped("no lane runs it".to_owned()),
            None => Status::Passed,
        };
        Test {
            group: group.clone(),
            name: function.function.clone(),
            file: group.clone(),
            status,
            output: format!("{} samples, {} dispatches", function.samples, function.dispatches),
            warnings: warnings.iter().map(|item| item.details.trim().to_owned()).collect(),
            ..Test::default()
        }
    };
    broken.into_iter().chain(file.functions.iter().map(function)).collect()
}

/// The counts, and a row for each file in which something is wrong.
fn table(summary: &Summary) -> String {
    let mut text = totals(summary, false, false).lines().last().map_or_else(String::new, |line| format!("{line}.\n"));
    let of = |file: &FileReport, severity| file.functions.iter().map(|one| one.of(severity).count()).sum::<usize>();
    let mut head = "\n| file | functions | findings | warnings |\n|---|---:|---:|---:|\n";
    for file in &summary.files {
        let counts = [fuzz::Severity::Finding, fuzz::Severity::Warning].map(|severity| of(file, severity));
        if counts == [0, 0] && file.errors.is_empty() {
            continue;
        }
        let findings = if file.errors.is_empty() { counts[0].to_string() } else { "does not compile".to_owned() };
        // Writing into a String does not fail.
        let (name, many) = (file.file.replace('|', "\\|"), file.functions.len());
        let _ = writeln!(text, "{head}| `{name}` | {many} | {findings} | {} |", counts[1]);
        head = "";
    }
    text
}

/// What did not run.
fn rest(summary: &Summary) -> String {
    let mut text = String::new();
    for (name, why) in &summary.unavailable {
        let _ = writeln!(text, "\nLane `{name}` did not run: {why}");
    }
    for shortcoming in summary.shortcomings() {
        let _ = writeln!(text, "\n**Incomplete**: {}", crate::ci::escaped(&shortcoming));
    }
    text
}
