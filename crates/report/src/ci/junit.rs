//! `junit`: test cases as CI services read them.

use quick_junit::{NonSuccessKind, Property, Report, TestCase, TestCaseStatus, TestSuite, XmlString};

use super::{Format, Item, Run, Status, relative};

/// The format.
pub const FORMAT: Format =
    Format { name: "junit", summary: "Test cases, for CI services", file: "junit.xml", write: junit };

/// The whole file.
///
/// # Errors
/// What the library says.
fn junit(run: &Run) -> Result<String, String> {
    let mut report = Report::new("shadercheck");
    let mut suites: Vec<TestSuite> = Vec::new();
    for test in &run.tests {
        let status = match &test.status {
            Status::Passed => TestCaseStatus::success(),
            Status::Skipped(why) => {
                let mut skipped = TestCaseStatus::skipped();
                skipped.set_message(why.as_str());
                skipped
            }
            Status::Failed(items) => failed(NonSuccessKind::Failure, items),
            Status::Broken(items) => failed(NonSuccessKind::Error, items),
        };
        let mut case = TestCase::new(test.name.as_str(), status);
        if !test.file.is_empty() {
            let file = relative(&test.file);
            case.set_classname(file.as_str());
            case.extra.insert(XmlString::new("file"), XmlString::new(file));
        }
        if !test.output.is_empty() {
            case.set_system_out(test.output.as_str());
        }
        if !test.warnings.is_empty() {
            case.set_system_err(test.warnings.join("\n\n"));
        }
        case.properties
            .extend(test.properties.iter().map(|(name, value)| Property::new(name.as_str(), value.as_str())));
        let at = suites.iter().position(|suite| suite.name.as_str() == test.group).unwrap_or_else(|| {
            suites.push(TestSuite::new(test.group.as_str()));
            suites.len() - 1
        });
        suites[at].add_test_case(case);
    }
    report.add_test_suites(suites);
    report.to_string().map_err(|error| error.to_string())
}

fn failed(kind: NonSuccessKind, items: &[Item]) -> TestCaseStatus {
    let mut failed = TestCaseStatus::non_success(kind);
    if let Some(first) = items.first() {
        failed.set_message(first.message.as_str()).set_type(first.code.as_str());
    }
    let details: Vec<&str> = items.iter().map(|item| item.details.trim()).collect();
    failed.set_description(details.join("\n\n"));
    failed
}
