//! Faults in suites: a run that means nothing must not pass.

use std::fs;

use crate::binary::{Ran, root, run, run_in};

/// A copy of `fixtures/alarms/NAME.suite.toml` with its shader, changed, in a folder of its own.
fn changed(name: &str, shader: &str, changes: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut text = fs::read_to_string(root().join(format!("fixtures/alarms/{name}.suite.toml"))).unwrap();
    for (from, to) in changes.iter().chain(&[(format!("../../{shader}").as_str(), "a.glsl")]) {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    fs::write(folder.path().join("a.suite.toml"), text).unwrap();
    fs::copy(root().join(shader), folder.path().join("a.glsl")).unwrap();
    folder
}

fn weight(name: &str, changes: &[(&str, &str)]) -> Ran {
    let folder = changed(name, "shaders/chapter9/bone_weight.glsl", changes);
    run_in(folder.path(), "check a.suite.toml")
}

#[test]
fn nothing_judged_fails() {
    let ran = run("check fixtures/alarms/nothing_judged.suite.toml").expect(1);
    assert!(ran.out.contains("no sample was judged: of 1024, all are undetermined (1024 no value"));
    weight("nothing_judged", &[("[-2.0, -1.0]", "[0.0, 1.0]")]).expect(0);
}

#[test]
fn too_little_judged_fails() {
    let ran = run("check fixtures/alarms/floor.suite.toml").expect(1);
    assert!(ran.out.contains(" samples were judged; the suite asks for 1000"), "{}", ran.out);
    weight("floor", &[("judged = 1000", "judged = 400")]).expect(0);
}

#[test]
fn too_much_undetermined_fails() {
    let ran = run("check fixtures/alarms/undetermined.suite.toml").expect(1);
    assert!(ran.out.contains(" % of the samples are undetermined ("), "{}", ran.out);
    assert!(ran.out.contains("; the suite allows 5.0 %"), "{}", ran.out);
    weight(
        "undetermined",
        &[("undetermined = 0.05", "undetermined = 0.6\nreason = \"Half of the inputs have no value.\"")],
    )
    .expect(0);
}

#[test]
fn an_unknown_key_is_reported_with_the_one_that_was_meant() {
    let ran = run("check fixtures/alarms/unknown_key.suite.toml").expect(2);
    assert_eq!(
        ran.err,
        "error: fixtures/alarms/unknown_key.suite.toml:9:1: unknown key `relation`; did you mean `relations`?\n"
    );
    assert_eq!(ran.out, "");
    weight("unknown_key", &[("relation =", "relations =")]).expect(0);
}

#[test]
fn everything_that_is_wrong_in_a_suite_file_is_reported_at_once() {
    let changes = [("\"bone_weight\"\nsamples", "\"bone_wait\"\nsamples"), ("[\"weight_range\"]", "[\"weight_rang\"]")];
    let ran = weight("unknown_key", &[changes[0], changes[1], ("relation =", "relations =")]).expect(2);
    assert!(
        ran.err.contains("a.suite.toml:7:11: unknown formula `bone_wait`; did you mean `bone_weight`?"),
        "{}",
        ran.err
    );
    assert!(ran.err.contains("unknown relation `weight_rang`; did you mean `weight_range`?"), "{}", ran.err);
}

#[test]
fn inputs_that_the_shader_does_not_have_are_reported_with_their_place() {
    let ran = weight("undetermined", &[("[\"d\"]", "[\"dd\"]")]).expect(2);
    assert!(ran.out.contains("a.suite.toml:11:"), "{}{}", ran.out, ran.err);
    assert!(ran.out.contains("`dd`"), "{}{}", ran.out, ran.err);
}

#[test]
fn segments_that_a_host_does_not_draw_are_reported() {
    let ran = run("check fixtures/alarms/hair_as_drawn.suite.toml --samples 300").expect(1);
    let said = "9 of 11 segments are drawn; missing between nodes 0–1 and 10–11";
    assert!(ran.out.contains(said), "{}", ran.out);
    assert!(ran.out.contains("repeat the end nodes, which gives m − 1"), "{}", ran.out);
    assert!(ran.out.contains(" 0 deviated"), "the shader itself is right: {}", ran.out);
    // The host that repeats the end nodes draws all segments.
    let folder = changed("hair_as_drawn", "shaders/hair/hair.geom", &[("\"as-drawn\"", "\"repeat\"")]);
    fs::rename(folder.path().join("a.glsl"), folder.path().join("a.geom")).unwrap();
    let text = fs::read_to_string(folder.path().join("a.suite.toml")).unwrap().replace("a.glsl", "a.geom");
    fs::write(folder.path().join("a.suite.toml"), text).unwrap();
    let ran = run_in(folder.path(), "check a.suite.toml --samples 300").expect(0);
    assert!(ran.out.contains("11 of 11 segments are drawn"), "{}", ran.out);
}

#[test]
fn weights_that_all_underflow_are_a_finding_about_the_shader() {
    // (3 + 1)^-64 is 2^-128, below what binary32 has in full.
    let edits = [("range = [-1.0, 1.0]", "range = [3.0, 8.0]"), ("range = [1.0, 64.0]", "range = [64.0, 64.0]")];
    let ran = weight("undetermined", &edits).expect(1);
    let said = "warning: undetermined on vulkan/compute: outside of the range of binary32: ";
    assert!(ran.out.contains(said) && ran.out.contains(" undetermined, underflow: pow of "), "{}", ran.out);
    assert!(ran.out.contains(", `pow(d + 1.0, -c)` at "), "{}", ran.out);
    assert!(ran.out.contains("no sample was judged: of 1024, all are undetermined (1024 underflow)"), "{}", ran.out);
}
