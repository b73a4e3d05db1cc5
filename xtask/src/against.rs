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

use anyhow::{Context, Result, bail, ensure};

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
            let number = || number().with_context(|| format!("{name} needs a positive number, not `{}`", value.display()));
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
        let mut rates = Rates::default();
        for _ in 0..options.rounds {
            // The vertex stage alone is what the script runs; both stages are what `check` runs.
            rates.stage.push(program_rate(&program, suite, options.samples, &["--stage", "vertex"])?);
            rates.check.push(program_rate(&program, suite, options.samples, &[])?);
            let timing = script(&environment, &folder, suite, options.samples)?;
            rates.judge_only.push(timing.rate(&timing.judge_only));
            rates.end_to_end.push(timing.rate(&timing.end_to_end));
        }
        out.write_all(rates.table(suite).as_bytes())?;
    }
    Ok(0)
}
