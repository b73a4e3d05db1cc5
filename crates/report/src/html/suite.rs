//! A suite: its picture and map, and what came out in each way in which it ran.

use maud::{Markup, PreEscaped, display, html};

use super::charts::{Chart, power};
use super::finding::{copied, finding};
use super::known::{because, expected, failures};
use super::source::{Notes, listing, note, places};
use super::text::{Message, count, number};
use super::{Page, anchor, fails, suite_anchor, way};
use crate::check::reached;
use base::diagnostic::Lang;
use engine::suite::run::{
    Entry, Errors, FindingKind, Gallery, Known, Outcome, Reach, Report, RunError, Scene, State, Translated,
};
use judge::verdict::{Promise, Reason};

/// The part of the page about a suite.
pub(super) fn suite(page: &Page<'_>, name: &str, numbers: &[usize], open: bool) -> Markup {
    let entries: Vec<(usize, &Entry)> = numbers.iter().map(|&n| (n, &page.summary.entries[n])).collect();
    let subject = page.subjects.iter().find(|subject| subject.name == name);
    let failing = entries.iter().filter(|(_, entry)| fails(entry)).count();
    let known: usize = entries.iter().map(|(_, entry)| expected(entry)).sum();
    let state = match (failing, entries.len()) {
        (0, _) if known > 0 => format!("passes with {}", failures(known)),
        (0, _) => "passes".to_owned(),
        (n, all) if n == all => "fails".to_owned(),
        (n, all) => format!("fails on {n} of {all}"),
    };
    let marks = subject.map_or_else(Notes::new, |subject| notes(subject.shader.name(), &entries));
    let ran: Vec<(usize, &Entry)> = entries.iter().copied().filter(|(_, entry)| entry.on.is_some()).collect();
    let gallery = |n: usize| page.galleries.get(n).and_then(Option::as_ref);
    html! {
        details.suite.fail[failing > 0] id=(suite_anchor(name)) open[open] {
            summary {
                h3 { (name) }
                span.quiet { (subject.map_or("", |subject| &subject.title)) }
                span.state { (state) }
            }
            div.body {
                p.quiet {
                    code { (entries.first().map_or("", |(_, entry)| &entry.shader)) }
                    ", compared with its " (subject.map_or("formula", |subject| &subject.against))
                }
                @if let (Some(subject), false) = (subject, marks.is_empty()) {
                    (listing(subject.shader.text(), &marks, Some(3)))
                }
                @if !ran.is_empty() { (tabs(&ran)) }
                @if let Some(scene) = ran.iter().find_map(|(n, _)| gallery(*n)?.scene.as_ref()) { (stage(scene)) }
                @for (number, entry) in &entries { (panel(entry, *number, gallery(*number))) }
                @if let Some(subject) = subject {
                    details.plain {
                        summary { "Source of " code { (subject.shader.name()) } }
                        (listing(subject.shader.text(), &marks, None))
                    }
                }
            }
        }
    }
}

/// A tab for each way in which a suite ran; the first that fails is chosen.
fn tabs(ran: &[(usize, &Entry)]) -> Markup {
    let chosen = ran.iter().position(|(_, entry)| fails(entry)).unwrap_or(0);
    html! {
        div.ways role="tablist" aria-label="Lane and stage" {
            @for (k, (number, entry)) in ran.iter().enumerate() {
                button class=[fails(entry).then_some("fail")] type="button" role="tab" aria-selected=(k == chosen)
                    aria-controls=(anchor(entry, *number)) data-entry=(number) {
                    (way(entry)) @if fails(entry) { " ✕" }
                }
            }
        }
    }
}

/// Picture and map, which the script draws.
fn stage(scene: &Scene) -> Markup {
    let usual = "Numbers mark the places with the largest errors beside their bounds. Point at a place to read it.";
    html! {
        div.stage {
            @if let Some(output) = &scene.output { (picture(output)) }
            figure.map {
                h4 { "Error over " (scene.axes[0].name) " and " (scene.axes[1].name) }
                canvas tabindex="0" role="img" aria-label="Map of errors. Arrow keys go from place to place." {}
                div.controls {
                    label {
                        "colour "
                        select name="by" {
                            option value="ratio" { "error ÷ bound" }
                            option value="ulp" { "error in ULP" }
                        }
                    }
                }
                div.scale {
                    span data-end data-ratio="none" data-ulp="none" { "none" }
                    span.ramp {}
                    span data-end data-ratio="all that is allowed" data-ulp="16 ULP and more" { "all that is allowed" }
                    span { i style="background:var(--open)" {} " undetermined" }
                    span {
                        i style="background:linear-gradient(90deg,var(--bad-cold),var(--bad))" {}
                        " deviates, the darker the farther"
                    }
                }
                figcaption.said aria-live="polite" data-usual=(usual) { (usual) }
            }
        }
    }
}

fn picture(output: &str) -> Markup {
    let keys = "Arrow keys turn it, plus and minus change its size, 0 puts it back.";
    html! {
        figure.shape {
            h4 { (output) ": what came out, over what is expected" }
            canvas tabindex="0" role="img" aria-label={ "Picture of " (output) ". " (keys) } {}
            div.controls {
                @for (name, shown) in [("actual", "lane"), ("expected", "expected"), ("worst", "worst places")] {
                    label { input type="checkbox" name=(name) checked; (shown) }
                }
                label { input type="checkbox" name="larger"; span.times { "differences larger" } }
                label hidden {
                    input type="range" name="frame" min="0" value="0" step="1" aria-label="Time";
                    span.frame {}
                }
            }
            figcaption { "Drag to turn, arrow keys too; + and − zoom, 0 puts it back. Projections are left out." }
        }
    }
}

fn panel(entry: &Entry, number: usize, gallery: Option<&Gallery>) -> Markup {
    let anchor = anchor(entry, number);
    let plain = |title: &str, message: &str| html! { section.finding { h4 { (title) } p { (Message(message)) } } };
    html! {
        div.panel id=(anchor) role="tabpanel" {
            @match &entry.outcome {
                Outcome::Ran(report) => { (ran(entry, report, &anchor, gallery)) }
                Outcome::Refused(RunError::Shader { diagnostics, .. }) => {
                    @for d in diagnostics {
                        section.finding {
                            h4 { "Does not compile" }
                            pre.text { (crate::diagnostics::text(d, Lang::En, false)) }
                        }
                    }
                }
                Outcome::Refused(error) => { (plain("Cannot run", &error.to_string())) }
                Outcome::LaneFailed(message) => { (plain("The lane failed", message)) }
                Outcome::KnownFailure { message, expectation } => {
                    section.finding.known {
                        h4 { "The lane fails, as is expected" }
                        p { (Message(message)) }
                        p { (because(expectation)) }
                    }
                }
            }
        }
    }
}

fn ran(entry: &Entry, report: &Report, anchor: &str, gallery: Option<&Gallery>) -> Markup {
    let deviates = report.findings.iter().any(|f| f.kind == FindingKind::Deviation);
    html! {
        (facts(report))
        @if let Some(why) = entry.not_run() { p { "Not run: " (Message(why)) "." } }
        @for (k, one) in report.findings.iter().enumerate() {
            @let shown = finding(one, report.lane, &format!("{anchor}-f{k}"));
            // Relations that break follow from outputs that deviate.
            @if deviates && one.kind == FindingKind::Relation {
                details.plain { summary { (Message(&one.message)) } (shown) }
            } @else {
                (shown)
            }
        }
        @for (k, Known { finding: one, expectation }) in report.known.iter().enumerate() {
            details.plain.known {
                summary { "Known: " (Message(&one.message)) }
                p { (because(expectation)) }
                (finding(one, report.lane, &format!("{anchor}-k{k}")))
            }
        }
        @if let Some(gallery) = gallery {
            @if gallery.errors.words > 0 { (charts(entry, &gallery.errors)) }
            @if let Some(scene) = &gallery.scene { (worst(scene, anchor)) }
        }
        (details(report))
    }
}

fn facts(report: &Report) -> Markup {
    let verdicts = &report.verdicts;
    let mut facts: Vec<(String, String)> = vec![
        ("judged".to_owned(), count(report.judged())),
        ("agree".to_owned(), count(verdicts.agreed)),
        ("deviate".to_owned(), count(verdicts.deviated)),
        ("undetermined".to_owned(), count(verdicts.undetermined_count())),
    ];
    if verdicts.agreed > 0 {
        facts.push(("largest error that agrees".to_owned(), format!("{:.1} ULP", verdicts.max_ulp)));
    }
    for (promise, n) in Promise::ALL.iter().zip(verdicts.agreed_by) {
        if n > 0 && *promise != Promise::Text {
            facts.push((format!("agree by {}", promise.name()), count(n)));
        }
    }
    if report.unsupported > 0 {
        facts.push(("not supported".to_owned(), count(report.unsupported)));
    }
    facts.extend(report.reach.iter().flat_map(reached).map(|(name, value)| (name.to_owned(), value)));
    html! {
        dl.facts { @for (name, value) in facts { div { dt { (name) } dd { (value) } } } }
        @for asked in report.reach.iter().flat_map(Reach::one_sided) { p.quiet { (Message(asked)) "." } }
    }
}

fn charts(entry: &Entry, errors: &Errors) -> Markup {
    let chart =
        |chart: Chart<'_>, title: &str| PreEscaped(chart.svg(&format!("{title} of {} on {}", entry.suite, way(entry))));
    html! {
        div.charts {
            figure {
                h4 { "Errors" }
                (chart(Chart::Errors(errors), "Errors"))
                figcaption {
                    (count(errors.words)) " words of " (count(errors.samples)) " samples; "
                    (count(errors.exact.iter().sum())) " are exact. "
                    @match errors.by_error.keys().last() {
                        None => { "No word has an error." }
                        Some(&at) => { "The largest lie between " (power(at)) " and " (power(at + 1)) " ULP." }
                    }
                    " " span style="color:var(--good)" { "Blue" } " of samples that agree, "
                    span style="color:var(--open)" { "grey" } " undetermined, "
                    span style="color:var(--bad)" { "red" } " deviating."
                }
            }
            @if !errors.by_bound.is_empty() {
                figure {
                    h4 { "Errors and bounds" }
                    (chart(Chart::Bounds(errors), "Errors and bounds"))
                    figcaption {
                        "Words by what is allowed and what came out; the darker, the more. Below the line is allowed. "
                        @match errors.beyond {
                            0 => { "No error is beyond its bound." }
                            n => { (count(n)) " words are beyond their bounds." }
                        }
                        @if errors.unbounded > 0 { " " (count(errors.unbounded)) " words have no bound." }
                    }
                }
            }
        }
    }
}

/// The places that the picture marks.
fn worst(scene: &Scene, anchor: &str) -> Markup {
    let Some(first) = scene.worst.first() else { return Markup::default() };
    let verdict = |state: State| match state {
        State::Agrees => "agrees".to_owned(),
        State::Deviates(blame) => format!("the {} deviates", blame.name()),
        State::Undetermined(reason) => reason.to_string(),
        State::Nothing => "no vertex".to_owned(),
    };
    html! {
        h4 { "Worst places of the picture" }
        div.wide {
            table {
                thead {
                    tr {
                        @for name in ["#", "place", "component"] { th { (name) } }
                        @for name in ["expected", "lane", "allowed", "error", "÷ bound"] { th.number { (name) } }
                        th { "verdict" }
                    }
                }
                tbody {
                    @for (k, worst) in scene.worst.iter().enumerate() {
                        tr {
                            td { (k + 1) }
                            td { (worst.at) }
                            td.mono { (worst.component) }
                            td.number.mono { (format!("{:.9}", worst.seen.target())) }
                            td.number.mono { (format!("{:.9}", worst.seen.actual)) }
                            td.number { "± " (number(worst.seen.bound())) }
                            td.number { (number(worst.ulp)) " ULP" }
                            td.number { (number(worst.ratio)) }
                            td { (verdict(worst.state)) }
                        }
                    }
                }
            }
        }
        details.plain {
            summary { "Run place 1 again" }
            (copied("", &format!("{anchor}-worst"), &first.reproduce))
        }
    }
}

/// What is looked up and not read.
fn details(report: &Report) -> Markup {
    html! {
        @if !report.doubts.is_empty() { (doubts(report)) }
        @if !report.relations.is_empty() {
            details.plain {
                summary { (report.relations.len()) " relations" }
                table {
                    tbody {
                        @for (name, checked) in &report.relations {
                            tr { td.mono { (name) } td { "checked on " (count(*checked)) " samples" } }
                        }
                    }
                }
            }
        }
        @if !report.translations.is_empty() {
            details.plain {
                summary { "Translations" }
                table { tbody { @for translated in &report.translations { (translation(translated)) } } }
            }
        }
        @if let Some(budget) = &report.budget { p.quiet { (display(budget)) } }
        @if let Some(coverage) = &report.coverage { p.quiet { (display(coverage)) } }
        @for texture in &report.textures { p.quiet { "Texture " (texture) } }
    }
}

fn doubts(report: &Report) -> Markup {
    let reasons = Reason::ALL.iter().zip(report.verdicts.undetermined).filter(|(_, n)| *n > 0);
    let reasons: Vec<String> = reasons.map(|(reason, n)| format!("{} {reason}", count(n))).collect();
    html! {
        details.plain {
            summary { "Undetermined: " (reasons.join(", ")) }
            table {
                thead { tr { th.number { "samples" } th { "why" } th { "operation" } th { "where" } } }
                tbody {
                    @for doubtful in &report.doubts {
                        tr {
                            td.number { (count(doubtful.count)) }
                            td { (display(doubtful.reason)) }
                            td.mono { @if let Some(op) = doubtful.op { (op.name()) } }
                            td.mono { (doubtful.text) " " @if let Some(at) = &doubtful.at { (display(at)) } }
                        }
                    }
                }
            }
        }
    }
}

fn translation(translated: &Translated) -> Markup {
    let Translated { language, agreed, deviated, undetermined, unsupported } = translated;
    html! {
        tr {
            td { (display(language)) }
            td {
                @match unsupported {
                    Some(why) => { "not compared: " (why) }
                    None => { (agreed) " agree, " (deviated) " deviate, " (undetermined) " undetermined" }
                }
            }
        }
    }
}

/// What is wrong at which places of the shader.
fn notes(file: &str, entries: &[(usize, &Entry)]) -> Notes {
    let mut notes = Notes::new();
    for (_, entry) in entries {
        match &entry.outcome {
            Outcome::Ran(report) => {
                for finding in report.errors() {
                    for (at, meant, told) in places(finding) {
                        note(&mut notes, file, &at, &meant, &told);
                    }
                }
            }
            Outcome::Refused(RunError::Shader { diagnostics, .. }) => {
                for d in diagnostics {
                    note(&mut notes, file, &d.file.location(d.span.start), d.file.slice(d.span), &d.message);
                }
            }
            Outcome::Refused(_) | Outcome::LaneFailed(_) | Outcome::KnownFailure { .. } => {}
        }
    }
    notes
}
