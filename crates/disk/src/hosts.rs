//! Files of a project that may say what its shaders are built with: host code, scripts and build files around a file.

use std::fs;
use std::path::{Component, Path, PathBuf};

use crate::elsewhere::plain;
use crate::modules::outwards;
use crate::read_source;
use base::text::{SourceFile, decode};

/// Files that are looked at, at most.
const MOST_FILES: usize = 20_000;
/// Bytes that are read, at most.
const MOST_BYTES: u64 = 256 << 20;
/// Bytes of one file, at most: larger ones are made by programs.
const LARGEST: u64 = 2 << 20;

/// Looks for files around another one, folder by folder outwards up to that of the project, each file once.
///
/// Where no folder shows a sign of a project, folders beyond the working directory may belong to anyone, and are left alone;
/// for a path that does not begin there, all folders but its own.
///
/// `wanted` tells files by their paths. `each` gets the files of one folder and what is below it, without those that it has
/// had, and says whether to go on to the folder around.
pub fn hosts_around(path: &Path, wanted: &dyn Fn(&Path) -> bool, each: &mut dyn FnMut(&[PathBuf]) -> bool) {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut left = MOST_FILES;
    let mut done: Option<PathBuf> = None;
    let (mut folders, project) = outwards(folder);
    let within =
        |folder: &PathBuf| folder.is_relative() && !folder.components().any(|part| part == Component::ParentDir);
    let last = project.unwrap_or_else(|| folders.iter().take_while(|folder| within(folder)).count().saturating_sub(1));
    folders.truncate(last + 1);
    for folder in folders {
        let mut found = Vec::new();
        below(&folder, done.as_deref(), wanted, &mut left, &mut found);
        if !each(&found) || left == 0 {
            return;
        }
        done = folder.canonicalize().ok();
    }
}

/// Files below a folder, but for one folder in it. Hidden folders and those that builds write are left out.
fn below(
    folder: &Path,
    without: Option<&Path>,
    wanted: &dyn Fn(&Path) -> bool,
    left: &mut usize,
    found: &mut Vec<PathBuf>,
) {
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        let mut paths: Vec<_> = entries.filter_map(Result::ok).map(|entry| (entry.path(), entry.file_type())).collect();
        paths.sort_by(|a, b| a.0.cmp(&b.0));
        for (path, kind) in paths {
            if *left == 0 {
                return;
            }
            *left -= 1;
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            let hidden = name.starts_with('.') || matches!(name.as_str(), "target" | "node_modules" | "third_party");
            let seen = |path: &Path| without.is_some_and(|done| path.canonicalize().ok().as_deref() == Some(done));
            match kind {
                Ok(kind) if kind.is_dir() && !hidden && !seen(&path) => open.push(path),
                Ok(kind) if kind.is_file() && wanted(&path) => found.push(path),
                _ => {}
            }
        }
    }
}

/// The bytes that may still be read for a command.
#[derive(Clone, Copy, Debug)]
pub struct Budget(u64);

impl Default for Budget {
    fn default() -> Self {
        Self(MOST_BYTES)
    }
}

impl Budget {
    /// A file as text; none for one that cannot be read, is larger than people write, or goes beyond what is read in all.
    pub fn read(&mut self, path: &Path) -> Option<SourceFile> {
        let size = fs::metadata(path).ok()?.len();
        if size > LARGEST || size > self.0 {
            return None;
        }
        self.0 -= size;
        Some(decode(&plain(path), &read_source(path).ok()?).ok()?.file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_searched_outwards_and_each_once() {
        let project = tempfile::tempdir().unwrap();
        let at = |name: &str| project.path().join(name);
        for folder in [".git", "src/shaders", "src/other", "target"] {
            fs::create_dir_all(at(folder)).unwrap();
        }
        let files = ["src/shaders/a.cpp", "src/b.cpp", "src/other/c.cpp", "d.cpp", "target/e.cpp", "f.txt"];
        files.iter().for_each(|file| fs::write(at(file), "x").unwrap());
        let mut seen: Vec<Vec<String>> = Vec::new();
        let cpp = |path: &Path| path.extension().is_some_and(|ending| ending == "cpp");
        let names = |paths: &[PathBuf]| -> Vec<String> {
            paths.iter().map(|path| path.file_name().unwrap().to_string_lossy().into_owned()).collect()
        };
        hosts_around(&at("src/shaders/k.comp"), &cpp, &mut |found| {
            seen.push(names(found));
            true
        });
        assert_eq!(seen, [vec!["a.cpp"], vec!["b.cpp", "c.cpp"], vec!["d.cpp"]]);
        seen.clear();
        hosts_around(&at("src/shaders/k.comp"), &cpp, &mut |found| {
            seen.push(names(found));
            false
        });
        assert_eq!(seen, [vec!["a.cpp"]]);
        // Without a sign of a project, files beside the folder may belong to another one.
        fs::remove_dir(at(".git")).unwrap();
        seen.clear();
        hosts_around(&at("src/shaders/k.comp"), &cpp, &mut |found| {
            seen.push(names(found));
            true
        });
        assert_eq!(seen, [vec!["a.cpp"]]);
    }
}
