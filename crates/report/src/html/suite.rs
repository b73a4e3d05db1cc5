//! A suite: its picture and map, and what came out in each way in which it ran.

use std::fmt::Write;

use super::charts::{Chart, power};
use super::escape::{Escaped, Message, count, number};
use super::finding::{copied, finding};
use super::known::{because, expected, failures};
use super::source::{Notes, listing, note, places};
use super::{Page, anchor, fails, suite_anchor, way};
use crate::check::reached;
use base::diagnostic::Lang;
use engine::suite::run::{Entry, Errors, FindingKind, Gallery, Known, Outcome, Reach, Report, RunError, Scene, State};
use judge::verdict::{Promise, Reason};

/// The part of the page about a suite.
pub(super) fn suite(text: &mut String, page: &Page<'_>, name: &str, numbers: &[usize], open: bool) {
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
    let _ = write!(
        text,
        "<details class=\"suite{}\" id=\"{}\"{}><summary><h3>{}</h3><span class=\"quiet\">{}</span>\
         <span class=\"state\">{state}</span></summary>\n<div class=\"body\">\n",
        if failing > 0 { " fail" } else { "" },
        suite_anchor(name),
        if open { " open" } else { "" },
        Escaped(name),
        Escaped(subject.map_or("", |subject| &subject.title))
    );
    let shader = entries.first().map_or("", |(_, entry)| entry.shader.as_str());
    let against = subject.map_or("formula", |subject| subject.against.as_str());
    let _ = writeln!(
        text,
        "<p class=\"quiet\"><code>{}</code>, compared with its {}</p>",
        Escaped(shader),
        Escaped(against)
    );
    let marks = subject.map_or_else(Notes::new, |subject| notes(subject.shader.name(), &entries));
    if let (Some(subject), false) = (subject, marks.is_empty()) {
        listing(text, subject.shader.text(), &marks, Some(3));
    }
    let ran: Vec<(usize, &Entry)> = entries.iter().copied().filter(|(_, entry)| entry.on.is_some()).collect();
    tabs(text, &ran);
    let scenes = ran.iter().filter_map(|(n, _)| page.galleries.get(*n)?.as_ref()?.scene.as_ref());
    if let Some(scene) = scenes.clone().next() {
        stage(text, scene);
    }
    for (number, entry) in &entries {
        let gallery = page.galleries.get(*number).and_then(Option::as_ref);
        panel(text, entry, *number, gallery);
    }
    if let Some(subject) = subject {
        let _ = write!(
            text,
            "<details class=\"plain\"><summary>Source of <code>{}</code></summary>",
            Escaped(subject.shader.name())
        );
        listing(text, subject.shader.text(), &marks, None);
        text.push_str("</details>\n");
    }
    text.push_str("</div></details>\n");
}

/// A tab for each way in which a suite ran; the first that fails is chosen.
fn tabs(text: &mut String, ran: &[(usize, &Entry)]) {
    if ran.is_empty() {
        return;
    }
    let chosen = ran.iter().position(|(_, entry)| fails(entry)).unwrap_or(0);
    text.push_str("<div class=\"ways\" role=\"tablist\" aria-label=\"Lane and stage\">");
    for (k, (number, entry)) in ran.iter().enumerate() {
        let class = if fails(entry) { " class=\"fail\"" } else { "" };
        let _ = write!(
            text,
            "<button type=\"button\" role=\"tab\"{class} aria-selected=\"{}\" aria-controls=\"{}\" data-entry=\"{number}\">{}{}</button>",
            k == chosen,
            anchor(entry, *number),
            Escaped(way(entry)),
            if fails(entry) { " ✕" } else { "" }
        );
    }
    text.push_str("</div>\n");
}

/// Picture and map, which the script draws.
fn stage(text: &mut String, scene: &Scene) {
    text.push_str("<div class=\"stage\">\n");
    if let Some(output) = &scene.output {
        let _ = writeln!(
            text,
            "<figure class=\"shape\"><h4>{0}: what came out, over what is expected</h4>\
             <canvas tabindex=\"0\" role=\"img\" aria-label=\"Picture of {0}. Arrow keys turn it, plus and minus change \
             its size, 0 puts it back.\"></canvas><div class=\"controls\">\
             <label><input type=\"checkbox\" name=\"actual\" checked>lane</label>\
             <label><input type=\"checkbox\" name=\"expected\" checked>expected</label>\
             <label><input type=\"checkbox\" name=\"worst\" checked>worst places</label>\
             <label><input type=\"checkbox\" name=\"larger\"><span class=\"times\">differences larger</span></label>\
             <label hidden><input type=\"range\" name=\"frame\" min=\"0\" value=\"0\" step=\"1\" aria-label=\"Time\">\
             <span class=\"frame\"></span></label></div>\
             <figcaption>Drag to turn, arrow keys too; + and − zoom, 0 puts it back. Projections are left out.\
             </figcaption></figure>",
            Escaped(output)
        );
    }
    let _ = write!(
        text,
        "<figure class=\"map\"><h4>Error over {} and {}</h4>\
         <canvas tabindex=\"0\" role=\"img\" aria-label=\"Map of errors. Arrow keys go from place to place.\"></canvas>\
         <div class=\"controls\"><label>colour <select name=\"by\"><option value=\"ratio\">error ÷ bound</option>\
         <option value=\"ulp\">error in ULP</option></select></label></div>\
         <div class=\"scale\"><span data-end data-ratio=\"none\" data-ulp=\"none\">none</span><span class=\"ramp\"></span>\
         <span data-end data-ratio=\"all that is allowed\" data-ulp=\"16 ULP and more\">all that is allowed</span>\
         <span><i style=\"background:var(--open)\"></i> undetermined</span>\
         <span><i style=\"background:linear-gradient(90deg,var(--bad-cold),var(--bad))\"></i> deviates, the darker the farther</span></div>\
         <figcaption class=\"said\" aria-live=\"polite\" data-usual=\"{usual}\">{usual}</figcaption></figure>\n</div>\n",
        Escaped(&scene.axes[0].name),
        Escaped(&scene.axes[1].name),
        usual = "Numbers mark the places with the largest errors beside their bounds. Point at a place to read it."
    );
}

fn panel(text: &mut String, entry: &Entry, number: usize, gallery: Option<&Gallery>) {
    let anchor = anchor(entry, number);
    let _ = writeln!(text, "<div id=\"{anchor}\" class=\"panel\" role=\"tabpanel\">");
    match &entry.outcome {
        Outcome::Ran(report) => {
            facts(text, report);
            if let Some(why) = entry.not_run() {
                let _ = writeln!(text, "<p>Not run: {}.</p>", Message(&why));
            }
            let deviates = report.findings.iter().any(|f| f.kind == FindingKind::Deviation);
            for (k, one) in report.findings.iter().enumerate() {
                // Relations that break follow from outputs that deviate.
                let follows = deviates && one.kind == FindingKind::Relation;
                if follows {
                    let _ = write!(text, "<details class=\"plain\"><summary>{}</summary>", Message(&one.message));
                }
                finding(text, one, report.lane, &format!("{anchor}-f{k}"));
                text.push_str(if follows { "</details>\n" } else { "" });
            }
            for (k, Known { finding: one, expectation }) in report.known.iter().enumerate() {
                let _ = write!(
                    text,
                    "<details class=\"plain known\"><summary>Known: {}</summary><p>",
                    Message(&one.message)
                );
                because(text, expectation);
                text.push_str("</p>");
                finding(text, one, report.lane, &format!("{anchor}-k{k}"));
                text.push_str("</details>\n");
            }
            if let Some(gallery) = gallery {
                charts(text, entry, &gallery.errors);
                if let Some(scene) = &gallery.scene {
                    worst(text, scene, &anchor);
                }
            }
            details(text, report);
        }
        Outcome::Refused(RunError::Shader { diagnostics, .. }) => {
            for d in diagnostics {
                let shown = crate::diagnostics::text(d, Lang::En, false);
                let _ = write!(
                    text,
                    "<section class=\"finding\"><h4>Does not compile</h4><pre class=\"text\">{}</pre></section>",
                    Escaped(shown)
                );
            }
        }
        Outcome::Refused(error) => plain(text, "Cannot run", &error.to_string()),
        Outcome::LaneFailed(message) => plain(text, "The lane failed", message),
        Outcome::KnownFailure { message, expectation } => {
            let _ = write!(
                text,
                "<section class=\"finding known\"><h4>The lane fails, as is expected</h4><p>{}</p><p>",
                Message(message)
            );
            because(text, expectation);
            text.push_str("</p></section>\n");
        }
    }
    text.push_str("</div>\n");
}

fn plain(text: &mut String, title: &str, message: &str) {
    let _ = writeln!(text, "<section class=\"finding\"><h4>{title}</h4><p>{}</p></section>", Message(message));
}

fn facts(text: &mut String, report: &Report) {
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
    text.push_str("<dl class=\"facts\">");
    for (name, value) in facts {
        let _ = write!(text, "<div><dt>{}</dt><dd>{}</dd></div>", Escaped(name), Escaped(value));
    }
    text.push_str("</dl>\n");
    for asked in report.reach.iter().flat_map(Reach::one_sided) {
        let _ = writeln!(text, "<p class=\"quiet\">{}.</p>", Message(asked));
    }
}

fn charts(text: &mut String, entry: &Entry, errors: &Errors) {
    if errors.words == 0 {
        return;
    }
    let on = format!("{} on {}", entry.suite, way(entry));
    let largest = errors.by_error.keys().last().map_or_else(
        || "No word has an error.".to_owned(),
        |exponent| format!("The largest lie between {} and {} ULP.", power(*exponent), power(exponent + 1)),
    );
    let exact: u64 = errors.exact.iter().sum();
    let _ = write!(
        text,
        "<div class=\"charts\"><figure><h4>Errors</h4>{}<figcaption>{} words of {} samples; {} are exact. {largest} \
         <span style=\"color:var(--good)\">Blue</span> of samples that agree, <span style=\"color:var(--open)\">grey</span> \
         undetermined, <span style=\"color:var(--bad)\">red</span> deviating.</figcaption></figure>",
        Chart::Errors(errors).svg(&format!("Errors of {on}")),
        count(errors.words),
        count(errors.samples),
        count(exact)
    );
    if !errors.by_bound.is_empty() {
        let beyond = match errors.beyond {
            0 => "No error is beyond its bound.".to_owned(),
            n => format!("{} words are beyond their bounds.", count(n)),
        };
        let free = if errors.unbounded > 0 {
            format!(" {} words have no bound.", count(errors.unbounded))
        } else {
            String::new()
        };
        let _ = write!(
            text,
            "<figure><h4>Errors and bounds</h4>{}<figcaption>Words by what is allowed and what came out; the darker, the \
             more. Below the line is allowed. {beyond}{free}</figcaption></figure>",
            Chart::Bounds(errors).svg(&format!("Errors and bounds of {on}"))
        );
    }
    text.push_str("</div>\n");
}

/// The places that the picture marks.
fn worst(text: &mut String, scene: &Scene, anchor: &str) {
    if scene.worst.is_empty() {
        return;
    }
    text.push_str(
        "<h4>Worst places of the picture</h4><div class=\"wide\"><table><thead><tr><th>#</th><th>place</th><th>component</th>\
         <th class=\"number\">expected</th><th class=\"number\">lane</th><th class=\"number\">allowed</th>\
         <th class=\"number\">error</th><th class=\"number\">÷ bound</th><th>verdict</th></tr></thead><tbody>",
    );
    for (k, worst) in scene.worst.iter().enumerate() {
        let verdict = match worst.state {
            State::Agrees => "agrees".to_owned(),
            State::Deviates(blame) => format!("the {} deviates", blame.name()),
            State::Undetermined(reason) => reason.to_string(),
            State::Nothing => "no vertex".to_owned(),
        };
        let seen = &worst.seen;
        let _ = write!(
            text,
            "<tr><td>{}</td><td>{}</td><td class=\"mono\">{}</td><td class=\"number mono\">{}</td><td class=\"number mono\">{}</td>\
             <td class=\"number\">± {}</td><td class=\"number\">{} ULP</td><td class=\"number\">{}</td><td>{}</td></tr>",
            k + 1,
            Escaped(&worst.at),
            Escaped(&worst.component),
            Escaped(format!("{:.9}", seen.target())),
            Escaped(format!("{:.9}", seen.actual)),
            number(seen.bound()),
            number(worst.ulp),
            number(worst.ratio),
            Escaped(verdict)
        );
    }
    text.push_str("</tbody></table></div>\n");
    if let Some(first) = scene.worst.first() {
        text.push_str("<details class=\"plain\"><summary>Run place 1 again</summary>");
        copied(text, "", &format!("{anchor}-worst"), &first.reproduce);
        text.push_str("</details>\n");
    }
}

/// What is looked up and not read.
fn details(text: &mut String, report: &Report) {
    if !report.doubts.is_empty() {
        let reasons: Vec<String> = Reason::ALL
            .iter()
            .zip(report.verdicts.undetermined)
            .filter(|(_, n)| *n > 0)
            .map(|(reason, n)| format!("{} {reason}", count(n)))
            .collect();
        let _ = write!(
            text,
            "<details class=\"plain\"><summary>Undetermined: {}</summary><table><thead><tr><th class=\"number\">samples</th><th>why</th><th>operation</th><th>where</th></tr></thead><tbody>",
            Escaped(reasons.join(", "))
        );
        for doubtful in &report.doubts {
            let _ = write!(
                text,
                "<tr><td class=\"number\">{}</td><td>{}</td><td class=\"mono\">{}</td><td class=\"mono\">{} {}</td></tr>",
                count(doubtful.count),
                Escaped(doubtful.reason),
                doubtful.op.map_or("", |op| op.name()),
                Escaped(&doubtful.text),
                Escaped(&doubtful.at.as_ref().map_or_else(String::new, ToString::to_string))
            );
        }
        text.push_str("</tbody></table></details>\n");
    }
    if !report.relations.is_empty() {
        let _ = write!(
            text,
            "<details class=\"plain\"><summary>{} relations</summary><table><tbody>",
            report.relations.len()
        );
        for (name, checked) in &report.relations {
            let _ = write!(
                text,
                "<tr><td class=\"mono\">{}</td><td>checked on {} samples</td></tr>",
                Escaped(name),
                count(*checked)
            );
        }
        text.push_str("</tbody></table></details>\n");
    }
    if !report.translations.is_empty() {
        text.push_str("<details class=\"plain\"><summary>Translations</summary><table><tbody>");
        for translated in &report.translations {
            let told = match &translated.unsupported {
                Some(why) => format!("not compared: {why}"),
                None => format!(
                    "{} agree, {} deviate, {} undetermined",
                    translated.agreed, translated.deviated, translated.undetermined
                ),
            };
            let _ = write!(text, "<tr><td>{}</td><td>{}</td></tr>", Escaped(translated.language), Escaped(told));
        }
        text.push_str("</tbody></table></details>\n");
    }
    if let Some(coverage) = &report.coverage {
        let _ = writeln!(text, "<p class=\"quiet\">{}</p>", Escaped(coverage));
    }
    for texture in &report.textures {
        let _ = writeln!(text, "<p class=\"quiet\">Texture {}</p>", Escaped(texture));
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
