//! `shadercheck worker`: the other side of a lane that runs in a process of its own. Nobody types it.

use std::io::Write;
use std::path::PathBuf;

use anyhow::Context;
use clap::Args;

use crate::cli::status::ExitStatus;
use lanes::remote::planted::Fault;
use lanes::{opengl, remote, worker};

/// Arguments of `shadercheck worker`.
#[derive(Args, Clone, Debug)]
pub struct WorkerArgs {
    /// Lanes to serve
    side: String,
    /// Fault of the engine to plant: garbage, lost-device, out-of-memory, crash or hang
    #[arg(long)]
    plant: Option<Fault>,
}

/// The program that is started for such a lane: this one, or the one that `SHADERCHECK_WORKER` names, which then starts
/// `shadercheck worker` with what it gets; none where that is empty: lanes run in this process.
pub fn program(executable: PathBuf) -> Option<worker::Program> {
    match std::env::var_os("SHADERCHECK_WORKER") {
        Some(none) if none.is_empty() => None,
        Some(other) => Some(worker::Program { path: other.into(), arguments: Vec::new() }),
        None => Some(worker::Program { path: executable, arguments: vec!["worker".into()] }),
    }
}

/// Runs the command: jobs come from standard input, and answers go to `out`.
///
/// # Errors
/// When what comes is no job, or nobody reads the answers.
pub fn run(args: &WorkerArgs, out: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let mut from = std::io::stdin().lock();
    let served = match args.side.as_str() {
        opengl::SIDE => opengl::serve(&mut from, out),
        remote::SIDE => remote::serve(&mut from, out, args.plant),
        other => anyhow::bail!("`{other}` is no kind of lanes"),
    };
    served.context("the process that sends jobs is gone")?;
    Ok(ExitStatus::Clean)
}
