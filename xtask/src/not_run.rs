//! Tests that did not run, or ran in part: each adds a line to a record (`tests/record`). They are listed before the
//! runner's own summary, which closes the output.

use std::fs;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};

use anyhow::{Context, Result};

/// The variable that tests read.
const VARIABLE: &str = "SHADERCHECK_NOT_RUN";

/// The record of one run of tests.
pub struct Record {
    file: PathBuf,
}

impl Record {
    /// Starts an empty record below the build folder.
    pub fn start(target: &Path) -> Result<Self> {
        let file = target.join("tests-not-run.txt");
        fs::write(&file, "").with_context(|| format!("cannot write {}", file.display()))?;
        Ok(Self { file })
    }

    /// What is in it so far: tests with their reasons, each once, in order.
    pub fn lines(&self) -> Result<Vec<String>> {
        let text = fs::read_to_string(&self.file).with_context(|| format!("cannot read {}", self.file.display()))?;
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines.sort();
        lines.dedup();
        Ok(lines)
    }

    /// Runs tests on this terminal, and lists those that did not run before the summary of the runner: `nextest` writes its
    /// own to standard error, the runner of cargo to standard output.
    pub fn run(&self, command: &mut Command, nextest: bool, messages: &mut dyn Write) -> Result<ExitStatus> {
        command.env(VARIABLE, &self.file);
        if nextest {
            command.stderr(Stdio::piped())
        } else {
            command.stdout(Stdio::piped())
        };
        let started = command.spawn();
        let mut child = started.with_context(|| format!("cannot start {}", command.get_program().display()))?;
        let list = || self.lines().map(|lines| listed(&lines));
        if let Some(output) = child.stderr.take() {
            forward(output, messages, list)?;
        } else if let Some(output) = child.stdout.take() {
            forward(output, &mut io::stdout(), list)?;
        }
        Ok(child.wait()?)
    }
}

/// The list as it is printed.
fn listed(lines: &[String]) -> String {
    let tests = if lines.len() == 1 { "1 test" } else { &format!("{} tests", lines.len()) };
    let why = if lines.is_empty() { "" } else { ", whole or in part, because something is not installed:" };
    let head = format!("xtask: {tests} left out{why}\n");
    lines.iter().fold(head, |text, line| text + "  " + line + "\n")
}

/// Hands lines on as they come, and puts the list in front of the summary. That of `nextest` is known when it comes; of the
/// runner of cargo there is one for each program, and the last is known at the end.
fn forward(output: impl Read, to: &mut dyn Write, list: impl Fn() -> Result<String>) -> Result<()> {
    let mut held: Vec<u8> = Vec::new();
    let mut reported = false;
    let mut output = BufReader::new(output);
    loop {
        let mut line = Vec::new();
        if output.read_until(b'\n', &mut line)? == 0 {
            break;
        }
        let text = String::from_utf8_lossy(&line);
        let summary = text.contains("Summary") && text.contains(" run: ");
        if summary && !reported {
            to.write_all(list()?.as_bytes())?;
            reported = true;
        }
        let begins = text.trim_start().starts_with("──────") || text.starts_with("test result: ");
        if begins || (!held.is_empty() && text.trim().is_empty()) {
            if begins {
                to.write_all(&std::mem::take(&mut held))?;
            }
            held.extend(line);
            continue;
        }
        to.write_all(&std::mem::take(&mut held))?;
        to.write_all(&line)?;
        to.flush()?;
    }
    if !reported {
        to.write_all(list()?.as_bytes())?;
    }
    to.write_all(&held)?;
    Ok(to.flush()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIST: &str =
        "xtask: 1 test left out, whole or in part, because something is not installed:\n  a::b: no browser\n";

    fn forwarded(output: &str) -> String {
        let mut to = Vec::new();
        forward(output.as_bytes(), &mut to, || Ok(listed(&["a::b: no browser".to_owned()]))).unwrap();
        String::from_utf8(to).unwrap()
    }

    #[test]
    fn the_list_stands_before_the_summary_of_either_runner() {
        let head = "    PASS [   0.1s] a b\n";
        let summary = "────────────\n     Summary [   0.2s] 2 tests run: 2 passed, 0 skipped\n";
        assert_eq!(forwarded(&format!("{head}{summary}")), format!("{head}{LIST}{summary}"));
        let failed = "        FAIL [   0.1s] a c\nerror: test run failed\n";
        assert_eq!(forwarded(&format!("{summary}{failed}")), format!("{LIST}{summary}{failed}"));
        let first = "running 1 test\n\ntest result: ok. 1 passed\n\n     Running b\n";
        let last = "test result: ok. 2 passed\n\n";
        assert_eq!(forwarded(&format!("{first}{last}")), format!("{first}{LIST}{last}"));
        assert_eq!(forwarded("error: could not compile\n"), format!("error: could not compile\n{LIST}"));
    }

    #[test]
    fn nothing_left_out_is_said_too() {
        assert_eq!(listed(&[]), "xtask: 0 tests left out\n");
    }

    /// A runner whose tests leave something out, as the crate `test_record` records it.
    #[cfg(unix)]
    #[test]
    fn what_tests_record_is_listed_and_a_run_without_any_is_empty() {
        let folder = std::env::temp_dir().join(format!("shadercheck-not-run-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let mut said = Vec::new();
        let mut run = |script: &str, nextest: bool| {
            let record = Record::start(&folder).unwrap();
            said.clear();
            let status = record.run(Command::new("sh").args(["-c", script]), nextest, &mut said).unwrap();
            (status.code(), record.lines().unwrap(), String::from_utf8(said.clone()).unwrap())
        };
        let planted = "for n in 1 2; do echo 'a::b: no browser' >> $SHADERCHECK_NOT_RUN; done
                       echo '   Summary [ 1s] 1 test run: 1 passed' >&2; exit 3";
        let (code, lines, text) = run(planted, true);
        assert_eq!((code, lines), (Some(3), vec!["a::b: no browser".to_owned()]));
        assert_eq!(text, format!("{LIST}   Summary [ 1s] 1 test run: 1 passed\n"));
        assert_eq!(run("true", false), (Some(0), vec![], String::new()));
        fs::remove_dir_all(&folder).unwrap();
    }
}
