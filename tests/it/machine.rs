//! What other programs rely on: versions, colours, and the formats of services that show findings.

use std::collections::BTreeSet;
use std::fs;

use serde_json::Value;

use crate::binary::{Ran, command, root, run};

#[test]
fn the_version_names_what_a_report_of_a_fault_needs() {
    let short = run("--version").expect(0).out;
    assert_eq!(short, concat!("shadercheck ", env!("CARGO_PKG_VERSION"), "\n"));
    let lock = fs::read_to_string(root().join("Cargo.lock")).unwrap();
    for args in ["--version --verbose", "--verbose --version"] {
        let long = run(args).expect(0).out;
        assert!(long.starts_with(&short), "{long}");
        for library in ["naga", "wgpu"] {
            let version = long.lines().find_map(|line| line.strip_prefix(&format!("{library}: "))).unwrap();
            assert!(lock.contains(&format!("name = \"{library}\"\nversion = \"{version}\"\n")), "{long}");
        }
        assert!(long.contains("\ncommit: ") && long.contains("\nfeatures: lint, run, drivers\n"), "{long}");
    }
    assert!(run("--verbose lint .").expect(2).err.contains("--version"));
}

/// A run of the linter on the tour with variables of the environment set.
fn colored(args: &str, variables: &[(&str, &str)]) -> bool {
    let mut command = command(root(), &format!("lint fixtures/tour --lang en {args}"));
    for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
        command.env_remove(name);
    }
    let ran: Ran = command.envs(variables.iter().copied()).output().unwrap().into();
    ran.expect(1).out.contains('\u{1b}')
}

#[test]
fn colours_follow_the_option_and_the_environment() {
    assert!(!colored("", &[]), "a pipe has none");
    assert!(colored("--color always", &[("NO_COLOR", "1")]));
    assert!(colored("", &[("CLICOLOR_FORCE", "1")]));
    assert!(!colored("", &[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]));
    assert!(!colored("--color never", &[("CLICOLOR_FORCE", "1")]));
    assert!(!colored("--color always --format json", &[]), "for programs");
    assert!(run("--color sometimes lint .").expect(2).err.contains("auto, always, never"));
}

/// Findings as the formats have them: file, line, code.
type Place = (String, u64, String);

fn gitlab(report: &Value) -> BTreeSet<Place> {
    let mut prints = BTreeSet::new();
    let place = |issue: &Value| {
        assert!(prints.insert(issue["fingerprint"].as_str().unwrap().to_owned()), "twice: {issue}");
        assert!(["info", "minor", "major"].contains(&issue["severity"].as_str().unwrap()), "{issue}");
        assert!(!issue["description"].as_str().unwrap().is_empty(), "{issue}");
        let code = issue["check_name"].as_str().unwrap().split(' ').next().unwrap().to_owned();
        let location = &issue["location"];
        (location["path"].as_str().unwrap().to_owned(), location["lines"]["begin"].as_u64().unwrap(), code)
    };
    report.as_array().unwrap().iter().map(place).collect()
}

fn rdjson(report: &Value) -> BTreeSet<Place> {
    let place = |found: &Value| {
        assert!(["ERROR", "WARNING", "INFO"].contains(&found["severity"].as_str().unwrap()), "{found}");
        let location = &found["location"];
        let line = location["range"]["start"]["line"].as_u64().unwrap_or(1);
        (location["path"].as_str().unwrap().to_owned(), line, found["code"]["value"].as_str().unwrap().to_owned())
    };
    report["diagnostics"].as_array().unwrap().iter().map(place).collect()
}

#[test]
fn services_are_told_the_findings_of_lint_at_their_places() {
    let report = |format: &str| run(&format!("lint fixtures/tour --lang en --format {format}")).expect(1).json();
    let plain = report("json");
    let place = |found: &Value| {
        let text = |key: &str| found[key].as_str().unwrap().to_owned();
        (text("file"), found["line"].as_u64().unwrap(), text("code"))
    };
    let plain: BTreeSet<Place> = plain.as_array().unwrap().iter().map(place).collect();
    assert!(plain.len() > 5, "{plain:?}");
    assert_eq!(gitlab(&report("gitlab")), plain);
    assert_eq!(rdjson(&report("rdjson")), plain);
}

#[test]
fn services_are_told_the_findings_of_check() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("tone.glsl", "float tone(float x) {\n    return x / (1.0 + x) * 1.5;\n}\n");
    write("wanted.glsl", "float tone(float x) { return x / (1.0 + x); }\n");
    write(
        "tone.suite.toml",
        "suite = \"tone\"\nshader = \"tone.glsl\"\nstage = \"function\"\nentry = \"tone\"\nsamples = 64\n\
         reference = \"wanted.glsl\"\n[[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [0.5, 4.0]\n",
    );
    let report = |format: &str| -> Value {
        let ran: Ran =
            command(folder.path(), &format!("check . --lane embedded --format {format}")).output().unwrap().into();
        ran.expect(1).json()
    };
    let wanted = BTreeSet::from([("tone.glsl".to_owned(), 2, "deviation".to_owned())]);
    assert_eq!(gitlab(&report("gitlab")), wanted);
    assert_eq!(rdjson(&report("rdjson")), wanted);
    // The same run has the same fingerprints.
    let print = || report("gitlab")[0]["fingerprint"].clone();
    assert_eq!(print(), print());
}
