//! Findings that are known and put off, in a file of the form that `lint` has: a run leaves them out, and fails for new ones.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::cli::paths::relative;
use base::diagnostic::{Code, Diagnostic, Severity};
use base::text::{Shown, SourceFile, Span, counted};
use disk::fresh;
use engine::fuzz::{self, Finding, FunctionReport};
use lint::baseline::Baseline;

/// A baseline, and how often it was needed.
pub struct Known {
    baseline: Baseline,
    paths: Paths,
    left_out: u64,
}

/// How files are called in a baseline: from its own folder on.
struct Paths(PathBuf);

impl Paths {
    fn of(path: &Path) -> Self {
        Self(real(path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))))
    }

    fn path(&self, name: &str) -> String {
        relative(&self.0, &real(Path::new(name)))
    }
}

fn real(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

impl Known {
    /// Reads a baseline.
    ///
    /// # Errors
    /// When it cannot be read, or is none.
    pub fn read(path: &Path) -> Result<Self> {
        let text = fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.shown()))?;
        let baseline = Baseline::parse(&text).with_context(|| path.shown().to_string())?;
        Ok(Self { baseline, paths: Paths::of(path), left_out: 0 })
    }

    /// Leaves out what is known of a function, each as often as it is known.
    pub fn cover(&mut self, function: &mut FunctionReport) {
        let mut findings = std::mem::take(&mut function.findings);
        let (baseline, paths, before) = (&mut self.baseline, &self.paths, findings.len());
        findings.retain(|finding| {
            let told = told(function, finding);
            !told.is_some_and(|told| baseline.takes(&told, |name| paths.path(name)))
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
    let paths = Paths::of(path);
    let baseline = Baseline::of(&found, |name| paths.path(name));
    let cannot = || format!("{}: cannot be written", path.shown());
    fresh::write(path, baseline.to_text().as_bytes()).with_context(cannot)?;
    Ok(baseline.len())
}

/// A finding as baselines know it: by its kind, its file, and the text of its line. None for a note.
fn told(function: &FunctionReport, finding: &Finding) -> Option<Diagnostic> {
    if finding.severity == fuzz::Severity::Note {
        return None;
    }
    let (file, line) = match &finding.place {
        Some(place) => (place.at.file.as_str(), place.line.as_str()),
        None => (function.at.rsplitn(3, ':').last().unwrap_or(&function.at), function.function.as_str()),
    };
    let line = SourceFile::new(file, line);
    Some(Diagnostic::new(Code(finding.kind.name()), Severity::Error, &line, Span::at(0), String::new()))
}
