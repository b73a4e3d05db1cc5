//! What is told of a run beside its findings, once for each cause: the suites and lanes that share it stand together.

use std::fmt::Write as _;

use base::text::Location;
use engine::suite::run::{Apart, Doubtful, LaneUsed, Outcome, Report, Summary};
use judge::verdict::Reason;
use program::InputSource;

/// Kinds of doubt that are told for each suite on a lane.
const DOUBTS: usize = 3;
/// Lanes and stages that are named in a note.
const NAMED: usize = 4;

/// Something that is told of some suites on some lanes.
struct Note<'a> {
    what: What<'a>,
    suites: Vec<&'a str>,
    places: Vec<String>,
}

enum What<'a> {
    Plain(String),
    /// Undetermined samples, of all suites and lanes together; the arguments are those of the first.
    Doubt(Doubtful, Cause<'a>),
}

/// Why samples are undetermined, and where.
type Cause<'a> = (Reason, Option<&'static str>, Option<&'a Location>, &'a str);

#[derive(Default)]
struct Notes<'a>(Vec<Note<'a>>);

impl<'a> Notes<'a> {
    fn plain(&mut self, report: &'a Report, text: String) {
        let same = |note: &&mut Note<'a>| matches!(&note.what, What::Plain(known) if *known == text);
        match self.0.iter_mut().find(same) {
            Some(note) => note.add(report),
            None => self.push(report, What::Plain(text)),
        }
    }

    fn doubt(&mut self, report: &'a Report, doubtful: &'a Doubtful) {
        let cause = (doubtful.reason, doubtful.op.map(|op| op.name()), doubtful.at.as_ref(), doubtful.text.as_str());
        for note in &mut self.0 {
            if let What::Doubt(known, of) = &mut note.what
                && *of == cause
            {
                known.count += doubtful.count;
                return note.add(report);
            }
        }
        self.push(report, What::Doubt(doubtful.clone(), cause));
    }

    fn push(&mut self, report: &'a Report, what: What<'a>) {
        let mut note = Note { what, suites: Vec::new(), places: Vec::new() };
        note.add(report);
        self.0.push(note);
    }
}

impl<'a> Note<'a> {
    fn add(&mut self, report: &'a Report) {
        let place = super::text::place(report);
        if !self.suites.contains(&report.suite.as_str()) {
            self.suites.push(&report.suite);
        }
        if !self.places.contains(&place) {
            self.places.push(place);
        }
    }
}

/// Facts about coverage, sources, textures and undetermined samples, a line for each.
pub(super) fn of_suites(summary: &Summary) -> String {
    let mut notes = Notes::default();
    for entry in &summary.entries {
        let Outcome::Ran(report) = &entry.outcome else { continue };
        if let Some(coverage) = report.coverage.as_ref().filter(|coverage| coverage.is_complete()) {
            notes.plain(report, coverage.to_string());
        }
        if let Some(apart) = report.apart.as_ref().filter(|apart| apart.different > 0) {
            notes.plain(report, differs(apart));
        }
        if let Some(budget) = &report.budget {
            notes.plain(report, budget.to_string());
        }
        report.textures.iter().for_each(|texture| notes.plain(report, format!("texture {texture}")));
        // A few more samples of the same inputs are in doubt for the same reasons.
        let few = matches!(report.source, Some(InputSource::Constants | InputSource::Uniforms));
        if report.verdicts.faded > 0 && !few {
            let faded = report.verdicts.faded;
            let why = "`exp` or `pow` has faded out, and its value at the start is 1";
            notes.plain(report, format!("{faded} agree at the scale 1: {why}"));
        }
        report.doubts.iter().take(if few { 0 } else { DOUBTS }).for_each(|doubtful| notes.doubt(report, doubtful));
        if report.replayed > 0 && report.verdicts.seen() > report.replayed {
            notes.plain(report, format!("saved cases that ran first: {}", report.replayed));
        }
    }
    let mut text = String::new();
    for Note { what, suites, places } in notes.0 {
        let what = match what {
            What::Plain(text) => text,
            What::Doubt(doubtful, _) => doubtful.to_string(),
        };
        let _ = writeln!(text, "note: {} on {}: {what}", suites.join(", "), some(&places));
    }
    text
}

/// The first few of a list, and how many more there are.
fn some(places: &[String]) -> String {
    let named = places[..places.len().min(NAMED)].join(", ");
    match places.len().saturating_sub(NAMED) {
        0 => named,
        more => format!("{named} and {more} more"),
    }
}

/// How outputs differ from those of inputs in storage.
fn differs(apart: &Apart) -> String {
    let Apart { samples, different, ulp, component } = apart;
    let most =
        if ulp.is_finite() && *ulp > 0.0 { format!(", by {ulp} ULP of `{component}` at most") } else { String::new() };
    format!("{different} of {samples} samples have other bits than with inputs in storage{most}")
}

/// Suites that a lane did not run, a line for each lane and reason.
pub(super) fn not_run(summary: &Summary) -> String {
    let mut text = String::new();
    for super::not_run::NotRun { lane, why, suites } in super::not_run::by_cause(summary) {
        let _ = writeln!(text, "note: not run on {lane}: {}: {why}", suites.join(", "));
    }
    text
}

/// What the results of lanes were held against: lanes that share it stand together.
pub(super) fn of_lanes(summary: &Summary) -> String {
    let mut all: Vec<(String, Vec<&str>)> = Vec::new();
    for LaneUsed { description, against } in &summary.lanes {
        let promises: Vec<&str> =
            [&against.promise].into_iter().chain(&against.conformance).map(String::as_str).collect();
        let measured = match &against.measured {
            Some(measured) => format!("measured profile {measured}"),
            None => "no measured profile".to_owned(),
        };
        let what = format!("promises of {}; {measured}", promises.join(", "));
        match all.iter_mut().find(|(known, _)| *known == what) {
            Some((_, lanes)) => lanes.push(description.name),
            None => all.push((what, vec![description.name])),
        }
    }
    let mut text = String::new();
    for (what, lanes) in all {
        let word = if lanes.len() == 1 { "lane" } else { "lanes" };
        let _ = writeln!(text, "note: {word} `{}`: {what}", lanes.join("`, `"));
    }
    text
}
