//! `#include` in shaders that are run: where files are looked for, and what is told of those that are not there.

use std::path::{Path, PathBuf};

use super::error::LoadError;
use base::diagnostic::Diagnostic;
use base::text::{Shown, SourceFile};
use disk::MOST_BYTES;
use syntax::include::{self, Wanted};

/// Files that a text includes, at most, each as often as it does.
const MOST_FILES: u32 = 1 << 14;

/// Folders that are searched, and what was not found in them.
#[derive(Clone, Debug, Default)]
pub struct Includes {
    /// Folders that are searched for `<path>`, and for `"path"` after the folder of the file that asks.
    pub folders: Vec<PathBuf>,
    /// What was asked for and is not there. It is told only where the shader needs it.
    missing: Vec<Wanted>,
    /// Files without a guard that include themselves by way of others, each told in a sentence.
    cycles: Vec<String>,
    /// The user names the folders, and not a file.
    trusted: bool,
    /// How a user names a folder, to be said where one is missing.
    named_by: &'static str,
}

impl Includes {
    /// Folders that a user names in a certain way: `` `-I FOLDER` ``.
    pub fn new(folders: Vec<PathBuf>, named_by: &'static str) -> Self {
        Self { folders, missing: Vec::new(), cycles: Vec::new(), trusted: true, named_by }
    }

    /// Folders that a suite file names.
    pub(super) fn of_suite(folders: Vec<PathBuf>) -> Self {
        Self { trusted: false, ..Self::new(folders, "`include = [\"FOLDER\"]`") }
    }

    /// The text of a file with that of the files that it includes.
    ///
    /// # Errors
    /// [`LoadError::Include`] for a file that is there and cannot be read or is no text.
    pub fn resolve(&mut self, file: &SourceFile) -> Result<SourceFile, LoadError> {
        let mut failed = None;
        let (mut files, mut bytes) = (0, file.text().len() as u64);
        let mut within = vec![Path::new(file.name()).parent().unwrap_or(Path::new(""))];
        within.extend(self.folders.iter().filter(|_| self.trusted).map(PathBuf::as_path));
        let included = include::resolve(file, &mut |wanted| {
            if failed.is_some() {
                return None;
            }
            let found = disk::included(wanted, &self.folders, &within).and_then(|found| {
                // Files that each include another one twice have no end that anyone lives to see.
                files += 1;
                bytes += found.as_ref().map_or(0, |file| file.text().len() as u64);
                let whole = files <= MOST_FILES && bytes <= MOST_BYTES;
                whole.then_some(found).ok_or_else(|| {
                    format!("with what it includes, the text has more than {MOST_FILES} files or {MOST_BYTES} bytes")
                })
            });
            found.unwrap_or_else(|why| {
                let at = wanted.from.locate(wanted.span.start).to_string();
                failed.get_or_insert(LoadError::Include { at, path: wanted.path.clone(), why });
                None
            })
        });
        self.missing.extend(included.missing);
        let open = included.cycles.into_iter().filter(|cycle| !cycle.guarded);
        self.cycles.extend(open.map(|cycle| {
            let at = cycle.wanted.from.locate(cycle.wanted.span.start);
            let chain: Vec<&str> = cycle.chain.iter().map(|name| &**name).collect();
            format!(
                "{at}: these files include each other without a guard, and a compiler would find no end: {} -> {}; the second \
                 time is left out; begin each with `#pragma once` or `#ifndef`",
                chain.join(" -> "),
                chain.first().copied().unwrap_or_default()
            )
        }));
        failed.map_or(Ok(included.file), Err)
    }

    /// Files that include themselves, each told in a sentence.
    pub fn cycles(&self) -> &[String] {
        &self.cycles
    }

    /// A diagnostic at its place in the file that it is about, with what is known about includes that were
    /// not found.
    pub fn explained(&self, diagnostic: Diagnostic) -> Diagnostic {
        let diagnostic = diagnostic.at_origin();
        let here = |w: &&Wanted| w.from.name() == diagnostic.file.name() && w.span.touches(diagnostic.span);
        let Some(wanted) = self.missing.iter().find(here) else { return diagnostic };
        let mut searched: Vec<String> = self.folders.iter().map(|f| f.shown().to_string()).collect();
        if wanted.quoted {
            searched.insert(0, "the folder of the file and those around it".to_owned());
        }
        let message = format!("`{}` is not found", wanted.path);
        let why = match searched.is_empty() {
            true => "no folder was searched".to_owned(),
            false => format!("searched: {}", searched.join(", ")),
        };
        let new = Diagnostic::new(diagnostic.code, diagnostic.severity, &wanted.from, wanted.span, message);
        new.with_why(why).with_help(format!("name its folder with {}", self.named_by))
    }
}
