//! How much of a folder of shaders reaches a valid module, by version and stage, and what stops the rest.
//!
//! A file counts when `glslangValidator` accepts it; where that program is missing, every file counts. A file
//! without `main` is a part of a stage, and counted apart.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a command prints its figures")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

use anyhow::{Context, Result, bail};
use rayon::prelude::*;
use shadercheck::glsl::{Profile, Shader, Stage};
use shadercheck::lower::Target;
use shadercheck::program::{Program, ProgramError, contain};
use shadercheck::text::{SourceFile, decode};

/// What was asked for.
#[derive(Default)]
struct Request {
    folders: Vec<PathBuf>,
    list: Option<String>,
    tree: bool,
    every: usize,
}

/// What became of one file.
struct Outcome {
    path: PathBuf,
    group: String,
    stage: Stage,
    extensions: bool,
    accepted: bool,
    whole: bool,
    /// Why there is no valid module.
    reason: Option<String>,
}

#[derive(Clone, Copy, Default)]
struct Tally {
    files: usize,
    accepted: usize,
    parts: usize,
    valid: usize,
}

impl Outcome {
    fn counts(&self) -> bool {
        self.accepted && self.whole
    }
}

impl Tally {
    fn add(&mut self, outcome: &Outcome) {
        self.files += 1;
        self.parts += usize::from(outcome.accepted && !outcome.whole);
        self.accepted += usize::from(outcome.counts());
        self.valid += usize::from(outcome.counts() && outcome.reason.is_none());
    }

    fn line(&self, name: &str, stage: &str) {
        let share = if self.accepted == 0 { 100.0 } else { 100.0 * self.valid as f64 / self.accepted as f64 };
        println!(
            "{name:<12}{stage:<10}{:>7}{:>9}{:>10}{:>8}{share:>8.1} %",
            self.files, self.parts, self.accepted, self.valid
        );
    }
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("survey: {error:#}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<()> {
    let request = request(std::env::args().skip(1).filter(|a| a != "--bench"))?;
    if request.folders.is_empty() {
        // All benchmarks run: there is nothing to survey.
        return Ok(());
    }
    let mut files = Vec::new();
    for folder in &request.folders {
        walk(folder, &mut files)?;
    }
    files.sort();
    let files: Vec<PathBuf> = files.into_iter().step_by(request.every.max(1)).collect();
    let reference = reference();
    if !reference {
        eprintln!("survey: glslangValidator is not on the path, so every file counts as accepted");
    }
    let outcomes: Vec<Outcome> = files.par_iter().filter_map(|path| examine(path, reference, request.tree)).collect();
    if let Some(wanted) = &request.list {
        for o in outcomes.iter().filter(|o| o.counts()) {
            if let Some(reason) = o.reason.as_ref().filter(|r| r.contains(wanted.as_str())) {
                println!("{}: {reason}", o.path.display());
            }
        }
        return Ok(());
    }
    for extensions in [false, true] {
        println!("{}", if extensions { "with `#extension`" } else { "without extensions" });
        println!("version     stage       files  no main  accepted   valid");
        report(outcomes.iter().filter(|o| o.extensions == extensions));
        println!();
    }
    Ok(())
}

fn report<'a>(outcomes: impl Iterator<Item = &'a Outcome>) {
    let mut table: BTreeMap<(&str, &str), Tally> = BTreeMap::new();
    let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
    let mut all = Tally::default();
    for o in outcomes {
        table.entry((&o.group, o.stage.name())).or_default().add(o);
        all.add(o);
        if let Some(reason) = o.reason.as_deref().filter(|_| o.counts()) {
            *reasons.entry(reason).or_default() += 1;
        }
    }
    for ((group, stage), tally) in &table {
        tally.line(group, stage);
    }
    all.line("all", "");
    let mut reasons: Vec<_> = reasons.into_iter().collect();
    reasons.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    for (reason, count) in reasons.iter().take(60) {
        println!("{count:>7}  {reason}");
    }
}

fn request(mut arguments: impl Iterator<Item = String>) -> Result<Request> {
    let mut request = Request::default();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--list" => request.list = Some(arguments.next().context("--list takes a reason")?),
            "--tree" => request.tree = true,
            "--every" => request.every = arguments.next().context("--every takes a number")?.parse()?,
            _ if argument.starts_with('-') => bail!("unknown option `{argument}`; known: --list, --tree, --every"),
            _ => request.folders.push(PathBuf::from(argument)),
        }
    }
    Ok(request)
}

fn walk(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    for entry in std::fs::read_dir(folder).with_context(|| format!("cannot read `{}`", folder.display()))? {
        let entry = entry?;
        let kind = entry.file_type()?;
        let path = entry.path();
        if kind.is_dir() {
            walk(&path, files)?;
        } else if kind.is_file() && stage(&path).is_some() {
            files.push(path);
        }
    }
    Ok(())
}

fn stage(path: &Path) -> Option<Stage> {
    Stage::from_path(path.to_str()?)
        .filter(|s| matches!(s, Stage::Vertex | Stage::Fragment | Stage::Geometry | Stage::Compute))
}

fn reference() -> bool {
    Command::new("glslangValidator").arg("--version").stdout(Stdio::null()).status().is_ok()
}

fn accepted(path: &Path, stage: Stage) -> bool {
    let name = match stage {
        Stage::Vertex => "vert",
        Stage::Geometry => "geom",
        Stage::Compute => "comp",
        _ => "frag",
    };
    let run = Command::new("glslangValidator").args(["-S", name]).arg(path).stdout(Stdio::null()).status();
    run.is_ok_and(|s| s.success())
}

fn examine(path: &Path, reference: bool, tree: bool) -> Option<Outcome> {
    let stage = stage(path)?;
    let bytes = std::fs::read(path).ok()?;
    let file = decode(&path.display().to_string(), &bytes).ok()?.file;
    let parsed = contain(|| Shader::parse(&file, stage)).ok()?.shader;
    let version = parsed.version();
    let es = if version.profile == Profile::Es { " es" } else { "" };
    Some(Outcome {
        path: path.to_owned(),
        group: format!("{}{es}", version.number),
        stage,
        extensions: !parsed.extensions().is_empty(),
        accepted: !reference || accepted(path, stage),
        whole: parsed.function("main").is_some(),
        reason: contain(|| reason(&file, stage, tree)).unwrap_or_else(|panic| Some(format!("panic: {panic}"))),
    })
}

/// Why a shader does not reach a valid module.
fn reason(file: &SourceFile, stage: Stage, tree: bool) -> Option<String> {
    let error = if tree {
        let parsed = Shader::parse(file, stage);
        Program::build(&parsed.shader, &Target::Stage).err()?
    } else {
        Program::from_source(file, stage, |_| Ok(Target::Stage)).err()?
    };
    Some(match error {
        ProgramError::Source(found) => {
            found.first().map_or_else(String::new, |d| format!("{} {}", d.code, short(&d.message)))
        }
        ProgramError::Unsupported { what } => what,
        ProgramError::Internal(what) => format!("internal: {}", what.chars().take(120).collect::<String>()),
    })
}

/// A message without the names of the author.
fn short(message: &str) -> String {
    let mut parts = message.split('`');
    let mut all = parts.next().unwrap_or_default().to_owned();
    let mut quoted = true;
    for part in parts {
        // What begins like something of the language stays.
        let own = ["gl_", "texture", "image", "sampler", "isampler", "usampler", "interpolate", "atomic", "E8"];
        let keep = !quoted || own.iter().any(|o| part.starts_with(o)) || part.len() < 3;
        all += if keep { part } else { "…" };
        quoted = !quoted;
    }
    all.chars().take(110).collect()
}
