//! Findings that are known and put off, in a file of the form that `lint` has: a run leaves them out, and fails for new ones.

use std::path::{Path, PathBuf};

use anyhow::Result;

use crate::cli::baseline;
use base::diagnostic::{Code, Diagnostic, Severity};
use base::text::{SourceFile, Span, counted};
use engine::fuzz::{self, Finding, FunctionReport};
use lint::baseline::Baseline;
use report::ci::place;

/// A baseline, and how often it was needed.
pub struct Known {
    baseline: Baseline,
    folder: PathBuf,
    left_out: u64,
}

impl Known {
    /// Reads a baseline.
    ///
    /// # Errors
    /// When it cannot be read, or is none.
    pub fn read(path: &Path) -> Result<Self> {
        Ok(Self { baseline: baseline::read(path)?, folder: baseline::folder_of(path), left_out: 0 })
    }

    /// Leaves out what is known of a function, each as often as it is known.
    pub fn cover(&mut self, function: &mut FunctionReport) {
        let mut findings = std::mem::take(&mut function.findings);
        let (known, folder, before) = (&mut self.baseline, &self.folder, findings.len());
        findings.retain(|finding| {
            let told = told(function, finding);
            !told.is_some_and(|told| known.takes(&told, |name| path_of(folder, name)))
        });
        self.left_out += (before - findings.len()) as u64;
        function.findings = findings;
    }

    /// What to say of it; nothing where it knew none of what was found.
    pub fn note(&self) -> Option<String> {
        (self.left_out > 0).then(|| format!("{} of the baseline left out", counted(self.left_out, "finding")))
    }
}

/// Writes a baseline that knows all findings and warnings of functions, and gives their number.
///
/// # Errors
/// When it cannot be written.
pub fn record<'f>(path: &Path, functions: impl Iterator<Item = &'f FunctionReport>) -> Result<usize> {
    let all = |function: &'f FunctionReport| function.findings.iter().filter_map(|finding| told(function, finding));
    let found: Vec<Diagnostic> = functions.flat_map(all).collect();
    let folder = baseline::folder_of(path);
    let known = Baseline::of(&found, |name| path_of(&folder, name));
    baseline::save(path, &known)?;
    Ok(known.len())
}

/// How a file is called in a baseline of a folder.
fn path_of(folder: &Path, name: &str) -> String {
    baseline::path_in(folder, Path::new(name)).unwrap_or_else(|| name.to_owned())
}

/// A finding as baselines know it: by its kind, its file, and the text of its line. None for a note.
fn told(function: &FunctionReport, finding: &Finding) -> Option<Diagnostic> {
    if finding.severity == fuzz::Severity::Note {
        return None;
    }
    let (file, line) = match &finding.place {
        Some(place) => (place.at.file.as_str(), place.line.as_str()),
        None => (place(&function.at).0, function.function.as_str()),
    };
    let line = SourceFile::new(file, line);
    Some(Diagnostic::new(Code(finding.kind.name()), Severity::Error, &line, Span::at(0), String::new()))
}
