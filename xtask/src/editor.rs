//! `cargo xtask editor`: builds the extension for VS Code, tests it with the program, and packages it.

use std::ffi::OsString;
use std::io::Write;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::cargo::{program, status, target, workspace};

/// Installs what the lock file names, runs the tests, and makes `dist/shadercheck.vsix`.
pub fn run(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    let workspace = workspace()?;
    let program = match arguments {
        [] => program(&target(&workspace)?)?,
        [option, program] if option == "--program" => std::path::absolute(program)?,
        _ => bail!("editor takes no argument but --program FILE"),
    };
    let folder = workspace.join("editors/vscode");
    // Scripts of packages are not run: none of them is needed.
    for arguments in [&["ci", "--ignore-scripts", "--no-audit", "--no-fund"][..], &["test"], &["run", "package"]] {
        let failed = npm(arguments, &folder, &program)?;
        if failed != 0 {
            return Ok(failed);
        }
    }
    let made = folder.join("dist/shadercheck.vsix");
    ensure!(made.is_file(), "there is no {}", made.display());
    writeln!(messages, "xtask: the extension is {}", made.display())?;
    Ok(0)
}

fn npm(arguments: &[&str], folder: &Path, program: &Path) -> Result<u8> {
    let name = if cfg!(windows) { "npm.cmd" } else { "npm" };
    let mut command = Command::new(name);
    status(command.args(arguments).current_dir(folder).env("SHADERCHECK", program)).context("npm comes with Node.js")
}
