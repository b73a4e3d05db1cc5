//! Reports of `fuzz`.

mod ci;
mod json;
mod text;

use base::diagnostic::Diagnostic;
use engine::fuzz::{FunctionReport, Severity};
use engine::suite::run::signal_name;
use lanes::{Description, Unavailable};

pub use ci::ci;
pub use json::json;
pub(crate) use json::{Input, inputs};
pub use text::{findings, line, totals};

/// A run of `fuzz`.
#[derive(Debug, Default)]
pub struct Summary {
    /// Seed of the inputs.
    pub seed: u64,
    /// Lanes that were used.
    pub lanes: Vec<Description>,
    /// Lanes that could not be had, by name.
    pub unavailable: Vec<(&'static str, Unavailable)>,
    /// Lanes that were asked for by name: a run without one of them is incomplete.
    pub asked: Vec<String>,
    /// The signal that ended the run before its time.
    pub interrupted: Option<u8>,
    /// The files, in the order of the command line.
    pub files: Vec<FileReport>,
}

/// What came of one file.
#[derive(Debug, Default)]
pub struct FileReport {
    /// Name of the file, as it was given.
    pub file: String,
    /// What is assumed of it, and where parts of it come from.
    pub notes: Vec<String>,
    /// Why it does not compile.
    pub errors: Vec<Diagnostic>,
    /// Its functions in the order of the text.
    pub functions: Vec<FunctionReport>,
}

/// How many of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Functions that were run.
    pub run: usize,
    /// Functions that were not.
    pub not_run: usize,
    /// Findings of the severity `Finding`.
    pub findings: usize,
    /// Findings of the severity `Warning`.
    pub warnings: usize,
    /// Findings of the severity `Note`, without those that are told in any case.
    pub notes: usize,
    /// Functions that ran, in which nothing is wrong and most samples are undetermined.
    pub weak: usize,
    /// Files that do not compile.
    pub broken: usize,
}

impl Summary {
    /// Why the run is not the one that was asked for, a line each: a lane that is missing, or a signal.
    pub fn shortcomings(&self) -> Vec<String> {
        let asked = |name: &str| self.asked.iter().any(|asked| asked == name);
        let missing = self.unavailable.iter().filter(|(name, _)| asked(name));
        let missing = missing.map(|(name, why)| format!("the lane `{name}` was asked for and is not available: {why}"));
        let interrupted = self.interrupted.map(signal_name);
        missing.chain(interrupted.map(|signal| format!("the run was interrupted by {signal}"))).collect()
    }

    /// Everything counted.
    pub fn totals(&self) -> Totals {
        let mut totals = Totals::default();
        for file in &self.files {
            totals.broken += usize::from(!file.errors.is_empty());
            for function in &file.functions {
                match function.ran() {
                    true => totals.run += 1,
                    false => totals.not_run += 1,
                }
                totals.findings += function.of(Severity::Finding).count();
                totals.warnings += function.of(Severity::Warning).count();
                totals.weak += usize::from(function.weak().is_some());
                if !function.tells_notes() {
                    totals.notes += function.of(Severity::Note).count();
                }
            }
        }
        totals
    }
}
