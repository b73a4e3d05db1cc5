//! `cargo xtask editor`: builds the extension for VS Code, tests it with the program, and packages it.

use std::ffi::OsString;
use std::io::Write;

use anyhow::{Context, Result, bail, ensure};

use crate::cargo::{NPM_CI, npm, program, status, target, workspace};

/// Installs what the lock file names, runs the tests, and makes `dist/shadercheck.vsix`.
pub fn run(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    let workspace = workspace()?;
    let program = match arguments {
        [] => program(&target(&workspace)?)?,
        [option, program] if option == "--program" => std::path::absolute(program)?,
        _ => bail!("editor takes no argument but --program FILE"),
    };
    let folder = workspace.join("editors/vscode");
    for arguments in [NPM_CI, &["test"], &["run", "package"]] {
        let failed =
            status(npm(&folder).args(arguments).env("SHADERCHECK", &program)).context("npm comes with Node.js")?;
        if failed != 0 {
            return Ok(failed);
        }
    }
    let made = folder.join("dist/shadercheck.vsix");
    ensure!(made.is_file(), "there is no {}", made.display());
    writeln!(messages, "xtask: the extension is {}", made.display())?;
    Ok(0)
}
