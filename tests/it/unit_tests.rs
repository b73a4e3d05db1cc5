//! `shadercheck test`: what does not hold is told at its place, each beside a twin that holds.

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::binary::{Ran, run_in};

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn test(folder: &Path, arguments: &str) -> Ran {
    run_in(folder, &format!("test --lane embedded {arguments}"))
}

/// Names of tests with how they came out, and the codes of what is told.
fn told(ran: &Ran) -> (Vec<String>, Vec<String>) {
    let line = |line: &str| {
        let (mark, rest) = line.split_at_checked(4)?;
        let name = rest.split_whitespace().next()?;
        let is_test = ["ok  ", "warn", "FAIL", "--  "].contains(&mark) && rest.starts_with("  ");
        is_test.then(|| format!("{name} {}", mark.trim()))
    };
    let tests = ran.out.lines().filter_map(line).collect();
    let code = |line: &str| line.split_once('[').filter(|_| line.contains("]: ")).map(|(_, rest)| rest[..4].to_owned());
    (tests, ran.out.lines().filter_map(code).collect())
}

const MODULE: &str = "\
import package::lib::luminance;
import wgsl_test::{expect, expectEq, expectNear, expectNearVec3, expectWithin, expectUlp};
@buffer var<storage, read_write> data: array<f32, 4>;
@test fn near() { expectNear(luminance(vec3f(1.0)), 1.0); expectNearVec3(vec3f(1.0, 2.0, 3.0), vec3f(1.0, 2.0, 3.0001)); }
@test(with_a_name) fn far() { expectNearVec3(vec3f(1.0, 2.0, 3.0), vec3f(1.0, 2.1, 3.0)); }
@test fn condition() { expect(luminance(vec3f(0.5)) < 0.6); }
@test fn no_condition() { expect(luminance(vec3f(0.5)) < 0.4); }
@test fn equal() { expectEq(4294967295u, 0u - 1u); }
@test fn unequal() { expectEq(4294967295u, 4294967294u); }
@test fn ulp() { expectUlp(1.0, 1.0000001, 1u); }
@test fn no_ulp() { expectUlp(1.0, 1.0000004, 1u); }
@test fn nan() { expectNear(pow(luminance(vec3f(-1.0)), 2.0), 1.0); }
@test fn tight() { expectWithin(sin(luminance(vec3f(0.5))), 0.479425539, 0.0, 1e-6); }
@test fn wide() { expectWithin(sin(luminance(vec3f(0.5))), 0.479425539, 0.0, 1e-3); }
@test fn memory() { data[2] = 3.0; expectNear(data[2] + data[1], 3.0); }
@test fn nothing() { let x = luminance(vec3f(1.0)); }
@test fn loops() { for (var i = 0; i < 5; i++) { expectNear(f32(i), 2.0); } }
@test fn takes(x: f32) { expectNear(x, 2.0); }
";
const LIBRARY: &str = "fn luminance(c: vec3f) -> f32 { return dot(c, vec3f(0.2126, 0.7152, 0.0722)); }\n";

#[test]
fn expectations_of_wgsl_hold_or_are_told_at_their_place() {
    let folder = folder(&[("a.test.wesl", MODULE), ("lib.wesl", LIBRARY)]);
    let ran = test(folder.path(), ".").expect(1);
    let (tests, codes) = told(&ran);
    let expected = [
        "near ok",
        "with_a_name FAIL",
        "condition ok",
        "no_condition FAIL",
        "equal ok",
        "unequal FAIL",
        "ulp ok",
        "no_ulp FAIL",
        "nan FAIL",
        "tight warn",
        "wide ok",
        "memory ok",
        "nothing warn",
        "loops FAIL",
        "takes --",
    ];
    assert_eq!(tests, expected, "{}", ran.out);
    assert_eq!(codes, ["U001", "U001", "U001", "U001", "U001", "U002", "U003", "U001"], "{}", ran.out);
    assert!(ran.out.contains("a.test.wesl:5:31") && ran.out.contains("y: 2.0, and 2.1 is expected"), "{}", ran.out);
    assert!(ran.out.contains("NaN, and 1.0 is expected") && ran.out.contains("4294967295"), "{}", ran.out);
    assert!(ran.out.ends_with("fail: 8 tests passed, 6 failed, 1 not run, 2 warnings\n"), "{}", ran.out);
    // What may fail elsewhere fails where that is asked for.
    test(folder.path(), "a.test.wesl --filter tight").expect(0);
    let strict = test(folder.path(), "a.test.wesl --filter tight --strict").expect(1);
    assert!(strict.out.contains("error[U002]") && strict.out.contains("(absolute)"), "{}", strict.out);
    test(folder.path(), "a.test.wesl --filter wide --strict").expect(0);
    assert!(test(folder.path(), "a.test.wesl --filter zz").expect(2).err.contains("see --filter"));
    // Other commands read such a file too.
    let fuzzed = run_in(folder.path(), "fuzz a.test.wesl --lane embedded");
    assert!(!fuzzed.out.contains("E901") && !fuzzed.out.contains("expectWithin  "), "{}", fuzzed.out);
}

#[test]
fn comments_of_glsl_are_tests() {
    let text = "#version 330\n\
        // @test white\n// expectNear(luminance(vec3(1.0)), 1.0);\n// expectNear(vec2(1.0, 2.0), vec2(1.0, 2.0));\n// expectEq(3u, 3u);\n// expectEq(true, true);\n\
        \n// @test expectUlp(luminance(vec3(1.0, 0.0, 0.0)), 0.2126, 8);\n\
        float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }\n\
        /* @test rounds:\n * for (int i = 0; i < 3; i++) {\n *   expectEq(i, 1);\n * }\n */\n\
        uniform float k;\n// @test host\n// expectNear(k, 1.0);\n\n// see @test in the manual\n";
    let old = "precision mediump float;\nfloat f(float x) { return x * x; }\n// @test expectNear(f(2.0), 4.0);\n\
        void main() { gl_FragColor = vec4(f(2.0)); }\n";
    let folder = folder(&[("a.glsl", text), ("old.frag", old), ("none.glsl", "float f() { return 1.0; }\n")]);
    let ran = test(folder.path(), "a.glsl").expect(1);
    let (tests, codes) = told(&ran);
    assert_eq!(tests, ["white ok", "line ok", "rounds FAIL", "host --"], "{}", ran.out);
    assert_eq!(codes, ["U001"], "{}", ran.out);
    assert!(ran.out.contains("a.glsl:12:6") && ran.out.contains("only a host can give"), "{}", ran.out);
    test(folder.path(), "old.frag").expect(0);
    // A folder has tests, and a file that cannot be read is told; so is a named one without a test.
    fs::write(folder.path().join("torn.frag"), [0, 159, 146, 150, 0, 1]).unwrap();
    assert!(test(folder.path(), ".").err.contains("left out: "));
    assert!(test(folder.path(), ".").expect(1).out.contains("old.frag"));
    let none = test(folder.path(), "none.glsl").expect(2);
    assert!(none.err.contains("`none.glsl` has no test"), "{}", none.err);
    // What is wrong in a test is told in its comment.
    fs::write(folder.path().join("bad.glsl"), "#version 330\n// @test\n// expectNear(g(1.0), 1.0);\n").unwrap();
    let bad = test(folder.path(), "bad.glsl").expect(1);
    assert!(bad.out.contains("error[E021]") && bad.out.contains("bad.glsl:3:15"), "{}", bad.out);
}

#[test]
fn a_lane_that_is_wrong_is_named_and_check_runs_tests_where_there_is_no_suite() {
    let folder = folder(&[("a.wesl", MODULE), ("lib.wesl", LIBRARY)]);
    let all = run_in(folder.path(), "test a.wesl --filter near --all-lanes --format json").expect(0);
    let report: Value = serde_json::from_str(&all.out).unwrap();
    let expectation = &report["files"][0]["tests"][0]["expectations"][0];
    assert_eq!((&expectation["verdict"], &expectation["line"]), (&"holds".into(), &4.into()), "{expectation:#}");
    assert!(expectation["room"].as_f64().unwrap() > 100.0, "{expectation:#}");
    let lanes = expectation["lanes"].as_array().unwrap();
    assert!(lanes.len() > 1 && lanes.iter().all(|lane| lane["conforms"] == true), "{lanes:?}");
    let checked = run_in(folder.path(), "check a.wesl --lane embedded").expect(1);
    assert!(checked.out.contains("FAIL  with_a_name"), "{}", checked.out);
    let junit = test(folder.path(), "a.wesl --format junit").expect(1);
    assert!(junit.out.contains("failures=\"6\"") && junit.out.contains("skipped=\"1\""), "{}", junit.out);
    let github = test(folder.path(), "a.wesl --format github").expect(1);
    assert!(github.out.contains("::error file=a.wesl,line=5"), "{}", github.out);
}
#[test]
fn faults_that_tests_let_pass_are_told() {
    let module = "import package::lib::luminance;\nimport wgsl_test::expectNear;\n\
        @test fn near() { expectNear(luminance(vec3f(1.0)), 1.0); }\n@test fn far() { expectNear(1.0, 2.0); }\n";
    let folder = folder(&[("a.wesl", module), ("lib.wesl", LIBRARY)]);
    let ran = run_in(folder.path(), "mutate a.wesl --format json").expect(0);
    let report: Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!(report["suites"][0]["shader"], "lib.wesl", "tests themselves stay as they are\n{report:#}");
    assert_eq!(report["suites"].as_array().unwrap().len(), 1);
    let outcome = |of: &str| {
        let mutants = report["suites"][0]["mutants"].as_array().unwrap();
        let found = mutants.iter().find(|own| own["what"].as_str().unwrap().contains(of));
        found.unwrap_or_else(|| panic!("{of}\n{report:#}"))["outcome"].as_str().unwrap().to_owned()
    };
    assert_eq!(outcome("`0.7152` becomes `0.7153`"), "survived");
    assert_eq!(outcome("`0.7152` becomes `0.0`"), "killed");
    assert!(ran.err.contains("`far` fails, and is left out"), "{}", ran.err);
    run_in(folder.path(), "mutate a.wesl --floor 100").expect(1);
    let text = "// @test one\n// expectNear(twice(1.0), 2.0);\nfloat twice(float x) { return x * 2.0; }\n";
    fs::write(folder.path().join("b.glsl"), text).unwrap();
    let ran = run_in(folder.path(), "mutate b.glsl").expect(0);
    assert!(ran.out.contains("killed by\n") && ran.out.contains("test "), "{}", ran.out);
}

#[test]
fn what_tests_reach_is_written_as_lcov() {
    let library = "fn clamped(x: f32) -> f32 {\n    if (x < 0.0) {\n        return 0.0;\n    }\n    return min(x, 1.0);\n}\n\
        fn unused(x: f32) -> f32 {\n    return x;\n}\n";
    let module = "import package::lib::clamped;\nimport wgsl_test::expectNear;\n\
        @test fn near() { expectNear(clamped(0.5), 0.5); }\n@test fn high() { expectNear(clamped(2.0), 1.0); }\n";
    let glsl = "#version 330\nfloat sum(int n) {\n  float s = 0.0;\n  for (int i = 0; i < n; i++) {\n    s += 1.0;\n    if (i > 5) {\n      \
        s = 0.0;\n    }\n  }\n  return s;\n}\n// @test expectNear(sum(3), 3.0);\n";
    let folder = folder(&[("a.wesl", module), ("lib.wesl", library), ("b.glsl", glsl)]);
    let of = |arguments: &str| {
        let ran = test(folder.path(), &format!("{arguments} --coverage out.info")).expect(0);
        (ran.err, fs::read_to_string(folder.path().join("out.info")).unwrap())
    };
    let (said, lcov) = of("a.wesl");
    assert_eq!(said, "coverage: 2 of 4 lines, 1 of 2 functions, 1 of 2 branches\n");
    let expected = "TN:\nSF:lib.wesl\nFN:1,clamped\nFNDA:2,clamped\nFN:7,unused\nFNDA:0,unused\nFNF:2\nFNH:1\nBRDA:2,0,0,0\n\
        BRDA:2,0,1,2\nBRF:2\nBRH:1\nDA:2,2\nDA:3,0\nDA:5,2\nDA:8,0\nLF:4\nLH:2\nend_of_record\n";
    assert_eq!(lcov, expected);
    let (_, lcov) = of("b.glsl");
    for line in ["FNDA:1,sum", "DA:4,4", "DA:5,3", "DA:6,3", "DA:7,0", "DA:10,1", "SF:b.glsl"] {
        assert!(lcov.contains(line), "{line}\n{lcov}");
    }
    assert!(!lcov.contains("sc_") && !lcov.contains("DA:12"), "{lcov}");
}

#[test]
fn check_hides_no_fault_of_a_suite_and_no_option_behind_tests() {
    let folder = folder(&[("a.wesl", MODULE), ("lib.wesl", LIBRARY)]);
    let asked = run_in(folder.path(), "check a.wesl --lane embedded --report-dir out").expect(2);
    assert!(asked.err.contains("is no suite file"), "{}", asked.err);
    run_in(folder.path(), "mutate a.wesl --lane embedded").expect(2);
    fs::write(folder.path().join("b.suite.toml"), "shader = 3\n").unwrap();
    let broken = run_in(folder.path(), "check .").expect(2);
    assert!(broken.err.contains("b.suite.toml"), "{}", broken.err);
}
