//! Test cases as CI services read them: a file is a suite of tests.

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::{FileReport, Summary, TestReport, diagnostics};
use crate::diagnostics::text;
use base::diagnostic::{Diagnostic, Lang, Severity};

/// The whole file.
///
/// # Errors
/// What the library says.
pub fn junit(summary: &Summary) -> Result<String, String> {
    let mut report = Report::new("shadercheck");
    for file in &summary.files {
        let mut suite = TestSuite::new(file.file.name());
        if let Some(first) = file.errors.first() {
            let mut broken = TestCaseStatus::non_success(NonSuccessKind::Error);
            broken.set_message(first.message.to_string()).set_description(details(file.errors.iter()));
            suite.add_test_case(TestCase::new("compiles", broken));
        }
        file.tests.iter().for_each(|test| {
            suite.add_test_case(case(summary, file, test));
        });
        report.add_test_suite(suite);
    }
    report.to_string().map_err(|error| error.to_string())
}

fn case(summary: &Summary, file: &FileReport, test: &TestReport) -> TestCase {
    let found = diagnostics::of(summary, file, test);
    let of = |severity: Severity| found.iter().filter(move |own| own.severity == severity);
    let status = match (&test.outcome, of(Severity::Error).next()) {
        (Err(why), _) => {
            let mut skipped = TestCaseStatus::skipped();
            skipped.set_message(format!("not run: {why}"));
            skipped
        }
        (Ok(_), Some(first)) => {
            let mut failed = TestCaseStatus::non_success(NonSuccessKind::Failure);
            failed.set_message(first.message.to_string()).set_type(first.code.0);
            failed.set_description(details(of(Severity::Error)));
            failed
        }
        (Ok(_), None) => TestCaseStatus::success(),
    };
    let mut case = TestCase::new(test.name.as_str(), status);
    case.set_classname(file.file.name());
    if of(Severity::Warning).next().is_some() {
        case.set_system_err(details(of(Severity::Warning)));
    }
    case
}

fn details<'d>(found: impl Iterator<Item = &'d Diagnostic>) -> String {
    found.map(|own| text(own, Lang::En, false)).collect::<Vec<_>>().join("\n")
}
