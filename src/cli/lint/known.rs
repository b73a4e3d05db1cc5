//! The baseline of a run of the linter.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Result;

use crate::cli::baseline::{folder_of, path_in, read, save};
use base::diagnostic::Diagnostic;
use lint::baseline::{Baseline, Covered};

use super::files::Loaded;
use super::groups::Groups;

/// A baseline file, and how the linted files are called in it.
pub struct Known {
    path: PathBuf,
    folder: PathBuf,
    /// Path in the baseline of each reported file, by its name.
    paths: BTreeMap<String, String>,
}

impl Known {
    /// Prepares for a baseline at `path`; it need not exist.
    pub fn new(path: &Path, loaded: &Loaded) -> Self {
        let folder = folder_of(path);
        let reported = loaded.inputs.iter().filter(|i| i.reported).map(|i| i.file.name());
        let paths =
            reported.filter_map(|name| Some((name.to_owned(), path_in(&folder, loaded.path(name)?)?))).collect();
        Self { path: path.to_owned(), folder, paths }
    }

    fn path_of(&self, name: &str) -> String {
        self.paths.get(name).cloned().unwrap_or_else(|| name.to_owned())
    }

    /// Writes a baseline that knows these findings; gives their number.
    pub fn write(&self, found: &[Diagnostic]) -> Result<usize> {
        let baseline = Baseline::of(found, |name| self.path_of(name));
        save(&self.path, &baseline)?;
        Ok(baseline.len())
    }

    /// Takes out the findings that the baseline knows. With `prune`, what is not found any more is
    /// removed from the file.
    pub fn cover(&self, found: Vec<Diagnostic>, groups: &Groups, prune: bool) -> Result<Covered> {
        let baseline = read(&self.path)?;
        let names: BTreeMap<&str, &str> =
            self.paths.iter().map(|(name, path)| (path.as_str(), name.as_str())).collect();
        let judged = |file: &str, code: &str| match names.get(file) {
            Some(name) => groups.asks(name, code),
            // A file that is gone has no findings; one that was not linted may have them still.
            None => !self.folder.join(file).exists(),
        };
        let covered = baseline.cover(found, |name| self.path_of(name), judged);
        if prune && !covered.stale.is_empty() {
            save(&self.path, &baseline.without(&covered.stale))?;
        }
        Ok(covered)
    }
}
