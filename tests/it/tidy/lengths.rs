//! Files stay short enough to be read in one go.

use super::{Fault, File, expect_none, messages, project};

const LIMIT: usize = 600;

/// Longer files, each with its reason.
const LONGER: &[(&str, &str)] = &[];

fn too_long(files: &[File], longer: &[(&str, &str)]) -> Vec<Fault> {
    let sources = files
        .iter()
        .filter(|file| file.is_below(&["src", "crates", "xtask", "tests", "benches"]) && file.path.ends_with(".rs"));
    let fault = |file: &File| {
        let lines = file.text.lines().count();
        let excused = longer.iter().any(|(path, _)| *path == file.path);
        match (lines > LIMIT, excused) {
            (true, false) => Some(file.fault(lines, format!("{lines} lines; the limit is {LIMIT}"))),
            (false, true) => Some(file.fault(lines, format!("{lines} lines: it needs no exception"))),
            (true, true) | (false, false) => None,
        }
    };
    let mut faults: Vec<Fault> = sources.filter_map(fault).collect();
    let gone = longer.iter().filter(|(path, _)| !files.iter().any(|file| file.path == *path));
    faults.extend(gone.map(|(path, _)| File::new(path, "").fault(1, "an exception for a file that does not exist")));
    let bare = longer.iter().filter(|(_, reason)| reason.is_empty());
    faults.extend(bare.map(|(path, _)| File::new(path, "").fault(1, "an exception without a reason")));
    faults
}

#[test]
fn no_file_is_longer_than_the_limit_without_a_reason() {
    expect_none(&too_long(&project(), LONGER));
}

#[test]
fn planted_long_files_and_stale_exceptions_are_reported() {
    let long = "\n".repeat(LIMIT + 1);
    let found = |files: &[File], longer| too_long(files, longer).iter().map(|f| f.message.clone()).collect::<Vec<_>>();
    assert_eq!(found(&[File::new("src/a.rs", &long)], &[]), ["601 lines; the limit is 600"]);
    assert!(found(&[File::new("src/a.rs", &long)], &[("src/a.rs", "one table")]).is_empty());
    assert!(found(&[File::new("src/a.rs", &long[1..])], &[]).is_empty());
    assert_eq!(
        found(&[File::new("tests/a.rs", "")], &[("tests/a.rs", "one table")]),
        ["0 lines: it needs no exception"]
    );
    assert_eq!(
        messages(&too_long(&[], &[("src/b.rs", "")])),
        ["an exception for a file that does not exist", "an exception without a reason"]
    );
}
