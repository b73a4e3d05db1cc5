//! `junit`: test cases as CI services read them. A lane is a suite of tests, and a suite a test in it.

use quick_junit::{NonSuccessKind, Property, Report, TestCase, TestCaseStatus, TestSuite, XmlString};

use super::Format;
use super::items;
use base::diagnostic::Severity;
use engine::suite::run::{Expectation, Outcome, Standing, Summary};

/// The format.
pub const FORMAT: Format =
    Format { name: "junit", summary: "Test cases, for CI services", file: "junit.xml", write: junit };

/// The whole file.
///
/// # Errors
/// What the library says.
fn junit(summary: &Summary) -> Result<String, String> {
    let mut report = Report::new("shadercheck");
    let mut suites: Vec<TestSuite> = Vec::new();
    for entry in &summary.entries {
        let on = entry.on.map_or_else(|| "not run".to_owned(), |(lane, stage)| format!("{lane}/{stage}"));
        let all = items::of_entry(entry);
        let (errors, warnings): (Vec<_>, Vec<_>) = all.into_iter().partition(|item| item.severity == Severity::Error);
        let status = match (errors.first(), &entry.outcome) {
            (None, Outcome::Ran(_)) if entry.standing() == Standing::NotRun => {
                let mut skipped = TestCaseStatus::skipped();
                skipped.set_message(format!("not run: {}", entry.not_run().unwrap_or_default()));
                skipped
            }
            (None, Outcome::Ran(report)) if !report.known.is_empty() => expected(&report.known[0].expectation),
            (None, Outcome::KnownFailure { expectation, .. }) => expected(expectation),
            (None, _) => TestCaseStatus::success(),
            (Some(first), outcome) => {
                let kind = match outcome {
                    Outcome::Ran(_) => NonSuccessKind::Failure,
                    Outcome::Refused(_) | Outcome::LaneFailed(_) | Outcome::KnownFailure { .. } => {
                        NonSuccessKind::Error
                    }
                };
                let mut failed = TestCaseStatus::non_success(kind);
                let details: Vec<&str> = errors.iter().map(|item| item.details.trim()).collect();
                failed.set_message(first.message.as_str()).set_type(first.code.as_str());
                failed.set_description(details.join("\n\n"));
                failed
            }
        };
        let mut case = TestCase::new(entry.suite.as_str(), status);
        case.set_classname(items::relative(&entry.shader));
        case.extra.insert(XmlString::new("file"), XmlString::new(items::relative(&entry.shader)));
        if let Outcome::Ran(report) = &entry.outcome {
            let verdicts = &report.verdicts;
            let weak = if entry.standing() == Standing::Weak { "weak: " } else { "" };
            case.set_system_out(format!(
                "{weak}{} judged, {} agreed, {} deviated, {} undetermined",
                report.judged(),
                verdicts.agreed,
                verdicts.deviated,
                verdicts.undetermined_count()
            ));
            let facts = report.reach.as_ref().map(super::reach::facts).unwrap_or_default();
            case.properties.extend(facts.into_iter().map(|(name, value)| Property::new(name, value)));
        }
        if !warnings.is_empty() {
            let text: Vec<&str> = warnings.iter().map(|item| item.details.trim()).collect();
            case.set_system_err(text.join("\n\n"));
        }
        let at = suites.iter().position(|suite| suite.name.as_str() == on).unwrap_or_else(|| {
            suites.push(TestSuite::new(on));
            suites.len() - 1
        });
        suites[at].add_test_case(case);
    }
    for (lane, shortcoming) in summary.shortcomings() {
        let mut failed = TestCaseStatus::non_success(NonSuccessKind::Error);
        failed.set_message(shortcoming).set_type("lane");
        let mut suite = TestSuite::new(lane);
        suite.add_test_case(TestCase::new("the lane", failed));
        suites.push(suite);
    }
    report.add_test_suites(suites);
    report.to_string().map_err(|error| error.to_string())
}

/// The format has no word for a failure that is expected; other tools tell it as a test that is skipped.
fn expected(expectation: &Expectation) -> TestCaseStatus {
    let mut skipped = TestCaseStatus::skipped();
    skipped.set_message(format!("known failure: {expectation}"));
    skipped
}
