//! `shadercheck worker`: the other side of a lane that runs in a process of its own. Nobody types it.

use std::io::Write;
use std::path::PathBuf;

use anyhow::Context;
use clap::Args;

use crate::cli::status::ExitStatus;
use crate::lane::{opengl, worker};

/// Arguments of `shadercheck worker`: none.
#[derive(Args, Clone, Debug, Default)]
pub struct WorkerArgs {}

/// The program that is started for such a lane: this one.
pub fn program(executable: PathBuf) -> worker::Program {
    worker::Program { path: executable, arguments: vec!["worker".into()] }
}

/// Runs the command: jobs come from standard input, and answers go to `out`.
///
/// # Errors
/// When what comes is no job, or nobody reads the answers.
pub fn run(_args: &WorkerArgs, out: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    opengl::serve(&mut std::io::stdin().lock(), out).context("the process that sends jobs is gone")?;
    Ok(ExitStatus::Clean)
}
