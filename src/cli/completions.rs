//! `shadercheck completions`: what a shell needs to complete commands and options; `shadercheck man`: pages of the manual.

use std::io::Write;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::{Args, Command, CommandFactory};
use clap_complete::Shell;

use crate::cli::Cli;
use crate::cli::status::ExitStatus;
use base::text::Shown;

/// Print a script that completes commands and options in a shell
///
/// bash: `shadercheck completions bash > ~/.local/share/bash-completion/completions/shadercheck`
#[derive(Args, Clone, Debug)]
pub struct CompletionsArgs {
    /// Shell to print the script for
    #[arg(value_enum)]
    pub shell: Shell,
}

/// Write manual pages, one for each command
#[derive(Args, Clone, Debug)]
pub struct ManArgs {
    /// Folder for the pages
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
}

/// Prints the script of a shell.
///
/// # Errors
/// When `out` cannot be written to.
pub fn run(args: &CompletionsArgs, out: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    // The generator panics where it cannot write.
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command(), "shadercheck", &mut script);
    out.write_all(&script)?;
    Ok(ExitStatus::Clean)
}

/// Writes the pages.
///
/// # Errors
/// When the folder cannot be made or written to.
pub fn man(args: &ManArgs) -> anyhow::Result<ExitStatus> {
    let folder = &args.folder;
    std::fs::create_dir_all(folder)
        .and_then(|()| clap_mangen::generate_to(command(), folder))
        .with_context(|| format!("{}: the manual cannot be written", folder.shown()))?;
    Ok(ExitStatus::Clean)
}

/// The command line with names of programs that do not depend on how this one was called.
fn command() -> Command {
    Cli::command().bin_name("shadercheck")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shell_is_told_every_command() {
        for shell in [Shell::Bash, Shell::Elvish, Shell::Fish, Shell::PowerShell, Shell::Zsh] {
            let mut out = Vec::new();
            run(&CompletionsArgs { shell }, &mut out).unwrap();
            let script = String::from_utf8(out).unwrap();
            for command in command().get_subcommands().filter(|command| !command.is_hide_set()) {
                assert!(script.contains(command.get_name()), "{shell}: {}", command.get_name());
            }
            assert!(script.contains("unsafe-fixes"), "{shell}");
        }
    }

    #[test]
    fn every_command_has_a_page_of_the_manual() {
        let folder = std::env::temp_dir().join(format!("shadercheck-man-{}", std::process::id()));
        man(&ManArgs { folder: folder.clone() }).unwrap();
        let page = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
        assert!(page("shadercheck.1").contains("Test shaders like other code"));
        assert!(page("shadercheck-lint.1").contains("unsafe"));
        for command in command().get_subcommands().filter(|command| !command.is_hide_set()) {
            let name = command.get_name();
            assert!(page(&format!("shadercheck-{name}.1")).contains(name), "{name}");
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
}
