//! What the tests of all crates share: the record of tests that did not run. No program needs this crate.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::PathBuf;

/// The variable that names the file of the record; `cargo xtask test` sets it. Without it, standard error alone is told.
pub const RECORD: &str = "SHADERCHECK_NOT_RUN";

/// Records that the test that calls this did not run, or ran in part, and why: what is not installed, and what was not
/// looked at because of that. A test that returns early without this call counts as one that ran.
///
/// The reason also goes to standard error, past the capture of the test harness.
///
/// # Panics
/// When the record cannot be written.
pub fn not_run(why: &str) {
    // The harness runs each test on a thread of the test's name.
    let thread = std::thread::current();
    let record = std::env::var_os(RECORD).map(PathBuf::from);
    append(thread.name().unwrap_or("a test without a name"), why, record).expect("the record of tests can be written");
}

/// One write for each line, since tests of several processes add to the same file.
fn append(test: &str, why: &str, record: Option<PathBuf>) -> io::Result<()> {
    let line = format!("{test}: {}\n", why.replace('\n', " "));
    io::stderr().write_all(format!("NOT RUN: {line}").as_bytes())?;
    let Some(path) = record else { return Ok(()) };
    OpenOptions::new().append(true).create(true).open(path)?.write_all(line.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_test_that_did_not_run_adds_a_line() {
        let folder = tempfile::tempdir().unwrap();
        let record = folder.path().join("record");
        append("a::b", "no browser", Some(record.clone())).unwrap();
        append("a::c", "two\nlines", Some(record.clone())).unwrap();
        append("a::d", "only told", None).unwrap();
        assert_eq!(std::fs::read_to_string(record).unwrap(), "a::b: no browser\na::c: two lines\n");
    }

    #[test]
    fn a_record_that_cannot_be_written_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        append("a::b", "no browser", Some(folder.path().to_owned())).unwrap_err();
    }
}
