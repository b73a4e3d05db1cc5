//! The page as a whole: its head, what is wrong, and what comes after.

use std::fmt::Write;

use super::escape::{Escaped, Message, count, script};
use super::finding::{how_many, who};
use super::{Page, anchor, fails, suites, way};
use engine::suite::run::{Finding, FindingKind, Outcome, RunError, Status};

const STYLE: &str = include_str!("style.css");
const SCRIPTS: [&str; 4] =
    [include_str!("script.js"), include_str!("scene.js"), include_str!("viewer.js"), include_str!("map.js")];

/// The whole page.
pub(super) fn page(page: &Page<'_>) -> String {
    let mut text = String::new();
    let title = match page.summary.status() {
        Status::Pass => "passed",
        Status::Fail => "failed",
        Status::Broken if page.summary.totals().judged > 0 => "is incomplete",
        Status::Broken => "could not run",
    };
    // Writing into a String does not fail. Nothing outside of the page is ever asked for.
    let _ = write!(
        text,
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; \
         script-src 'unsafe-inline'; img-src data:\">\n<title>shadercheck {title}</title>\n<style>\n{STYLE}</style>\n\
         </head>\n<body>\n<a class=\"skip\" href=\"#matrix\">To the table of suites</a>\n"
    );
    hero(&mut text, page);
    wrongs(&mut text, page);
    super::known::known(&mut text, page);
    super::matrix::matrix(&mut text, page);
    let _ = writeln!(text, "<h2 id=\"suites\">Suites</h2>");
    let all = suites(page.summary);
    let first_failing = all.iter().position(|(_, numbers)| numbers.iter().any(|&n| fails(&page.summary.entries[n])));
    for (k, (name, numbers)) in all.iter().enumerate() {
        super::suite::suite(&mut text, page, name, numbers, k == first_failing.unwrap_or(0));
    }
    super::lanes::lanes(&mut text, page);
    if let Some(mutations) = page.mutations {
        super::mutations::mutations(&mut text, mutations);
    }
    let _ = write!(
        text,
        "<footer>shadercheck {}, seed {}. The charts are beside this page in <code>plots</code>; the same run for \
         programs is in <code>report.json</code>.</footer>\n<script type=\"application/json\" id=\"data\">{}</script>\n\
         <script>\n",
        env!("CARGO_PKG_VERSION"),
        page.summary.seed,
        script(&super::data::data(page))
    );
    for part in SCRIPTS {
        text.push_str(part);
    }
    text.push_str("</script>\n</body>\n</html>\n");
    text
}

fn hero(text: &mut String, page: &Page<'_>) {
    let summary = page.summary;
    let totals = summary.totals();
    let all = suites(summary);
    let failing = all.iter().filter(|(_, numbers)| numbers.iter().any(|&n| fails(&summary.entries[n]))).count();
    let suites = |n: usize| if n == 1 { "suite" } else { "suites" };
    let (class, headline) = match (summary.status(), failing) {
        (Status::Pass, _) if all.len() == 1 => ("", "The suite passes".to_owned()),
        (Status::Pass, _) => ("", format!("All {} suites pass", all.len())),
        (Status::Fail, 1) if all.len() == 1 => (" fail", "The suite fails".to_owned()),
        (Status::Fail, 1) => (" fail", format!("1 of {} {} fails", all.len(), suites(all.len()))),
        (Status::Fail, n) => (" fail", format!("{n} of {} {} fail", all.len(), suites(all.len()))),
        (Status::Broken, _) if !summary.shortcomings().is_empty() => (" fail", "The run is incomplete".to_owned()),
        (Status::Broken, 0) => (" fail", "Nothing was judged".to_owned()),
        (Status::Broken, n) => (" fail", format!("{n} of {} {} could not run", all.len(), suites(all.len()))),
    };
    let lanes: Vec<String> = summary
        .lanes
        .iter()
        .map(|used| format!("<b>{}</b> ({})", Escaped(used.description.name), Escaped(&used.description.driver)))
        .collect();
    let _ = write!(
        text,
        "<div class=\"top\"><span><b>shadercheck</b></span><button id=\"theme\" type=\"button\" \
         aria-label=\"Light or dark page\">Dark</button></div>\n<header class=\"hero{class}\">\n<h1>{headline}</h1>\n\
         <p class=\"quiet\">on {}</p>\n<dl class=\"figures\">",
        lanes.join(", ")
    );
    for (name, n, bad) in [
        ("samples judged", totals.judged, false),
        ("agree", totals.agreed, false),
        ("deviate", totals.deviated, totals.deviated > 0),
        ("undetermined", totals.undetermined, false),
        ("not supported", totals.unsupported, false),
    ] {
        if n > 0 || name != "not supported" {
            let class = if bad { " class=\"bad\"" } else { "" };
            let _ = write!(text, "<div{class}><dt>{name}</dt><dd>{}</dd></div>", count(n));
        }
    }
    text.push_str("</dl>\n</header>\n");
    for (name, why) in &summary.unavailable {
        let _ = writeln!(text, "<p class=\"quiet\">Lane <b>{}</b> did not run: {}.</p>", Escaped(name), Escaped(why));
    }
    for (_, shortcoming) in summary.shortcomings() {
        let _ = writeln!(text, "<p><b>Incomplete</b>: {}.</p>", Escaped(shortcoming));
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
fn wrongs(text: &mut String, page: &Page<'_>) {
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
    for (warning, follows) in [(false, false), (false, true), (true, false)] {
        let some: Vec<&Wrong> = all.iter().filter(|w| (w.warning, w.follows) == (warning, follows)).collect();
        let heading = match (some.len(), warning, follows) {
            (0, _, _) => continue,
            (_, false, false) => "<h2>What is wrong</h2>".to_owned(),
            (1, false, true) => "<summary>1 relation does not hold for outputs that deviate</summary>".to_owned(),
            (n, false, true) => format!("<summary>{n} relations do not hold for outputs that deviate</summary>"),
            (1, true, _) => "<summary>1 warning</summary>".to_owned(),
            (n, true, _) => format!("<summary>{n} warnings</summary>"),
        };
        let folded = warning || follows;
        let open = if folded { "<details class=\"plain\">" } else { "" };
        let _ = writeln!(text, "{open}{heading}\n<ul class=\"wrongs\">");
        for wrong in some {
            let class = if warning { "who warning" } else { "who" };
            let _ = write!(
                text,
                "<li><span class=\"{class}\">{}</span><div><p><b>{}</b>: {}</p><p class=\"more\">",
                Escaped(&wrong.who),
                Escaped(&wrong.suite),
                Message(&wrong.message)
            );
            if let Some(at) = &wrong.at {
                let _ = write!(text, "at <code>{}</code>; ", Escaped(at));
            }
            if let Some(many) = &wrong.many {
                let _ = write!(text, "{many}; ");
            }
            let links: Vec<String> = wrong
                .on
                .iter()
                .map(|(way, anchor)| {
                    let way = if way.is_empty() { "details" } else { way };
                    format!("<a href=\"#{}\">{}</a>", Escaped(anchor), Escaped(way))
                })
                .collect();
            let _ = writeln!(text, "{}</p></div></li>", links.join(", "));
        }
        text.push_str(if folded { "</ul></details>\n" } else { "</ul>\n" });
    }
}

/// Where a finding shows first in the author's text.
pub(super) fn place(finding: &Finding) -> Option<String> {
    super::source::places(finding).into_iter().next().map(|(at, _, _)| at.to_string())
}
