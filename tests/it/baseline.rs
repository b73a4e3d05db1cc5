//! `fuzz` with a baseline: what is known is put off, and what is new is told.

use std::fs;

use crate::binary::run_in;

#[test]
fn what_a_baseline_knows_is_left_out_and_what_is_new_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let write = |text: &str| fs::write(folder.path().join("a.glsl"), text).unwrap();
    let run = |more: &str| run_in(folder.path(), &format!("fuzz a.glsl --lane embedded --samples 2048 {more}"));
    let old = "float f(float x) { return sqrt(-8.0 - x * x); }\n";
    write(old);
    run("").expect(1);
    let ran = run("--write-baseline ci/known.json").expect(2);
    assert!(ran.err.contains("ci/known.json: cannot be written"), "{ran:?}");
    let ran = run("--write-baseline known.json").expect(0);
    assert!(ran.err.contains("1 finding recorded in known.json"), "{ran:?}");
    // What does not compile cannot be put off, and is told with its place.
    fs::write(folder.path().join("broken.glsl"), "float f(float x) { return vec2(x); }\n").unwrap();
    let ran = run_in(folder.path(), "fuzz broken.glsl --lane embedded --write-baseline other.json").expect(1);
    assert!(ran.err.contains("broken.glsl:1:") && ran.err.contains("0 findings recorded"), "{ran:?}");
    // A line that moves stays known; another one with the same fault is new.
    write(&format!("\n\n{old}"));
    let ran = run("--baseline known.json").expect(0);
    assert!(ran.err.contains("1 finding of the baseline left out") && ran.out.contains("0 findings"), "{ran:?}");
    write(&format!("{old}float g(float y) {{ return sqrt(-9.0 - y * y); }}\n"));
    let ran = run("--baseline known.json --format github").expect(1);
    assert!(ran.out.contains("line=2") && !ran.out.contains("line=1,"), "{ran:?}");
    let ran = run("--baseline nothing.json").expect(2);
    assert!(ran.err.contains("nothing.json: cannot be read"), "{ran:?}");
    let ran = run("--baseline known.json --shard 0/2").expect(2);
    assert!(ran.err.contains("--shard does a part"), "{ran:?}");
}
