//! Failures that are expected: what failed, why that is known, and where more is told.

use std::fmt::Write;

use super::escape::{Escaped, Message};
use super::{Page, anchor, way};
use engine::suite::run::{Entry, Expectation, Outcome};

/// How many failures of an entry are expected.
pub(super) fn expected(entry: &Entry) -> usize {
    match &entry.outcome {
        Outcome::Ran(report) => report.known.len(),
        Outcome::KnownFailure { .. } => 1,
        Outcome::Refused(_) | Outcome::LaneFailed(_) => 0,
    }
}

/// `1 known failure`, `3 known failures`.
pub(super) fn failures(n: usize) -> String {
    format!("{n} known {}", if n == 1 { "failure" } else { "failures" })
}

/// Why a failure is expected.
pub(super) fn because(text: &mut String, expectation: &Expectation) {
    let Expectation { at, reason, link } = expectation;
    let _ = write!(text, "Expected: {} (<code>{}</code>", Message(reason), Escaped(at));
    match link {
        // Nothing else is made a link of, `javascript:` for one.
        Some(link) if link.starts_with("https://") || link.starts_with("http://") => {
            let _ = write!(text, ", <a href=\"{0}\" rel=\"noreferrer\">{0}</a>", Escaped(link));
        }
        Some(link) => {
            let _ = write!(text, ", {}", Escaped(link));
        }
        None => {}
    }
    text.push(')');
}

/// All of them, each thing once, folded.
pub(super) fn known(text: &mut String, page: &Page<'_>) {
    let mut all: Vec<(&str, &str, &Expectation, Vec<String>)> = Vec::new();
    for (entry, _, message, expectation) in page.summary.known() {
        let number = page.summary.entries.iter().position(|other| std::ptr::eq(other, entry)).unwrap_or_default();
        let link = format!("<a href=\"#{}\">{}</a>", Escaped(anchor(entry, number)), Escaped(way(entry)));
        let same = |known: &&mut (&str, &str, &Expectation, Vec<String>)| {
            (known.0, known.1, known.2) == (entry.suite.as_str(), message, expectation)
        };
        match all.iter_mut().find(same) {
            Some(old) => old.3.push(link),
            None => all.push((&entry.suite, message, expectation, vec![link])),
        }
    }
    if all.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "<details class=\"plain\" id=\"known\"><summary>{}</summary>\n<ul class=\"wrongs\">",
        failures(all.len())
    );
    for (suite, message, expectation, links) in all {
        let _ = write!(
            text,
            "<li><span class=\"who known\">Known</span><div><p><b>{}</b>: {}</p><p class=\"more\">",
            Escaped(suite),
            Message(message)
        );
        because(text, expectation);
        let _ = writeln!(text, "; {}</p></div></li>", links.join(", "));
    }
    text.push_str("</ul></details>\n");
}
