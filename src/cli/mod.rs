//! The command line, one file a subcommand. Results go to standard output, progress and complaints
//! to standard error.

pub mod check;
pub mod explain;
pub mod lanes;
pub mod lint;
pub mod mutate;
pub mod status;
pub mod translate;

use std::io::{IsTerminal, Write};

use clap::{Parser, Subcommand};

use status::ExitStatus;

/// Test shaders like other code, on a machine without a GPU
///
/// Exit status: 0 clean; 1 findings or failed cases; 2 usage, configuration or internal error.
#[derive(Parser, Debug)]
#[command(name = "shadercheck", version, max_term_width = 100)]
pub struct Cli {
    /// What to do
    #[command(subcommand)]
    pub command: Command,
}

/// The subcommands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Run shaders on many inputs and compare every output with its formula
    Check(check::CheckArgs),
    /// Find and repair mistakes in shaders and in the code that feeds them
    Lint(lint::LintArgs),
    /// Show the page of a lint rule
    Explain(explain::ExplainArgs),
    /// Translate a shader to another language
    Translate(translate::TranslateArgs),
    /// Put small faults into shaders and see whether their suites notice
    Mutate(mutate::MutateArgs),
    /// Show what can run shaders here
    Lanes(lanes::LanesArgs),
}

impl Command {
    /// True when the command opens devices.
    pub fn opens_devices(&self) -> bool {
        matches!(self, Self::Check(_) | Self::Lanes(_) | Self::Mutate(_))
    }
}

/// Runs the command line.
pub fn run(cli: &Cli) -> ExitStatus {
    let stdout = std::io::stdout();
    let stderr = std::io::stderr();
    let color = stdout.is_terminal() && std::env::var_os("NO_COLOR").is_none();
    let mut out = std::io::BufWriter::new(stdout.lock());
    let mut err = &stderr;
    let result = match &cli.command {
        Command::Check(args) => check::run(args, &mut out, &mut err, color),
        Command::Lint(args) => lint::run(args, &mut out, &mut err, color),
        Command::Explain(args) => explain::run(args, &mut out, &mut err, color),
        Command::Translate(args) => translate::run(args, &mut out, &mut err),
        Command::Mutate(args) => mutate::run(args, &mut out, &mut err),
        Command::Lanes(args) => lanes::run(args, &mut out),
    };
    let result = result.and_then(|status| Ok(out.flush().map(|()| status)?));
    match result {
        Ok(status) => status,
        // A reader that went away, such as `head`, has seen what it wanted.
        Err(error) if is_broken_pipe(&error) => ExitStatus::Clean,
        Err(error) => {
            let _ = writeln!(err, "error: {error:#}");
            ExitStatus::Error
        }
    }
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let io = error.chain().find_map(|e| e.downcast_ref::<std::io::Error>());
    io.is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
}
