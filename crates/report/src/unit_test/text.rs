//! For people: a line for each test, then what is wrong.

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
