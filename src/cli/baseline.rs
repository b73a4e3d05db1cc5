//! Baselines on disk: paths in one start at its own folder, so that it means the same wherever a command is called.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::cli::paths::relative;
use base::text::Shown;
use disk::fresh;
use lint::baseline::Baseline;

/// Reads a baseline.
///
/// # Errors
/// When it cannot be read, or is none.
pub fn read(path: &Path) -> Result<Baseline> {
    let text = fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.shown()))?;
    Baseline::parse(&text).with_context(|| path.shown().to_string())
}

/// Writes a baseline, in one step.
///
/// # Errors
/// When it cannot be written.
pub fn save(path: &Path, baseline: &Baseline) -> Result<()> {
    fresh::write(path, baseline.to_text().as_bytes()).with_context(|| format!("{}: cannot be written", path.shown()))
}

/// The folder that a file lies in, as the system knows it.
pub fn folder_of(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned())
}

/// How a file is called in a baseline of a folder; none for a path that is no file's.
pub fn path_in(folder: &Path, file: &Path) -> Option<String> {
    Some(relative(folder, &folder_of(file).join(file.file_name()?)))
}
