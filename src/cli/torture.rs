//! `shadercheck torture`: random programs on every lane and through every translator.

mod shared;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use clap::{Args, ValueEnum};

use super::bar::Bar;
use super::check::Format;
use crate::cli::shard::ShardArgs;
use crate::cli::status::ExitStatus;
use base::text::Shown;
use disk::fresh;
use engine::suite::run::{DEFAULT_SEED, Peer};
use engine::torture::{Asked, Found, Language, Wish};
use judge::profile::Promises;
use lanes::{Lane, Stage, StandIn, Wanted, interrupt};
use report::torture::{Summary, json, text};

pub use shared::ShardResult;

/// Programs of a run, when none are asked for.
const PROGRAMS: u64 = 100;

/// Languages by the names that the option has for them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LanguageName {
    /// GLSL 4.50
    Glsl,
    /// WGSL
    Wgsl,
}

/// Arguments of `shadercheck torture`.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = "\
Each program is made from the seed and its number: valid by construction, in GLSL or WGSL, as a function or as a \
vertex, fragment or compute stage. It runs on every lane, and its translations are read back; outputs are \
compared with what the program means, within the errors that the API allows. A program with a finding is made \
smaller, as a program and as an input. Programs with one cause are reported once.

Findings are: a lane whose outputs are not what the program means, or differ for the same inputs; a translation \
with another meaning; a driver or translator that crashes or hangs; a call that fails; a panic of naga.

Exit status: 0 no finding; 1 findings; 2 usage, a lane of --lane that is unavailable, or nothing could be run; \
130 and 143 if SIGINT or SIGTERM ended the run, which then reports what it had found.")]
pub struct TortureArgs {
    /// Number of programs
    #[arg(long, value_name = "N", default_value_t = PROGRAMS, value_parser = clap::value_parser!(u64).range(1..))]
    pub programs: u64,
    /// Number of the first program, to run one again: `--first 17 --programs 1`
    #[arg(long, value_name = "K", default_value_t = 0)]
    pub first: u64,
    /// Seed of the programs and of their inputs: the same seed gives the same programs everywhere
    #[arg(long, value_name = "S", default_value_t = DEFAULT_SEED)]
    pub seed: u64,
    /// Only programs in this language
    #[arg(long, value_enum, value_name = "LANGUAGE")]
    pub language: Option<LanguageName>,
    /// Only these lanes [default: all available]
    #[arg(long, value_name = "LANE", value_delimiter = ',')]
    pub lane: Vec<String>,
    /// Samples per program
    #[arg(long, value_name = "N", default_value_t = engine::torture::SAMPLES, value_parser = clap::value_parser!(u64).range(1..))]
    pub samples: u64,
    /// Write a folder for each cause to this folder, with the program, its suite, and a bug report
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Which programs of the run: shard `k` modulo N runs program `k`
    #[command(flatten)]
    pub sharing: ShardArgs,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

impl TortureArgs {
    fn asked(&self) -> Asked {
        let language = self.language.map(|language| match language {
            LanguageName::Glsl => Language::Glsl,
            LanguageName::Wgsl => Language::Wgsl,
        });
        Asked { seed: self.seed, wish: Wish { language }, samples: self.samples }
    }

    /// The command line up to the number of the program.
    fn command(&self) -> String {
        let mut words = format!("shadercheck torture --seed {}", self.seed);
        if let Some(language) = self.language.and_then(|language| language.to_possible_value()) {
            words = format!("{words} --language {}", language.get_name());
        }
        if !self.lane.is_empty() {
            words = format!("{words} --lane {}", self.lane.join(","));
        }
        words
    }
}

/// Runs the command: the result goes to `out`, progress and complaints to `err`.
///
/// # Errors
/// When no lane is available, a lane has no such name, or something cannot be written.
pub fn run(args: &TortureArgs, out: &mut dyn Write, err: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let shard = args.sharing.shard()?;
    if let Some(folder) = &args.out {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder `{}`", folder.shown()))?;
        fresh::probe(folder).with_context(|| format!("cannot write to the folder `{}`", folder.shown()))?;
    }
    let opened = Wanted { stand_in: StandIn::Beside, ..Wanted::named(&args.lane) }.open()?;
    if let Some((name, missing)) = opened.missing.iter().find(|(name, _)| args.lane.iter().any(|lane| lane == name)) {
        anyhow::bail!("lane `{name}` is not available: {missing}");
    }
    anyhow::ensure!(!opened.lanes.is_empty(), "no lane is available, so nothing was run");
    let promises: Vec<Promises> = opened.lanes.iter().map(|lane| Promises::of_lane(lane.description())).collect();
    let peers: Vec<Peer<'_>> = opened
        .lanes
        .iter()
        .zip(&promises)
        .map(|(lane, promises)| Peer { lane: &**lane as &dyn Lane, promises })
        .collect();
    let lanes = opened.lanes.iter().map(|lane| lane.description().clone()).collect();
    let summary = Summary { seed: args.seed, command: args.command(), lanes, ..Summary::default() };
    if let Some(shard) = shard {
        return shared::run(args, shard, &peers, summary, out, err);
    }
    let mut summary = summary;
    let mut progress = Bar::new(args.format == Format::Text);
    progress.start("programs", "all lanes", Stage::Compute, args.programs);
    let begun = Instant::now();
    let numbers = args.first..args.first.saturating_add(args.programs);
    for (done, index) in numbers.enumerate() {
        let known = summary.found.causes.len();
        if !summary.found.program(index, &peers, &args.asked()) {
            break;
        }
        // What is found stays found where the process is ended.
        for cause in &summary.found.causes[known..] {
            progress.suspend(|| writeln!(err, "program {index}: {}", report::torture::line(cause)))?;
            if let Some(folder) = &args.out {
                write(folder, cause)?;
            }
        }
        progress.at(done as u64 + 1);
    }
    progress.finish();
    summary.seconds = begun.elapsed().as_secs_f64();
    summary.interrupted = interrupt::signal();
    conclude(&summary, args.format == Format::Json, out, err)
}

/// Writes the folder of a cause.
fn write(folder: &Path, cause: &engine::torture::Cause) -> anyhow::Result<()> {
    let own = folder.join(format!("{}-{}", cause.program, cause.folder.name));
    std::fs::create_dir_all(&own).with_context(|| format!("cannot make the folder `{}`", own.shown()))?;
    for (name, text) in &cause.folder.files {
        let path = own.join(name);
        fresh::write(&path, text.as_bytes()).with_context(|| format!("cannot write `{}`", path.shown()))?;
    }
    Ok(())
}

/// Writes the folders of all causes.
fn write_all(folder: &Path, found: &Found) -> anyhow::Result<()> {
    found.causes.iter().try_for_each(|cause| write(folder, cause))
}

/// Prints the result and gives its status.
fn conclude(summary: &Summary, as_json: bool, out: &mut dyn Write, err: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let printed = if as_json { json(summary) } else { text(summary) };
    out.write_all(printed.as_bytes())?;
    out.flush()?;
    Ok(if let Some(signal) = summary.interrupted {
        ExitStatus::Interrupted(signal)
    } else if summary.found.fails() {
        ExitStatus::Findings
    } else if summary.found.agreed == 0 {
        writeln!(err, "error: nothing was judged")?;
        ExitStatus::Error
    } else {
        ExitStatus::Clean
    })
}
