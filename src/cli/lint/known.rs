//! The baseline on disk: paths in it start at its own folder, so that it means the same wherever the
//! command is called.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, Result};

use crate::diagnostic::Diagnostic;
use crate::lint::baseline::{Baseline, Covered};

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
        let name = self.path.display();
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

    /// Replaces the file in one step, so that it is never half written.
    fn save(&self, baseline: &Baseline) -> Result<()> {
        let failed = || format!("{}: cannot be written", self.path.display());
        let mut file = tempfile::NamedTempFile::new_in(&self.folder).with_context(failed)?;
        file.write_all(baseline.to_text().as_bytes()).with_context(failed)?;
        if let Ok(metadata) = fs::metadata(&self.path) {
            file.as_file().set_permissions(metadata.permissions()).with_context(failed)?;
        } else {
            readable(&file).with_context(failed)?;
        }
        file.persist(&self.path).map_err(|error| error.error).with_context(failed)?;
        Ok(())
    }
}

/// Temporary files are for their owner alone; a new baseline is for all who read the project.
fn readable(file: &tempfile::NamedTempFile) -> std::io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        file.as_file().set_permissions(fs::Permissions::from_mode(0o644))?;
    }
    #[cfg(not(unix))]
    let _ = file;
    Ok(())
}

fn real(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// The path of `to` as seen from the folder `from`, with `/`. Both are absolute and without `..`.
fn relative(from: &Path, to: &Path) -> String {
    let (mut from, mut to) = (from.components().peekable(), to.components().peekable());
    while from.peek().is_some() && from.peek() == to.peek() {
        from.next();
        to.next();
    }
    let up = from.map(|_| "..".to_owned());
    let down = to.filter(|c| !matches!(c, Component::RootDir)).map(|c| c.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_from_the_folder_of_the_baseline() {
        let from = |a: &str, b: &str| relative(Path::new(a), Path::new(b));
        assert_eq!(from("/p", "/p/s/a.vert"), "s/a.vert");
        assert_eq!(from("/p/ci", "/p/s/a.vert"), "../s/a.vert");
        assert_eq!(from("/p", "/q/a.vert"), "../q/a.vert");
    }
}
