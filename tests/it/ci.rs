//! The action, workflows and the script in `deploy/`, without a service: every key is one that GitHub or GitLab has at
//! this place, what refers to something refers to what is there, and the steps are run by a stand-in for a runner.
#![cfg(unix)]

mod keys;
mod runner;
mod templates;

use std::fs;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;
use test_record::not_run;

use crate::binary::{Ran, root};
use runner::{Event, Runner};

/// At the root, where the marketplace of GitHub wants it.
const ACTION: &str = "action.yml";
const WORKFLOW: &str = "deploy/github/workflow.yml";
const GITLAB: &str = "deploy/gitlab/.gitlab-ci.yml";
/// The workflows of this repository.
const PROJECT: &str = ".github/workflows/ci.yml";
const RELEASE: &str = ".github/workflows/release.yml";

fn text(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap()
}

/// A folder with a shader and its suite: right, or with a fault for `lint` and one for `check`.
fn project(right: bool) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let body = if right { "x / (1.0 + x)" } else { "x / (1.0 + x) * float(1 / 3)" };
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("tone.glsl", &format!("float tone(float x) {{ return {body}; }}\n"));
    write("wanted.glsl", "float tone(float x) { return x / (1.0 + x); }\n");
    write(
        "tone.suite.toml",
        "suite = \"tone\"\nshader = \"tone.glsl\"\nstage = \"function\"\nentry = \"tone\"\nsamples = 256\n\
         reference = { file = \"wanted.glsl\", function = \"tone\" }\n\n\
         [[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [0.5, 4.0]\n",
    );
    folder
}

#[test]
fn the_action_and_the_workflows_have_keys_that_are_known() {
    assert_eq!(keys::faults(&text(ACTION), &text(WORKFLOW), &text(GITLAB)), Vec::<String>::new());
}

#[test]
fn the_workflow_of_the_project_runs_everything_and_has_keys_that_are_known() {
    let faults = |workflow: &str| keys::faults(&text(ACTION), workflow, &text(GITLAB));
    let workflow = text(PROJECT);
    assert_eq!(faults(&workflow), Vec::<String>::new());
    assert!(workflow.lines().any(|line| line.trim() == "- run: .ci/run"), "{workflow}");
    assert!(root().join(".ci/run").is_file());
    assert_eq!(faults(&workflow.replacen("runs-on", "run-on", 1)).len(), 1);
}

#[test]
fn the_workflow_of_a_release_has_keys_and_values_that_are_known() {
    let faults = |workflow: &str| keys::faults(&text(ACTION), workflow, &text(GITLAB));
    let workflow = text(RELEASE);
    assert_eq!(faults(&workflow), Vec::<String>::new());
    for (from, to, part) in [
        ("tags:", "tag:", "unknown field `tag`"),
        ("id-token: write", "id-tokens: write", "unknown variant `id-tokens`"),
        ("needs: [build, wheels]", "needs: [build, wheel]", "there is no job `wheel`"),
        ("${{ matrix.target }}", "${{ matrix.triple }}", "the matrix has no `triple`"),
        ("subject-path:", "subject:", "has no input `subject`"),
    ] {
        let planted = faults(&workflow.replacen(from, to, 1));
        assert!(planted.iter().any(|fault| fault.contains(part)), "`{to}`: {planted:?}");
    }
}

#[test]
fn planted_faults_in_keys_are_reported() {
    let reported = |which: usize, from: &str, to: &str, part: &str| {
        let mut texts = [ACTION, WORKFLOW, GITLAB].map(text);
        assert!(texts[which].contains(from), "{from}");
        texts[which] = texts[which].replacen(from, to, 1);
        let faults = keys::faults(&texts[0], &texts[1], &texts[2]);
        assert!(faults.iter().any(|fault| fault.contains(part)), "`{to}`: {faults:?}");
    };
    reported(0, "using: composite", "using: docker", "unknown variant `docker`");
    reported(0, "    default: \".\"", "    defualt: \".\"", "unknown field `defualt`");
    reported(0, "      shell: bash\n", "", "has `run` and no shell");
    reported(0, "${{ inputs.lanes }}", "${{ inputs.lane }}", "there is no input `lane`");
    reported(0, "steps.run.outputs.status", "steps.runs.outputs.status", "there is no step `runs`");
    reported(0, "      id: cache\n", "      id: build\n", "two steps are called `build`");
    reported(0, "sarif_file:", "sarif-file:", "upload-sarif has no input `sarif-file`");
    reported(0, "actions/cache@v4", "actions/cache", "has no version");
    reported(1, "          paths: shaders", "          path: shaders", "the action has no input `path`");
    reported(1, "runs-on", "run-on", "unknown field `run-on`");
    reported(1, "needs: long", "needs: lang", "there is no job `lang`");
    reported(1, "security-events: write", "security-events: true", "unknown variant `true`");
    reported(1, "--shard auto", "--shared auto", "the program does not take");
    reported(2, "when: always", "when: allways", "unknown variant `allways`");
    reported(2, "      junit: shadercheck-reports", "      junit: reports", "is not below the folder of reports");
    reported(2, "deploy/plain/ci.sh", "deploy/plain/run.sh", "is not in this repository");
}

/// Runs all steps of the action, and gives the status of the last that failed.
fn act(folder: &Path, inputs: &[(&str, &str)]) -> Runner {
    let mut runner = Runner::new(&text(ACTION), folder, inputs);
    runner.set("program", env!("CARGO_BIN_EXE_shadercheck"));
    runner.set("drivers", "false");
    runner.set("lanes", "embedded");
    runner.run();
    runner
}

#[test]
fn the_action_passes_a_project_that_is_right() {
    let folder = project(true);
    let runner = act(folder.path(), &[]);
    assert_eq!(runner.status, 0, "{}", runner.log);
    assert_eq!(runner.output("run", "status"), "0");
    let summary = runner.summary();
    assert!(summary.contains("No findings.") && summary.contains("tone"), "{summary}");
    assert!(!runner.log.contains("::error"), "{}", runner.log);
    let junit = fs::read_to_string(folder.path().join("shadercheck-reports/junit.xml")).unwrap();
    assert!(junit.contains("tone") && junit.contains("failures=\"0\""), "{junit}");
    // Nothing is built or sent that nobody asked for; the reports are uploaded.
    let used: Vec<&str> = runner.events.iter().map(|Event { uses, .. }| uses.as_str()).collect();
    assert_eq!(used, ["actions/upload-artifact@v4"]);
}

#[test]
fn the_action_fails_a_project_that_is_wrong_and_tells_where() {
    let folder = project(false);
    let runner = act(folder.path(), &[("upload-sarif", "true")]);
    assert_eq!(runner.status, 1, "{}", runner.log);
    assert_eq!(runner.output("run", "status"), "1");
    let of_shader = |line: &&str| line.starts_with("::") && line.contains("tone.glsl");
    assert!(runner.log.lines().any(|line| of_shader(&line) && line.contains("T005")), "lint: {}", runner.log);
    assert!(runner.log.lines().any(|line| of_shader(&line) && !line.contains("T005")), "check: {}", runner.log);
    let summary = runner.summary();
    assert!(summary.contains("T005") && summary.contains("```"), "{summary}");
    // Reports are uploaded although there are findings, and are what they should be.
    let used: Vec<&str> = runner.events.iter().map(|Event { uses, .. }| uses.as_str()).collect();
    let sarif = "github/codeql-action/upload-sarif@v3";
    assert_eq!(used, [sarif, sarif, "actions/upload-artifact@v4"]);
    for event in &runner.events[..2] {
        let file = folder.path().join(&event.with["sarif_file"]);
        let json: serde_json::Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
        let results = json["runs"][0]["results"].as_array().unwrap();
        assert!(!results.is_empty(), "{}", file.display());
    }
    let reports = folder.path().join(&runner.events[2].with["path"]);
    let junit = fs::read_to_string(reports.join("junit.xml")).unwrap();
    assert!(junit.contains("<failure"), "{junit}");
}

#[test]
fn the_action_does_what_its_inputs_say() {
    // Lint alone: the fault of the formula does not show, and no reports of check are written.
    let folder = project(false);
    let runner = act(folder.path(), &[("run", "lint"), ("lint-args", "--ignore T005"), ("upload-reports", "")]);
    assert_eq!(runner.status, 0, "{}", runner.log);
    assert!(runner.events.is_empty() && !folder.path().join("shadercheck-reports/junit.xml").exists());
    // A folder of its own, options with blanks, and a lane that has to be there and is not.
    let folder = project(true);
    let runner = act(folder.path(), &[("run", "check"), ("args", "--samples 64 --seed 3"), ("reports", "out/here")]);
    assert_eq!(runner.status, 0, "{}", runner.log);
    let json = fs::read_to_string(folder.path().join("out/here/report.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["seed"].to_string().trim_matches('"'), "3");
    assert_eq!(runner.output("run", "reports"), "out/here");
    let runner = act(folder.path(), &[("run", "check"), ("require-lanes", "quantum")]);
    assert_eq!(runner.status, 2, "{}", runner.log);
    let runner = act(folder.path(), &[("paths", "nowhere")]);
    assert_eq!(runner.status, 2, "{}", runner.log);
    // Without a program it is built, and what was built is kept.
    let runner = {
        let mut runner = Runner::new(&text(ACTION), folder.path(), &[("program", ""), ("drivers", "true")]);
        runner.only_conditions();
        runner
    };
    let wanted = [
        "Install a Vulkan driver",
        "Download shadercheck",
        "Name the build",
        "Keep the build",
        "Build shadercheck",
        "Lint and check",
    ];
    assert_eq!(runner.would_run()[..6], wanted);
    // The linter runs no shader.
    let mut linter = Runner::new(&text(ACTION), folder.path(), &[("drivers", "true"), ("run", "lint")]);
    linter.only_conditions();
    assert!(!linter.would_run().contains(&wanted[0]), "{:?}", linter.would_run());
}

/// What the script that downloads a release says, and whether it leaves a program; `spoil` changes the archive.
fn downloaded(version: &str, spoil: bool) -> (Ran, bool) {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let name = format!("shadercheck-{}-unknown-linux-gnu", std::env::consts::ARCH);
    fs::create_dir_all(at("v1.2.3")).unwrap();
    fs::create_dir_all(at(&name)).unwrap();
    let script = "#!/bin/sh\necho shadercheck 1.2.3\n";
    fs::write(at(&name).join("shadercheck"), script).unwrap();
    let archive = at("v1.2.3").join(format!("{name}.tar.gz"));
    let shell = format!(
        "chmod +x {name}/shadercheck && tar -czf {0} {name} && shasum -a 256 {0} > {0}.sha256",
        archive.display()
    );
    let made = Command::new("sh").args(["-c", &shell]).current_dir(folder.path()).status().unwrap();
    assert!(made.success());
    if spoil {
        fs::write(&archive, "other bytes").unwrap();
    }
    let base = format!("file://{}", folder.path().display());
    let mut command = Command::new(root().join("deploy/github/download.sh"));
    let ran: Ran = command.arg(version).arg(at("out")).env("BASE", base).output().unwrap().into();
    (ran, at("out/bin/shadercheck").exists())
}

#[test]
fn a_release_is_downloaded_and_what_is_not_one_is_built() {
    if cfg!(not(target_os = "linux")) || Command::new("curl").arg("--version").output().is_err() {
        return not_run("no curl: the download of the action");
    }
    let (ran, there) = downloaded("v1.2.3", false);
    assert!(ran.code == 0 && there && ran.out.contains("shadercheck 1.2.3"), "{ran:?}");
    for (version, spoil, why) in [
        ("v1.2.4", false, "cannot be downloaded"),
        ("main", false, "`main` is no version of a release"),
        ("", false, "is no version of a release"),
        ("v1.2.3", true, "has another SHA-256 than its release says"),
    ] {
        let (ran, there) = downloaded(version, spoil);
        assert!(ran.code == 1 && !there && ran.out.contains(why), "{version}: {ran:?}");
    }
}

fn script(folder: &Path, args: &[&str], variables: &[(&str, &str)]) -> Ran {
    let mut command = Command::new(root().join("deploy/plain/ci.sh"));
    for name in
        ["GITHUB_STEP_SUMMARY", "SUMMARY", "RUN", "ARGS", "LINT_ARGS", "FUZZ_ARGS", "REQUIRE", "FORMAT", "REPORTS"]
    {
        command.env_remove(name);
    }
    command.env("SHADERCHECK", env!("CARGO_BIN_EXE_shadercheck")).env("LANES", "embedded");
    command.args(args).envs(variables.iter().copied()).current_dir(folder).output().unwrap().into()
}

#[test]
fn the_script_alone_gives_status_and_reports() {
    let right = project(true);
    let ran = script(right.path(), &[], &[("SUMMARY", "page.md")]).expect(0);
    assert!(ran.out.contains("tone"), "{}", ran.out);
    assert!(right.path().join("shadercheck-reports/lint.sarif").exists());
    assert!(fs::read_to_string(right.path().join("page.md")).unwrap().contains("shadercheck lint"));
    let wrong = project(false);
    script(wrong.path(), &["tone.glsl"], &[("RUN", "lint")]).expect(1);
    script(wrong.path(), &["tone.suite.toml"], &[("RUN", "check")]).expect(1);
    // What has no suite is fuzzed, and what is found stands on the page and in the reports.
    fs::write(wrong.path().join("root.glsl"), "float f(float x) { return sqrt(-8.0 - x * x); }\n").unwrap();
    let variables = [("RUN", "fuzz"), ("FUZZ_ARGS", "--samples 999"), ("SUMMARY", "page.md"), ("FORMAT", "github")];
    let ran = script(wrong.path(), &["root.glsl"], &variables).expect(1);
    assert!(ran.out.contains("::error file=root.glsl,line=1,col=27,title=shadercheck no_value::"), "{}", ran.out);
    let page = fs::read_to_string(wrong.path().join("page.md")).unwrap();
    assert!(page.contains("## shadercheck fuzz failed") && page.contains("| `root.glsl` | 1 | 1 | 0 |"), "{page}");
    let junit = fs::read_to_string(wrong.path().join("shadercheck-reports/fuzz/junit.xml")).unwrap();
    assert!(junit.contains("type=\"no_value\"") && junit.contains("999 samples"), "{junit}");
    // A finding of lint does not hide that check could not be run.
    script(wrong.path(), &[], &[("REQUIRE", "quantum")]).expect(2);
    for (name, value) in [("FORMAT", "xml"), ("RUN", "lint chekc"), ("SHADERCHECK", "/nowhere/shadercheck")] {
        let ran = script(wrong.path(), &[], &[(name, value)]).expect(2);
        assert!(ran.err.contains(value.split(' ').next_back().unwrap()), "{}", ran.err);
    }
}

#[test]
fn the_script_is_one_for_every_shell() {
    for shell in ["sh", "bash"] {
        let output = Command::new(shell).arg("-n").arg(root().join("deploy/plain/ci.sh")).output().unwrap();
        assert!(output.status.success(), "{shell}: {}", String::from_utf8_lossy(&output.stderr));
    }
    let Ok(output) = Command::new("shellcheck").arg(root().join("deploy/plain/ci.sh")).output() else {
        return not_run("shellcheck is not on PATH: deploy/plain/ci.sh was not checked by it");
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}
