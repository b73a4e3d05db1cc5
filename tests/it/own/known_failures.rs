//! `expectations.toml`: failures that are expected, and those that are expected and do not come.

use std::fs;
use std::path::Path;

use quick_junit::{Report, TestCaseStatus};

use super::{folder, suite};
use crate::binary::{Ran, command};

const RIGHT: &str = "float f(float x) { return x; }\n";
const WRONG: &str = "float f(float x) { return 2.0 * x; }\n";

fn entry(rest: &str) -> String {
    format!(
        "# What is known.\n[[expected]]\nlane = \"embedded\"\nsuite = \"own\"\n{rest}\nreason = \"f is not ready\"\n"
    )
}

const DEVIATION: &str = "kind = \"deviation\"\nlink = \"https://example.org/1\"";

/// A folder with a suite over a shader, and expectations.
fn project(shader: &str, expectations: &str) -> tempfile::TempDir {
    let suite = suite(&["x"], "reference = \"r.glsl\"");
    folder(&[("f.glsl", shader), ("r.glsl", RIGHT), ("own.suite.toml", &suite), ("expectations.toml", expectations)])
}

fn check(folder: &Path, more: &str) -> Ran {
    command(folder, &format!("check . --lane embedded --samples 256 {more}")).output().unwrap().into()
}

#[test]
fn a_failure_that_is_expected_is_reported_and_does_not_fail() {
    let folder = project(WRONG, &entry(DEVIATION));
    let ran = check(folder.path(), "").expect(0);
    assert!(ran.out.starts_with("known own              embedded/compute "), "{}", ran.out);
    let reported = "\nknown: own on embedded/compute: deviation: the shader deviates from its reference: `return` is ";
    assert!(ran.out.contains(reported), "{}", ran.out);
    assert!(
        ran.out.contains("; expected: f is not ready (./expectations.toml:2:1, https://example.org/1)\n"),
        "{}",
        ran.out
    );
    assert!(ran.out.ends_with(" unsupported, 1 known failure\n") && ran.out.contains("\npass: "), "{}", ran.out);
    let json = check(folder.path(), "--format json").expect(0).json();
    assert_eq!((&json["status"], &json["totals"]["known_failures"]), (&"pass".into(), &1.into()));
    let suite = &json["suites"][0];
    assert_eq!((suite["findings"].as_array().unwrap().len(), suite["known"].as_array().unwrap().len()), (0, 1));
    assert_eq!(suite["known"][0]["expected"]["reason"], "f is not ready");
    assert!(suite["deviated"].as_u64().unwrap() > 0, "what deviates is counted all the same");
    let junit = Report::deserialize_from_str(&check(folder.path(), "--format junit").expect(0).out).unwrap();
    assert!(matches!(junit.test_suites[0].test_cases[0].status, TestCaseStatus::Skipped { .. }));
    let page = check(folder.path(), "--format markdown").expect(0).out;
    assert!(page.contains("| known | `own` |") && page.contains("### Known failures"), "{page}");
}

#[test]
fn a_failure_that_does_not_come_fails() {
    let folder = project(RIGHT, &entry(DEVIATION));
    let ran = check(folder.path(), "").expect(1);
    let reported = "own on embedded/compute: an expected failure did not come: deviation because f is not ready \
        (./expectations.toml:2:1";
    assert!(ran.out.starts_with("FAIL  own ") && ran.out.contains(reported), "{}", ran.out);
    let json = check(folder.path(), "--format json").expect(1).json();
    assert_eq!(json["suites"][0]["findings"][0]["kind"], "unexpected_pass");
    // One that comes in some runs alone may stay away.
    fs::write(folder.path().join("expectations.toml"), entry(&format!("{DEVIATION}\nalways = false"))).unwrap();
    check(folder.path(), "").expect(0);
}

#[test]
fn an_entry_covers_what_it_says_and_nothing_else() {
    for rest in [
        "kind = \"relation\"\nalways = false",
        "kind = \"deviation\"\nmessage = \"*gl_Position*\"\nalways = false",
        "kind = \"deviation\"\nstage = \"vertex\"",
        "kind = \"deviation\"\ndriver = \"*llvmpipe*\"",
        "kind = \"deviation\"\nversions = { of = \"shadercheck\", before = \"0.0.1\" }",
    ] {
        let ran = check(project(WRONG, &entry(rest)).path(), "").expect(1);
        assert!(
            ran.out.contains("the shader deviates from its reference") && !ran.out.contains("known"),
            "{rest}\n{}",
            ran.out
        );
        assert!(!ran.out.contains("did not come"), "{rest}\n{}", ran.out);
    }
    for rest in [
        "kind = \"deviation\"\nmessage = \"*`return`*\"",
        "kind = \"deviation\"\nstage = \"compute\"\ndriver = \"interpreter*\"",
        "kind = \"deviation\"\nversions = { of = \"shadercheck\", from = \"0.1\" }",
    ] {
        check(project(WRONG, &entry(rest)).path(), "").expect(0);
    }
}

#[test]
fn an_entry_about_nothing_is_reported_where_its_lane_ran() {
    let about = |lane: &str| entry(DEVIATION).replace("\"own\"", "\"gone*\"").replace("\"embedded\"", lane);
    let reported = "note: ./expectations.toml:2:1: nothing that ran is a suite `gone*`\n";
    let ran = check(project(RIGHT, &about("\"embed*\"")).path(), "").expect(0);
    assert!(ran.out.contains(reported), "{}", ran.out);
    let ran = check(project(RIGHT, &about("\"other\"")).path(), "").expect(0);
    assert!(!ran.out.contains("nothing that ran"), "{}", ran.out);
    // Of one suite that was asked for nothing follows.
    let folder = project(RIGHT, &about("\"embedded\""));
    let ran: Ran = command(folder.path(), "check own.suite.toml --lane embedded --samples 64").output().unwrap().into();
    assert!(!ran.expect(0).out.contains("nothing that ran"));
}

#[test]
fn the_nearest_ledger_up_to_the_root_of_the_repository_counts() {
    let folder = project(WRONG, &entry(DEVIATION));
    let root = folder.path();
    let inner = root.join("a/b");
    fs::create_dir_all(&inner).unwrap();
    for name in ["f.glsl", "r.glsl", "own.suite.toml"] {
        fs::rename(root.join(name), inner.join(name)).unwrap();
    }
    let from = |at: &Path, status: i32| {
        let ran: Ran = command(at, "check . --lane embedded --samples 64").output().unwrap().into();
        ran.expect(status)
    };
    // Above the working folder it counts in a repository alone.
    from(root, 0);
    from(&inner, 1);
    fs::create_dir(root.join(".git")).unwrap();
    from(&inner, 0);
    // A repository inside of it ends the search.
    fs::create_dir(root.join("a/.git")).unwrap();
    from(&inner, 1);
    fs::write(root.join("a/expectations.toml"), entry("kind = \"relation\"\nalways = false")).unwrap();
    fs::remove_dir(root.join("a/.git")).unwrap();
    from(&inner, 1);
}

#[test]
fn a_ledger_is_named_or_left_out() {
    let folder = project(WRONG, "");
    fs::write(folder.path().join("mine.toml"), entry(DEVIATION)).unwrap();
    check(folder.path(), "").expect(1);
    check(folder.path(), "--expectations mine.toml").expect(0);
    check(folder.path(), "--expectations none").expect(1);
    let ran = check(folder.path(), "--expectations gone.toml").expect(2);
    assert!(ran.err.contains("cannot read the expectations `gone.toml`"), "{}", ran.err);
    // A single case is shown in full.
    fs::write(folder.path().join("expectations.toml"), entry(DEVIATION)).unwrap();
    check(folder.path(), "").expect(0);
    let ran = check(folder.path(), "--case x=3f800000").expect(1);
    assert!(ran.out.contains("the shader deviates from its reference"), "{}", ran.out);
}

#[test]
fn what_is_wrong_in_a_ledger_is_reported_at_its_place() {
    let ran = check(project(WRONG, &entry("knd = \"deviation\"")).path(), "").expect(2);
    let reported = "./expectations.toml:5:1: unknown key `knd` in [[expected]]; did you mean `kind`?";
    assert!(ran.err.contains(reported), "{}", ran.err);
    assert!(ran.err.contains("./expectations.toml:2:1: missing key `kind` in [[expected]]"), "{}", ran.err);
    assert_eq!(ran.out, "");
}

#[test]
fn expectations_are_applied_to_the_joined_result_once() {
    for (shader, status) in [(WRONG, 0), (RIGHT, 1)] {
        let folder = project(shader, &entry(DEVIATION));
        let run = |args: &str| -> Ran { command(folder.path(), args).output().unwrap().into() };
        // Saved cases would run first the second time.
        let check = "check . --lane embedded --samples 300";
        for index in 0..3 {
            run(&format!("{check} --shard {index}/3 --shard-dir parts")).expect(0);
        }
        let whole = run(check).expect(status);
        // Elsewhere there is no such file.
        fs::remove_file(folder.path().join("expectations.toml")).unwrap();
        assert_eq!(run("merge parts").expect(status).out, whole.out);
    }
}
