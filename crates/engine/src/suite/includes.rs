//! `#include` in shaders that are run: where files are looked for, and what is told of those that are not there.

use std::collections::HashSet;
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
        let mut guarded: HashSet<String> = HashSet::new();
        guarded.extend(has_guard(file).then(|| file.name().to_owned()));
        let included = include::resolve(file, &mut |wanted| {
            if failed.is_some() {
                return None;
            }
            let found = disk::included(wanted, &self.folders, &within).and_then(|found| {
                // Files that each include another one twice have no end that anyone lives to see.
                files += 1;
                bytes += found.as_ref().map_or(0, |file| file.text().len() as u64);
                guarded.extend(found.iter().filter(|file| has_guard(file)).map(|file| file.name().to_owned()));
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
        let open =
            included.cycles.into_iter().filter(|cycle| cycle.chain.iter().all(|name| !guarded.contains(&**name)));
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

/// True for a file whose first directive keeps it from being taken in twice.
fn has_guard(file: &SourceFile) -> bool {
    let first = file.text().lines().map(str::trim_start).find_map(|line| line.strip_prefix('#'));
    first.map(str::trim_start).is_some_and(|rest| {
        rest.starts_with("ifndef") || rest.starts_with("if !defined") || rest.split_whitespace().eq(["pragma", "once"])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_include_each_other_are_told_unless_a_guard_ends_it() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let told = |guard: &str| {
            std::fs::write(at("a.glsl"), format!("{guard}#include \"b.glsl\"\nfloat a;\n")).unwrap();
            std::fs::write(at("b.glsl"), "#include \"a.glsl\"\nfloat b;\n").unwrap();
            let mut includes = Includes::default();
            let whole = includes.resolve(&file(&at("a.glsl"))).unwrap();
            assert!(whole.text().contains("float b;"));
            includes.cycles().len()
        };
        assert_eq!([told(""), told("#pragma once\n"), told("#ifndef A\n#define A\n")], [1, 0, 0]);
    }

    fn file(path: &Path) -> SourceFile {
        SourceFile::new(path.display().to_string(), std::fs::read_to_string(path).unwrap())
    }

    #[test]
    fn quoted_files_lie_beside_and_others_in_the_folders() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("lib")).unwrap();
        std::fs::write(at("main.glsl"), "#include \"near.glsl\"\n#include <far.glsl>\n#include <near.glsl>\n").unwrap();
        std::fs::write(at("near.glsl"), "float near;\n").unwrap();
        std::fs::write(at("lib/far.glsl"), "float far;\n").unwrap();
        let mut includes = Includes::new(vec![at("lib")], "`-I FOLDER`");
        let whole = includes.resolve(&file(&at("main.glsl"))).unwrap();
        assert!(whole.text().contains("float near;") && whole.text().contains("float far;"));
        assert_eq!(includes.missing.iter().map(|w| w.path.as_str()).collect::<Vec<_>>(), ["near.glsl"]);
    }

    #[test]
    fn quoted_files_are_named_from_folders_around_too() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir_all(at("shaders/pass")).unwrap();
        std::fs::write(at("shaders/pass/main.comp"), "#include \"pass/own.glsl\"\n#include <pass/far.glsl>\n").unwrap();
        std::fs::write(at("shaders/pass/own.glsl"), "float own;\n").unwrap();
        std::fs::write(at("shaders/pass/far.glsl"), "float far;\n").unwrap();
        let mut includes = Includes::default();
        let whole = includes.resolve(&file(&at("shaders/pass/main.comp"))).unwrap();
        assert!(whole.text().contains("float own;"), "{}", whole.text());
        assert_eq!(includes.missing.iter().map(|w| w.path.as_str()).collect::<Vec<_>>(), ["pass/far.glsl"]);
    }

    #[test]
    fn a_file_that_is_there_and_is_no_text_is_not_called_missing() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("main.glsl"), "float a;\n#include \"b.glsl\"\n").unwrap();
        std::fs::write(at("b.glsl"), [0u8, 159, 146, 150, 0, 1]).unwrap();
        let error = Includes::default().resolve(&file(&at("main.glsl"))).unwrap_err().to_string();
        assert!(error.contains("main.glsl:2:1: cannot include `b.glsl`"), "{error}");
        std::fs::remove_file(at("b.glsl")).unwrap();
        std::fs::create_dir(at("b.glsl")).unwrap();
        let error = Includes::default().resolve(&file(&at("main.glsl"))).unwrap_err().to_string();
        assert!(error.contains("cannot include `b.glsl`"), "{error}");
    }
}
