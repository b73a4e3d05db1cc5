//! `shadercheck check`: suites on lanes.

mod bundle;
mod expectations;
mod page;
pub(super) mod profile;
mod progress;
mod screen;
pub(super) mod select;
mod shared;
mod watched;

use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Context;
use clap::{Args, ValueEnum};

use crate::cli::reported::{self, Reported};
use crate::cli::shard::ShardArgs;
use crate::cli::status::ExitStatus;
use crate::cli::test;
use crate::cli::waiting::Waiting;
use engine::check::{self, Check, Suites};
use engine::suite::run::{DEFAULT_SEED, LaneUsed, Peer, Prepared, Request, RunError, Status, Summary, prepare};
use judge::profile::Promises;
use judge::verdict::Literals;
use lanes::{Lane, Stage, Wanted, interrupt};
use program::InputSource;
use property::regressions::{self, Regression};

use expectations::RunExpectations;
use page::Pages;
pub(super) use page::write_site;
use profile::Choice;
use progress::{Progress, Task};
use screen::Screen;
use select::Selected;
pub use shared::ShardResult;
use watched::Watched;

/// Arguments of `shadercheck check`.
#[derive(Args, Clone, Debug, Default)]
#[command(after_long_help = "\
Verdicts. Every sample is judged on every lane: a driver, or the interpreter that is built in, together with a way to run \
shaders on it. It agreed, deviated, or is undetermined, which is to say inconclusive: it has no value, its bound is not \
finite or too wide, or the API promises nothing there. The report gives the reason.

Exit status: 0 clean; 1 findings; 2 usage, a suite that is wrong, a lane of --lane or --require-lane that is unavailable, \
or nothing could be run.")]
pub struct CheckArgs {
    /// Suite files (*.suite.toml), shaders with suites beside them, folders that are searched, and shipped suites by name;
    /// shaders without a suite that have tests, which `test` runs
    /// [default: the current folder]
    #[arg(value_name = "SUITE|PATH")]
    pub suites: Vec<String>,
    /// Also all suites that come with shadercheck
    #[arg(long)]
    pub shipped: bool,
    /// Run this shader instead of the suite's own; needs exactly one suite. `README.md:12` is the shader at that line
    /// of a document
    #[arg(long, value_name = "FILE")]
    pub shader: Option<PathBuf>,
    /// Only these lanes, of those that `shadercheck lanes` lists; exit status 2 if one of them is unavailable
    #[arg(long, value_name = "LANE", value_delimiter = ',')]
    pub lane: Vec<String>,
    /// Exit status 2 if one of these lanes is unavailable or judges no sample
    #[arg(long, value_name = "LANE", value_delimiter = ',')]
    pub require_lane: Vec<String>,
    /// Only this stage of each lane
    #[arg(long, value_enum)]
    pub stage: Option<StageArg>,
    /// Run each suite with inputs as constants, uniforms, attributes and in storage buffers, or in those of
    /// these ways that are listed: each is another path through a compiler
    #[arg(long, value_name = "LIST", num_args = 0..=1, default_missing_value = "constants,uniforms,storage,attributes",
        value_parser = sources)]
    pub sources: Option<Sources>,
    /// Samples per suite and lane [default: from the suite]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub samples: Option<u64>,
    /// Seed of the inputs: the same seed gives the same inputs everywhere
    #[arg(long, value_name = "S", default_value_t = DEFAULT_SEED)]
    pub seed: u64,
    /// Run an eighth of the samples
    #[arg(long, conflicts_with = "samples")]
    pub quick: bool,
    /// Judge literals such as 3.141593 for π as written, instead of as the constant with a warning
    #[arg(long)]
    pub strict_literals: bool,
    /// Run only this case, copied from the `reproduce` line of a report; needs exactly one suite
    #[arg(long, value_name = "INPUTS")]
    pub case: Option<String>,
    /// Measured profile to compare lanes with: a shipped one by name, a file that `calibrate` wrote, or `none`
    /// [default: the shipped one of each lane's device, if any]
    #[arg(long, value_name = "NAME|FILE")]
    pub profile: Option<String>,
    /// File of expected failures, or `none` [default: the nearest `expectations.toml` beside or above each suite, up to
    /// the root of the repository; none with --shader or --case]
    #[arg(long, value_name = "FILE|none")]
    pub expectations: Option<String>,
    /// Write a page (`index.html`) and the report in every format to this folder, and for each failing case the shader,
    /// its lowered form, SPIR-V, inputs and outputs as bits, the command that runs it again, a test for piglit's
    /// shader_runner, and an Amber script for functions and geometry stages
    #[arg(long, value_name = "DIR")]
    pub report_dir: Option<PathBuf>,
    /// Show these results of `shadercheck mutate --format json` on the page
    #[arg(long, value_name = "FILE", requires = "report_dir")]
    pub mutations: Option<PathBuf>,
    /// Which part of the run
    #[command(flatten)]
    pub sharing: ShardArgs,
    /// Print a line for each suite and stage on a terminal too, without colours, table and progress
    #[arg(long)]
    pub plain: bool,
    /// Format of the result
    #[arg(long, value_parser = reported::names(), default_value = "text")]
    pub format: String,
}

/// Stage of a lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StageArg {
    /// Compute: uniforms of its own for every case
    Compute,
    /// Vertex: vertex buffers and uniform buffers
    Vertex,
    /// Geometry: a geometry stage of the API
    Geometry,
}

/// Sources of inputs, storage first: what other sources give is compared with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sources(pub Vec<InputSource>);

/// Reads a list of sources.
fn sources(text: &str) -> Result<Sources, String> {
    let mut all = Vec::new();
    for name in text.split(',').map(str::trim) {
        let Some(source) = InputSource::ALL.into_iter().find(|s| s.name() == name) else {
            let names: Vec<&str> = InputSource::ALL.into_iter().map(InputSource::name).collect();
            return Err(format!(
                "there is no source `{name}`; sources are {}, and suites stand before `--sources`",
                names.join(", ")
            ));
        };
        if !all.contains(&source) {
            all.push(source);
        }
    }
    all.sort_by_key(|s| *s != InputSource::Storage);
    Ok(Sources(all))
}

impl StageArg {
    fn stage(self) -> Stage {
        match self {
            Self::Compute => Stage::Compute,
            Self::Vertex => Stage::Vertex,
            Self::Geometry => Stage::Geometry,
        }
    }
}

/// How the result is printed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people
    #[default]
    Text,
    /// For programs
    Json,
}

impl CheckArgs {
    /// True where nothing is asked for that is of suites alone.
    fn is_plain(&self) -> bool {
        let files = [&self.shader, &self.report_dir, &self.mutations];
        let words = [&self.case, &self.profile, &self.expectations];
        let others = self.shipped || self.stage.is_some() || self.sources.is_some() || self.samples.is_some();
        !others
            && self.require_lane.is_empty()
            && files.iter().all(|own| own.is_none())
            && words.iter().all(|own| own.is_none())
    }

    fn reported(&self) -> Reported {
        Reported::named(&self.format)
    }

    fn is_text(&self) -> bool {
        self.reported().is_text()
    }

    fn is_json(&self) -> bool {
        self.format == "json"
    }
}

/// Runs the command: the result goes to `out`, progress and complaints to `err`.
///
/// The status is [`ExitStatus::Findings`] when a shader or lane is at fault, and
/// [`ExitStatus::Error`] when the run itself could not be made: unknown suite or lane, a required
/// lane that is missing, no lane at all, files that cannot be read, a suite that does not fit.
///
/// # Errors
/// When a file cannot be read, or `out` or `err` cannot be written to.
pub fn run(args: &CheckArgs, out: &mut dyn Write, err: &mut dyn Write, color: bool) -> anyhow::Result<ExitStatus> {
    let shard = args.sharing.shard()?;
    anyhow::ensure!(
        shard.is_none() || (args.case.is_none() && args.report_dir.is_none() && args.sources.is_none()),
        "--shard does a part of the samples; --case, --sources and --report-dir are for a run without it"
    );
    anyhow::ensure!(
        shard.is_none() || args.is_text() || args.is_json(),
        "a shard has no whole report; with --shard, --format is text or json"
    );
    let _waiting = Waiting::begin();
    let mut selected = match select::select(&args.suites, args.shipped) {
        Ok(selected) => selected,
        // Shaders without a suite may have tests of their own.
        Err(error) => {
            let tests = test::TestArgs { lane: args.lane.clone(), ..test::TestArgs::of(&args.suites, &args.format) };
            let plain = args.is_plain() && shard.is_none();
            return if plain && tests.applies() { test::run(&tests, out, err, color) } else { Err(error) };
        }
    };
    if args.strict_literals {
        selected.iter_mut().for_each(|one| one.suite.literals = Literals::Exact);
    }
    let count = selected.len();
    anyhow::ensure!(args.case.is_none() || count == 1, "--case needs exactly one suite, and {count} are chosen");
    // A suite once for each of its variants is about one shader.
    let one =
        selected.first().is_some_and(|first| selected.iter().all(|of| of.suite.file.name() == first.suite.file.name()));
    anyhow::ensure!(args.shader.is_none() || one, "--shader needs exactly one suite, and {count} are chosen");
    if let Some(path) = &args.shader {
        let shader = super::document::shader(path)?;
        selected.iter_mut().for_each(|one| one.shader = shader.clone());
    }
    let profile = Choice::new(args.profile.as_deref())?;
    let expectations = RunExpectations::new(args, &selected)?;
    let mut summary = Summary { seed: args.seed, ..Summary::default() };
    let (lanes, promises) = open_lanes(args, &profile, &mut summary)?;
    if lanes.is_empty() {
        for (name, missing) in &summary.unavailable {
            writeln!(err, "lane `{name}` is not available: {missing}")?;
        }
        if args.is_json() {
            out.write_all(report::check::json(&summary).as_bytes())?;
        }
        anyhow::bail!("no lane can run here, so nothing was checked");
    }
    let peers = lanes.iter().zip(&promises).map(|(lane, promises)| Peer { lane: lane.as_ref(), promises }).collect();
    let sources = args.sources.as_ref().map(|Sources(sources)| &sources[..]);
    let stage = args.stage.map(StageArg::stage);
    let suites = Asked { args, selected: &selected };
    let mut check = Check::new(suites, peers);
    (check.stage, check.sources, check.shard, check.translations) = (stage, sources, shard, true);
    if shard.is_some() {
        return shared::run(args, check, &expectations, summary, out, err);
    }
    let mut watched = Watched {
        args,
        selected: &selected,
        expectations: &expectations,
        summary,
        progress: Progress::new(args.is_text() && !args.plain, selected.len(), tasks(args, &check)),
        pages: Pages::new(args.report_dir.as_deref(), args.mutations.as_deref())?,
        screen: Screen::new(args, &selected, &lanes, color),
        entries: 0,
        unfit: Vec::new(),
        failing: Vec::new(),
        out,
        err,
    };
    check::run_whole(&mut check, &mut watched)?;
    let Watched { mut summary, mut progress, mut pages, screen, unfit, out, err, .. } = watched;
    progress.finish();
    without_stage(args.stage, &unfit, err)?;
    summary.interrupted = interrupt::signal();
    summary.stale = expectations.stale();
    if let Some(folder) = &args.report_dir {
        let written = reported::write_all(folder, &report::check::ci(&summary), &report::check::json(&summary));
        pages.attempt(written);
        let written = pages.write(folder, &summary, &promises);
        pages.attempt(written);
        for note in &pages.notes {
            writeln!(err, "note: {note}")?;
        }
    }
    match args.reported().of(|| report::check::ci(&summary), || report::check::json(&summary))? {
        None => screen.end(&summary, out)?,
        Some(text) => out.write_all(text.as_bytes())?,
    }
    out.flush()?;
    pages.failed.map_or(Ok(()), Err)?;
    concluded(&summary, err)
}

/// Names the suites that no lane had a stage for.
fn without_stage(stage: Option<StageArg>, suites: &[&str], err: &mut dyn Write) -> std::io::Result<()> {
    let (word, them, vertex) = match suites.len() {
        0 => return Ok(()),
        1 => ("suite", "it", "it is no vertex suite, and runs"),
        _ => ("suites", "them", "they are no vertex suites, and run"),
    };
    let why = match stage {
        Some(StageArg::Vertex) => format!("{vertex} with --stage compute"),
        Some(StageArg::Compute | StageArg::Geometry) => format!("no lane of this run has this stage for {them}"),
        None => format!("no lane of this run has a stage for {them}"),
    };
    writeln!(err, "note: {word} `{}` did not run: {why}", suites.join("`, `"))
}

/// Says why the run is not the one that was asked for, and gives its status.
fn concluded(summary: &Summary, err: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    for (_, shortcoming) in summary.shortcomings() {
        writeln!(err, "error: {shortcoming}")?;
    }
    Ok(summary.interrupted.map_or_else(|| status_of(summary), ExitStatus::Interrupted))
}

/// Prints what follows the lines of the suites.
fn print(summary: &Summary, format: Reported, color: bool, out: &mut dyn Write) -> anyhow::Result<()> {
    if let Some(text) = format.of(|| report::check::ci(summary), || report::check::json(summary))? {
        out.write_all(text.as_bytes())?;
    } else {
        screen::findings(summary, color, out)?;
        out.write_all(report::check::totals(summary, color).as_bytes())?;
    }
    out.flush()?;
    Ok(())
}

fn status_of(summary: &Summary) -> ExitStatus {
    match summary.status() {
        Status::Pass => ExitStatus::Clean,
        Status::Fail => ExitStatus::Findings,
        Status::Broken => ExitStatus::Error,
    }
}

/// Lanes, and for each what its results are held against.
type Lanes = (Vec<Box<dyn Lane>>, Vec<Promises>);

/// Opens the lanes that are asked for, or all. A required one that is missing is an error.
fn open_lanes(args: &CheckArgs, profile: &Choice, summary: &mut Summary) -> anyhow::Result<Lanes> {
    (summary.asked, summary.required) = (args.lane.clone(), args.require_lane.clone());
    let opened = Wanted { also: &args.require_lane, ..Wanted::named(&args.lane) }.open()?;
    if let Some((name, missing)) = opened.missing.iter().find(|(name, _)| args.require_lane.iter().any(|n| n == name)) {
        anyhow::bail!("the required lane `{name}` is not available: {missing}");
    }
    let descriptions = || opened.lanes.iter().map(|lane| lane.description());
    let promises: Vec<Promises> = descriptions().map(|description| profile.promises(description)).collect();
    let used = descriptions().zip(&promises).map(|(lane, promises)| LaneUsed::new(lane.clone(), promises));
    (summary.lanes, summary.unavailable) = (used.collect(), opened.missing);
    Ok((opened.lanes, promises))
}

/// What is to be run.
fn tasks(args: &CheckArgs, check: &Check<'_, Asked<'_>>) -> Vec<Task> {
    let mut tasks = Vec::new();
    for (suite, selected) in check.suites.selected.iter().enumerate() {
        let samples = args.samples.unwrap_or(selected.suite.samples / if args.quick { 8 } else { 1 }).max(1);
        for peer in &check.peers {
            let ways = check.ways(&selected.suite, peer.lane);
            tasks.extend(ways.into_iter().map(|(stage, _)| Task { suite, on: (peer.name(), stage), samples }));
        }
    }
    tasks
}

/// The suites that were asked for.
#[derive(Clone, Copy)]
struct Asked<'a> {
    args: &'a CheckArgs,
    selected: &'a [Selected],
}

impl Suites for Asked<'_> {
    type Error = anyhow::Error;

    fn count(&self) -> usize {
        self.selected.len()
    }

    fn prepare(&self, suite: usize) -> Result<Arc<Prepared>, RunError> {
        let one = &self.selected[suite];
        prepare(&one.suite, &one.shader).map(Arc::new)
    }

    fn request(&self, suite: usize, prepared: &Prepared, peer: Peer<'_>) -> anyhow::Result<Request> {
        request(self.args, &self.selected[suite], prepared, peer.promises.clone())
    }
}

fn request(args: &CheckArgs, selected: &Selected, prepared: &Prepared, promises: Promises) -> anyhow::Result<Request> {
    let (invocation, case) = (&prepared.compute.invocation, &prepared.compute.case);
    let mut arguments = shell_word(&selected.argument);
    if let Some(shader) = &args.shader {
        arguments = format!("{arguments} --shader {}", shell_word(&shader.display().to_string()));
    }
    if let Some(profile) = &args.profile {
        arguments = format!("{arguments} --profile {}", shell_word(profile));
    }
    if args.strict_literals {
        arguments.push_str(" --strict-literals");
    }
    let mut replay = Vec::new();
    match &args.case {
        Some(text) => {
            let line = format!("{} {text}", selected.suite.name);
            let file = base::text::SourceFile::new("--case", line);
            let sample = |r: &Regression| r.to_sample(invocation, case);
            let samples =
                regressions::parse(&file).and_then(|all| all.iter().map(sample).collect::<Result<Vec<_>, _>>());
            replay = samples.map_err(|error| match error.to_string().split_once(": ") {
                // The place is one in the line made above, which nobody has seen.
                Some((_, what)) => anyhow::anyhow!("--case: {what}"),
                None => error.into(),
            })?;
            anyhow::ensure!(!replay.is_empty(), "--case is empty; give inputs such as `t=3f000000`");
        }
        // A shader of the user's under this suite may have other inputs; the saved cases are not its.
        None if args.shader.is_none() => {
            for regression in selected.saved.iter().filter(|r| r.suite == selected.suite.name) {
                replay.push(
                    regression
                        .to_sample(invocation, case)
                        .context("a saved case does not fit the shader; delete its line if the shader has changed")?,
                );
            }
        }
        None => {}
    }
    Ok(Request {
        samples: args.samples,
        seed: args.seed,
        quick: args.quick,
        replay_only: args.case.is_some(),
        replay,
        promises,
        arguments,
    })
}

/// A word as a shell takes it.
pub(super) fn shell_word(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=+@%:,".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else if word.contains(char::is_control) {
        // A line break would begin a line of a report. Every shell has `printf`.
        let escaped = |c: char| match c {
            '%' => "%%".to_owned(),
            '\\' => r"\\".to_owned(),
            c if c.is_control() => c.to_string().bytes().map(|byte| format!("\\{byte:03o}")).collect(),
            c => c.to_string(),
        };
        format!("\"$(printf {})\"", shell_word(&word.chars().map(escaped).collect::<String>()))
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::shell_word;

    #[test]
    fn words_are_quoted_when_a_shell_would_split_them() {
        assert_eq!(shell_word("shaders/a.suite.toml"), "shaders/a.suite.toml");
        assert_eq!(shell_word("my shader.vert"), "'my shader.vert'");
        assert_eq!(shell_word("it's"), r"'it'\''s'");
        assert_eq!(shell_word("a\n%\\'b"), r#""$(printf 'a\012%%\\'\''b')""#);
    }
}
