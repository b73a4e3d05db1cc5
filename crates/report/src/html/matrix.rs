//! Suites in rows, lanes and their stages in columns.

use std::fmt::Write;

use super::escape::{Escaped, count};
use super::finding::blamed;
use super::known::{expected, failures};
use super::{Page, anchor, fails, suite_anchor, suites, way};
use engine::suite::run::{Entry, Outcome, Standing};

/// The table with its filters.
pub(super) fn matrix(text: &mut String, page: &Page<'_>) {
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
    let _ = write!(
        text,
        "<h2 id=\"matrix\">Suites and lanes</h2>\n<div class=\"filters\" role=\"group\" aria-label=\"Filter\">\
         <button type=\"button\" data-show=\"all\" aria-pressed=\"true\">All</button>\
         <button type=\"button\" data-show=\"fail\" aria-pressed=\"false\">Failing</button>\
         <label>Lane <select id=\"lane\"><option value=\"\">all</option>"
    );
    for lane in &lanes {
        let _ = write!(text, "<option value=\"{0}\">{0}</option>", Escaped(lane));
    }
    text.push_str(
        "</select></label><input id=\"search\" type=\"search\" placeholder=\"Search suites ( / )\" aria-label=\"Search\"></div>\n\
         <div class=\"wide\"><table class=\"matrix\" id=\"matrix-table\"><thead><tr><th scope=\"col\">Suite</th>",
    );
    for (way, lane) in &ways {
        let stage = way.strip_prefix(lane).unwrap_or(way).trim_start_matches('/');
        let (stage, lane) = (Escaped(stage), Escaped(lane));
        let _ = write!(text, "<th scope=\"col\" data-lane=\"{lane}\">{lane}<span>{stage}</span></th>");
    }
    text.push_str("</tr></thead><tbody>\n");
    for (name, numbers) in suites(summary) {
        row(text, page, name, &numbers, &ways);
    }
    text.push_str(
        "</tbody></table></div>\n<p id=\"none\" class=\"quiet\" hidden>No suite is like that.</p>\n<p class=\"key\">\
         <span><i style=\"background:var(--good)\"></i>agree</span>\
         <span><i style=\"background:var(--open)\"></i>undetermined: the sample is inconclusive</span>\
         <span><i style=\"background:var(--bad)\"></i>deviate</span>\
         <span><b>≈</b> fails as a expectations expects</span>\
         <span><b>∼</b> weak: more than half undetermined</span><span><b>–</b> not run</span></p>\n",
    );
}

fn row(text: &mut String, page: &Page<'_>, name: &str, numbers: &[usize], ways: &[(String, &str)]) {
    let entries: Vec<(usize, &Entry)> = numbers.iter().map(|&n| (n, &page.summary.entries[n])).collect();
    let failing = entries.iter().any(|(_, entry)| fails(entry));
    let refused = entries.iter().any(|(_, entry)| entry.on.is_none());
    let title = page.subjects.iter().find(|s| s.name == name).map_or("", |subject| subject.title.as_str());
    let words: Vec<String> = entries.iter().map(|(_, entry)| format!("{} {}", entry.shader, way(entry))).collect();
    let _ = write!(
        text,
        "<tr data-suite=\"{}\" data-state=\"{}\" data-refused=\"{refused}\" data-text=\"{}\"><th scope=\"row\">\
         <a href=\"#{}\">{}</a><span>{}</span></th>",
        suite_anchor(name),
        if failing { "fail" } else { "ok" },
        Escaped(format!("{name} {title} {}", words.join(" ")).to_lowercase()),
        suite_anchor(name),
        Escaped(name),
        Escaped(title)
    );
    if refused {
        let _ = writeln!(
            text,
            "<td colspan=\"{}\" data-state=\"fail\"><a class=\"cell fail\" href=\"#{}\"><span class=\"mark\">✕</span>\
             <b>does not run</b></a></td></tr>",
            ways.len().max(1),
            suite_anchor(name)
        );
        return;
    }
    for (way, lane) in ways {
        let found = entries.iter().find(|(_, entry)| self::way(entry) == *way);
        match found {
            Some((number, entry)) => cell(text, entry, *number, lane),
            None => {
                let _ = write!(text, "<td data-lane=\"{}\"></td>", Escaped(lane));
            }
        }
    }
    text.push_str("</tr>\n");
}

fn cell(text: &mut String, entry: &Entry, number: usize, lane: &str) {
    let known = expected(entry);
    let (state, mark) = match entry.standing() {
        Standing::Failed | Standing::LaneFailed => ("fail", "✕"),
        Standing::Passed => ("ok", "✓"),
        // It does not fail the run, and it is not right.
        Standing::Known => ("known", "≈"),
        Standing::Weak => ("known", "∼"),
        Standing::NotRun => ("known", "–"),
    };
    let _ = write!(
        text,
        "<td data-lane=\"{}\" data-state=\"{state}\"><a class=\"cell {state}\" href=\"#{}\"><span class=\"mark\">{mark}</span>",
        Escaped(lane),
        anchor(entry, number)
    );
    match &entry.outcome {
        Outcome::Ran(_) if entry.standing() == Standing::NotRun => {
            let why = entry.not_run().unwrap_or_default();
            let _ = write!(text, "<b>not run</b><span class=\"rest\">{}</span>", Escaped(why));
        }
        Outcome::Ran(report) => {
            let verdicts = &report.verdicts;
            let (deviated, open) = (verdicts.deviated, verdicts.undetermined_count());
            let headline = match (deviated, report.errors().len()) {
                (_, 0) if known > 0 => failures(known),
                (0, 0) if entry.standing() == Standing::Weak => format!("weak: {} agree", count(verdicts.agreed)),
                (0, 0) => format!("{} agree", count(verdicts.agreed)),
                (0, 1) => "1 finding".to_owned(),
                (0, n) => format!("{n} findings"),
                (n, _) => format!("{} deviate", count(n)),
            };
            let judged = count(report.judged());
            let rest = if open > 0 {
                format!("{judged} judged, {} undetermined", count(open))
            } else {
                format!("{judged} judged")
            };
            let part = |n: u64| 100.0 * n as f64 / verdicts.seen() as f64;
            let _ = write!(
                text,
                "<b>{headline}</b><span class=\"rest\">{rest}</span><span class=\"share\" aria-hidden=\"true\">\
                 <i style=\"width:{:.2}%\"></i>",
                part(verdicts.agreed)
            );
            for (class, n) in [("open", open), ("bad", deviated)] {
                if n > 0 {
                    let _ = write!(text, "<i class=\"{class}\" style=\"width:{:.2}%\"></i>", part(n));
                }
            }
            text.push_str("</span>");
            if let Some(blamed) = blamed(report) {
                let _ = write!(text, "<span class=\"rest\">fault: {}</span>", Escaped(blamed));
            }
        }
        Outcome::Refused(_) => text.push_str("<b>does not run</b>"),
        Outcome::LaneFailed(_) => text.push_str("<b>the lane failed</b>"),
        Outcome::KnownFailure { .. } => text.push_str("<b>fails as expected</b>"),
    }
    text.push_str("</a></td>");
}
