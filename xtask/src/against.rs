//! `cargo xtask bench --against-script`: `shadercheck check` beside the test that one writes by hand.
//!
//! Program and script run in turn, so that a slow moment of the machine meets both. The script times
//! itself, without the start of Python, its libraries and OpenGL, and with the shader compiled. From the
//! program's wall time the time of a run with one case is taken off, which is its start, its shader
//! compilers and its relations: work that grows with the samples is what remains on either side.

mod environment;
mod figures;

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};

use crate::cargo::{cargo, workspace};
use crate::host::ThisMachine;
use environment::Environment;
use figures::{Rates, Timing};

/// The suites whose shaders the script knows.
const SUITES: [&str; 2] = ["sphere", "skinning"];
/// Samples of the run whose time is taken off: one case of the suites.
const ONE_CASE: u64 = 16;

/// What the command line asks for.
#[derive(Debug, PartialEq, Eq)]
struct Options {
    samples: u64,
    rounds: u32,
    /// A program to measure instead of the release build.
    program: Option<PathBuf>,
}

impl Options {
    fn parse(arguments: &[OsString]) -> Result<Self> {
        let mut options = Self { samples: 1 << 20, rounds: 7, program: None };
        let mut arguments = arguments.iter();
        while let Some(name) = arguments.next() {
            let name = name.to_string_lossy();
            ensure!(
                matches!(&*name, "--samples" | "--rounds" | "--program"),
                "`bench --against-script` has no option `{name}`; it has --samples N, --rounds N and --program FILE"
            );
            let value = arguments.next().with_context(|| format!("{name} needs a value"))?;
            let number = || value.to_str().and_then(|v| v.parse().ok()).filter(|&n: &u32| n > 0);
            let number =
                || number().with_context(|| format!("{name} needs a positive number, not `{}`", value.display()));
            match &*name {
                "--samples" => options.samples = number()?.into(),
                "--rounds" => options.rounds = number()?,
                _ => options.program = Some(value.into()),
            }
        }
        Ok(options)
    }
}

/// Runs both and prints their rates.
pub fn run(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    let options = Options::parse(arguments)?;
    let workspace = workspace()?;
    let folder = workspace.join("fixtures/bench");
    let program = match &options.program {
        Some(program) => program.clone(),
        None => release(&workspace)?,
    };
    writeln!(messages, "xtask: making a Python environment for {}", folder.join("handwritten.py").display())?;
    let environment = Environment::make(&mut ThisMachine, &folder.join("requirements.txt"))?;
    let mut out = io::stdout();
    writeln!(
        out,
        "millions of judged samples a second, {} samples, {} rounds in turn: best, median, range",
        options.samples, options.rounds
    )?;
    for suite in SUITES {
        notices_a_fault(&environment, &folder, suite, options.samples)?;
        let mut rates = Rates::default();
        for _ in 0..options.rounds {
            // The vertex stage alone is what the script runs; both stages are what `check` runs.
            rates.stage.push(program_rate(&program, suite, options.samples, &["--stage", "vertex"])?);
            rates.check.push(program_rate(&program, suite, options.samples, &[])?);
            let timing = timed(&environment, &folder, suite, options.samples)?;
            rates.judge_only.push(timing.rate(&timing.judge_only));
            rates.end_to_end.push(timing.rate(&timing.end_to_end));
        }
        out.write_all(rates.table(suite).as_bytes())?;
    }
    Ok(0)
}

/// Builds the program as users have it, and gives its file.
fn release(workspace: &Path) -> Result<PathBuf> {
    let mut build = cargo(["build", "--release", "--package", "shadercheck", "--bin", "shadercheck"]);
    let output = build.arg("--message-format=json-render-diagnostics").current_dir(workspace).stderr(Stdio::inherit());
    let output = output.output().context("cannot start cargo")?;
    ensure!(output.status.success(), "shadercheck does not build");
    figures::executable(&String::from_utf8_lossy(&output.stdout)).context("cargo names no executable")
}

/// Judged samples a second of `shadercheck check`, without what a run of one case takes.
fn program_rate(program: &Path, suite: &str, samples: u64, stage: &[&str]) -> Result<f64> {
    let check = |samples: u64| -> Result<(u64, Duration)> {
        let mut command = Command::new(program);
        command.args(["check", suite, "--lane", "vulkan", "--format", "json", "--samples", &samples.to_string()]);
        let start = Instant::now();
        let output = command.args(stage).output().with_context(|| format!("cannot start {}", program.display()))?;
        let time = start.elapsed();
        let text = String::from_utf8_lossy(&output.stdout);
        let judged = figures::judged(&text).with_context(|| {
            format!("`check {suite}` gave no figures: {}", String::from_utf8_lossy(&output.stderr).trim())
        })?;
        Ok((judged, time))
    };
    let (few, start) = check(ONE_CASE)?;
    let (judged, time) = check(samples)?;
    let seconds = time.saturating_sub(start).as_secs_f64();
    ensure!(seconds > 0.0 && judged > few, "{samples} samples are too few to be timed");
    Ok((judged - few) as f64 / seconds)
}

/// One run of the script: an untimed repetition, then one that counts.
fn timed(environment: &Environment, folder: &Path, suite: &str, samples: u64) -> Result<Timing> {
    let (_, printed, errors) = script(environment, folder, suite, samples, None)?;
    figures::timing(&printed).with_context(|| format!("the script gave no figures: {errors}"))
}

/// Puts a fault into the script's reference and sees that it is reported: otherwise its time is worth nothing.
fn notices_a_fault(environment: &Environment, folder: &Path, suite: &str, samples: u64) -> Result<()> {
    let (status, printed, errors) = script(environment, folder, suite, samples, Some("--fault"))?;
    let disagreed = figures::disagreed(&printed).with_context(|| format!("the script gave no figures: {errors}"))?;
    ensure!(status == Some(1) && disagreed > 0, "the script does not notice a fault in the formula of `{suite}`");
    Ok(())
}

/// Runs the script with one timed repetition; gives its exit status, output and messages.
fn script(
    environment: &Environment,
    folder: &Path,
    suite: &str,
    samples: u64,
    option: Option<&str>,
) -> Result<(Option<i32>, String, String)> {
    let mut command = Command::new(environment.python());
    command.arg("-B").arg(folder.join("handwritten.py"));
    command.args(["--shader", suite, "--samples", &samples.to_string(), "--repeat", "1", "--json"]).args(option);
    let output = command.output().context("cannot start the script")?;
    let errors = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    ensure!(
        !errors.contains("OpenGL cannot be used"),
        "{errors}; on Debian and Ubuntu, run `apt-get install libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri`"
    );
    Ok((output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned(), errors))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(arguments: &[&str]) -> Result<Options> {
        Options::parse(&arguments.iter().map(OsString::from).collect::<Vec<_>>())
    }

    #[test]
    fn options_are_read_and_have_defaults() {
        assert_eq!(parse(&[]).unwrap(), Options { samples: 1 << 20, rounds: 7, program: None });
        let given = parse(&["--samples", "4096", "--program", "bin/shadercheck", "--rounds", "3"]).unwrap();
        assert_eq!(given, Options { samples: 4096, rounds: 3, program: Some("bin/shadercheck".into()) });
    }

    #[test]
    fn wrong_options_are_named() {
        let message = |arguments: &[&str]| parse(arguments).unwrap_err().to_string();
        assert!(message(&["--sample", "1"]).starts_with("`bench --against-script` has no option `--sample`"));
        assert_eq!(message(&["--samples"]), "--samples needs a value");
        assert_eq!(message(&["--rounds", "0"]), "--rounds needs a positive number, not `0`");
        assert_eq!(message(&["--samples", "many"]), "--samples needs a positive number, not `many`");
    }
}
