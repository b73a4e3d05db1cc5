//! `--format junit|sarif|github|markdown`, and the same as files of `--report-dir`.

use std::fs;

use quick_junit::{Report, TestCaseStatus};
use serde_json::Value;

use super::{folder, suite};
use crate::binary::{Ran, command};
use crate::sarif::all_faults;

const RIGHT: &str = "float f(float x) { return x < 0.5 ? x : 2.0 * x; }\n";

/// A suite that holds, one that does not, and one whose shader does not compile: line 2, column 3.
fn project() -> tempfile::TempDir {
    let of = |name: &str, shader: &str| {
        suite(&["x"], "reference = \"r.glsl\"").replace("f.glsl", shader).replace("\"own\"", &format!("{name:?}"))
    };
    let wrong = RIGHT.replace("2.0", "3.0");
    folder(&[
        ("r.glsl", RIGHT),
        ("a.glsl", RIGHT),
        ("a.suite.toml", &of("a", "a.glsl")),
        ("b.glsl", &wrong),
        ("b.suite.toml", &of("b", "b.glsl")),
        ("c.glsl", "float f(float x) {\n  retrun x; }\n"),
        ("c.suite.toml", &of("c", "c.glsl")),
    ])
}

fn formatted(folder: &tempfile::TempDir, format: &str) -> String {
    let ran: Ran =
        command(folder.path(), &format!("check . --lane embedded --format {format}")).output().unwrap().into();
    ran.expect(1).out
}

#[test]
fn junit_is_read_back() {
    let report = Report::deserialize_from_str(&formatted(&project(), "junit")).unwrap();
    assert_eq!((report.tests, report.failures, report.errors), (3, 1, 1));
    let cases: Vec<_> = report.test_suites.iter().flat_map(|suite| &suite.test_cases).collect();
    let status = |name: &str| &cases.iter().find(|case| case.name.as_str() == name).unwrap().status;
    assert!(matches!(status("a"), TestCaseStatus::Success { .. }));
    let TestCaseStatus::NonSuccess { message, description, .. } = status("b") else { panic!("{:?}", status("b")) };
    assert!(message.as_ref().unwrap().as_str().contains("`return` is 3.0, expected 2.0"), "{message:?}");
    assert!(description.as_ref().unwrap().as_str().contains("reproduce  shadercheck check"), "{description:?}");
    let TestCaseStatus::NonSuccess { description, .. } = status("c") else { panic!("{:?}", status("c")) };
    assert!(description.as_ref().unwrap().as_str().contains("c.glsl:2:3"), "{description:?}");
}

#[test]
fn sarif_follows_the_standard() {
    let log: Value = serde_json::from_str(&formatted(&project(), "sarif")).unwrap();
    assert_eq!(all_faults(&log), [""; 0]);
    let results = log["runs"][0]["results"].as_array().unwrap();
    let of = |file: &str| {
        results.iter().find(|r| r["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == file).unwrap()
    };
    assert_eq!(of("b.glsl")["ruleId"], "deviation");
    let inside = |r: &&Value| r["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == "c.glsl";
    let region = |r: &Value| r["locations"][0]["physicalLocation"]["region"].clone();
    let places: Vec<Value> = results.iter().filter(inside).map(region).collect();
    assert!(places.contains(&serde_json::json!({ "startLine": 2, "startColumn": 3 })), "{places:?}");
    let rules = log["runs"][0]["tool"]["driver"]["rules"].as_array().unwrap();
    for result in results {
        assert_eq!(rules[result["ruleIndex"].as_u64().unwrap() as usize]["id"], result["ruleId"]);
    }
}

#[test]
fn annotations_and_the_summary_name_what_is_wrong() {
    let folder = project();
    let lines = formatted(&folder, "github");
    assert_eq!(lines.lines().filter(|l| l.starts_with("::error ")).count(), lines.lines().count(), "{lines}");
    assert!(lines.contains("::error file=b.glsl,line=1,col=41,title=shadercheck deviation::"), "{lines}");
    assert!(lines.contains("::error file=c.glsl,line=2,col=3,title=shadercheck E"), "{lines}");
    let page = formatted(&folder, "markdown");
    assert!(page.starts_with("## shadercheck failed\n"), "{page}");
    for row in ["| ok | `a` | embedded/compute | 2048 | 0 |", "| **FAIL** | `b` |", "| **FAIL** | `c` | - |"] {
        assert!(page.contains(row), "{row}\n{page}");
    }
    assert_eq!(page.matches("<details>").count(), lines.lines().count(), "{page}");
}

#[test]
fn a_folder_of_reports_holds_every_format() {
    let folder = project();
    let ran: Ran = command(folder.path(), "check . --lane embedded --report-dir out").output().unwrap().into();
    ran.expect(1);
    let read = |name: &str| fs::read_to_string(folder.path().join("out").join(name)).unwrap();
    for (format, file) in [
        ("json", "report.json"),
        ("sarif", "report.sarif"),
        ("github", "annotations.txt"),
        ("gitlab", "code-quality.json"),
        ("rdjson", "reviewdog.json"),
        ("markdown", "summary.md"),
        ("junit", "junit.xml"),
    ] {
        // Failing cases that were saved run first the second time, and are counted.
        let again: Ran =
            command(folder.path(), &format!("check a.glsl --lane embedded --format {format}")).output().unwrap().into();
        assert!(!again.expect(0).out.is_empty() || format == "github", "{format}");
        assert!(!read(file).is_empty(), "{file}");
    }
    assert!(read("report.json").contains("\"status\": \"fail\""));
}

#[test]
fn what_a_run_reached_is_in_every_report() {
    let reports = |shader: &str| {
        let folder = folder(&[("f.glsl", shader), ("f.suite.toml", &suite(&["x"], ""))]);
        let ran: Ran = command(folder.path(), "check . --lane embedded --report-dir out").output().unwrap().into();
        ran.expect(0);
        ["summary.md", "junit.xml", "index.html"]
            .map(|name| fs::read_to_string(folder.path().join("out").join(name)).unwrap())
    };
    let [markdown, junit, page] =
        reports("float f(float x) { return (x > 0.0 ? x : -x) + (x > 3.0 ? 1.0 : 0.0) + max(x, 1.0); }\n");
    assert!(markdown.contains("\nCoverage: 1 of 2 comparisons came out both ways; "), "{markdown}");
    assert!(markdown.contains("\n- own: `x > 3.0` is never true, at ./f.glsl:1:"), "{markdown}");
    let report = Report::deserialize_from_str(&junit).unwrap();
    let properties = &report.test_suites[0].test_cases[0].properties;
    let value = |name: &str| properties.iter().find(|p| p.name.as_str() == name).map(|p| p.value.as_str().to_owned());
    assert_eq!(value("comparisons both ways").as_deref(), Some("1 of 2"), "{junit}");
    assert!(value("argument classes met").is_some_and(|value| value.contains(" of ")), "{junit}");
    assert!(page.contains("<dt>comparisons both ways</dt><dd>1 of 2</dd>"));
    assert!(page.contains("<code>x &gt; 3.0</code> is never true, at ./f.glsl:1:"));
    // A shader that asks nothing has nothing to reach.
    let [_, junit, page] = reports("float f(float x) { return x * 2.0; }\n");
    assert!(!junit.contains("comparisons") && !page.contains("<dt>comparisons both ways</dt>"), "{junit}");
}
