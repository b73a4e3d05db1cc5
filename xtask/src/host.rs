//! The machine that set-up looks at and changes, behind a trait so that tests can stand in for it.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What a program left behind.
pub struct Outcome {
    /// Whether it ended with status 0.
    pub success: bool,
    /// Standard output and standard error, one after the other.
    pub output: String,
}

/// Files, environment and programs of a machine.
pub trait Host {
    /// An environment variable; none when unset, empty or not UTF-8.
    fn var(&self, name: &str) -> Option<String>;
    /// The text of a file; none when there is no such file or it cannot be read.
    fn read(&self, path: &Path) -> Option<String>;
    /// Whether a path exists.
    fn exists(&self, path: &Path) -> bool;
    /// The entries of a folder in order of name; none when there is no such folder.
    fn list(&self, path: &Path) -> Vec<PathBuf>;
    /// Runs a program with its output captured and nothing to read; none when it cannot be started.
    fn run(&mut self, command: &[&str]) -> Option<Outcome>;
}

/// The machine that this program runs on.
pub struct ThisMachine;

impl Host for ThisMachine {
    fn var(&self, name: &str) -> Option<String> {
        std::env::var(name).ok().filter(|value| !value.is_empty())
    }

    fn read(&self, path: &Path) -> Option<String> {
        std::fs::read_to_string(path).ok()
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }

    fn list(&self, path: &Path) -> Vec<PathBuf> {
        let mut entries: Vec<PathBuf> =
            std::fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
        entries.sort();
        entries
    }

    fn run(&mut self, command: &[&str]) -> Option<Outcome> {
        let (program, arguments) = command.split_first()?;
        let output = Command::new(program).args(arguments).stdin(Stdio::null()).output().ok()?;
        let text = [output.stdout, output.stderr].concat();
        Some(Outcome { success: output.status.success(), output: String::from_utf8_lossy(&text).into_owned() })
    }
}

/// The file that `program` names when it is looked up on `PATH`.
pub fn on_path(host: &dyn Host, program: &str) -> Option<PathBuf> {
    let path = host.var("PATH")?;
    std::env::split_paths(&path).map(|folder| folder.join(program)).find(|file| host.exists(file))
}

#[cfg(test)]
pub mod fake {
    //! A machine made of maps.

    use std::collections::{BTreeMap, BTreeSet};
    use std::path::{Path, PathBuf};

    use super::{Host, Outcome};

    /// A machine made of maps, with a log of the programs that were run.
    #[derive(Default)]
    pub struct Fake {
        pub vars: BTreeMap<String, String>,
        pub files: BTreeMap<PathBuf, String>,
        /// Programs that can be run: the command's beginning, its success, and what it prints.
        pub programs: Vec<(&'static str, bool, &'static str)>,
        /// Files that appear when a command that starts with the text succeeds.
        pub appear: Vec<(&'static str, &'static str, &'static str)>,
        pub log: Vec<String>,
    }

    impl Fake {
        pub fn file(mut self, path: &str, text: &str) -> Self {
            self.files.insert(path.into(), text.into());
            self
        }

        pub fn var(mut self, name: &str, value: &str) -> Self {
            self.vars.insert(name.into(), value.into());
            self
        }

        pub fn program(mut self, start: &'static str, success: bool, output: &'static str) -> Self {
            self.programs.push((start, success, output));
            self
        }
    }

    impl Host for Fake {
        fn var(&self, name: &str) -> Option<String> {
            self.vars.get(name).filter(|v| !v.is_empty()).cloned()
        }

        fn read(&self, path: &Path) -> Option<String> {
            self.files.get(path).cloned()
        }

        fn exists(&self, path: &Path) -> bool {
            self.files.keys().any(|file| file.starts_with(path))
        }

        fn list(&self, path: &Path) -> Vec<PathBuf> {
            let inside = self.files.keys().filter_map(|file| file.strip_prefix(path).ok());
            let names: BTreeSet<_> = inside.filter_map(|rest| rest.iter().next()).collect();
            names.into_iter().map(|name| path.join(name)).collect()
        }

        fn run(&mut self, command: &[&str]) -> Option<Outcome> {
            let line = command.join(" ");
            self.log.push(line.clone());
            let (_, success, output) = *self.programs.iter().find(|(start, ..)| line.starts_with(start))?;
            if success {
                for (start, path, text) in &self.appear {
                    if line.starts_with(start) {
                        self.files.insert(path.into(), (*text).into());
                    }
                }
            }
            Some(Outcome { success, output: output.into() })
        }
    }
}
