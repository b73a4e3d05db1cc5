//! `shadercheck compare`: planted differences between languages are found with their smallest input, and the twin without
//! them is equal.

use std::fs;
use std::process::Command;

use serde_json::Value;

use crate::binary::{Ran, root, run_in, run_reported};

fn compared(arguments: &str) -> Ran {
    run_in(&root().join("fixtures/compare"), &format!("compare {arguments} --lane embedded --samples 4096"))
}

fn pair<'r>(report: &'r Value, function: &str) -> &'r Value {
    let named = |pair: &&Value| pair["first"]["function"] == function;
    report["pairs"].as_array().unwrap().iter().find(named).unwrap_or_else(|| panic!("{function}: {report}"))
}

#[test]
fn the_same_functions_in_two_languages_are_equal() {
    let report = compared("functions.glsl functions.wgsl --format json").expect(0).json();
    assert_eq!((&report["status"], report["pairs"].as_array().unwrap().len()), (&"pass".into(), 4));
    for pair in report["pairs"].as_array().unwrap() {
        assert_eq!((&pair["unlike"], &pair["smallest"]), (&0.into(), &Value::Null), "{pair}");
        assert!(
            pair["equal"].as_u64().unwrap() > 4000 && pair["lanes"][0]["samples"].as_u64().unwrap() > 3000,
            "{pair}"
        );
    }
}

#[test]
fn three_slips_are_found_with_their_smallest_input() {
    let report = compared("functions.glsl slips.wgsl --format json").expect(1).json();
    let smallest = |function: &str| {
        let found = &pair(&report, function)["smallest"];
        let values = |input: &Value| {
            input["values"].as_array().unwrap().iter().map(|v| v.as_str().unwrap().to_owned()).collect::<Vec<_>>()
        };
        found["inputs"].as_array().unwrap().iter().flat_map(values).collect::<Vec<String>>()
    };
    // The sign of a remainder, the order of arguments, rows for columns.
    assert_eq!(smallest("wrapAngle"), ["-1.0"]);
    assert_eq!(smallest("heading"), ["1.0", "0.0"]);
    let turn = smallest("turn");
    assert_eq!((turn.len(), turn.iter().filter(|value| *value == "0.0").count()), (12, 8), "{turn:?}");
    assert_eq!(pair(&report, "fade")["unlike"], 0);
    let line = pair(&report, "heading")["smallest"]["reproduce"].as_str().unwrap().to_owned();
    let again = run_reported(&root().join("fixtures/compare"), &line, &["--lane", "embedded"]).expect(1);
    assert!(again.out.contains("1 of 1 samples mean something else"), "{}", again.out);
}

#[test]
fn a_version_in_git_stands_beside_the_file_of_today() {
    let folder = tempfile::tempdir().unwrap();
    let git = |arguments: &[&str]| {
        let who = ["-c", "user.name=a", "-c", "user.email=a@b.invalid"];
        let done = Command::new("git").args(who).args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(done.status.success(), "{done:?}");
    };
    let write = |body: &str| {
        fs::write(folder.path().join("f.glsl"), format!("float scaled(float x) {{ return {body}; }}\n")).unwrap();
    };
    write("x * 3.0 + 1.0");
    git(&["init", "--quiet"]);
    git(&["add", "f.glsl"]);
    git(&["commit", "--quiet", "-m", "one"]);
    let run = || run_in(folder.path(), "compare HEAD:f.glsl f.glsl --lane embedded --samples 256");
    write("1.0 + x + x * 2.0");
    run().expect(0);
    write("x * 3.0 - 1.0");
    let changed = run().expect(1);
    assert!(changed.out.contains("`return` is 4.0 in the first and 2.0 in the second"), "{}", changed.out);
}

#[test]
fn functions_without_a_value_are_not_called_equal() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("f.glsl"), "float f(float x) { return sqrt(-1.0 - x * x); }\n").unwrap();
    let ran = run_in(folder.path(), "compare f.glsl f.glsl --lane embedded --samples 256").expect(2);
    assert!(
        ran.err.contains("nothing could be compared") && ran.out.contains("0 of 256 samples mean the same"),
        "{ran:?}"
    );
    assert!(ran.out.contains("0 compared, 0 unlike, 1 not compared"), "{ran:?}");
}

#[test]
fn what_cannot_be_compared_says_what_to_do() {
    let says = |arguments: &str, code: i32| compared(arguments).expect(code).err;
    let err = says("nosuch:functions.glsl functions.wgsl", 2);
    assert!(err.contains("no file `nosuch:functions.glsl`") && err.contains("git"), "{err}");
    let err = says("functions.glsl functions.wgsl --function heding", 2);
    assert!(err.contains("the first text has no function `heding`") && err.contains("`heading`"), "{err}");
    let err = says("functions.glsl ../../shaders/chapter9/sphere.vert", 2);
    assert!(err.contains("no function in common") && err.contains("--function NAME=OTHER"), "{err}");
    let ran = compared("functions.glsl functions.wgsl --function heading=fade").expect(2);
    assert!(ran.out.contains("not compared") && ran.err.contains("nothing could be compared"), "{ran:?}");
    let err = says("functions.glsl functions.wgsl --profile none", 2);
    assert!(err.contains("needs bounds"), "{err}");
}
