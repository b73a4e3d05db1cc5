//! `shadercheck torture`: random programs on every lane and through every translator.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use clap::{Args, ValueEnum};
use serde::{Deserialize, Serialize};

use super::check::Format;
use crate::cli::shard::{Printed, Printing, ShardArgs, Terminal, Watch};
use crate::cli::status::ExitStatus;
use base::text::Shown;
use disk::fresh;
use engine::session::{At, Job, Join, Observer, Seen, Unlike};
use engine::shard::{Identity, Shard};
use engine::suite::run::{DEFAULT_SEED, Peer};
use engine::torture::{Asked, Found, Language, Wish};
use judge::profile::Promises;
use lanes::{Description, Lane, StandIn, Wanted};
use report::torture::{Summary, json, text};

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
    let lanes: Vec<Description> = opened.lanes.iter().map(|lane| lane.description().clone()).collect();
    let count = shard.map_or(1, Shard::count);
    let terminal = Terminal::new(args.format, false, out, err);
    terminal.bar.start("programs", "all lanes", args.programs.div_ceil(count));
    let mut watched = Watched { terminal, folder: args.out.as_deref(), known: 0 };
    let key = |shards| identity(args, shards, &lanes);
    let part = ShardResult { lanes: lanes.clone(), ..ShardResult::default() };
    let mut programs = Programs { args, peers: &peers, begun: Instant::now() };
    args.sharing.run(&mut programs, part, key, &mut watched)
}

/// The programs of a run.
struct Programs<'a> {
    args: &'a TortureArgs,
    peers: &'a [Peer<'a>],
    begun: Instant,
}

/// What came of them.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct ShardResult {
    lanes: Vec<Description>,
    found: Found,
    /// How long a whole run took.
    #[serde(skip)]
    seconds: f64,
}

/// Name of the parameter with the command line.
const COMMAND: &str = "command";

fn identity(args: &TortureArgs, shards: u64, lanes: &[Description]) -> Identity {
    Identity::new("torture", args.seed, shards)
        .with("--programs", args.programs)
        .with("--first", args.first)
        .with("--samples", args.samples)
        .with(COMMAND, args.command())
        .on(lanes)
}

impl Job for Programs<'_> {
    type Unit = u64;
    type Part = ShardResult;
    type Error = anyhow::Error;
    type Event<'e> = Seen<'e>;

    fn unit(&mut self, number: u64, _: &mut At<'_, Self>) -> anyhow::Result<Option<u64>> {
        Ok(self.args.first.checked_add(number).filter(|_| number < self.args.programs))
    }

    fn run(&mut self, (_, index): (u64, u64), at: &mut At<'_, Self>) -> anyhow::Result<()> {
        at.part.found.program(index, self.peers, &self.args.asked());
        at.part.seconds = self.begun.elapsed().as_secs_f64();
        Ok(())
    }
}

/// A run whose causes are told and written as they are found: they stay found where the process is ended.
struct Watched<'a> {
    terminal: Terminal<'a>,
    folder: Option<&'a Path>,
    /// Causes that were told.
    known: usize,
}

impl<'a> Watch<'a> for Watched<'a> {
    fn terminal(&mut self) -> &mut Terminal<'a> {
        &mut self.terminal
    }
}

impl Observer<Programs<'_>> for Watched<'_> {
    fn end(&mut self, part: &ShardResult) -> anyhow::Result<()> {
        let Terminal { bar, err, .. } = &mut self.terminal;
        for cause in part.found.causes.iter().skip(self.known) {
            bar.suspend(|| writeln!(err, "program {}: {}", cause.program, report::torture::line(cause)))?;
            if let Some(folder) = self.folder {
                write(folder, cause)?;
            }
        }
        self.known = part.found.causes.len();
        bar.at(part.found.programs);
        Ok(())
    }
}

impl Join for ShardResult {
    fn join(&mut self, other: Self) -> Result<(), Unlike> {
        Unlike::unless(self.lanes == other.lanes, "ran on different lanes")?;
        self.found.join(other.found)
    }
}

impl Printed for ShardResult {
    fn print(self, to: Printing<'_>) -> anyhow::Result<ExitStatus> {
        let summary = Summary {
            seed: to.identity.seed,
            command: to.identity.parameters.get(COMMAND).cloned().unwrap_or_default(),
            lanes: self.lanes,
            found: self.found,
            seconds: self.seconds,
            interrupted: to.interrupted,
        };
        let printed = if !to.format.is_text() { json(&summary) } else { text(&summary) };
        to.out.write_all(printed.as_bytes())?;
        Ok(if let Some(signal) = summary.interrupted {
            ExitStatus::Interrupted(signal)
        } else if summary.found.fails() {
            ExitStatus::Findings
        } else if summary.found.agreed == 0 {
            writeln!(to.err, "error: nothing was judged")?;
            ExitStatus::Error
        } else {
            ExitStatus::Clean
        })
    }
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
