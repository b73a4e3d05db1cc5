//! A Python environment that is thrown away.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};

use crate::host::{Host, on_path};

/// Makes a folder under a name that nobody else has, and prints it.
const TEMPORARY: &str = "import tempfile; print(tempfile.mkdtemp(prefix='shadercheck-bench-'))";

/// A folder with Python and the packages of a requirement list; it is deleted with the value.
#[derive(Debug)]
pub struct Environment {
    folder: PathBuf,
}

impl Environment {
    /// Makes the environment in the folder for temporary files.
    ///
    /// # Errors
    /// When Python, its module for environments or pip is missing, with what to install; when a package
    /// is not available, with pip's own reason.
    pub fn make(host: &mut dyn Host, requirements: &Path) -> Result<Self> {
        ensure!(
            on_path(host, "python3").is_some(),
            "python3 is missing; on Debian and Ubuntu, run `apt-get install python3 python3-venv`"
        );
        let created = host.run(&["python3", "-c", TEMPORARY]).context("cannot start python3")?;
        ensure!(created.success, "no temporary folder can be made: {}", last_line(&created.output, |_| true));
        let environment = Self { folder: created.output.lines().next().unwrap_or_default().into() };
        let folder = environment.folder.display().to_string();
        let made = host.run(&["python3", "-m", "venv", &folder]).context("cannot start python3")?;
        if !made.success {
            let reason = last_line(&made.output, |_| true);
            let missing = ["ensurepip", "No module named"].iter().any(|words| made.output.contains(words));
            let advice = if missing { "on Debian and Ubuntu, run `apt-get install python3-venv`" } else { reason };
            bail!("no Python environment can be made in {folder}: {advice}");
        }
        let python = environment.python().display().to_string();
        let list = requirements.display().to_string();
        let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement"];
        let command = [&[python.as_str()][..], &pip, &[list.as_str()]].concat();
        let installed = host.run(&command).context("cannot start pip")?;
        ensure!(
            installed.success,
            "the packages in {list} cannot be installed, which needs a network: {}",
            last_line(&installed.output, |line| line.starts_with("ERROR: "))
        );
        Ok(environment)
    }

    /// The interpreter that sees the packages.
    pub fn python(&self) -> PathBuf {
        self.folder.join("bin/python")
    }
}

impl Drop for Environment {
    fn drop(&mut self) {
        // What cannot be deleted is left to the system, as all temporary files are.
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

fn last_line(output: &str, which: impl Fn(&str) -> bool) -> &str {
    output.lines().rfind(|line| which(line)).unwrap_or("no reason given")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::fake::Fake;

    const PIP: &str = "no-such-folder/bench/bin/python -m pip install";

    fn made(mut machine: Fake) -> (Result<Environment>, Vec<String>) {
        let environment = Environment::make(&mut machine, Path::new("bench/requirements.txt"));
        (environment, machine.log)
    }

    fn with_python() -> Fake {
        let machine = Fake::default().var("PATH", "bin").file("bin/python3", "");
        machine.program("python3 -c", true, "no-such-folder/bench\n")
    }

    fn complaint(machine: Fake) -> String {
        made(machine).0.unwrap_err().to_string()
    }

    #[test]
    fn the_packages_of_the_list_are_installed_into_the_environment() {
        let (environment, log) = made(with_python().program("python3 -m venv", true, "").program(PIP, true, ""));
        let environment = environment.unwrap();
        assert_eq!(environment.python(), Path::new("no-such-folder/bench/bin/python"));
        assert_eq!(log[1], "python3 -m venv no-such-folder/bench");
        let pip = "pip install --quiet --disable-pip-version-check --requirement bench/requirements.txt";
        assert_eq!(log[2..], [format!("no-such-folder/bench/bin/python -m {pip}")]);
    }

    #[test]
    fn what_is_missing_is_said_with_its_package() {
        assert!(complaint(Fake::default()).contains("apt-get install python3 python3-venv"));
        for output in [
            "The virtual environment was not created successfully because ensurepip is not available.\n",
            "python3: No module named venv\n",
        ] {
            let message = complaint(with_python().program("python3 -m venv", false, output));
            assert!(message.ends_with("run `apt-get install python3-venv`"), "{message}");
        }
    }

    #[test]
    fn another_failure_is_reported_in_its_own_words() {
        let full = with_python().program("python3 -m venv", false, "Error: [Errno 28] No space left on device\n");
        assert!(complaint(full).ends_with(": Error: [Errno 28] No space left on device"));
        let offline =
            "WARNING: Retrying\nERROR: Could not find a version\nERROR: No matching distribution found for moderngl\n";
        let message = complaint(with_python().program("python3 -m venv", true, "").program(PIP, false, offline));
        assert!(message.contains("needs a network: ERROR: No matching distribution found for moderngl"), "{message}");
    }
}
