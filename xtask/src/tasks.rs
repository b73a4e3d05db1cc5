//! The tasks, one function each. They give the exit status to pass on.

use std::ffi::OsString;
use std::io::{IsTerminal, Write};
use std::path::Path;

use anyhow::{Context, Result};

use crate::cargo::{cargo, code, status, target, workspace};
use crate::host::ThisMachine;
use crate::not_run::Record;
use crate::setup::Packages;
use crate::snapshots::{self, References};
use crate::{against, features, setup, vulkan};

/// The gate is built in the profile of the tests: one build of the dependencies serves both tasks.
const GATE: [&str; 4] = ["--package", "shadercheck", "--bin", "shadercheck"];

/// Builds the program while the machine is set up, and runs `shadercheck check --shipped`. Without arguments the lane that decides first
/// comes first, alone; then all of them, which are compared with each other.
pub fn check(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    messages.write_all(
        b"xtask: building shadercheck: minutes the first time (about 5 on two cores), seconds after an edit\n",
    )?;
    let mut build = cargo(["build"]).args(GATE).spawn().context("cannot start cargo")?;
    let prepared = setup::prepare_lanes(&mut ThisMachine, messages);
    let built = code(build.wait()?);
    prepared?;
    if built != 0 {
        return Ok(built);
    }
    let gate = || {
        let mut gate = cargo(["run", "--quiet"]);
        gate.args(GATE).args(["--", "check", "--shipped"]);
        gate
    };
    let first = arguments.is_empty() && vulkan::find(&ThisMachine).complete();
    let first = if first { status(gate().args(["--lane", "vulkan"]))? } else { return status(gate().args(arguments)) };
    if ended_by_signal(first) {
        return Ok(first);
    }
    messages.write_all(b"\nxtask: that was the lane `vulkan`; now all lanes, compared with each other\n")?;
    Ok(first.max(status(&mut gate())?))
}

/// True for the status of a program that a person stopped.
fn ended_by_signal(status: u8) -> bool {
    status >= 128
}

/// Sets the machine up and runs all tests. The runner's own summary closes the output, and what did not run is listed before
/// it. With `--install` first, what single tests need is installed as well, and then all of them have to run.
pub fn test(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    let (install, arguments) = match arguments.split_first() {
        Some((first, rest)) if first == "--install" => (true, rest),
        _ => (false, arguments),
    };
    let workspace = workspace()?;
    let target = target(&workspace)?;
    let packages = Packages::below(&target);
    setup::prepare_lanes(&mut ThisMachine, messages)?;
    // Where something cannot be installed, which has been told, tests that need it are listed and nothing more.
    let mut complete = false;
    if install {
        let programs = setup::prepare_tests(&mut ThisMachine, messages)?;
        complete = setup::prepare_packages(&mut ThisMachine, &packages, messages)? && programs;
    }
    let nextest = cargo(["nextest", "--version"]).output().is_ok_and(|output| output.status.success());
    let mut run = match (nextest, arguments.is_empty()) {
        (true, _) => cargo(["nextest", "run", "--workspace"]),
        (false, false) => cargo(["test", "--workspace"]),
        (false, true) => cargo(["test", "--workspace", "--lib", "--bins", "--tests", "--no-fail-fast"]),
    };
    if nextest && std::env::var_os("NEXTEST_PROFILE").is_none() && std::env::var_os("CI").is_some() {
        run.args(["--profile", "ci"]);
    }
    if nextest && std::io::stderr().is_terminal() {
        // The runner does not see the terminal: colours, and a line for each test in place of a bar.
        let usual = [("CARGO_TERM_COLOR", "always"), ("NEXTEST_STATUS_LEVEL", "pass")];
        run.envs(usual.into_iter().filter(|(name, _)| std::env::var_os(name).is_none()));
    }
    packages.show(&ThisMachine, &mut run);
    let record = Record::start(&target)?;
    if !arguments.is_empty() {
        let tests = code(record.run(run.args(arguments), nextest, messages)?);
        return Ok(tests.max(incomplete(complete, &record, messages)?));
    }
    let twice = complain(&features::compiled_twice()?, messages)?;
    let references = References::start(&target)?;
    let documentation = status(references.record(&mut cargo(["test", "--workspace", "--doc"])))?;
    let tests = code(record.run(references.record(&mut run), nextest, messages)?);
    let incomplete = incomplete(complete, &record, messages)?;
    match (tests, documentation) {
        (0, 0) => Ok(complain(&references.complaints(&workspace)?, messages)?.max(incomplete).max(twice)),
        (0, failed) => {
            writeln!(messages, "xtask: documentation tests failed, see above")?;
            Ok(failed)
        }
        (failed, _) => Ok(failed),
    }
}

/// Complains when tests did not run although all that they need is there.
fn incomplete(complete: bool, record: &Record, messages: &mut dyn Write) -> Result<u8> {
    let left_out = if complete { record.lines()?.len() } else { 0 };
    let line = format!("everything that tests need is installed, and {left_out} were left out, see above");
    complain(if left_out > 0 { std::slice::from_ref(&line) } else { &[] }, messages)
}

/// Checks the project's own structure, which `test` does as well, among other things.
pub fn tidy(messages: &mut dyn Write) -> Result<u8> {
    let workspace = workspace()?;
    let twice = complain(&features::compiled_twice()?, messages)?;
    let structure = status(&mut cargo(["test", "--package", "shadercheck", "--test", "it", "--", "tidy::"]))?;
    let snapshots = unreferenced(&workspace, messages)?;
    Ok(structure.max(twice).max(snapshots))
}

/// Runs the tests that compare snapshots and reports the snapshots that none of them compared.
fn unreferenced(workspace: &Path, messages: &mut dyn Write) -> Result<u8> {
    if snapshots::snapshots(workspace)?.is_empty() {
        return Ok(0);
    }
    let references = References::start(&target(workspace)?)?;
    let mut run = cargo(["test", "--package", "shadercheck", "--lib", "--test", "it", "--quiet", "--"]);
    let failed = status(references.record(run.args(snapshots::modules(workspace)?)))?;
    if failed != 0 {
        // A test that stopped early has not named all its snapshots.
        return Ok(failed);
    }
    complain(&references.complaints(workspace)?, messages)
}

/// Prints how fast the gate is, the functions on columns, the linter, and reference data.
pub fn bench(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    setup::prepare_lanes(&mut ThisMachine, messages)?;
    if let Some((_, rest)) = arguments.split_first().filter(|(first, _)| *first == "--against-script") {
        return against::run(rest, messages);
    }
    status(
        cargo([
            "bench",
            "--package",
            "shadercheck",
            "--bench",
            "gate",
            "--bench",
            "math",
            "--bench",
            "lint",
            "--bench",
            "fuzz",
            "--bench",
            "refdata",
            "--",
        ])
        .args(arguments),
    )
}

/// Judges devices that err as far as they may; needs no driver. Options that come later count.
pub fn soundness(arguments: &[OsString]) -> Result<u8> {
    let run = ["bench", "--quiet", "--package", "shadercheck", "--bench", "soundness", "--", "--samples", "100000000"];
    status(cargo(run).args(arguments))
}

/// Prints how many shaders of some folders reach a valid module, and what stops the others.
pub fn survey(arguments: &[OsString]) -> Result<u8> {
    // The profile of development is optimised, and most often built already.
    let run = ["bench", "--quiet", "--profile", "dev", "--package", "shadercheck", "--bench", "survey", "--"];
    status(cargo(run).args(arguments))
}

/// Prints how many of piglit's tests of built-in functions agree.
pub fn piglit(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    setup::prepare_lanes(&mut ThisMachine, messages)?;
    let run = ["bench", "--quiet", "--profile", "dev", "--package", "shadercheck", "--bench", "piglit", "--"];
    status(cargo(run).args(arguments))
}

fn complain(lines: &[String], messages: &mut dyn Write) -> Result<u8> {
    for line in lines {
        writeln!(messages, "xtask: {line}")?;
    }
    Ok(u8::from(!lines.is_empty()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_that_did_not_run_fails_where_everything_is_installed() {
        let folder = std::env::temp_dir().join(format!("shadercheck-incomplete-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let record = Record::start(&folder).unwrap();
        let mut said = Vec::new();
        assert_eq!(incomplete(true, &record, &mut said).unwrap(), 0);
        std::fs::write(folder.join("tests-not-run.txt"), "a::b: no browser\n").unwrap();
        assert_eq!(incomplete(false, &record, &mut said).unwrap(), 0);
        assert!(said.is_empty());
        assert_eq!(incomplete(true, &record, &mut said).unwrap(), 1);
        assert_eq!(said, b"xtask: everything that tests need is installed, and 1 were left out, see above\n");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
