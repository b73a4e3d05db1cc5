//! For people: a line for each test, then what is wrong.

use std::collections::BTreeMap;

use super::{Summary, TestReport};
use crate::diagnostics;
use base::diagnostic::{Lang, Severity};
use base::text::counted;

/// One line for a test, with its line break.
pub fn line(summary: &Summary, test: &TestReport, color: bool) -> String {
    let (mark, paint, words) = match &test.outcome {
        Err(why) => ("--  ", "\u{1b}[33m", format!("not run: {why}")),
        Ok(ran) => {
            let count = counted(ran.expectations.len() as u64, "expectation");
            match (summary.fails(test), test.may_fail() || ran.expectations.is_empty()) {
                (true, _) => ("FAIL", "\u{1b}[31m", count),
                (false, true) => ("warn", "\u{1b}[33m", count),
                (false, false) => ("ok  ", "\u{1b}[32m", count),
            }
        }
    };
    let (paint, off) = if color { (paint, "\u{1b}[0m") } else { ("", "") };
    format!("{paint}{mark}{off}  {:<28} {words}\n", test.name)
}

/// What is wrong, and how many tests came out in each way. Information is left out.
pub fn text(summary: &Summary, color: bool) -> String {
    let mut text = String::new();
    for found in summary.diagnostics().iter().filter(|found| found.severity != Severity::Info) {
        text.push('\n');
        text.push_str(&diagnostics::text(found, Lang::En, color));
    }
    let mut missing: BTreeMap<&str, (u64, &str)> = BTreeMap::new();
    let ran = summary.files.iter().flat_map(|file| &file.tests).filter_map(|test| test.outcome.as_ref().ok());
    for (lane, why) in ran.flat_map(|ran| &ran.not_run) {
        missing.entry(lane).or_insert((0, why)).0 += 1;
    }
    for (lane, (count, why)) in missing {
        text.push_str(&format!("\nnote: {lane} did not run {}: {}\n", counted(count, "test"), why.trim_end()));
    }
    let totals = summary.totals();
    let word = if totals.failed + totals.broken > 0 { "fail" } else { "ok" };
    let mut parts = vec![format!("{} passed", counted(totals.passed, "test"))];
    parts.push(format!("{} failed", totals.failed));
    if totals.not_run > 0 {
        parts.push(format!("{} not run", totals.not_run));
    }
    if totals.broken > 0 {
        let does = if totals.broken == 1 { "does" } else { "do" };
        parts.push(format!("{} {does} not compile", counted(totals.broken, "file")));
    }
    if totals.warnings > 0 {
        parts.push(counted(totals.warnings, "warning"));
    }
    text.push_str(&format!("\n{word}: {}\n", parts.join(", ")));
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit_test::FileReport;
    use base::text::{SourceFile, Span};
    use engine::unit_test::Ran;

    #[test]
    fn a_lane_that_did_not_run_a_test_is_told() {
        let file = SourceFile::new("a.wesl", "@test fn a() {}\n");
        let not_run = vec![("opengl", "it does not read WGSL".to_owned())];
        let test = |outcome| TestReport { name: "a".to_owned(), span: Span::new(9, 10), outcome };
        let summary = |not_run| {
            let tests = vec![test(Ok(Ran { expectations: Vec::new(), not_run }))];
            let files = vec![FileReport { file: file.clone(), notes: Vec::new(), errors: Vec::new(), tests }];
            Summary { files, profile: "vulkan-1.4".to_owned(), strict: false }
        };
        let told = text(&summary(not_run), false);
        assert!(told.contains("\nnote: opengl did not run 1 test: it does not read WGSL\n"), "{told}");
        assert!(!text(&summary(Vec::new()), false).contains("did not run"));
    }
}
