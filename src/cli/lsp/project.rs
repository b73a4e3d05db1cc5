//! The files of a workspace as they are on the disk, with the texts of open documents in their places.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use ignore::WalkBuilder;

use crate::cli::lint::LintArgs;
use crate::cli::lint::files::{Loaded, has_known_ending, load_found, name};
use crate::cli::lint::groups::Groups;
use lint::Input;

/// Files that are read of a workspace; more are linted when they are opened.
const MOST_FILES: usize = 4_000;
/// Files that are read beside an open one where the whole workspace is too large.
const MOST_BESIDE: usize = 500;
/// Entries of folders that are looked at.
const MOST_ENTRIES: usize = 200_000;
/// Bytes of all files that are read.
const MOST_BYTES: u64 = 96 << 20;
/// How long the folders are searched.
const LONGEST_SEARCH: Duration = Duration::from_secs(5);

/// A workspace, read.
pub(super) struct Project {
    pub loaded: Loaded,
    /// Which configuration holds for which of them.
    pub groups: Groups,
    /// What the user should know: a wrong configuration, a workspace that is too large.
    pub messages: Vec<String>,
}

/// Reads a workspace. `open` are documents by their paths, and `before` the inputs of the last time.
pub(super) fn load(roots: &[PathBuf], open: &BTreeMap<String, String>, args: &LintArgs, before: &[Input]) -> Project {
    // Who types waits for an answer.
    let args = &LintArgs { no_variants: true, ..args.clone() };
    let mut search =
        Search { left: MOST_ENTRIES, most: MOST_FILES, bytes: 0, began: Instant::now(), found: Vec::new(), cut: false };
    roots.iter().for_each(|root| search.folder(root, None));
    // What stands beside an open document outside of all folders may belong to its program.
    for path in open.keys().map(Path::new) {
        let known = |root: &PathBuf| path.starts_with(root);
        if let Some(folder) = path.parent().filter(|_| search.cut || !roots.iter().any(known)) {
            search.left = search.left.max(MOST_BESIDE);
            search.most = search.found.len() + MOST_BESIDE;
            search.folder(folder, Some(1));
        }
    }
    search.found.sort();
    search.found.dedup();
    let mut messages = Vec::new();
    if search.cut {
        messages.push(format!(
            "The workspace is large: {} of its files are read; others are linted when they are opened, with what stands beside them",
            search.found.len()
        ));
    }
    let mut loaded = load_found(search.found, before);
    for (path, text) in open {
        let same = before.iter().find(|b| b.file.name() == path && b.file.text() == text);
        match (same, loaded.inputs.iter_mut().find(|i| i.file.name() == path)) {
            (Some(same), Some(input)) if input.reported => *input = same.clone(),
            _ => loaded.overlay(Path::new(path), text),
        }
    }
    let groups = Groups::new(args, &mut loaded).or_else(|error| {
        messages.push(format!("{error:#}"));
        Groups::new(&LintArgs { no_config: true, ..args.clone() }, &mut loaded)
    });
    let groups = groups.unwrap_or_else(|error| {
        messages.push(format!("{error:#}"));
        Groups::none()
    });
    messages.extend(groups.missing.iter().cloned());
    Project { loaded, groups, messages }
}

struct Search {
    /// Entries that may still be looked at.
    left: usize,
    /// Files that are found at most.
    most: usize,
    bytes: u64,
    began: Instant,
    found: Vec<PathBuf>,
    /// True when something was left out.
    cut: bool,
}

impl Search {
    /// Finds files below a folder. Links that lead out of it are not followed.
    fn folder(&mut self, root: &Path, depth: Option<usize>) {
        let real = std::fs::canonicalize(root).unwrap_or_else(|_| root.to_owned());
        let walk = WalkBuilder::new(root).require_git(false).git_global(false).max_depth(depth).build();
        for entry in walk.flatten() {
            let Some(left) = self.left.checked_sub(1).filter(|_| self.began.elapsed() < LONGEST_SEARCH) else {
                self.cut = true;
                return;
            };
            self.left = left;
            let path = entry.path();
            if !has_known_ending(path) || !path.is_file() {
                continue;
            }
            let leads_out = || std::fs::canonicalize(path).is_ok_and(|real_path| !real_path.starts_with(&real));
            if entry.path_is_symlink() && leads_out() {
                continue;
            }
            self.bytes += entry.metadata().map_or(0, |m| m.len());
            if self.found.len() >= self.most || self.bytes > MOST_BYTES {
                self.cut = true;
                return;
            }
            self.found.push(path.to_owned());
        }
    }
}

/// The name of a document among the inputs.
pub(super) fn name_of(path: &Path) -> String {
    name(path)
}
