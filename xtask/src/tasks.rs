//! The tasks, one function each. They give the exit status to pass on.

use std::ffi::OsString;
use std::io::Write;
use std::path::Path;

use anyhow::Result;

use crate::cargo::{cargo, status, workspace};
use crate::host::ThisMachine;
use crate::snapshots::{self, References};
use crate::{against, features, setup};

/// The gate is built in the profile of the tests: one build of the dependencies serves both tasks. On a
/// fresh machine with two cores either profile takes minutes (dev 222 s and release 147 s, other builds
/// running beside them), and the tests after a dev build take 21 s more.
const GATE: [&str; 6] = ["run", "--package", "shadercheck", "--bin", "shadercheck", "--"];

/// Sets the machine up and runs `shadercheck check`.
pub fn check(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    setup::prepare(&mut ThisMachine, messages)?;
    setup::prepare_translator(&mut ThisMachine, messages)?;
    setup::prepare_opengl(&mut ThisMachine, messages)?;
    status(cargo(GATE).arg("check").args(arguments))
}

/// Sets the machine up and runs all tests. The runner's own summary closes the output.
pub fn test(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    setup::prepare(&mut ThisMachine, messages)?;
    setup::prepare_translator(&mut ThisMachine, messages)?;
    setup::prepare_opengl(&mut ThisMachine, messages)?;
    setup::report_validators(&ThisMachine, messages)?;
    setup::report_readers(&mut ThisMachine, messages)?;
    let nextest = cargo(["nextest", "--version"]).output().is_ok_and(|output| output.status.success());
    let mut run = match (nextest, arguments.is_empty()) {
        (true, _) => cargo(["nextest", "run", "--workspace"]),
        (false, false) => cargo(["test", "--workspace"]),
        (false, true) => cargo(["test", "--workspace", "--lib", "--bins", "--tests", "--no-fail-fast"]),
    };
    if nextest && std::env::var_os("NEXTEST_PROFILE").is_none() && std::env::var_os("CI").is_some() {
        run.args(["--profile", "ci"]);
    }
    if !arguments.is_empty() {
        return status(run.args(arguments));
    }
    let workspace = workspace()?;
    let references = References::start(&workspace)?;
    let documentation = status(references.record(&mut cargo(["test", "--workspace", "--doc"])))?;
    let tests = status(references.record(&mut run))?;
    match (tests, documentation) {
        (0, 0) => complain(&references.complaints(&workspace)?, messages),
        (0, failed) => {
            writeln!(messages, "xtask: documentation tests failed, see above")?;
            Ok(failed)
        }
        (failed, _) => Ok(failed),
    }
}

/// Checks the project's own structure.
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
    let references = References::start(workspace)?;
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
    setup::prepare(&mut ThisMachine, messages)?;
    setup::prepare_translator(&mut ThisMachine, messages)?;
    setup::prepare_opengl(&mut ThisMachine, messages)?;
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
    setup::prepare(&mut ThisMachine, messages)?;
    setup::prepare_translator(&mut ThisMachine, messages)?;
    setup::prepare_opengl(&mut ThisMachine, messages)?;
    let run = ["bench", "--quiet", "--profile", "dev", "--package", "shadercheck", "--bench", "piglit", "--"];
    status(cargo(run).args(arguments))
}

fn complain(lines: &[String], messages: &mut dyn Write) -> Result<u8> {
    for line in lines {
        writeln!(messages, "xtask: {line}")?;
    }
    Ok(u8::from(!lines.is_empty()))
}
