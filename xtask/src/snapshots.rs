//! Finds snapshots that no test compares any more. insta appends the path of every snapshot that is
//! compared to the file named in `INSTA_SNAPSHOT_REFERENCES_FILE`.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

/// The list of compared snapshots, filled by the tests that run with [`References::record`].
pub struct References {
    file: PathBuf,
}

impl References {
    /// Starts an empty list under the build folder.
    pub fn start(target: &Path) -> Result<Self> {
        let file = target.join("snapshot-references.txt");
        fs::write(&file, "").with_context(|| format!("cannot write {}", file.display()))?;
        Ok(Self { file })
    }

    /// Makes the tests that `command` runs add to the list.
    pub fn record<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        command.env("INSTA_SNAPSHOT_REFERENCES_FILE", &self.file)
    }

    /// A line for each snapshot below `workspace` that was not compared, or that waits for review.
    pub fn complaints(&self, workspace: &Path) -> Result<Vec<String>> {
        let list = fs::read_to_string(&self.file).with_context(|| format!("cannot read {}", self.file.display()))?;
        // A listed path may go through `..` and may no longer exist.
        let compared = list.lines().filter_map(|path| fs::canonicalize(path).ok()).collect();
        Ok(complaints(&snapshots(workspace)?, &compared, workspace))
    }
}

fn complaints(snapshots: &[PathBuf], compared: &BTreeSet<PathBuf>, workspace: &Path) -> Vec<String> {
    let line = |path: &PathBuf| {
        let shown = path.strip_prefix(workspace).unwrap_or(path).display();
        if path.extension().is_some_and(|extension| extension == "new") {
            Some(format!("{shown}: a new snapshot waits for review: rename it to .snap when it is right"))
        } else if compared.contains(path) {
            None
        } else {
            Some(format!("{shown}: no test compares this snapshot: delete it"))
        }
    };
    snapshots.iter().filter_map(line).collect()
}

/// Every `.snap` and `.snap.new` of the workspace, in order.
pub fn snapshots(workspace: &Path) -> Result<Vec<PathBuf>> {
    let is_snapshot = |path: &Path| {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        name.ends_with(".snap") || name.ends_with(".snap.new")
    };
    files(workspace, &is_snapshot)
}

/// Filters for a test run that reaches every test which compares a snapshot: the modules of all
/// files that say the word, so that a helper that wraps the macro of insta is covered as well.
pub fn modules(workspace: &Path) -> Result<Vec<String>> {
    let mut modules = Vec::new();
    let mut roots = vec![workspace.join("src"), workspace.join("tests/it")];
    roots.extend(
        fs::read_dir(workspace.join("crates")).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path())),
    );
    roots.sort();
    for root in roots {
        for file in files(&root, &|path| path.extension().is_some_and(|extension| extension == "rs"))? {
            let text = fs::read_to_string(&file).with_context(|| format!("cannot read {}", file.display()))?;
            if text.contains("snapshot") {
                modules.push(module(file.strip_prefix(&root).unwrap_or(&file)));
            }
        }
    }
    Ok(modules)
}

/// The module path of a file, with `::` behind it; empty for the root of a crate.
fn module(file: &Path) -> String {
    let names = file.with_extension("");
    let names = names.iter().map(|name| name.to_string_lossy().into_owned());
    names.filter(|name| !["src", "mod", "lib", "main"].contains(&name.as_str())).map(|name| name + "::").collect()
}

fn files(root: &Path, wanted: &dyn Fn(&Path) -> bool) -> Result<Vec<PathBuf>> {
    let (mut found, mut folders) = (Vec::new(), vec![root.to_owned()]);
    while let Some(folder) = folders.pop() {
        if !folder.is_dir() {
            continue;
        }
        for entry in fs::read_dir(&folder).with_context(|| format!("cannot list {}", folder.display()))? {
            let entry = entry?;
            let (path, kind) = (entry.path(), entry.file_type()?);
            let name = entry.file_name();
            if kind.is_dir() {
                if name != "target" && !name.to_string_lossy().starts_with('.') {
                    folders.push(path);
                }
            } else if wanted(&path) {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(snapshots: &[&str], compared: &[&str]) -> Vec<String> {
        let paths = |list: &[&str]| -> Vec<PathBuf> { list.iter().map(PathBuf::from).collect() };
        complaints(&paths(snapshots), &paths(compared).into_iter().collect(), Path::new("/w"))
    }

    #[test]
    fn a_compared_snapshot_is_fine() {
        assert!(said(&["/w/tests/a.snap"], &["/w/tests/a.snap"]).is_empty());
    }

    #[test]
    fn an_unreferenced_snapshot_is_reported() {
        let lines = said(&["/w/tests/a.snap", "/w/tests/b.snap"], &["/w/tests/a.snap"]);
        assert_eq!(lines, ["tests/b.snap: no test compares this snapshot: delete it"]);
    }

    #[test]
    fn a_snapshot_that_waits_for_review_is_reported() {
        let lines = said(&["/w/tests/a.snap.new"], &["/w/tests/a.snap.new"]);
        assert_eq!(lines.len(), 1, "{lines:?}");
        assert!(lines[0].starts_with("tests/a.snap.new: a new snapshot waits"));
    }

    #[test]
    fn modules_follow_the_files() {
        assert_eq!(module(Path::new("lower/edits.rs")), "lower::edits::");
        assert_eq!(module(Path::new("lower/mod.rs")), "lower::");
        assert_eq!(module(Path::new("main.rs")), "");
    }
}
