//! `shadercheck mutate`: mutation testing of shaders and their suites.

mod shared;

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;

use super::bar::Bar;
use super::check::Format;
use super::check::select::{self, Selected};
use crate::cli::shard::ShardArgs;
use crate::cli::status::ExitStatus;
use base::diagnostic::Lang;
use base::did_you_mean;
use base::text::{Shown, SourceFile};
use engine::mutate::operators::{by_name, registry};
use engine::mutate::{MutateError, Operator, Request, SuiteResult, run as run_suite};
use engine::shard::Shard;
use engine::suite::run::{DEFAULT_SEED, RunError, signal_name};
use lanes::{Lane, Stage, interrupt, open_first};
use report::diagnostics;
use report::mutate::{Summary, json, text};

pub use shared::ShardResult;

/// Samples of a mutant that nothing kills, when none are asked for.
const SAMPLES: u64 = 1 << 16;

/// Arguments of `shadercheck mutate`.
#[derive(Args, Clone, Debug, Default)]
pub struct MutateArgs {
    /// Suite files (*.suite.toml), shaders with suites beside them, folders that are searched, and shipped suites by name
    /// [default: the current folder]
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
    let selected = select(&args.suites, args.shipped)?;
    anyhow::ensure!(
        args.shader.is_none() || selected.len() == 1,
        "--shader needs exactly one suite, and {} are chosen",
        selected.len()
    );
    let lane = open_first(args.lane.as_ref())?.only().map_err(|missing| {
        let missing = missing.iter().map(|(name, why)| format!("lane `{name}` is not available: {why}"));
        anyhow::anyhow!("{}", missing.collect::<Vec<_>>().join("; "))
    })?;
    let description = lane.description().clone();
    let mut summary = Summary {
        seed: args.seed,
        lane: format!("{}/{} ({})", description.name, Stage::Compute, description.driver),
        ..Summary::default()
    };
    let request = Request { samples: args.samples, seed: args.seed, operators, shard: shard.unwrap_or(Shard::WHOLE) };
    let work = Work { args, selected: &selected, lane: lane.as_ref(), request };
    if let Some(shard) = shard {
        return shared::run(&work, shard, &summary.lane, out, err);
    }
    let mut progress = Bar::new(args.format == Format::Text);
    for one in &selected {
        match work.suite(one, &mut progress)? {
            Err(_) if interrupt::asked() => {}
            Ok(result) => summary.suites.push(result),
            // Its other sizes are mutated.
            Err(error @ MutateError::Large { .. }) if selected.len() > 1 => {
                progress.suspend(|| writeln!(err, "note: {error}"))?;
            }
            Err(error) => {
                progress.suspend(|| {
                    diagnostics_of(&error).try_for_each(|text| err.write_all(text.as_bytes()))?;
                    writeln!(err, "error: {error}")
                })?;
                summary.failed.push((one.suite.name.clone(), error.to_string()));
            }
        }
        if interrupt::asked() {
            break;
        }
    }
    progress.finish();
    match interrupt::signal() {
        Some(signal) => interrupted(&summary, signal, args.format, (out, err)),
        None => conclude(&summary, args.floor, args.format == Format::Json, out),
    }
}

/// What is to be done: the mutants of suites on a lane.
struct Work<'a> {
    args: &'a MutateArgs,
    selected: &'a [Selected],
    lane: &'a dyn Lane,
    request: Request,
}

impl Work<'_> {
    /// The shader that is mutated under a suite.
    fn shader(&self, selected: &Selected) -> anyhow::Result<SourceFile> {
        match &self.args.shader {
            Some(path) => super::translate::read(path),
            None => Ok(selected.shader.clone()),
        }
    }

    /// Runs the mutants of a suite.
    fn suite(&self, selected: &Selected, progress: &mut Bar) -> anyhow::Result<Result<SuiteResult, MutateError>> {
        let (suite, shader) = (&selected.suite, self.shader(selected)?);
        let name = self.lane.description().name;
        progress.start(&suite.name, name, Stage::Compute, 0);
        let mut reported = 0;
        Ok(run_suite(suite, &shader, self.lane, &self.request, &mut |done, all| {
            if reported != all {
                reported = all;
                progress.start(&suite.name, name, Stage::Compute, all as u64);
            }
            progress.at(done as u64);
        }))
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

/// Prints what was found until a signal came.
fn interrupted(
    summary: &Summary,
    signal: u8,
    format: Format,
    (out, err): (&mut dyn Write, &mut dyn Write),
) -> anyhow::Result<ExitStatus> {
    if format == Format::Json {
        out.write_all(json(summary).as_bytes())?;
    } else if !summary.suites.is_empty() {
        out.write_all(text(summary).as_bytes())?;
    }
    out.flush()?;
    let name = signal_name(signal);
    writeln!(err, "error: the run was interrupted by {name}; these are the mutants until then")?;
    Ok(ExitStatus::Interrupted(signal))
}

/// Prints the result and gives the status.
fn conclude(summary: &Summary, floor: f64, as_json: bool, out: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    if summary.failed.is_empty() && summary.score().all() == 0 {
        anyhow::bail!(
            "the chosen operators find nothing to change in the chosen shaders; choose others with --operator"
        );
    }
    if as_json {
        out.write_all(json(summary).as_bytes())?;
    } else if !summary.suites.is_empty() {
        out.write_all(text(summary).as_bytes())?;
    }
    out.flush()?;
    let score = summary.score().share();
    Ok(if !summary.failed.is_empty() {
        ExitStatus::Error
    } else if score.is_some_and(|share| 100.0 * share < floor) {
        ExitStatus::Findings
    } else if score.is_none() && floor > 0.0 {
        // No mutant moved anything: there is no score that could reach the floor.
        ExitStatus::Findings
    } else {
        ExitStatus::Clean
    })
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
