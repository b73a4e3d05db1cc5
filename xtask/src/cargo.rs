//! Runs cargo.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};

use anyhow::{Context, Result, ensure};

/// The folder of the workspace. Cargo sets the variable when it runs this program.
pub fn workspace() -> Result<PathBuf> {
    let package =
        std::env::var_os("CARGO_MANIFEST_DIR").context("start it as `cargo xtask`: CARGO_MANIFEST_DIR is unset")?;
    let package = PathBuf::from(package);
    Ok(package.parent().context("CARGO_MANIFEST_DIR has no parent folder")?.to_owned())
}

/// The build folder of the workspace, which is made where it is missing.
pub fn target(workspace: &Path) -> Result<PathBuf> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace.join("target"), PathBuf::from);
    std::fs::create_dir_all(&target).with_context(|| format!("cannot make {}", target.display()))?;
    Ok(std::path::absolute(target)?)
}

/// A command of the cargo that runs this program.
pub fn cargo<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments);
    command
}

/// npm in a folder. Scripts of packages are not run where it installs: none of them is needed.
pub fn npm(folder: &Path) -> Command {
    let mut command = Command::new(if cfg!(windows) { "npm.cmd" } else { "npm" });
    command.current_dir(folder);
    command
}

/// What npm installs the packages of a lock file with.
pub const NPM_CI: &[&str] = &["ci", "--ignore-scripts", "--no-audit", "--no-fund"];

/// Builds the program in the profile of development; gives its path.
pub fn program(target: &Path) -> Result<PathBuf> {
    let failed = status(&mut cargo(["build", "--quiet", "--package", "shadercheck", "--bin", "shadercheck"]))?;
    ensure!(failed == 0, "the program cannot be built");
    Ok(target.join("debug").join(format!("shadercheck{}", std::env::consts::EXE_SUFFIX)))
}

/// Runs a command on this terminal; gives the exit status that this program is to pass on.
pub fn status(command: &mut Command) -> Result<u8> {
    let status = command.status().with_context(|| format!("cannot start {}", command.get_program().display()))?;
    Ok(code(status))
}

/// The exit status as a shell gives it: 128 and the signal's number for a program that was killed.
pub fn code(status: ExitStatus) -> u8 {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return u8::try_from(signal).map_or(u8::MAX, |signal| signal.saturating_add(128));
    }
    // Statuses above 255 exist outside Unix; they must not become 0.
    status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(u8::MAX)
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::process::ExitStatusExt;

    use super::*;

    #[test]
    fn exit_status_passes_through() {
        for expected in [0, 1, 2, 101] {
            assert_eq!(code(ExitStatus::from_raw(i32::from(expected) << 8)), expected);
        }
    }

    #[test]
    fn a_killed_program_is_not_a_success() {
        assert_eq!(code(ExitStatus::from_raw(2)), 130);
    }
}
