//! What `mediump` and `precise` mean to `fuzz`, `lint` and the lanes.

use std::fs;

use crate::binary::{run, run_in};

const SQUARE: &str = "fuzz fixtures/precision/square.frag --samples 2048";

#[test]
fn a_square_overflows_at_mediump_in_the_range_that_is_stated() {
    let ran = run(&format!("{SQUARE} --lane embedded --domain v=[-500,500]")).expect(1);
    assert!(ran.out.contains("overflow at `mediump`"), "{}", ran.out);
    assert!(ran.out.contains("square.frag:9:32: `dot(v, v)`"), "{}", ran.out);
    let ran = run(&format!("{SQUARE} --lane embedded --domain v=[-60,60]")).expect(0);
    assert!(!ran.out.contains("mediump"), "{}", ran.out);
}

#[test]
fn the_half_lane_is_held_against_what_mediump_promises() {
    for domain in ["v=[-60,60]", "v=[-1,1]"] {
        let ran = run(&format!("{SQUARE} --lane embedded-half --domain {domain}")).expect(0);
        assert!(ran.out.contains("embedded-half"), "{}", ran.out);
    }
}

#[test]
fn the_half_lane_runs_where_it_is_named_alone() {
    let ran = run(&format!("{SQUARE} --domain v=[-1,1] --format json")).expect(0);
    assert!(!ran.out.contains("embedded-half"), "{}", ran.out);
    let ran = run("lanes").expect(0);
    assert!(ran.out.contains("embedded-half"), "{}", ran.out);
}

/// The error of a sum (Knuth), by what its variables are declared as.
fn two_sum(declared: &str) -> String {
    format!(
        "#version 450\nfloat error_of(float a, float b) {{\n  {declared} s = a + b;\n  {declared} t = s - a;\n  {declared} u = s - t;\n  \
         {declared} v = a - u;\n  {declared} w = b - t;\n  {declared} e = v + w;\n  return e;\n}}\n"
    )
}

#[test]
fn an_error_free_transformation_is_told_without_precise_and_silent_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let found = |declared: &str| {
        fs::write(folder.path().join("sum.glsl"), two_sum(declared)).unwrap();
        run_in(folder.path(), "fuzz sum.glsl --samples 4096 --lane embedded --notes").out
    };
    let loose = found("float");
    assert!(loose.contains("relies on rounding order"), "{loose}");
    let strict = found("precise float");
    assert!(!strict.contains("relies on rounding order"), "{strict}");
}
