//! Runs of the real binary.

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// What a run of the binary left.
#[derive(Debug, PartialEq, Eq)]
pub struct Ran {
    /// Exit status; -1 when a signal ended it.
    pub code: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl Ran {
    /// Standard output as JSON.
    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.out).unwrap_or_else(|e| panic!("{e}\n{self:?}"))
    }

    /// Fails unless the exit status is `code`.
    #[track_caller]
    pub fn expect(self, code: i32) -> Self {
        assert_eq!(self.code, code, "\n--- stdout\n{}\n--- stderr\n{}", self.out, self.err);
        self
    }
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code().unwrap_or(-1), out: text(output.stdout), err: text(output.stderr) }
    }
}

/// Past the capture of the test harness: whoever reads the log sees what was not checked.
pub fn say(line: &str) {
    std::io::stderr().write_all(format!("{line}\n").as_bytes()).unwrap();
}

/// The project's root, in which tests run the binary unless they say otherwise.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The binary with arguments that hold no spaces, to be run in `folder`.
pub fn command(folder: &Path, args: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_shadercheck"));
    command.args(args.split_whitespace()).current_dir(folder);
    command
}

/// Runs the binary in `folder`.
pub fn run_in(folder: &Path, args: &str) -> Ran {
    command(folder, args).output().unwrap().into()
}

/// Runs the binary in the project's root.
pub fn run(args: &str) -> Ran {
    run_in(root(), args)
}

/// Runs a command of a report in `folder`, split into words as a shell would.
pub fn run_reported(folder: &Path, line: &str, more: &[&str]) -> Ran {
    let mut words = words(line).into_iter();
    assert_eq!(words.next().as_deref(), Some("shadercheck"), "{line}");
    command(folder, "").args(words).args(more).output().unwrap().into()
}

/// Words of a command line; `'` quotes.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '\'' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            c => words.last_mut().unwrap().push(c),
        }
    }
    words
}

/// The strings under `key` of a list of objects.
pub fn strings<'a>(list: &'a Value, key: &str) -> Vec<&'a str> {
    list.as_array().unwrap().iter().map(|object| object[key].as_str().unwrap_or_default()).collect()
}

#[test]
fn quoted_words_stay_together() {
    assert_eq!(words("a 'b c=1' d"), ["a", "b c=1", "d"]);
}
