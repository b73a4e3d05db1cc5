//! Packages of Python and of Node that tests need, in the build folder: nothing of the machine is changed by them.

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::host::{Host, on_path};

/// Where packages are, below the build folder.
pub struct Packages {
    folder: PathBuf,
}

impl Packages {
    /// Those of this build folder, whether they are there or not.
    pub fn below(target: &Path) -> Self {
        Self { folder: target.join("for-tests") }
    }

    fn python(&self) -> PathBuf {
        self.folder.join("python/bin/python")
    }

    fn modules(&self) -> PathBuf {
        self.folder.join("node_modules")
    }

    /// Programs that came with packages.
    fn programs(&self) -> PathBuf {
        self.folder.join("bin")
    }

    /// Makes the tests that a command runs find them, unless the variables say where else.
    pub fn show<'a>(&self, host: &dyn Host, command: &'a mut Command) -> &'a mut Command {
        let variables: [(&str, OsString, PathBuf); 2] = [
            ("SHADERCHECK_PYTHON", self.python().into(), self.python()),
            ("NODE_PATH", self.modules().into(), self.modules().join("webgpu/package.json")),
        ];
        for (name, value, file) in variables {
            if host.var(name).is_none() && host.exists(&file) {
                command.env(name, value);
            }
        }
        if host.exists(&self.programs().join("slangc")) {
            let own = std::iter::once(self.programs());
            let path = host.var("PATH").unwrap_or_default();
            let all = own.chain(std::env::split_paths(&path).collect::<Vec<_>>());
            if let Ok(path) = std::env::join_paths(all) {
                command.env("PATH", path);
            }
        }
        command
    }
}

/// Puts the compiler of the wheel `slangtorch` beside the environment that it is in.
const LINK: &str = "import os, sys, sysconfig; os.makedirs(sys.argv[1], exist_ok=True); \
    os.symlink(sysconfig.get_path('purelib') + '/slangtorch/bin/slangc', sys.argv[1] + '/slangc')";

/// Installs NumPy, PyArrow and the package `webgpu` where no variable names others, and slangc where none is found; whether
/// they are there.
pub fn prepare_packages(host: &mut dyn Host, packages: &Packages, messages: &mut dyn Write) -> io::Result<bool> {
    let python = packages.python().display().to_string();
    let environment = packages.folder.join("python").display().to_string();
    let folder = packages.folder.display().to_string();
    let venv: &[&str] = &["python3", "-m", "venv", &environment];
    let pip: &[&str] = &[&python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "numpy", "pyarrow"];
    let npm: &[&str] =
        &["npm", "install", "--silent", "--no-audit", "--no-fund", "--no-save", "--prefix", &folder, "webgpu"];
    let imports: &[&str] = &[&python, "-c", "import numpy, pyarrow"];
    let mut all = true;
    if host.var("SHADERCHECK_PYTHON").is_none() && !succeeds(host, imports) {
        all &= install(host, "NumPy and PyArrow", "pip", &[venv, pip], messages)?;
    }
    if host.var("NODE_PATH").is_none() && !host.exists(&packages.modules().join("webgpu/package.json")) {
        all &= install(host, "the package `webgpu`", "npm", &[npm], messages)?;
    }
    if on_path(host, "slangc").is_none() && !host.exists(&packages.programs().join("slangc")) {
        let environment = packages.folder.join("slang").display().to_string();
        let python = packages.folder.join("slang/bin/python").display().to_string();
        let programs = packages.programs().display().to_string();
        let venv: &[&str] = &["python3", "-m", "venv", &environment];
        // What the wheel depends on is for its users in Python, and large.
        let quiet = ["--quiet", "--disable-pip-version-check"];
        let pip = [&[python.as_str(), "-m", "pip", "install"][..], &quiet, &["--no-deps", "slangtorch"]].concat();
        let link: &[&str] = &[&python, "-c", LINK, &programs];
        all &= install(host, "slangc", "pip", &[venv, &pip, link], messages)?;
    }
    Ok(all)
}

fn succeeds(host: &mut dyn Host, command: &[&str]) -> bool {
    host.run(command).is_some_and(|outcome| outcome.success)
}

fn install(
    host: &mut dyn Host,
    what: &str,
    installer: &str,
    steps: &[&[&str]],
    messages: &mut dyn Write,
) -> io::Result<bool> {
    if host.var("SHADERCHECK_NO_INSTALL").is_some_and(|value| value != "0") {
        writeln!(messages, "xtask: {what} is missing, and SHADERCHECK_NO_INSTALL forbids to install it")?;
        return Ok(false);
    }
    writeln!(messages, "xtask: installing {what} with {installer} in the build folder")?;
    for step in steps {
        let reason = match host.run(step) {
            None => format!("`{}` cannot be started", step[0]),
            Some(outcome) if outcome.success => continue,
            Some(outcome) => outcome.output.trim().lines().last().unwrap_or("no reason given").to_owned(),
        };
        writeln!(messages, "xtask: {what} cannot be installed: {reason}")?;
        return Ok(false);
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::fake::Fake;

    fn prepared(host: &mut Fake) -> (bool, String) {
        let mut messages = Vec::new();
        let all = prepare_packages(host, &Packages::below(Path::new("/t")), &mut messages).unwrap();
        (all, String::from_utf8(messages).unwrap())
    }

    #[test]
    fn packages_go_into_the_build_folder() {
        let mut host = Fake::default().program("/t/for-tests/python/bin/python -c", false, "").program(
            "python3 -m venv",
            true,
            "",
        );
        host = host.program("/t/for-tests/python/bin/python -m pip", true, "").program("npm install", true, "");
        host = host.program("/t/for-tests/slang/bin/python", true, "");
        assert!(prepared(&mut host).0);
        assert_eq!(host.log[1], "python3 -m venv /t/for-tests/python");
        assert!(host.log[2].ends_with(" numpy pyarrow"), "{:?}", host.log);
        assert!(host.log[3].ends_with(" --prefix /t/for-tests webgpu"), "{:?}", host.log);
        assert_eq!(host.log[4], "python3 -m venv /t/for-tests/slang");
        assert!(host.log[5].ends_with(" --no-deps slangtorch"), "{:?}", host.log);
        assert!(host.log[6].ends_with(" /t/for-tests/bin"), "{:?}", host.log);
    }

    #[test]
    fn what_is_there_or_named_is_left_alone() {
        let there = Fake::default().file("/t/for-tests/node_modules/webgpu/package.json", "");
        let there = there.file("/t/for-tests/bin/slangc", "");
        let mut there = there.program("/t/for-tests/python/bin/python -c", true, "");
        assert_eq!(prepared(&mut there), (true, String::new()));
        let mut named = Fake::default().var("SHADERCHECK_PYTHON", "/opt/python").var("NODE_PATH", "/opt/modules");
        named = named.var("PATH", "/opt/bin").file("/opt/bin/slangc", "");
        assert_eq!(prepared(&mut named), (true, String::new()));
        assert!(named.log.is_empty());
    }

    #[test]
    fn what_cannot_be_installed_is_reported_with_the_reason() {
        let mut host = Fake::default().program("python3 -m venv", false, "Error: no space left\n");
        let (all, text) = prepared(&mut host);
        assert!(!all);
        assert!(text.contains("NumPy and PyArrow cannot be installed: Error: no space left\n"), "{text}");
        assert!(text.contains("the package `webgpu` cannot be installed: `npm` cannot be started\n"), "{text}");
        let (all, text) = prepared(&mut Fake::default().var("SHADERCHECK_NO_INSTALL", "1"));
        assert!(!all && text.matches("forbids to install it").count() == 3, "{text}");
    }

    #[test]
    fn tests_find_what_is_there() {
        let shown = |host: &Fake| {
            let mut command = Command::new("true");
            Packages::below(Path::new("/t")).show(host, &mut command);
            command.get_envs().map(|(name, _)| name.to_string_lossy().into_owned()).collect::<Vec<_>>()
        };
        let both = || {
            Fake::default()
                .file("/t/for-tests/python/bin/python", "")
                .file("/t/for-tests/node_modules/webgpu/package.json", "")
        };
        assert_eq!(shown(&both()), ["NODE_PATH", "SHADERCHECK_PYTHON"]);
        assert_eq!(shown(&both().var("NODE_PATH", "/opt/modules")), ["SHADERCHECK_PYTHON"]);
        assert!(shown(&Fake::default()).is_empty());
        assert_eq!(shown(&Fake::default().file("/t/for-tests/bin/slangc", "")), ["PATH"]);
    }
}
