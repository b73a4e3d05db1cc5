//! Code that the compiler cannot check stays in the lanes that call a C interface.

use super::{Fault, File, expect_none, messages, project};

/// Folders whose files may allow it, each with the interface that they call.
const PLACES: &[&str] = &["crates/lanes/src/opengl", "crates/lanes/src/native"];

fn stray(files: &[File]) -> Vec<Fault> {
    let sources = files.iter().filter(|file| file.path.ends_with(".rs") && !file.is_below(PLACES));
    let of_file = |file: &File| {
        let given = |line: &str| ["expect(unsafe_code", "allow(unsafe_code"].iter().any(|word| line.contains(word));
        let lines = file.text.lines().enumerate().filter(|(_, line)| given(line));
        let fault = |(at, _): (usize, &str)| file.fault(at + 1, "unsafe code outside of the lanes that may have it");
        lines.map(fault).collect::<Vec<_>>()
    };
    // This file names the words itself.
    sources.filter(|file| !file.path.ends_with("tidy/unsafe_code.rs")).flat_map(of_file).collect()
}

#[test]
fn unsafe_code_stays_in_the_lanes_that_call_c() {
    expect_none(&stray(&project()));
}

#[test]
fn planted_unsafe_code_is_reported() {
    let text = "#![expect(unsafe_code, reason = \"speed\")]\n";
    let reported = ["unsafe code outside of the lanes that may have it"];
    assert_eq!(messages(&stray(&[File::new("crates/number/src/lib.rs", text)])), reported);
    assert!(stray(&[File::new("crates/lanes/src/opengl/context.rs", text)]).is_empty());
}
