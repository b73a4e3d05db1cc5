//! Everything that is wrong in a run, once, in the form from which every format for other programs is made.

use std::path::Path;

use base::diagnostic::Severity;
use engine::suite::run::{Entry, Finding, Outcome, RunError, Summary};
use judge::verdict::diagnosis::{Diagnosis, Place};

/// Something that is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Item {
    /// Error or warning.
    pub severity: Severity,
    /// What it is about: the kind of a finding, or the code of an error.
    pub code: String,
    /// What is wrong, in a line.
    pub message: String,
    /// All that is known, over several lines, as people read it.
    pub details: String,
    /// The file where it shows.
    pub file: String,
    /// Line and column in it, from 1; none for a finding about the whole shader.
    pub at: Option<(usize, usize)>,
}

/// What is wrong with an entry.
pub(super) fn of_entry(entry: &Entry) -> Vec<Item> {
    let plain = |code: &str, message: String| Item {
        severity: Severity::Error,
        code: code.to_owned(),
        details: message.clone(),
        message,
        file: entry.shader.clone(),
        at: None,
    };
    match &entry.outcome {
        Outcome::Ran(report) => {
            let on = format!("{} on {}/{}", report.suite, report.lane, report.stage);
            report.findings.iter().map(|finding| of_finding(&on, &report.shader, finding)).collect()
        }
        Outcome::Refused(RunError::Shader { diagnostics, .. }) => diagnostics
            .iter()
            .map(|d| {
                let at = d.file.position(d.span.start);
                Item {
                    severity: d.severity,
                    code: d.code.0.to_owned(),
                    message: d.message.to_string(),
                    details: crate::diagnostics::text(d, base::diagnostic::Lang::En, false),
                    file: d.file.name().to_owned(),
                    at: Some((at.line, at.column)),
                }
            })
            .collect(),
        Outcome::Refused(error) => vec![plain("configuration", error.to_string())],
        Outcome::LaneFailed(message) => vec![plain("lane", message.clone())],
        Outcome::KnownFailure { .. } => Vec::new(),
    }
}

fn of_finding(on: &str, shader: &str, finding: &Finding) -> Item {
    let place = finding.case.as_ref().and_then(|case| shown(&case.diagnosis)).map(|place| &place.at);
    let at = place.and_then(|at| at.position).map(|position| (position.line, position.column));
    let file = place.map_or_else(|| shader.to_owned(), |at| at.file.clone());
    Item {
        severity: if finding.kind.is_warning() { Severity::Warning } else { Severity::Error },
        code: finding.kind.name().to_owned(),
        message: format!("{on}: {}", finding.message),
        details: super::block::block(on, shader, finding),
        file,
        at,
    }
}

/// Where a deviation shows first in the author's text.
pub(super) fn place(diagnosis: &Diagnosis) -> Option<&Place> {
    let literal = diagnosis.literals.first().map(|literal| &literal.place);
    let no_value = diagnosis.no_value.as_ref().and_then(|no_value| no_value.place.as_ref());
    let divergence = diagnosis.divergence.as_ref().map(|divergence| &divergence.place);
    literal.or(no_value).or(divergence)
}

/// What a deviation is shown at: where it shows first, or else where the wrong output is computed.
fn shown(diagnosis: &Diagnosis) -> Option<&Place> {
    place(diagnosis).or(diagnosis.written.as_ref())
}

/// Everything that is wrong in a run, in its order; what a suite shows on several lanes comes once for each.
pub(super) fn all(summary: &Summary) -> Vec<Item> {
    summary.entries.iter().flat_map(of_entry).collect()
}

/// A path as services that show findings want it: from the root of the repository on, without `./`.
pub(super) fn relative(file: &str) -> String {
    let path = Path::new(file);
    let plain: std::path::PathBuf =
        path.components().filter(|part| !matches!(part, std::path::Component::CurDir)).collect();
    plain.display().to_string().replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;
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
    fn paths_have_no_dots() {
        assert_eq!(relative("./a/./b.vert"), "a/b.vert");
        assert_eq!(relative("/a/b.vert"), "/a/b.vert");
    }
}
