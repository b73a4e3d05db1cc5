//! Files are written in one place, which knows devices, pipes, links and other people's files.

use super::dependencies::{is_source, is_test_file, test_modules};
use super::{Fault, File, expect_none, messages, paths, project};

/// What makes, replaces or writes a file, by the words of a path.
const WRITERS: [&[&str]; 8] = [
    &["fs", "write"],
    &["fs", "rename"],
    &["fs", "copy"],
    &["fs", "hard_link"],
    &["File", "create"],
    &["File", "create_new"],
    &["OpenOptions"],
    &["NamedTempFile"],
];

/// Where they may be.
const PLACE: &str = "crates/disk/src/fresh";

fn strays(files: &[File]) -> Vec<Fault> {
    let test_modules = test_modules(files);
    let asked = |file: &&File| is_source(file) && !file.path.starts_with(PLACE) && !is_test_file(file, &test_modules);
    let mut faults = Vec::new();
    for file in files.iter().filter(asked) {
        // A file that is not Rust is reported by the check of edges.
        for path in paths::named(&file.text).unwrap_or_default() {
            let is = |writer: &&&[&str]| path.segments.windows(writer.len()).any(|part| part.iter().eq(writer.iter()));
            if let Some(writer) = WRITERS.iter().find(is).filter(|_| !path.test) {
                let what = writer.join("::");
                faults.push(file.fault(path.line, format!("`{what}` is for {PLACE} alone; call `disk::fresh`")));
            }
        }
    }
    faults
}

#[test]
fn files_are_written_in_one_place() {
    expect_none(&strays(&project()));
}

#[test]
fn planted_writers_are_reported() {
    let count = |path: &str, text: &str| messages(&strays(&[File::new(path, text)])).len();
    assert_eq!(count("src/cli/a.rs", "use std::fs;\nfn f() { fs::write(p, b) }"), 1);
    assert_eq!(count("src/cli/a.rs", "fn f() { std::fs::rename(a, b); std::fs::File::create(p); }"), 2);
    assert_eq!(count("src/cli/a.rs", "use std::fs::OpenOptions;"), 1);
    assert_eq!(count("src/cli/a.rs", "fn f() { tempfile::NamedTempFile::new_in(p); }"), 1);
    assert_eq!(count("src/cli/a.rs", "fn f() { fs::read(p); File::open(p); fs::create_dir_all(p); }"), 0);
    assert_eq!(count("src/cli/a.rs", "#[cfg(test)]\nmod tests { fn f() { fs::write(p, b) } }"), 0);
    assert_eq!(count("crates/disk/src/fresh/target.rs", "fn f() { OpenOptions::new() }"), 0);
    assert_eq!(count("tests/it/a.rs", "fn f() { fs::write(p, b) }"), 0);
}
