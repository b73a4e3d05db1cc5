//! The project's structure, held by tests. Each check is a function over files that gives the faults
//! it found; each has a planted fault that it must report.

mod advisories;
mod architecture;
mod dependencies;
mod lengths;
mod links;
mod paths;
mod publish;
mod readme;
mod suites;
mod unsafe_code;
mod wording;
mod writers;

use std::fmt;
use std::fs;
use std::path::Path;
use std::process::Command;

/// A file of the project: its path from the root with `/`, and its text.
struct File {
    path: String,
    text: String,
}

/// What is wrong, and where.
#[derive(Debug, PartialEq, Eq)]
struct Fault {
    path: String,
    line: usize,
    message: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.path, self.line, self.message)
    }
}

impl File {
    fn new(path: &str, text: &str) -> Self {
        Self { path: path.into(), text: text.into() }
    }

    fn fault(&self, line: usize, message: impl Into<String>) -> Fault {
        Fault { path: self.path.clone(), line, message: message.into() }
    }

    fn is_below(&self, folders: &[&str]) -> bool {
        folders.iter().any(|folder| self.path.strip_prefix(folder).is_some_and(|rest| rest.starts_with('/')))
    }
}

/// Every file that git tracks or would track. Bytes that are not UTF-8 become replacement
/// characters: some fixtures are broken on purpose.
fn project() -> Vec<File> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let listed = Command::new("git")
        .args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"])
        .current_dir(root)
        .output()
        .expect("git is needed to list the project's files");
    assert!(listed.status.success(), "git ls-files: {}", String::from_utf8_lossy(&listed.stderr));
    let list = String::from_utf8(listed.stdout).expect("paths of the project are UTF-8");
    let read = |path: &str| {
        // A tracked file that was deleted is still listed; a broken link cannot be read.
        let bytes = fs::read(root.join(path)).ok()?;
        Some(File { path: path.into(), text: String::from_utf8_lossy(&bytes).into_owned() })
    };
    let files: Vec<File> = list.split('\0').filter(|path| !path.is_empty()).filter_map(read).collect();
    assert!(files.iter().any(|file| file.path == "Cargo.toml"), "the list of files is not the project's");
    files
}

/// The file at `path`.
fn file<'a>(files: &'a [File], path: &str) -> &'a File {
    files.iter().find(|file| file.path == path).unwrap_or_else(|| panic!("{path} is missing"))
}

/// Fails with one line for each fault.
#[track_caller]
fn expect_none(faults: &[Fault]) {
    let lines: Vec<String> = faults.iter().map(ToString::to_string).collect();
    assert!(faults.is_empty(), "{} faults\n{}\n", faults.len(), lines.join("\n"));
}

/// The messages alone, for planted faults.
fn messages(faults: &[Fault]) -> Vec<&str> {
    faults.iter().map(|fault| fault.message.as_str()).collect()
}

#[test]
fn a_fault_prints_as_file_and_line() {
    assert_eq!(File::new("src/a.rs", "").fault(3, "wrong").to_string(), "src/a.rs:3: wrong");
}
