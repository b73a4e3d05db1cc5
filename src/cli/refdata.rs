//! `shadercheck refdata`: reference data out, anyone's results in.

mod files;
mod generate;
mod item;
pub mod join;
mod verify;
mod work;

use std::io::Write;

use clap::{Args, Subcommand};

use crate::cli::status::ExitStatus;

/// Arguments of `shadercheck refdata`.
#[derive(Args, Clone, Debug)]
pub struct RefdataArgs {
    /// What to do
    #[command(subcommand)]
    pub command: RefdataCommand,
}

/// What is done with reference data.
#[derive(Subcommand, Clone, Debug)]
pub enum RefdataCommand {
    /// Write inputs, expected outputs and bounds of suites, or of shaders without one
    Generate(generate::GenerateArgs),
    /// Compare outputs with a reference file; needs neither the shader nor a device
    Verify(verify::VerifyArgs),
    /// Print the JSON Schema of the format `json`
    Schema,
}

/// Runs the command: the result goes to `out`, progress to `err`.
///
/// # Errors
/// When a file cannot be read or written, or an argument does not fit.
pub fn run(args: &RefdataArgs, out: &mut dyn Write, err: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    match &args.command {
        RefdataCommand::Generate(args) => generate::run(args, out, err),
        RefdataCommand::Verify(args) => verify::run(args, out),
        RefdataCommand::Schema => {
            out.write_all(refdata::schema().as_bytes())?;
            Ok(ExitStatus::Clean)
        }
    }
}
