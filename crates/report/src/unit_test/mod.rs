//! Tests that stand in shaders: a line for each, and a diagnostic at each expectation that does not hold everywhere.

mod diagnostics;
mod json;
mod junit;
mod text;

use base::diagnostic::{Diagnostic, Severity};
use base::text::{SourceFile, Span};
use engine::unit_test::{Ran, Verdict};

pub use json::json;
pub use junit::junit;
pub use text::{line, text};

/// A test and what came of it.
#[derive(Debug)]
pub struct TestReport {
    /// What its author calls it.
    pub name: String,
    /// Its name in the file.
    pub span: Span,
    /// What it expects, or why it was not run.
    pub outcome: Result<Ran, String>,
}

impl TestReport {
    /// True for one with an expectation that does not hold.
    pub fn fails(&self) -> bool {
        self.has(|verdict| verdict == Verdict::Fails)
    }

    /// True for one with an expectation that another device may break.
    pub fn may_fail(&self) -> bool {
        self.has(|verdict| matches!(verdict, Verdict::MayFail { .. } | Verdict::NoValue))
    }

    fn has(&self, wanted: fn(Verdict) -> bool) -> bool {
        self.outcome.as_ref().is_ok_and(|ran| ran.expectations.iter().any(|own| wanted(own.verdict)))
    }
}

/// The tests of a file.
#[derive(Debug)]
pub struct FileReport {
    /// The author's file.
    pub file: SourceFile,
    /// What is worth knowing about how it was read.
    pub notes: Vec<String>,
    /// Why it does not compile.
    pub errors: Vec<Diagnostic>,
    /// Its tests.
    pub tests: Vec<TestReport>,
}

/// A run.
#[derive(Debug)]
pub struct Summary {
    /// The files with tests.
    pub files: Vec<FileReport>,
    /// The profile that bounds are derived from.
    pub profile: String,
    /// Expectations that another device may break count as failures.
    pub strict: bool,
}

/// How many tests came out in each way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Tests without an expectation that fails.
    pub passed: u64,
    /// Tests with one.
    pub failed: u64,
    /// Tests that were not run.
    pub not_run: u64,
    /// Files that do not compile.
    pub broken: u64,
    /// Warnings.
    pub warnings: u64,
}

impl Summary {
    /// How many tests came out in each way.
    pub fn totals(&self) -> Totals {
        let mut totals = Totals::default();
        for file in &self.files {
            totals.broken += u64::from(!file.errors.is_empty());
            for test in &file.tests {
                match test.outcome {
                    Err(_) => totals.not_run += 1,
                    Ok(_) if self.fails(test) => totals.failed += 1,
                    Ok(_) => totals.passed += 1,
                }
            }
        }
        let all = self.diagnostics();
        totals.warnings = all.iter().filter(|found| found.severity == Severity::Warning).count() as u64;
        totals
    }

    /// True for a test that counts as failed.
    pub fn fails(&self, test: &TestReport) -> bool {
        test.fails() || (self.strict && test.may_fail())
    }

    /// What is wrong, file by file: texts that do not compile, and expectations.
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let of = |file: &FileReport| {
            let own = file.tests.iter().flat_map(|test| diagnostics::of(self, file, test)).collect::<Vec<_>>();
            file.errors.iter().cloned().chain(own).collect::<Vec<_>>()
        };
        self.files.iter().flat_map(of).collect()
    }
}
