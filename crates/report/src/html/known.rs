//! Failures that are expected: what failed, why that is known, and where more is told.

use maud::{Markup, html};

use super::text::{Message, commas};
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
pub(super) fn because(expectation: &Expectation) -> Markup {
    let Expectation { at, reason, link } = expectation;
    html! {
        "Expected: " (Message(reason)) " (" code { (at) }
        @match link {
            // Nothing else is made a link of, `javascript:` for one.
            Some(link) if link.starts_with("https://") || link.starts_with("http://") => {
                ", " a href=(link) rel="noreferrer" { (link) }
            }
            Some(link) => { ", " (link) }
            None => {}
        }
        ")"
    }
}

/// All of them, each thing once, folded.
pub(super) fn known(page: &Page<'_>) -> Markup {
    let mut all: Vec<(&str, &str, &Expectation, Vec<Markup>)> = Vec::new();
    for (entry, _, message, expectation) in page.summary.known() {
        let number = page.summary.entries.iter().position(|other| std::ptr::eq(other, entry)).unwrap_or_default();
        let link = html! { a href={ "#" (anchor(entry, number)) } { (way(entry)) } };
        let same = |known: &&mut (&str, &str, &Expectation, Vec<Markup>)| {
            (known.0, known.1, known.2) == (entry.suite.as_str(), message, expectation)
        };
        match all.iter_mut().find(same) {
            Some(old) => old.3.push(link),
            None => all.push((&entry.suite, message, expectation, vec![link])),
        }
    }
    html! {
        @if !all.is_empty() {
            details.plain id="known" {
                summary { (failures(all.len())) }
                ul.wrongs {
                    @for (suite, message, expectation, links) in all {
                        li {
                            span.who.known { "Known" }
                            div {
                                p { b { (suite) } ": " (Message(message)) }
                                p.more { (because(expectation)) "; " (commas(&links)) }
                            }
                        }
                    }
                }
            }
        }
    }
}
