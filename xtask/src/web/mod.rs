//! `cargo xtask web`: the page on which the program runs in a browser, and its tests.

mod toolchain;

use std::ffi::OsString;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::cargo::{NPM_CI, npm, program, status, target, workspace};
use crate::host::{ThisMachine, on_path};
use crate::setup::browser;

/// What the command line asks for.
#[derive(Debug, Default, PartialEq, Eq)]
struct Arguments {
    test: bool,
    program: Option<PathBuf>,
}

impl Arguments {
    fn read(words: &[OsString]) -> Result<Self> {
        let mut read = Self::default();
        let mut words = words.iter();
        while let Some(word) = words.next() {
            match word.to_str() {
                Some("--test") => read.test = true,
                Some("--program") => {
                    let path = words.next().context("--program needs the file of the program")?;
                    read.program = Some(std::path::absolute(path)?);
                }
                _ => bail!("web does not take `{}`; it takes --test and --program FILE", word.display()),
            }
        }
        Ok(read)
    }
}

/// Builds the program for WebAssembly and the page around it; with `--test`, tries both.
pub fn run(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    let arguments = Arguments::read(arguments)?;
    let workspace = workspace()?;
    let folder = workspace.join("web");
    let build = target(&workspace)?.join("web");
    let page = build.join("page");
    fs::create_dir_all(&page).with_context(|| format!("cannot make {}", page.display()))?;
    let wasm = toolchain::build(&folder, &build, messages)?;
    let wasm = smaller(&wasm, &build, messages)?;
    for arguments in [NPM_CI, &["run", "check"]] {
        let failed = npm(&folder).args(arguments).status().context("npm comes with Node.js")?;
        ensure!(failed.success(), "`npm {}` failed in {}", arguments.join(" "), folder.display());
    }
    let made = status(npm(&folder).args(["run", "build", "--"]).args([&wasm, &page]))?;
    ensure!(made == 0, "the page cannot be made");
    sizes(&page, messages)?;
    writeln!(messages, "xtask: the page is in {}; any server of files shows it", page.display())?;
    if !arguments.test {
        return Ok(0);
    }
    let native = arguments.program.map_or_else(|| program(&target(&workspace)?), Ok)?;
    let browser = browser(&ThisMachine).context("the tests need Chromium or Chrome")?;
    status(npm(&folder).arg("test").env("DIST", &page).env("SHADERCHECK", native).env("CHROMIUM", browser))
}

/// The program as `wasm-opt` makes it smaller, where that is installed.
fn smaller(wasm: &Path, build: &Path, messages: &mut dyn Write) -> Result<PathBuf> {
    let Some(tool) = on_path(&ThisMachine, "wasm-opt") else {
        writeln!(messages, "xtask: `wasm-opt` is not installed (binaryen): the page is larger than it need be")?;
        return Ok(wasm.to_owned());
    };
    let to = build.join("shadercheck.wasm");
    let failed = status(Command::new(tool).args(["-Os", "--all-features"]).arg(wasm).arg("-o").arg(&to))?;
    ensure!(failed == 0, "wasm-opt cannot read {}", wasm.display());
    Ok(to)
}

fn sizes(page: &Path, messages: &mut dyn Write) -> Result<()> {
    for entry in fs::read_dir(page)? {
        let entry = entry?;
        let size = entry.metadata()?.len() as f64 / 1e6;
        writeln!(messages, "xtask: {:>8.2} MB  {}", size, entry.file_name().display())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_read_or_refused() {
        let read = |words: &[&str]| Arguments::read(&words.iter().map(OsString::from).collect::<Vec<_>>());
        assert_eq!(read(&[]).unwrap(), Arguments::default());
        assert_eq!(read(&["--test", "--program", "/x"]).unwrap(), Arguments { test: true, program: Some("/x".into()) });
        assert!(read(&["--tests"]).unwrap_err().to_string().contains("does not take `--tests`"));
        assert!(read(&["--program"]).is_err());
    }
}
