//! Everything that is wrong in a run, once, in the form from which every format for other programs is made.

use std::fmt::Write as _;

use super::block::place;
use crate::ci::Item;
use base::diagnostic::Severity;
use engine::suite::run::{Entry, Finding, Outcome, RunError, Summary};
use judge::verdict::diagnosis::{Diagnosis, Place};
use judge::verdict::{Blame, What};

/// Something that is wrong, and where it was seen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Told {
    /// What is told of it.
    pub item: Item,
    /// Where a finding of a suite was seen; none for what is about no lane.
    seen: Option<Seen>,
}

/// Suite and lanes of a finding.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Seen {
    suite: String,
    /// Each as `lane/stage`.
    lanes: Vec<String>,
    /// What is the same in findings of one fault.
    fault: String,
}

impl Seen {
    /// What a message begins with.
    fn on(&self) -> String {
        let (suite, first) = (&self.suite, &self.lanes[0]);
        match self.lanes.len() {
            1 => format!("{suite} on {first}"),
            n => format!("{suite} on {first} and {} more", n - 1),
        }
    }
}

impl Told {
    /// Whether another finding is of the same fault, on another lane.
    fn is_of(&self, other: &Self) -> bool {
        let same = |own: &Seen, other: &Seen| own.suite == other.suite && own.fault == other.fault;
        let seen = self.seen.as_ref().zip(other.seen.as_ref()).is_some_and(|(own, other)| same(own, other));
        let (own, other) = (&self.item, &other.item);
        seen && (&own.code, &own.file, own.at) == (&other.code, &other.file, other.at)
    }

    /// Takes a lane more.
    fn also(&mut self, other: &Self) {
        let (Some(seen), Some(other)) = (&mut self.seen, &other.seen) else { return };
        let before = seen.on();
        seen.lanes.extend(other.lanes.iter().cloned());
        let now = seen.on();
        self.item.message = self.item.message.replacen(&before, &now, 1);
        self.item.details = self.item.details.replacen(&before, &now, 1);
    }

    /// All that is known, with the names of the lanes.
    fn with_lanes(self) -> Item {
        let mut item = self.item;
        let lanes: Vec<String> = self.seen.into_iter().flat_map(|seen| seen.lanes.into_iter().skip(1)).collect();
        item.details = item.details.trim().to_owned();
        if !lanes.is_empty() {
            let _ = write!(item.details, "\n  also on    {}", lanes.join(", "));
        }
        item
    }
}

/// What is wrong with an entry.
pub(super) fn of_entry(entry: &Entry) -> Vec<Told> {
    let plain = |code: &str, about: &'static str, message: String| {
        let (details, identity, file) = (message.clone(), message.clone(), entry.shader.clone());
        let severity = Severity::Error;
        let item = Item { severity, code: code.to_owned(), about, message, details, file, at: None, identity };
        vec![Told { item, seen: None }]
    };
    match &entry.outcome {
        Outcome::Ran(report) => {
            let seen = |finding: &Finding| Seen {
                suite: report.suite.clone(),
                lanes: vec![format!("{}/{}", report.lane, report.stage)],
                fault: fault(finding),
            };
            report.findings.iter().map(|finding| of_finding(seen(finding), &report.shader, finding)).collect()
        }
        Outcome::Refused(RunError::Shader { diagnostics, .. }) => {
            diagnostics.iter().map(|d| Told { item: Item::of(d), seen: None }).collect()
        }
        Outcome::Refused(error) => plain("configuration", UNFIT, error.to_string()),
        Outcome::LaneFailed(message) => plain("lane", LOST, message.clone()),
        Outcome::KnownFailure { .. } => Vec::new(),
    }
}

const LOST: &str = "The lane failed.";
const UNFIT: &str = "A suite does not fit its shader.";

/// What a code stands for that is no kind of finding.
pub fn about(code: &str) -> Option<&'static str> {
    match code {
        "lane" => Some(LOST),
        "configuration" => Some(UNFIT),
        _ => None,
    }
}

/// What is the same in findings of one fault on several lanes: of the shader's own, the component that is wrong, and not
/// the numbers.
fn fault(finding: &Finding) -> String {
    let deviation = finding.case.as_ref().and_then(|case| case.deviation.as_ref());
    match deviation.filter(|deviation| deviation.blame == Blame::Shader).map(|deviation| &deviation.what) {
        Some(What::Value(value)) => value.component.clone(),
        Some(What::NotWritten { component, .. }) => component.clone(),
        Some(_) | None => finding.message.clone(),
    }
}

fn of_finding(seen: Seen, shader: &str, finding: &Finding) -> Told {
    let on = &seen.on();
    let place = finding.case.as_ref().and_then(|case| shown(&case.diagnosis)).map(|place| &place.at);
    let at = place.and_then(|at| at.position).map(|position| (position.line, position.column));
    let file = place.map_or_else(|| shader.to_owned(), |at| at.file.clone());
    let item = Item {
        severity: if finding.kind.is_warning() { Severity::Warning } else { Severity::Error },
        code: finding.kind.name().to_owned(),
        about: finding.kind.about(),
        message: format!("{on}: {}", finding.message),
        details: super::block::block(on, shader, finding),
        file,
        at,
        identity: format!("{}: {}", seen.suite, seen.fault),
    };
    Told { item, seen: Some(seen) }
}

/// What a deviation is shown at: where it shows first, or else where the wrong output is computed.
fn shown(diagnosis: &Diagnosis) -> Option<&Place> {
    place(diagnosis).or(diagnosis.written.as_ref())
}

/// Everything that is wrong in a run, in its order; a fault that a suite shows on several lanes comes once.
pub(super) fn all(summary: &Summary) -> Vec<Item> {
    once(summary.entries.iter().flat_map(of_entry))
}

/// What is of one fault, as one item.
fn once(found: impl IntoIterator<Item = Told>) -> Vec<Item> {
    let mut all: Vec<Told> = Vec::new();
    for told in found {
        match all.iter_mut().find(|known| known.is_of(&told)) {
            Some(known) => known.also(&told),
            None => all.push(told),
        }
    }
    all.into_iter().map(Told::with_lanes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::suite::run::FindingKind;
    use judge::verdict::diagnosis::ShortLiteral;

    #[test]
    fn a_deviation_is_shown_where_its_output_is_computed() {
        let at = |at: &str| Place { at: at.into(), text: "x".into(), line: "x".into(), expansion: None };
        let mut diagnosis = Diagnosis { written: Some(at("a.vert:7:3")), ..Diagnosis::default() };
        assert_eq!(shown(&diagnosis).unwrap().at.to_string(), "a.vert:7:3");
        let literal = ShortLiteral { place: at("a.vert:2:1"), stands_for: "π".into(), off: 0.1 };
        diagnosis.literals.push(literal);
        assert_eq!(shown(&diagnosis).unwrap().at.to_string(), "a.vert:2:1");
        assert_eq!(shown(&Diagnosis::default()), None);
    }

    #[test]
    fn a_fault_on_several_lanes_comes_once_and_another_one_by_itself() {
        let finding = |message: &str| Finding {
            kind: FindingKind::Relation,
            message: message.into(),
            case: None,
            count: 2,
            reproduce: None,
        };
        let on = |suite: &str, lane: &str, message: &str| {
            let fault = fault(&finding(message));
            let seen = Seen { suite: suite.into(), lanes: vec![format!("{lane}/vertex")], fault };
            of_finding(seen, "a.vert", &finding(message))
        };
        let items = vec![
            on("s", "vulkan", "`p` is not `q`"),
            on("s", "opengl", "`p` is not `q`"),
            on("s", "opengl", "`p` is not `r`"),
            on("t", "opengl", "`p` is not `q`"),
        ];
        let all = once(items);
        let messages: Vec<&str> = all.iter().map(|item| item.message.as_str()).collect();
        let expected = [
            "s on vulkan/vertex and 1 more: `p` is not `q`",
            "s on opengl/vertex: `p` is not `r`",
            "t on opengl/vertex: `p` is not `q`",
        ];
        assert_eq!(messages, expected);
        assert!(all[0].details.starts_with(expected[0]) && all[0].details.ends_with("\n  also on    opengl/vertex"));
        assert!(!all[1].details.contains("also on") && all[0].identity == "s: `p` is not `q`");
    }

    #[test]
    fn what_is_no_kind_of_finding_is_explained() {
        assert_eq!(about("lane"), Some("The lane failed."));
        assert_eq!(about("E001"), None);
    }
}
