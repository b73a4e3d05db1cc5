//! The baseline on disk: paths in it start at its own folder, so that it means the same wherever the
//! command is called.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::cli::paths::relative;
use base::diagnostic::Diagnostic;
use base::text::Shown;
use disk::fresh;
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
        let folder = real(path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")));
        let reported = loaded.inputs.iter().filter(|i| i.reported).map(|i| i.file.name());
        let paths = reported
            .filter_map(|name| {
                let file = loaded.path(name)?;
                let parent = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
                Some((name.to_owned(), relative(&folder, &real(parent).join(file.file_name()?))))
            })
            .collect();
        Self { path: path.to_owned(), folder, paths }
    }

    fn path_of(&self, name: &str) -> String {
        self.paths.get(name).cloned().unwrap_or_else(|| name.to_owned())
    }

    /// Writes a baseline that knows these findings; gives their number.
    pub fn write(&self, found: &[Diagnostic]) -> Result<usize> {
        let baseline = Baseline::of(found, |name| self.path_of(name));
        self.save(&baseline)?;
        Ok(baseline.len())
    }

    /// Takes out the findings that the baseline knows. With `prune`, what is not found any more is
    /// removed from the file.
    pub fn cover(&self, found: Vec<Diagnostic>, groups: &Groups, prune: bool) -> Result<Covered> {
        let name = self.path.shown();
        let text = fs::read_to_string(&self.path).with_context(|| format!("{name}: cannot be read"))?;
        let baseline = Baseline::parse(&text).with_context(|| name.to_string())?;
        let names: BTreeMap<&str, &str> =
            self.paths.iter().map(|(name, path)| (path.as_str(), name.as_str())).collect();
        let judged = |file: &str, code: &str| match names.get(file) {
            Some(name) => groups.asks(name, code),
            // A file that is gone has no findings; one that was not linted may have them still.
            None => !self.folder.join(file).exists(),
        };
        let covered = baseline.cover(found, |name| self.path_of(name), judged);
        if prune && !covered.stale.is_empty() {
            self.save(&baseline.without(&covered.stale))?;
        }
        Ok(covered)
    }

    fn save(&self, baseline: &Baseline) -> Result<()> {
        fresh::write(&self.path, baseline.to_text().as_bytes())
            .with_context(|| format!("{}: cannot be written", self.path.shown()))
    }
}

fn real(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}
