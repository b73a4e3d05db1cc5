//! `cargo xtask package`: everything that can be built on this machine without an account, and a trial of each.

mod formats;
mod metadata;
mod papers;
mod trial;

use std::ffi::OsString;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::cargo::{cargo, status, target, workspace};
use formats::{FORMATS, Format};
use trial::{Times, step};

/// The profile of Cargo.toml that is packaged.
pub const PROFILE: &str = "dist";

/// Most bytes of the program, and of the linter alone: what they have today, so that they do not grow unseen. deploy/release.md
/// says what they are to have.
const LARGEST: [u64; 2] = [38_000_000, 15_000_000];

/// What goes into every package.
pub struct Staged {
    pub workspace: PathBuf,
    /// Binary, documents, licences, bill of materials, `completions/` and `man/`.
    pub folder: PathBuf,
    pub version: String,
    /// `x86_64-unknown-linux-gnu`.
    pub target: String,
    /// Options of cargo for the features of the program.
    pub features: Vec<&'static str>,
    /// Where cargo builds.
    pub build: PathBuf,
}

struct Arguments {
    program: Option<PathBuf>,
    lint: bool,
    /// Write completions, manual, licences and bill of materials here, and package nothing.
    papers: Option<PathBuf>,
    wanted: Vec<String>,
}

impl Arguments {
    fn read(arguments: &[OsString]) -> Result<Self> {
        let mut read = Self { program: None, lint: false, papers: None, wanted: Vec::new() };
        let mut words = arguments.iter();
        while let Some(word) = words.next() {
            match word.to_str() {
                Some("--program") => read.program = Some(words.next().context("--program names a FILE")?.into()),
                Some("--papers") => read.papers = Some(words.next().context("--papers names a FOLDER")?.into()),
                Some("--lint") => read.lint = true,
                Some(name) if FORMATS.iter().any(|format| format.name == name) => read.wanted.push(name.to_owned()),
                _ => {
                    let names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
                    bail!("package does not take `{}`; the formats are {}", word.display(), names.join(", "))
                }
            }
        }
        Ok(read)
    }

    fn wants(&self, format: &Format) -> bool {
        self.wanted.is_empty() || self.wanted.iter().any(|name| name == format.name)
    }
}

/// Builds the packages and tries them. The status is 1 when a trial fails.
pub fn run(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    let arguments = Arguments::read(arguments)?;
    let workspace = workspace()?;
    let build = target(&workspace)?.join("package");
    let features = if arguments.lint { vec!["--no-default-features", "--features", "lint"] } else { Vec::new() };
    let linter = || crate::cargo::program(&target(&workspace)?);
    if let Some(folder) = &arguments.papers {
        let program = arguments.program.clone().map_or_else(linter, Ok)?;
        let (_, triple) = version(&program)?;
        return papers(&workspace, folder, &program, &triple, &[]).map(|()| 0);
    }
    let program = match &arguments.program {
        Some(program) => fs::canonicalize(program).with_context(|| format!("cannot find {}", program.display()))?,
        None => release(&build, &features, messages)?,
    };
    fits(fs::metadata(&program)?.len(), arguments.lint)?;
    let out = build.join("out");
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| format!("cannot remove {}", out.display()))?;
    }
    fs::create_dir_all(&out)?;
    let staged = stage(workspace, build, features, &program)?;
    let mut rows = Vec::new();
    let mut failed = 0;
    for format in FORMATS.iter().filter(|format| arguments.wants(format)) {
        if let Some(tool) = format.needs.iter().find(|tool| !is_there(tool)) {
            writeln!(messages, "xtask: no {}: `{tool}` is not installed", format.name)?;
            continue;
        }
        let files = (format.make)(&staged, &out).with_context(|| format!("cannot make {}", format.name))?;
        let folder = staged.build.join("trial").join(format.name);
        match trial::trial(&folder, |folder| (format.install)(&files, folder)) {
            Ok(times) => rows.push(row(format.name, &files, times)?),
            Err(error) => {
                writeln!(messages, "xtask: {} does not work: {error:#}", format.name)?;
                failed = 1;
            }
        }
    }
    ensure!(!rows.is_empty() || failed > 0, "nothing was packaged");
    checksums(&out)?;
    writeln!(messages, "\n{}", table(&rows))?;
    writeln!(messages, "xtask: the packages are in {}", out.display())?;
    Ok(failed)
}

/// The program as it is released: with the list of its dependencies inside, where `cargo auditable` is installed.
fn release(build: &Path, features: &[&str], messages: &mut dyn Write) -> Result<PathBuf> {
    let auditable = cargo(["auditable", "--version"]).output().is_ok_and(|output| output.status.success());
    if !auditable {
        let hint = "the list of dependencies is not put into the program; to have it: cargo install cargo-auditable";
        writeln!(messages, "xtask: {hint}")?;
    }
    let start: &[&str] = if auditable { &["auditable", "build"] } else { &["build"] };
    let mut command = cargo(start);
    command.args(["--profile", PROFILE, "--locked", "--package", "shadercheck", "--bin", "shadercheck"]).args(features);
    let failed = status(command.env("CARGO_TARGET_DIR", build))?;
    ensure!(failed == 0, "the program cannot be built");
    Ok(build.join(PROFILE).join(format!("shadercheck{}", std::env::consts::EXE_SUFFIX)))
}

/// Refuses a program that is larger than its limit.
fn fits(size: u64, lint: bool) -> Result<()> {
    let most = LARGEST[usize::from(lint)];
    ensure!(size <= most, "the program has {:.1} MB; the limit is {} MB", size as f64 / 1e6, most / 1_000_000);
    Ok(())
}

/// Version and target of a program.
fn version(program: &Path) -> Result<(String, String)> {
    let said = Command::new(program).args(["--version", "--verbose"]).output();
    let said = said.with_context(|| format!("cannot start {}", program.display()))?;
    let said = String::from_utf8(said.stdout)?;
    let value = |name: &str| said.lines().find_map(|line| line.strip_prefix(name)).map(str::to_owned);
    let version = value("shadercheck ").context("the program does not tell its version")?;
    Ok((version, value("target: ").context("the program does not tell its target")?))
}

/// Writes what comes with a program: completions, manual, licences of third parties, bill of materials.
fn papers(workspace: &Path, folder: &Path, program: &Path, triple: &str, features: &[&str]) -> Result<()> {
    fs::create_dir_all(folder.join("completions")).with_context(|| format!("cannot make {}", folder.display()))?;
    let packages = metadata::packages(workspace, features, triple)?;
    fs::write(folder.join("sbom.cdx.json"), format!("{:#}\n", papers::bill(&packages)))?;
    fs::write(folder.join("THIRD-PARTY.md"), papers::licences(&packages)?)?;
    for (shell, file) in SHELLS {
        let script = Command::new(program).args(["completions", shell]).output()?;
        ensure!(script.status.success() && !script.stdout.is_empty(), "no completions for {shell}");
        fs::write(folder.join("completions").join(file), script.stdout)?;
    }
    step(Command::new(program).arg("man").arg(folder.join("man")))
}

/// Collects what goes into every package.
fn stage(workspace: PathBuf, build: PathBuf, features: Vec<&'static str>, program: &Path) -> Result<Staged> {
    let (version, target) = version(program)?;
    let folder = build.join("stage");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    fs::copy(program, folder.join(format!("shadercheck{}", std::env::consts::EXE_SUFFIX)))
        .context("cannot copy the program")?;
    for name in ["README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"] {
        fs::copy(workspace.join(name), folder.join(name)).with_context(|| format!("cannot copy {name}"))?;
    }
    papers(&workspace, &folder, program, &target, &features)?;
    Ok(Staged { workspace, folder, version, target, features, build })
}

/// Shells, and the names that their scripts go by.
pub const SHELLS: [(&str, &str); 5] = [
    ("bash", "shadercheck.bash"),
    ("zsh", "_shadercheck"),
    ("fish", "shadercheck.fish"),
    ("powershell", "_shadercheck.ps1"),
    ("elvish", "shadercheck.elv"),
];

fn is_there(tool: &str) -> bool {
    Command::new(tool).arg("--version").output().is_ok()
}

/// SHA-256 of every file, in the form of `sha256sum`.
fn checksums(out: &Path) -> Result<()> {
    let mut names: Vec<OsString> = fs::read_dir(out)?.map(|entry| Ok(entry?.file_name())).collect::<Result<_>>()?;
    names.sort();
    let (program, first): (_, &[&str]) =
        if is_there("sha256sum") { ("sha256sum", &[]) } else { ("shasum", &["-a", "256"]) };
    let output = Command::new(program).args(first).args(&names).current_dir(out).output();
    let output = output.with_context(|| format!("cannot start {program}"))?;
    ensure!(output.status.success(), "{program} failed");
    Ok(fs::write(out.join("SHA256SUMS"), output.stdout)?)
}

/// Name, size in MB, and both times in seconds.
fn row(name: &str, files: &[PathBuf], times: Times) -> Result<[String; 4]> {
    let sizes = files.iter().map(|file| Ok(fs::metadata(file)?.len())).collect::<Result<Vec<u64>>>()?;
    let size = sizes.iter().sum::<u64>() as f64 / 1e6;
    let seconds = |time: std::time::Duration| format!("{:.2}", time.as_secs_f64());
    Ok([name.to_owned(), format!("{size:.1}"), seconds(times.install), seconds(times.finding)])
}

fn table(rows: &[[String; 4]]) -> String {
    let mut text = "| Package | MB | Install, s | First finding, s |\n|---|---|---|---|\n".to_owned();
    for row in rows {
        text += &format!("| {} |\n", row.join(" | "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(words: &[&str]) -> Result<Arguments> {
        Arguments::read(&words.iter().map(OsString::from).collect::<Vec<_>>())
    }

    #[test]
    fn a_program_above_its_limit_is_refused() {
        let [whole, lint] = LARGEST;
        fits(whole, false).unwrap();
        fits(lint, true).unwrap();
        let error = fits(whole + 100_000, false).unwrap_err().to_string();
        let most = whole / 1_000_000;
        assert_eq!(error, format!("the program has {most}.1 MB; the limit is {most} MB"));
        assert!(fits(lint + 1, true).is_err() && fits(lint + 1, false).is_ok());
    }

    #[test]
    fn formats_are_chosen_by_name_and_others_are_refused() {
        let all = read(&[]).unwrap();
        assert!(FORMATS.iter().all(|format| all.wants(format)));
        let one = read(&["--lint", "deb"]).unwrap();
        assert!(one.lint && FORMATS.iter().filter(|format| one.wants(format)).count() == 1);
        let error = read(&["msi"]).err().unwrap().to_string();
        assert!(error.contains("`msi`; the formats are archive, deb"), "{error}");
        assert!(read(&["--program"]).is_err());
    }
}
