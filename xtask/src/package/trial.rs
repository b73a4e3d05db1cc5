//! Tries packages as a stranger does: installs one into an empty folder and reaches the first finding.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};

/// Longest time from nothing to the first finding.
pub const LIMIT: Duration = Duration::from_secs(30);

/// A shader with one mistake.
const SHADER: &str =
    "#version 330 core\nin vec4 p;\nvoid main() { gl_Position = vec4(vec3(p.x, p.y, p.z, 1.0), 1.0); }\n";

/// What a trial took.
#[derive(Clone, Copy, Debug)]
pub struct Times {
    pub install: Duration,
    /// From the start of the program to its finding.
    pub finding: Duration,
}

/// Installs a package into `folder`, which is made anew, and lints a shader with it. `install` gives the program.
///
/// # Errors
/// When a step fails, the mistake is not found, or it takes longer than [`LIMIT`].
pub fn trial(folder: &Path, install: impl FnOnce(&Path) -> Result<PathBuf>) -> Result<Times> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let start = Instant::now();
    let program = install(folder)?;
    let installed = start.elapsed();
    fs::write(folder.join("first.vert"), SHADER)?;
    let start = Instant::now();
    let output = Command::new(&program)
        .args(["lint", "first.vert", "--format", "concise", "--lang", "en"])
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .with_context(|| format!("cannot start {}", program.display()))?;
    let times = Times { install: installed, finding: start.elapsed() };
    let said = String::from_utf8_lossy(&output.stdout);
    ensure!(
        output.status.code() == Some(1) && said.starts_with("first.vert:3:") && said.contains("T001"),
        "the mistake is not found (status {:?}):\n{said}{}",
        output.status.code(),
        String::from_utf8_lossy(&output.stderr)
    );
    ensure!(times.install + times.finding <= LIMIT, "it takes longer than {} s: {times:?}", LIMIT.as_secs());
    Ok(times)
}

/// Runs a step of an installation.
///
/// # Errors
/// When it cannot be started or fails, with what it printed.
pub fn step(command: &mut Command) -> Result<()> {
    let name = command.get_program().display().to_string();
    let output = command.stdin(Stdio::null()).output().with_context(|| format!("cannot start {name}"))?;
    if !output.status.success() {
        bail!("{name} failed:\n{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    }
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    /// A trial of a script in place of the program.
    fn tried(name: &str, script: &str) -> Result<Times> {
        let folder = std::env::temp_dir().join(format!("shadercheck-trial-{name}-{}", std::process::id()));
        let result = trial(&folder, |folder| {
            let program = folder.join("program");
            fs::write(&program, format!("#!/bin/sh\n{script}\n"))?;
            fs::set_permissions(&program, fs::Permissions::from_mode(0o755))?;
            Ok(program)
        });
        fs::remove_dir_all(folder).unwrap();
        result
    }

    #[test]
    fn only_a_program_that_finds_the_mistake_passes() {
        tried("right", "echo 'first.vert:3:55: error[T001 x]: y'; exit 1").unwrap();
        for (name, script) in [
            ("silent", "exit 1"),
            ("clean", "echo 'first.vert:3:55: error[T001 x]: y'"),
            ("other", "echo 'first.vert:1:1: error[E001]: y'; exit 1"),
            ("broken", "echo 'no such library' >&2; exit 127"),
        ] {
            assert!(tried(name, script).is_err(), "{name}");
        }
    }

    #[test]
    fn a_step_that_fails_says_why() {
        let error = step(Command::new("sh").args(["-c", "echo because >&2; exit 3"])).unwrap_err().to_string();
        assert_eq!(error, "sh failed:\nbecause\n");
    }
}
