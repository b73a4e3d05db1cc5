//! `shadercheck mutate`: mutation testing of shaders and their suites.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use serde::{Deserialize, Serialize};

use super::check::Format;
use super::check::select::{self, Selected};
use super::test::{self, TestArgs};
use crate::cli::shard::{Printed, Printing, ShardArgs, Terminal};
use crate::cli::status::ExitStatus;
use base::diagnostic::Lang;
use base::did_you_mean;
use base::text::Shown;
use engine::mutate::operators::{by_name, registry};
use engine::mutate::{MutateError, Operator, Request, SuiteResult, Tested, run as run_suite};
use engine::session::{At, Job, Join, Seen, Unlike};
use engine::shard::{Identity, Shard};
use engine::suite::run::{DEFAULT_SEED, RunError};
use lanes::{Lane, Stage, interrupt, open_first};
use report::diagnostics;
use report::mutate::{Summary, json, text};

/// Samples of a mutant that nothing kills, when none are asked for.
const SAMPLES: u64 = 1 << 16;

/// Arguments of `shadercheck mutate`.
#[derive(Args, Clone, Debug, Default)]
pub struct MutateArgs {
    /// Suite files (*.suite.toml), shaders with suites beside them, folders that are searched, and shipped suites by name;
    /// shaders without a suite that have tests [default: the current folder]
    #[arg(value_name = "SUITE|FILE")]
    pub suites: Vec<String>,
    /// Also all suites that come with shadercheck
    #[arg(long)]
    pub shipped: bool,
    /// Mutate this shader instead of the suite's own; needs exactly one suite
    #[arg(long, value_name = "FILE")]
    pub shader: Option<PathBuf>,
    /// Only these operators; `list` shows them
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub operator: Vec<String>,
    /// Lane that runs the mutants [default: the first available]
    #[arg(long, value_name = "LANE")]
    pub lane: Option<String>,
    /// Samples per mutant, as long as none of them kills it
    #[arg(long, value_name = "N", default_value_t = SAMPLES, value_parser = clap::value_parser!(u64).range(1..))]
    pub samples: u64,
    /// Seed of the inputs: the same seed gives the same inputs everywhere
    #[arg(long, value_name = "S", default_value_t = DEFAULT_SEED)]
    pub seed: u64,
    /// Lowest acceptable score, in percent
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, value_parser = percent)]
    pub floor: f64,
    /// Which mutants of the run: shard `k` modulo N runs mutant `k` of a suite
    #[command(flatten)]
    pub sharing: ShardArgs,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

fn percent(text: &str) -> Result<f64, String> {
    match text.trim_end_matches('%').trim_end().parse() {
        Ok(value) if (0.0..=100.0).contains(&value) => Ok(value),
        _ => Err("not a number from 0 to 100".to_owned()),
    }
}

/// Runs the command: the result goes to `out`, progress and complaints to `err`.
///
/// The status is [`ExitStatus::Findings`] when the score of all suites together is below the floor,
/// and [`ExitStatus::Error`] when a suite fails on the unchanged shader, or nothing could be run.
///
/// # Errors
/// When a file cannot be read, a name is unknown, no lane is available, or output fails.
pub fn run(args: &MutateArgs, out: &mut dyn Write, err: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    if args.operator.iter().any(|name| name == "list") {
        for operator in registry() {
            writeln!(out, "{:<16} {}", operator.name, operator.about)?;
        }
        return Ok(ExitStatus::Clean);
    }
    let shard = args.sharing.shard()?;
    let operators = operators(&args.operator)?;
    let mut selected = match select(&args.suites, args.shipped) {
        Ok(selected) => selected,
        // Shaders without a suite may have tests of their own.
        Err(error) => {
            let tests = TestArgs::of(&args.suites, "text");
            let plain = !args.shipped && args.shader.is_none() && args.lane.is_none() && shard.is_none();
            return if plain && tests.applies() { of_tests(args, &tests, &operators, out, err) } else { Err(error) };
        }
    };
    anyhow::ensure!(
        args.shader.is_none() || selected.len() == 1,
        "--shader needs exactly one suite, and {} are chosen",
        selected.len()
    );
    let lane = open_first(args.lane.as_ref())?.only().map_err(|missing| {
        let missing = missing.iter().map(|(name, why)| format!("lane `{name}` is not available: {why}"));
        anyhow::anyhow!("{}", missing.collect::<Vec<_>>().join("; "))
    })?;
    if let Some(path) = &args.shader {
        let shader = super::translate::read(path)?;
        selected.iter_mut().for_each(|one| one.shader = shader.clone());
    }
    let description = lane.description();
    let on = format!("{}/{} ({})", description.name, Stage::Compute, description.driver);
    let shard = shard.unwrap_or(Shard::WHOLE);
    let request = Request { samples: args.samples, seed: args.seed, operators, shard };
    let mut work = Work { selected: &selected, lane: lane.as_ref(), request };
    let part = ShardResult { lane: on.clone(), suites: Vec::new() };
    let key = |shards| identity(args, shards, &on, &selected);
    args.sharing.run(&mut work, part, key, &mut Terminal::new(args.format, false, out, err))
}

/// Mutants of what tests call that stand in shaders.
fn of_tests(
    args: &MutateArgs,
    tests: &TestArgs,
    operators: &[&'static Operator],
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> anyhow::Result<ExitStatus> {
    let summary = test::mutants(tests, operators, err)?;
    let printed = match args.format {
        Format::Json => json(&summary),
        Format::Text => text(&summary),
    };
    out.write_all(printed.as_bytes())?;
    let share = summary.score().share();
    Ok(match interrupt::signal() {
        Some(signal) => ExitStatus::Interrupted(signal),
        None if !summary.failed.is_empty() => ExitStatus::Error,
        None if share.map_or(args.floor > 0.0, |share| 100.0 * share < args.floor) => ExitStatus::Findings,
        None => ExitStatus::Clean,
    })
}

/// Everything that the result of a run depends on.
fn identity(args: &MutateArgs, shards: u64, lane: &str, selected: &[Selected]) -> Identity {
    let identity = Identity::new("mutate", args.seed, shards)
        .with("--samples", args.samples)
        .with("--operator", args.operator.join(","))
        .with(FLOOR, args.floor)
        .with("lane", lane);
    selected.iter().fold(identity, |all, one| {
        let (what, text) = (format!("suite `{} ({})`", one.suite.name, one.argument), one.shader.text());
        all.of(&what, &format!("{text}\n{:?}", one.suite))
    })
}

/// What is to be done: the mutants of suites on a lane.
struct Work<'a> {
    selected: &'a [Selected],
    lane: &'a dyn Lane,
    request: Request,
}

impl Job for Work<'_> {
    type Unit = usize;
    type Part = ShardResult;
    type Error = anyhow::Error;
    type Event<'e> = Seen<'e>;

    const SHARED_WITHIN: bool = true;

    fn unit(&mut self, number: u64, _: &mut At<'_, Self>) -> anyhow::Result<Option<usize>> {
        Ok(Some(number as usize).filter(|suite| *suite < self.selected.len()))
    }

    fn run(&mut self, (_, suite): (u64, usize), at: &mut At<'_, Self>) -> anyhow::Result<()> {
        let Selected { suite, shader, .. } = &self.selected[suite];
        let (what, on) = (&*suite.name, self.lane.description().name);
        at.observer.event(Seen::Begun { what, on, steps: 0 })?;
        let (mut reported, mut told) = (0, Ok(()));
        let result = run_suite(suite, shader, self.lane, &self.request, &mut |done, all| {
            if reported != all {
                reported = all;
                told = at.observer.event(Seen::Begun { what, on, steps: all as u64 });
            }
            at.observer.progress(done as u64);
        });
        told?;
        let shared = match result {
            Ok(result) => Shared::tested(self.request.shard, result),
            Err(_) if interrupt::asked() => return Ok(()),
            // Its other sizes are mutated.
            Err(error @ MutateError::Large { .. }) if self.selected.len() > 1 => Shared::Large(error.to_string()),
            Err(error) => {
                let (suite, shown) = (suite.name.clone(), diagnostics_of(&error).collect());
                Shared::Failed { suite, why: error.to_string(), shown }
            }
        };
        if let Some(said) = shared.said() {
            at.observer.event(Seen::Said(&said))?;
        }
        at.part.suites.push(shared);
        Ok(())
    }
}

/// The name of the parameter with the lowest score that is no finding.
const FLOOR: &str = "--floor";

/// What came of suites.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct ShardResult {
    lane: String,
    suites: Vec<Shared>,
}

/// What came of a suite.
#[derive(Debug, Serialize, Deserialize)]
enum Shared {
    /// Mutants, each with its number in the suite.
    Tested { suite: String, shader: String, samples: u64, tested: Vec<(u64, Tested)> },
    /// No score can be given: the suite, why, and what is wrong with its shader.
    Failed { suite: String, why: String, shown: String },
    /// Too large to be mutated, which is said, since its other sizes are.
    Large(String),
}

impl Shared {
    /// The mutants of a shard.
    fn tested(shard: Shard, SuiteResult { suite, shader, samples, tested }: SuiteResult) -> Self {
        let numbers = (0_u64..).map(|k| k * shard.count() + shard.index());
        Self::Tested { suite, shader, samples, tested: numbers.zip(tested).collect() }
    }

    /// What is said of it beside the report.
    fn said(&self) -> Option<String> {
        match self {
            Self::Tested { .. } => None,
            Self::Failed { why, shown, .. } => Some(format!("{shown}error: {why}\n")),
            Self::Large(why) => Some(format!("note: {why}\n")),
        }
    }

    fn join(&mut self, other: Self) -> Result<(), Unlike> {
        match (self, other) {
            (Self::Tested { suite, tested, .. }, Self::Tested { suite: same, tested: more, .. }) if *suite == same => {
                tested.extend(more);
                tested.sort_by_key(|(number, _)| *number);
                Ok(())
            }
            (Self::Failed { suite, why, shown }, Self::Failed { suite: same, why: also, shown: more })
                if *suite == same =>
            {
                // Of two reasons one, whichever shard comes first.
                if also < *why {
                    (*why, *shown) = (also, more);
                }
                Ok(())
            }
            (Self::Large(why), Self::Large(same)) => Unlike::unless(*why == same, "ran different suites"),
            (Self::Tested { suite, .. } | Self::Failed { suite, .. } | Self::Large(suite), _) => {
                Err(Unlike(format!("suite `{suite}` passed on some shards and failed on others")))
            }
        }
    }
}

impl Join for ShardResult {
    fn join(&mut self, other: Self) -> Result<(), Unlike> {
        Unlike::unless(self.lane == other.lane, "ran on different lanes")?;
        Unlike::unless(self.suites.len() == other.suites.len(), "ran different suites")?;
        self.suites.iter_mut().zip(other.suites).try_for_each(|(one, other)| one.join(other))
    }
}

impl Printed for ShardResult {
    fn print(self, mut to: Printing<'_>) -> anyhow::Result<ExitStatus> {
        let mut summary = Summary { seed: to.identity.seed, lane: self.lane, ..Summary::default() };
        for suite in self.suites {
            if let Some(said) = suite.said().filter(|_| !to.live) {
                to.err.write_all(said.as_bytes())?;
            }
            match suite {
                Shared::Tested { suite, shader, samples, tested } => {
                    let tested = tested.into_iter().map(|(_, tested)| tested).collect();
                    summary.suites.push(SuiteResult { suite, shader, samples, tested });
                }
                Shared::Failed { suite, why, .. } => summary.failed.push((suite, why)),
                Shared::Large(_) => {}
            }
        }
        let nothing = summary.failed.is_empty() && summary.score().all() == 0;
        if nothing && to.interrupted.is_none() {
            anyhow::bail!(
                "the chosen operators find nothing to change in the chosen shaders; choose others with --operator"
            );
        }
        if !to.format.is_text() {
            to.out.write_all(json(&summary).as_bytes())?;
        } else if !summary.suites.is_empty() {
            to.out.write_all(text(&summary).as_bytes())?;
        }
        let floor = to.identity.parameters.get(FLOOR).and_then(|floor| floor.parse().ok()).unwrap_or(0.0);
        let score = summary.score().share();
        Ok(if let Some(status) = to.ended()? {
            status
        } else if !summary.failed.is_empty() {
            ExitStatus::Error
        } else if score.map_or(floor > 0.0, |share| 100.0 * share < floor) {
            // Where no mutant moved anything, there is no score that could reach the floor.
            ExitStatus::Findings
        } else {
            ExitStatus::Clean
        })
    }
}

/// What is wrong with a shader that does not compile, as `lint` tells it.
fn diagnostics_of(error: &MutateError) -> impl Iterator<Item = String> {
    let found = match error {
        MutateError::Suite(RunError::Shader { diagnostics, .. }) => &diagnostics[..],
        _ => &[],
    };
    found.iter().map(|diagnostic| diagnostics::text(diagnostic, Lang::En, false))
}

fn operators(names: &[String]) -> anyhow::Result<Vec<&'static Operator>> {
    if names.is_empty() {
        return Ok(registry().iter().collect());
    }
    let all = || registry().iter().map(|o| o.name);
    let find = |name: &String| {
        by_name(name)
            .with_context(|| format!("there is no operator `{name}`; {}", did_you_mean(name, all(), "operators are")))
    };
    names.iter().map(find).collect()
}

/// The suites that the arguments name. A shader stands for the suite files beside it that name it.
fn select(arguments: &[String], shipped: bool) -> anyhow::Result<Vec<Selected>> {
    let mut named = Vec::new();
    for argument in arguments {
        let path = Path::new(argument);
        if argument.ends_with(".toml") || !path.is_file() {
            named.push(argument.clone());
            continue;
        }
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let before = named.len();
        let entries =
            std::fs::read_dir(folder).with_context(|| format!("cannot read the folder `{}`", folder.shown()))?;
        for entry in entries {
            let file = entry?.path();
            if file.to_string_lossy().ends_with(".suite.toml") {
                let about = |loaded: &engine::suite::Loaded| {
                    path.file_name().is_some_and(|name| name.to_string_lossy() == loaded.suite.shader)
                };
                if engine::suite::load_all(&file)?.iter().any(about) {
                    named.push(file.to_string_lossy().into_owned());
                }
            }
        }
        anyhow::ensure!(
            named.len() > before,
            "no suite file beside `{argument}` names it; give the suite, and the shader with --shader"
        );
        named[before..].sort();
    }
    select::select(&named, shipped)
}
