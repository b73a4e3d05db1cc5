//! The page as a whole: its head, what is wrong, and what comes after.

use maud::{DOCTYPE, Markup, PreEscaped, display, html};

use super::finding::{how_many, who};
use super::text::{Message, commas, count, printable, script};
use super::{Page, anchor, fails, suites, way};
use engine::suite::run::{Finding, FindingKind, Outcome, RunError, Status};

const STYLE: &str = include_str!("style.css");
const SCRIPTS: [&str; 4] =
    [include_str!("script.js"), include_str!("scene.js"), include_str!("viewer.js"), include_str!("map.js")];

/// Nothing outside of the page is ever asked for.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";

pub(super) fn page(page: &Page<'_>) -> String {
    let status = match page.summary.status() {
        Status::Pass => "passed",
        Status::Fail => "failed",
        Status::Broken if page.summary.totals().judged > 0 => "is incomplete",
        Status::Broken => "could not run",
    };
    let body = html! {
        (printable(text(page)))
        script type="application/json" id="data" { (script(&super::data::data(page))) }
        script { @for part in SCRIPTS { (PreEscaped(part)) } }
    };
    document(status, &body)
}

/// A page with this body. Its title says what it is about.
pub(super) fn document(about: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                title { "shadercheck " (about) }
                style { (PreEscaped(STYLE)) }
            }
            body { (body) }
        }
    };
    page.into_string()
}

/// What is read on the page, from its top to its end.
fn text(page: &Page<'_>) -> Markup {
    let all = suites(page.summary);
    let first_failing = all.iter().position(|(_, numbers)| numbers.iter().any(|&n| fails(&page.summary.entries[n])));
    html! {
        a.skip href="#matrix" { "To the table of suites" }
        (hero(page))
        (wrongs(page))
        (super::known::known(page))
        (super::matrix::matrix(page))
        h2 id="suites" { "Suites" }
        @for (k, (name, numbers)) in all.iter().enumerate() {
            (super::suite::suite(page, name, numbers, k == first_failing.unwrap_or(0)))
        }
        (super::lanes::lanes(page))
        @if let Some(mutations) = page.mutations { (super::mutations::mutations(mutations)) }
        footer {
            "shadercheck " (env!("CARGO_PKG_VERSION")) ", seed " (page.summary.seed)
            ". The charts are beside this page in " code { "plots" } "; the same run for programs is in "
            code { "report.json" } "."
        }
    }
}

fn hero(page: &Page<'_>) -> Markup {
    let summary = page.summary;
    let totals = summary.totals();
    let all = suites(summary);
    let failing = all.iter().filter(|(_, numbers)| numbers.iter().any(|&n| fails(&summary.entries[n]))).count();
    let suites = |n: usize| if n == 1 { "suite" } else { "suites" };
    let headline = match (summary.status(), failing) {
        (Status::Pass, _) if all.len() == 1 => "The suite passes".to_owned(),
        (Status::Pass, _) => format!("All {} suites pass", all.len()),
        (Status::Fail, 1) if all.len() == 1 => "The suite fails".to_owned(),
        (Status::Fail, 1) => format!("1 of {} {} fails", all.len(), suites(all.len())),
        (Status::Fail, n) => format!("{n} of {} {} fail", all.len(), suites(all.len())),
        (Status::Broken, _) if !summary.shortcomings().is_empty() => "The run is incomplete".to_owned(),
        (Status::Broken, 0) => "Nothing was judged".to_owned(),
        (Status::Broken, n) => format!("{n} of {} {} could not run", all.len(), suites(all.len())),
    };
    let lanes = summary.lanes.iter().map(|used| &used.description);
    let lanes: Vec<Markup> = lanes.map(|lane| html! { b { (lane.name) } " (" (lane.driver) ")" }).collect();
    html! {
        div.top {
            span { b { "shadercheck" } }
            button id="theme" type="button" aria-label="Light or dark page" { "Dark" }
        }
        header.hero.fail[summary.status() != Status::Pass] {
            h1 { (headline) }
            p.quiet { "on " (commas(&lanes)) }
            dl.figures {
                div { dt { "samples judged" } dd { (count(totals.judged)) } }
                div { dt { "agree" } dd { (count(totals.agreed)) } }
                div class=[(totals.deviated > 0).then_some("bad")] { dt { "deviate" } dd { (count(totals.deviated)) } }
                div { dt { "undetermined" } dd { (count(totals.undetermined)) } }
                @if totals.unsupported > 0 { div { dt { "not supported" } dd { (count(totals.unsupported)) } } }
            }
        }
        @for (name, why) in &summary.unavailable { p.quiet { "Lane " b { (name) } " did not run: " (display(why)) "." } }
        @for (_, shortcoming) in summary.shortcomings() { p { b { "Incomplete" } ": " (shortcoming) "." } }
    }
}

/// One thing that is wrong, wherever it shows.
struct Wrong {
    suite: String,
    who: String,
    message: String,
    at: Option<String>,
    many: Option<String>,
    on: Vec<(String, String)>,
    warning: bool,
    /// It follows from outputs that deviate.
    follows: bool,
}

/// What is wrong, each thing once, errors first.
fn wrongs(page: &Page<'_>) -> Markup {
    let mut all: Vec<Wrong> = Vec::new();
    let mut add = |new: Wrong| {
        let same = |old: &&mut Wrong| (&old.suite, &old.who, &old.message) == (&new.suite, &new.who, &new.message);
        match all.iter_mut().find(same) {
            Some(old) => old.on.extend(new.on),
            None => all.push(new),
        }
    };
    for (number, entry) in page.summary.entries.iter().enumerate() {
        let on = vec![(way(entry), anchor(entry, number))];
        let plain = |who: &str, message: String, at: Option<String>| Wrong {
            suite: entry.suite.clone(),
            who: who.to_owned(),
            message,
            at,
            many: None,
            follows: false,
            on: on.clone(),
            warning: false,
        };
        match &entry.outcome {
            Outcome::Ran(report) => {
                let deviates = report.findings.iter().any(|f| f.kind == FindingKind::Deviation);
                for finding in &report.findings {
                    add(Wrong {
                        at: place(finding),
                        many: how_many(finding),
                        follows: deviates && finding.kind == FindingKind::Relation,
                        warning: finding.kind.is_warning(),
                        ..plain(&who(finding, report.lane), finding.message.clone(), None)
                    });
                }
            }
            Outcome::Refused(RunError::Shader { diagnostics, .. }) => {
                for d in diagnostics {
                    let at = d.file.locate(d.span.start);
                    add(plain("Does not compile", format!("{} [{}]", d.message, lint::with_name(d.code.0)), Some(at)));
                }
            }
            Outcome::Refused(error) => add(plain("Cannot run", error.to_string(), None)),
            Outcome::LaneFailed(message) => add(plain("The lane failed", message.clone(), None)),
            Outcome::KnownFailure { .. } => {}
        }
    }
    let part = |warning: bool, follows: bool| {
        let some: Vec<&Wrong> = all.iter().filter(|w| (w.warning, w.follows) == (warning, follows)).collect();
        let list = html! { ul.wrongs { @for wrong in &some { (item(wrong)) } } };
        let summary = match (some.len(), warning, follows) {
            (0, _, _) => return Markup::default(),
            (_, false, false) => return html! { h2 { "What is wrong" } (list) },
            (1, false, true) => "1 relation does not hold for outputs that deviate".to_owned(),
            (n, false, true) => format!("{n} relations do not hold for outputs that deviate"),
            (1, true, _) => "1 warning".to_owned(),
            (n, true, _) => format!("{n} warnings"),
        };
        html! { details.plain { summary { (summary) } (list) } }
    };
    html! { (part(false, false)) (part(false, true)) (part(true, false)) }
}

fn item(wrong: &Wrong) -> Markup {
    let link = |(way, anchor): &(String, String)| {
        let way = if way.is_empty() { "details" } else { way };
        html! { a href={ "#" (anchor) } { (way) } }
    };
    html! {
        li {
            span.who.warning[wrong.warning] { (wrong.who) }
            div {
                p { b { (wrong.suite) } ": " (Message(&wrong.message)) }
                p.more {
                    @if let Some(at) = &wrong.at { "at " code { (at) } "; " }
                    @if let Some(many) = &wrong.many { (many) "; " }
                    (commas(&wrong.on.iter().map(link).collect::<Vec<_>>()))
                }
            }
        }
    }
}

/// Where a finding shows first in the author's text.
pub(super) fn place(finding: &Finding) -> Option<String> {
    super::source::places(finding).into_iter().next().map(|(at, _, _)| at.to_string())
}
