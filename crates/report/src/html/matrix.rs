//! Suites in rows, lanes and their stages in columns.

use maud::{Markup, html};

use super::finding::blamed;
use super::known::{expected, failures};
use super::text::count;
use super::{Page, anchor, fails, suite_anchor, suites, way};
use engine::suite::run::{Entry, Outcome, Report, Standing};

/// The table with its filters.
pub(super) fn matrix(page: &Page<'_>) -> Markup {
    let summary = page.summary;
    let mut ways: Vec<(String, &str)> = Vec::new();
    for entry in &summary.entries {
        if let (way, Some((lane, _))) = (way(entry), entry.on)
            && !ways.iter().any(|(known, _)| *known == way)
        {
            ways.push((way, lane));
        }
    }
    // Columns of a lane stand together, in the order in which lanes ran.
    let order = |lane: &str| summary.lanes.iter().position(|used| used.description.name == lane);
    ways.sort_by_key(|(_, lane)| order(lane));
    let mut lanes: Vec<&str> = ways.iter().map(|(_, lane)| *lane).collect();
    lanes.dedup();
    html! {
        h2 id="matrix" { "Suites and lanes" }
        div.filters role="group" aria-label="Filter" {
            button type="button" data-show="all" aria-pressed="true" { "All" }
            button type="button" data-show="fail" aria-pressed="false" { "Failing" }
            label {
                "Lane "
                select id="lane" {
                    option value="" { "all" }
                    @for lane in &lanes { option value=(lane) { (lane) } }
                }
            }
            input id="search" type="search" placeholder="Search suites ( / )" aria-label="Search";
        }
        div.wide {
            table.matrix id="matrix-table" {
                thead {
                    tr {
                        th scope="col" { "Suite" }
                        @for (way, lane) in &ways {
                            @let stage = way.strip_prefix(lane).unwrap_or(way).trim_start_matches('/');
                            th scope="col" data-lane=(lane) { (lane) span { (stage) } }
                        }
                    }
                }
                tbody { @for (name, numbers) in suites(summary) { (row(page, name, &numbers, &ways)) } }
            }
        }
        p.quiet id="none" hidden { "No suite is like that." }
        p.key {
            span { i style="background:var(--good)" {} "agree" }
            span { i style="background:var(--open)" {} "undetermined: the sample is inconclusive" }
            span { i style="background:var(--bad)" {} "deviate" }
            span { b { "≈" } " fails as an expectation says" }
            span { b { "∼" } " weak: more than half undetermined" }
            span { b { "–" } " not run" }
        }
    }
}

fn row(page: &Page<'_>, name: &str, numbers: &[usize], ways: &[(String, &str)]) -> Markup {
    let entries: Vec<(usize, &Entry)> = numbers.iter().map(|&n| (n, &page.summary.entries[n])).collect();
    let failing = entries.iter().any(|(_, entry)| fails(entry));
    let refused = entries.iter().any(|(_, entry)| entry.on.is_none());
    let title = page.subjects.iter().find(|s| s.name == name).map_or("", |subject| subject.title.as_str());
    let words: Vec<String> = entries.iter().map(|(_, entry)| format!("{} {}", entry.shader, way(entry))).collect();
    let text = format!("{name} {title} {}", words.join(" ")).to_lowercase();
    let state = if failing { "fail" } else { "ok" };
    html! {
        tr data-suite=(suite_anchor(name)) data-state=(state) data-refused=(refused) data-text=(text) {
            th scope="row" { a href={ "#" (suite_anchor(name)) } { (name) } span { (title) } }
            @if refused {
                td colspan=(ways.len().max(1)) data-state="fail" {
                    a.cell.fail href={ "#" (suite_anchor(name)) } { span.mark { "✕" } b { "does not run" } }
                }
            } @else {
                @for (way, lane) in ways {
                    @match entries.iter().find(|(_, entry)| self::way(entry) == *way) {
                        Some((number, entry)) => { (cell(entry, *number, lane)) }
                        None => { td data-lane=(lane) {} }
                    }
                }
            }
        }
    }
}

fn cell(entry: &Entry, number: usize, lane: &str) -> Markup {
    let (state, mark) = match entry.standing() {
        Standing::Failed | Standing::LaneFailed => ("fail", "✕"),
        Standing::Passed => ("ok", "✓"),
        // It does not fail the run, and it is not right.
        Standing::Known => ("known", "≈"),
        Standing::Weak => ("known", "∼"),
        Standing::NotRun => ("known", "–"),
    };
    html! {
        td data-lane=(lane) data-state=(state) {
            a class={ "cell " (state) } href={ "#" (anchor(entry, number)) } {
                span.mark { (mark) }
                @match &entry.outcome {
                    Outcome::Ran(_) if entry.standing() == Standing::NotRun => {
                        b { "not run" } span.rest { (entry.not_run().unwrap_or_default()) }
                    }
                    Outcome::Ran(report) => { (judged(entry, report)) }
                    Outcome::Refused(_) => { b { "does not run" } }
                    Outcome::LaneFailed(_) => { b { "the lane failed" } }
                    Outcome::KnownFailure { .. } => { b { "fails as expected" } }
                }
            }
        }
    }
}

/// How many samples agree, and the parts of them that do not.
fn judged(entry: &Entry, report: &Report) -> Markup {
    let verdicts = &report.verdicts;
    let (deviated, open) = (verdicts.deviated, verdicts.undetermined_count());
    let known = expected(entry);
    let headline = match (deviated, report.errors().len()) {
        (_, 0) if known > 0 => failures(known),
        (0, 0) if entry.standing() == Standing::Weak => format!("weak: {} agree", count(verdicts.agreed)),
        (0, 0) => format!("{} agree", count(verdicts.agreed)),
        (0, 1) => "1 finding".to_owned(),
        (0, n) => format!("{n} findings"),
        (n, _) => format!("{} deviate", count(n)),
    };
    let width = |n: u64| format!("width:{:.2}%", 100.0 * n as f64 / verdicts.seen() as f64);
    html! {
        b { (headline) }
        span.rest { (count(report.judged())) " judged" @if open > 0 { ", " (count(open)) " undetermined" } }
        span.share aria-hidden="true" {
            i style=(width(verdicts.agreed)) {}
            @if open > 0 { i.open style=(width(open)) {} }
            @if deviated > 0 { i.bad style=(width(deviated)) {} }
        }
        @if let Some(blamed) = blamed(report) { span.rest { "fault: " (blamed) } }
    }
}
