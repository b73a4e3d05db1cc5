//! How much of a folder of shaders reaches a valid module and runs, by version and stage, and what stops the
//! rest.
//!
//! A file counts when `glslangValidator` accepts it; where that program is missing, every file counts. A file
//! without `main` is a part of a stage, and counted apart. With `--run`, what is valid is captured and runs one
//! batch of ordinary numbers on the vulkan lane. With `--vulkan`, files that are accepted for Vulkan alone
//! count too. With `--translate`, what is valid is translated to every language, checked by the validators that are
//! installed and compared by meaning.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a command prints its figures")]

#[path = "survey/translations.rs"]
mod translations;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::sync::Arc;

use anyhow::{Context, Result, bail};
use base::text::{SourceFile, decode};
use base::value::{Batch, Record, Scalar};
use lanes::{self, Lane};
use program::lower::Target;
use program::{Kernel, Program, ProgramError, contain};
use property::Stream;
use rayon::prelude::*;
use syntax::{Profile, Shader, Stage};

/// Rounds of loops that an invocation may go through.
const FUEL: u32 = 20_000;
/// Invocations of the batch that is run.
const BATCH: usize = 64;

/// What was asked for.
#[derive(Default)]
struct Request {
    folders: Vec<PathBuf>,
    list: Option<String>,
    every: usize,
    run: bool,
    vulkan: bool,
    translate: bool,
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
    /// What can be run.
    kernel: Option<Kernel>,
    /// Why it did not run.
    stopped: Option<String>,
    /// What became of it in each language.
    translated: Vec<translations::Message>,
}

#[derive(Clone, Copy, Default)]
struct Tally {
    files: usize,
    accepted: usize,
    parts: usize,
    valid: usize,
    ran: usize,
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
        self.ran += usize::from(outcome.counts() && outcome.reason.is_none() && outcome.stopped.is_none());
    }

    fn line(&self, name: &str, stage: &str, run: bool) {
        let share = if self.accepted == 0 { 100.0 } else { 100.0 * self.valid as f64 / self.accepted as f64 };
        let ran = if run { format!("{:>8}", self.ran) } else { String::new() };
        println!(
            "{name:<12}{stage:<10}{:>7}{:>9}{:>10}{:>8}{share:>8.1} %{ran}",
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
    let mut outcomes: Vec<Outcome> = files.par_iter().filter_map(|path| examine(path, reference, &request)).collect();
    if request.run {
        let vulkan = lanes::registry().iter().find(|c| c.name == "vulkan").context("no lane `vulkan`")?;
        let vulkan = (vulkan.open)()?;
        for outcome in outcomes.iter_mut().filter(|o| o.counts()) {
            if let Some(kernel) = outcome.kernel.take() {
                let ran = contain(|| run_once(vulkan.as_ref(), &kernel));
                outcome.stopped = ran.unwrap_or_else(|panic| Err(format!("panic: {panic}"))).err();
            }
        }
    }
    if let Some(wanted) = &request.list {
        for o in outcomes.iter().filter(|o| o.counts()) {
            if let Some(reason) = o.reason.as_ref().filter(|r| r.contains(wanted.as_str())) {
                println!("{}: {reason}", o.path.display());
            }
            if let Some(stopped) = o.stopped.as_ref().filter(|r| request.run && r.contains(wanted.as_str())) {
                println!("{}: does not run: {stopped}", o.path.display());
            }
            for reason in
                o.translated.iter().flat_map(translations::Message::reasons).filter(|r| r.contains(wanted.as_str()))
            {
                println!("{}: {reason}", o.path.display());
            }
        }
        return Ok(());
    }
    for extensions in [false, true] {
        println!("{}", if extensions { "with `#extension`" } else { "without extensions" });
        let ran = if request.run { "                 ran" } else { "" };
        println!("version     stage       files  no main  accepted   valid{ran}");
        report(outcomes.iter().filter(|o| o.extensions == extensions), request.run);
        println!();
    }
    if request.translate {
        translations::print(outcomes.iter().filter(|o| o.counts()).map(|o| o.translated.as_slice()));
    }
    Ok(())
}

fn report<'a>(outcomes: impl Iterator<Item = &'a Outcome>, run: bool) {
    let mut table: BTreeMap<(&str, &str), Tally> = BTreeMap::new();
    let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
    let mut stops: BTreeMap<&str, usize> = BTreeMap::new();
    let mut all = Tally::default();
    for o in outcomes {
        table.entry((&o.group, o.stage.name())).or_default().add(o);
        all.add(o);
        if let Some(reason) = o.reason.as_deref().filter(|_| o.counts()) {
            *reasons.entry(reason).or_default() += 1;
        } else if let Some(stopped) = o.stopped.as_deref().filter(|_| run && o.counts()) {
            *stops.entry(stopped).or_default() += 1;
        }
    }
    for ((group, stage), tally) in &table {
        tally.line(group, stage, run);
    }
    all.line("all", "", run);
    list(reasons);
    if run {
        println!("valid, and not run:");
        list(stops);
    }
}

fn list(reasons: BTreeMap<&str, usize>) {
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
            "--run" => request.run = true,
            "--vulkan" => request.vulkan = true,
            "--translate" => request.translate = true,
            "--every" => request.every = arguments.next().context("--every takes a number")?.parse()?,
            _ if argument.starts_with('-') => {
                bail!("unknown option `{argument}`; known: --list, --every, --run, --vulkan, --translate")
            }
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

fn accepted(path: &Path, stage: Stage, vulkan: bool) -> bool {
    let name = match stage {
        Stage::Vertex => "vert",
        Stage::Geometry => "geom",
        Stage::Compute => "comp",
        _ => "frag",
    };
    let run = |more: &[&str]| {
        let mut command = Command::new("glslangValidator");
        command.args(["-S", name]).args(more).arg(path).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|s| s.success())
    };
    run(&[]) || vulkan && run(&["-V", "-o", "/dev/null"])
}

fn examine(path: &Path, reference: bool, request: &Request) -> Option<Outcome> {
    let stage = stage(path)?;
    let bytes = std::fs::read(path).ok()?;
    let file = decode(&path.display().to_string(), &bytes).ok()?.file;
    let parsed = contain(|| Shader::parse(&file, stage)).ok()?.shader;
    let version = parsed.version();
    let es = if version.profile == Profile::Es { " es" } else { "" };
    let made = contain(|| program(&file, stage)).unwrap_or_else(|panic| Err(format!("panic: {panic}")));
    let accepted = !reference || accepted(path, stage, request.vulkan);
    let translated = match &made {
        Ok(program) if request.translate && accepted => translations::examine(program),
        _ => Vec::new(),
    };
    let (reason, ready) = match made {
        Ok(program) if request.run => (None, contain(|| kernel(program)).unwrap_or_else(Err)),
        Ok(_) => (None, Err(String::new())),
        Err(reason) => (Some(reason), Err(String::new())),
    };
    let (kernel, stopped) = match ready {
        Ok(kernel) => (Some(kernel), None),
        Err(stopped) => (None, Some(stopped)),
    };
    Some(Outcome {
        path: path.to_owned(),
        group: format!("{}{es}", version.number),
        stage,
        extensions: !parsed.extensions().is_empty(),
        accepted,
        whole: parsed.function("main").is_some(),
        reason,
        kernel,
        stopped,
        translated,
    })
}

/// The shader with its memory and inputs fed, and no loop without end.
fn kernel(program: Program) -> Result<Kernel, String> {
    let program = program.with_memory_inside().map_err(reported)?;
    program.compute_kernel().and_then(|kernel| kernel.with_fuel(FUEL)).map_err(reported)
}

/// Runs one batch.
fn run_once(lane: &dyn Lane, kernel: &Kernel) -> Result<(), String> {
    let mut stream = Stream::new(1);
    let mut words = |record: &Record| -> Vec<u32> {
        let scalars = record.fields().iter().flat_map(|f| vec![f.shape.scalar; f.shape.words()]);
        scalars.map(|scalar| word(scalar, &mut stream)).collect()
    };
    let invocations = (0..BATCH).flat_map(|_| words(&kernel.invocation)).collect();
    let cases = (0..BATCH).flat_map(|_| words(&kernel.case)).collect();
    let batch = Batch {
        per_case: 1,
        invocations,
        cases,
        invocation_record: Arc::clone(&kernel.invocation),
        case_record: Arc::clone(&kernel.case),
    };
    let cut = |e: lanes::LaneError| e.to_string().chars().take(110).collect::<String>();
    lane.prepare(kernel, BATCH).map_err(cut)?.run(&batch).map(|_| ()).map_err(cut)
}

/// An ordinary number.
fn word(scalar: Scalar, stream: &mut Stream) -> u32 {
    let bits = (stream.bits() >> 32) as u32;
    match scalar {
        Scalar::F32 => ((bits >> 8) as f32 / (1 << 22) as f32 - 2.0).to_bits(),
        Scalar::I32 | Scalar::U32 => bits % 4,
        Scalar::Bool => bits % 2,
    }
}

/// The program, or why a shader does not reach a valid module.
fn program(file: &SourceFile, stage: Stage) -> Result<Program, String> {
    Program::from_source(file, stage, |_| Ok(Target::Stage)).map_err(reported)
}

fn reported(error: ProgramError) -> String {
    match error {
        ProgramError::Source(found) => {
            found.first().map_or_else(String::new, |d| format!("{} {}", d.code, short(&d.message)))
        }
        ProgramError::Unsupported { what } => what,
        ProgramError::Internal(what) => format!("internal: {}", what.chars().take(120).collect::<String>()),
    }
}

/// A message that is the same for every place and number.
fn without_numbers(message: &str) -> String {
    let mut all = String::new();
    for c in message.chars() {
        match c {
            '0'..='9' if all.ends_with('0') => {}
            '0'..='9' => all.push('0'),
            _ => all.push(c),
        }
    }
    all
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
