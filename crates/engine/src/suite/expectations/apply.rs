//! What expectations make of a result.

use super::{Expectations, Expected, FailureKind, glob};
use crate::suite::run::{Entry, Finding, FindingKind, Known, Outcome, Report};
use lanes::Description;

impl Expectations {
    /// Applies the expectations to the result of a suite on a stage of a lane: findings that are expected become known
    /// ones, and a failure that is expected and did not come becomes a finding.
    pub fn apply(&self, entry: &mut Entry, lane: &Description) {
        let Some((_, stage)) = entry.on else { return };
        // Each is asked whether it is about the lane, so that stale ones are known.
        let of_lane: Vec<&Expected> = self.entries.iter().filter(|expected| expected.is_of(lane)).collect();
        let about: Vec<&Expected> =
            of_lane.into_iter().filter(|expected| expected.is_about(&entry.suite, stage)).collect();
        match &mut entry.outcome {
            Outcome::Ran(report) => ran(&about, report),
            Outcome::LaneFailed(message) => {
                let fits = |expected: &&&Expected| expected.kind == FailureKind::Lane && fits(expected, message);
                if let Some(expected) = about.iter().find(fits) {
                    let (message, expectation) = (std::mem::take(message), expected.expectation.clone());
                    entry.outcome = Outcome::KnownFailure { message, expectation };
                }
            }
            Outcome::Refused(_) | Outcome::KnownFailure { .. } => {}
        }
    }
}

fn fits(expected: &Expected, message: &str) -> bool {
    expected.message.as_ref().is_none_or(|pattern| glob::matches(pattern, message))
}

fn ran(about: &[&Expected], report: &mut Report) {
    let mut came = vec![false; about.len()];
    let (mut left, mut known) = (Vec::new(), Vec::new());
    for finding in std::mem::take(&mut report.findings) {
        let mut expectation = None;
        for (expected, came) in about.iter().zip(&mut came) {
            if expected.kind == FailureKind::Finding(finding.kind) && fits(expected, &finding.message) {
                *came = true;
                expectation.get_or_insert(&expected.expectation);
            }
        }
        match expectation {
            Some(expectation) => known.push(Known { finding, expectation: expectation.clone() }),
            None => left.push(finding),
        }
    }
    // What cannot run there at all has not passed.
    let passed = report.verdicts.seen() > 0;
    for (expected, came) in about.iter().zip(came) {
        if came || !expected.always || !passed {
            continue;
        }
        left.push(Finding {
            kind: FindingKind::UnexpectedPass,
            message: format!(
                "an expected failure did not come: {} because {}; remove or narrow the entry, or \
                 say `always = false`",
                expected.kind.name(),
                expected.expectation
            ),
            case: None,
            count: 0,
            reproduce: None,
        });
    }
    (report.findings, report.known) = (left, known);
    report.findings.sort_by_key(|finding| finding.kind);
}
