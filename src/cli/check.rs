//! `shadercheck check`: suites on lanes.

mod bundle;
mod ledger;
mod page;
pub(super) mod profile;
mod progress;
mod screen;
pub(super) mod select;
mod shared;

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, ValueEnum};

use crate::cli::shard::ShardArgs;
use crate::cli::status::ExitStatus;
use base::text::{Shown, SourceFile};
use disk::fresh;
use engine::suite::run::{
    DEFAULT_SEED, Entry, LaneUsed, Outcome, Peer, Prepared, Report, Request, Status, Summary, bundles,
    check_translations, cross_check, max_samples, prepare, run as run_suite, run_from, stage_of,
};
use engine::suite::{self, save_regressions};
use judge::profile::Promises;
use judge::verdict::Literals;
use lanes::{Lane, LaneError, Stage, Wanted, interrupt};
use program::Source;
use property::Sample;
use property::regressions::{self, Regression};

use bundle::write_bundle;
use ledger::Ledgers;
use page::Pages;
use profile::Choice;
use progress::{Progress, Task};
use screen::Screen;
use select::Selected;
pub use shared::Found;

/// Arguments of `shadercheck check`.
#[derive(Args, Clone, Debug, Default)]
pub struct CheckArgs {
    /// Shipped suites by name, suite files (*.suite.toml), and folders that are searched for them;
    /// all shipped suites without one
    #[arg(value_name = "SUITE|PATH")]
    pub suites: Vec<String>,
    /// Run this shader instead of the suite's own; needs exactly one suite
    #[arg(long, value_name = "FILE")]
    pub shader: Option<PathBuf>,
    /// Only these lanes; exit status 2 when one of them is unavailable
    #[arg(long, value_name = "LANE", value_delimiter = ',')]
    pub lane: Vec<String>,
    /// Fail, with exit status 2, when one of these lanes is unavailable or judges no sample
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
    /// Samples of each suite on each lane; what the suite says without it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub samples: Option<u64>,
    /// Seed of the inputs: the same seed gives the same inputs everywhere
    #[arg(long, value_name = "S", default_value_t = DEFAULT_SEED)]
    pub seed: u64,
    /// An eighth of the samples
    #[arg(long, conflicts_with = "samples")]
    pub quick: bool,
    /// Judge literals such as 3.141593 for π as they are written, and not as the constant with a warning
    #[arg(long)]
    pub strict_literals: bool,
    /// Run only this case, as a report's `reproduce` line gives it; needs exactly one suite
    #[arg(long, value_name = "INPUTS")]
    pub case: Option<String>,
    /// Measured profile that lanes are compared with: a shipped one by name, a file that `calibrate`
    /// wrote, or `none`; the shipped one of each lane's device, if there is one, without it
    #[arg(long, value_name = "NAME|FILE")]
    pub profile: Option<String>,
    /// Failures that are expected: this file, or `none`; without it the `expectations.toml` beside each suite or
    /// above it, up to the root of the repository (not with --shader and --case)
    #[arg(long, value_name = "FILE|none")]
    pub expectations: Option<String>,
    /// Write the report here as a page (`index.html`) and in every format, and each failing case: the shader, what it was lowered to,
    /// SPIR-V, inputs and outputs as bits, the command that runs it again, a test for piglit's shader_runner, and an Amber script for
    /// functions and geometry stages
    #[arg(long, value_name = "DIR")]
    pub report_dir: Option<PathBuf>,
    /// Results of `shadercheck mutate --format json`, to be shown on the page
    #[arg(long, value_name = "FILE", requires = "report_dir")]
    pub mutations: Option<PathBuf>,
    /// Which part of the run
    #[command(flatten)]
    pub sharing: ShardArgs,
    /// On a terminal as well, a line for each suite and stage, without colours, table and progress
    #[arg(long)]
    pub plain: bool,
    /// How the result is printed
    #[arg(long, value_parser = formats(), default_value = TEXT)]
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
pub struct Sources(pub Vec<Source>);

/// Reads a list of sources.
fn sources(text: &str) -> Result<Sources, String> {
    let mut all = Vec::new();
    for name in text.split(',').map(str::trim) {
        let Some(source) = Source::ALL.into_iter().find(|s| s.name() == name) else {
            let names: Vec<&str> = Source::ALL.into_iter().map(Source::name).collect();
            return Err(format!(
                "there is no source `{name}`; sources are {}, and suites stand before `--sources`",
                names.join(", ")
            ));
        };
        if !all.contains(&source) {
            all.push(source);
        }
    }
    all.sort_by_key(|s| *s != Source::Storage);
    Ok(Sources(all))
}

impl StageArg {
    fn admits(self, stage: Stage) -> bool {
        match self {
            Self::Compute => stage == Stage::Compute,
            Self::Vertex => stage == Stage::Vertex,
            Self::Geometry => stage == Stage::Geometry,
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

fn formats() -> PossibleValuesParser {
    let others = report::check::FORMATS.iter().map(|f| PossibleValue::new(f.name).help(f.summary));
    PossibleValuesParser::new(std::iter::once(PossibleValue::new(TEXT).help("For people")).chain(others))
}

/// The format that is no report for programs.
const TEXT: &str = "text";

impl CheckArgs {
    fn is_text(&self) -> bool {
        report::check::by_name(&self.format).is_none()
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
    let mut selected = select::select(&args.suites)?;
    if args.strict_literals {
        selected.iter_mut().for_each(|one| one.suite.literals = Literals::Exact);
    }
    if selected.len() != 1 {
        for (given, option) in [(args.shader.is_some(), "--shader"), (args.case.is_some(), "--case")] {
            anyhow::ensure!(!given, "{option} needs exactly one suite, and {} are chosen", selected.len());
        }
    }
    let profile = Choice::new(args.profile.as_deref())?;
    let ledgers = Ledgers::new(args, &selected)?;
    let mut summary = Summary { seed: args.seed, ..Summary::default() };
    let (lanes, promises) = open_lanes(args, &profile, &mut summary)?;
    if lanes.is_empty() {
        for (name, missing) in &summary.unavailable {
            writeln!(err, "lane `{name}` cannot be had: {missing}")?;
        }
        if args.is_json() {
            out.write_all(report::check::json(&summary).as_bytes())?;
        }
        anyhow::bail!("no lane can run here, so nothing was checked");
    }
    if let Some(shard) = shard {
        return shared::run(args, shard, &selected, &ledgers, &lanes, &promises, summary, out, err);
    }
    let tasks = tasks(args, &selected, &lanes);
    let mut progress = Progress::new(args.is_text() && !args.plain, selected.len(), tasks);
    let mut pages = Pages::new(args.report_dir.as_deref(), args.mutations.as_deref())?;
    let mut screen = Screen::new(args, &selected, &lanes, color);
    let all = Peers { lanes: &lanes, promises: &promises, ledgers: &ledgers };
    let mut unfit: Vec<&str> = Vec::new();
    for (number, suite) in selected.iter().enumerate() {
        let before = summary.entries.len();
        one_suite(args, (number, suite), &all, &mut summary, (&mut progress, &mut pages), &screen, (out, err))?;
        progress.suspend(|| screen.suite(&suite.suite.name, &summary.entries[before..], out))?;
        pages.next(summary.entries.len());
        if interrupt::asked() {
            break;
        }
        if summary.entries.len() == before {
            unfit.push(suite.suite.name.as_str());
        }
    }
    progress.finish();
    without_stage(args.stage, &unfit, err)?;
    summary.interrupted = interrupt::signal();
    summary.stale = ledgers.stale();
    if let Some(folder) = &args.report_dir {
        pages.attempt(write_reports(folder, &summary));
        let written = pages.write(folder, &summary, &promises);
        pages.attempt(written);
        for note in &pages.notes {
            writeln!(err, "note: {note}")?;
        }
    }
    match report::check::by_name(&args.format) {
        None => screen.end(&summary, out)?,
        Some(format) => out.write_all((format.write)(&summary).map_err(anyhow::Error::msg)?.as_bytes())?,
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
fn print(summary: &Summary, json: bool, color: bool, out: &mut dyn Write) -> anyhow::Result<()> {
    if json {
        out.write_all(report::check::json(summary).as_bytes())?;
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
        anyhow::bail!("the required lane `{name}` cannot be had: {missing}");
    }
    let descriptions = || opened.lanes.iter().map(|lane| lane.description());
    let promises: Vec<Promises> = descriptions().map(|description| profile.promises(description)).collect();
    let used = descriptions().zip(&promises).map(|(lane, promises)| LaneUsed::new(lane.clone(), promises));
    (summary.lanes, summary.unavailable) = (used.collect(), opened.missing);
    Ok((opened.lanes, promises))
}

/// What is to be run, as far as it is known before shaders are read.
fn tasks(args: &CheckArgs, selected: &[Selected], lanes: &[Box<dyn Lane>]) -> Vec<Task> {
    let mut tasks = Vec::new();
    for (suite, selected) in selected.iter().enumerate() {
        let samples = args.samples.unwrap_or(selected.suite.samples / if args.quick { 8 } else { 1 }).max(1);
        for lane in lanes {
            let lane = lane.description();
            let applies = |stage: Stage| match stage {
                Stage::Compute => true,
                Stage::Vertex => selected.suite.stage == suite::Stage::Vertex,
                Stage::Geometry => selected.suite.stage == suite::Stage::Geometry,
            };
            for &stage in lane.stages.iter().filter(|&&stage| applies(stage)) {
                if args.stage.is_none_or(|asked| asked.admits(stage)) {
                    tasks.push(Task { suite, on: (lane.name, stage), samples });
                }
            }
        }
    }
    tasks
}

/// The lanes of a run, what each is held against, and what is expected to fail.
struct Peers<'a> {
    lanes: &'a [Box<dyn Lane>],
    promises: &'a [Promises],
    ledgers: &'a Ledgers,
}

fn one_suite(
    args: &CheckArgs,
    (number, selected): (usize, &Selected),
    Peers { lanes, promises, ledgers }: &Peers<'_>,
    summary: &mut Summary,
    (progress, pages): (&mut Progress, &mut Pages),
    screen: &Screen,
    (out, err): (&mut dyn Write, &mut dyn Write),
) -> anyhow::Result<()> {
    let shader = shader_of(args, selected)?;
    let suite = &selected.suite;
    let before = summary.entries.len();
    let mut add = |mut entry: Entry, progress: &Progress| -> anyhow::Result<()> {
        ledgers.apply(number, &mut entry, &summary.lanes);
        progress.suspend(|| screen.entry(&entry, out))?;
        summary.entries.push(entry);
        Ok(())
    };
    let entry = |on, outcome| Entry { suite: suite.name.clone(), shader: shader.name().to_owned(), on, outcome };
    let prepared = prepare(suite, &shader);
    pages.suite(&suite.name, &suite.title, &shader, prepared.as_ref().ok());
    let prepared = match prepared {
        Ok(prepared) => prepared,
        Err(error) => return add(entry(None, Outcome::Refused(error)), progress),
    };
    let mut failing: Vec<Sample> = Vec::new();
    // Translations have no lane: the first that gives a report bears what is found out about them.
    let mut untold = true;
    let mut entries = before;
    for (lane, promises) in lanes.iter().zip(*promises) {
        let request = request(args, selected, &prepared, promises.clone())?;
        let name = lane.description().name;
        for (stage, source) in ways(args, lane.as_ref(), &prepared) {
            if interrupt::asked() {
                break;
            }
            let most = source.map_or(u64::MAX, |source| max_samples(&prepared, source));
            progress.start((number, &suite.name), name, stage, request.samples_of(suite).min(most));
            let mut at = |done| progress.at(done);
            let result = match source {
                None => run_suite(&prepared, lane.as_ref(), stage, &request, &mut at),
                Some(source) => run_from(&prepared, lane.as_ref(), source, &request, &mut at),
            };
            let outcome = match result {
                // A device that is given up because the run ends has not failed.
                Err(_) if interrupt::asked() => break,
                Ok(report) if interrupt::asked() => Outcome::Ran(Box::new(report)),
                Ok(mut report) => {
                    if std::mem::take(&mut untold) {
                        check_translations(&prepared, &request, &mut report);
                    }
                    if let Some(folder) = &args.report_dir {
                        for bundle in bundles(&prepared, lane.as_ref(), stage, &request.promises, &report)? {
                            pages.attempt(write_bundle(folder, &bundle));
                        }
                    }
                    pages.look(&prepared, lane.as_ref(), stage, &request, &report);
                    failing.extend(report.failing.iter().cloned());
                    Outcome::Ran(Box::new(report))
                }
                Err(error) => {
                    let way = source.map_or_else(String::new, |source| format!("{}: ", source.phrase()));
                    let again = match &error {
                        LaneError::Lost { inputs, .. } if !inputs.is_empty() => format!(
                            "\n  reproduce  shadercheck check {} --lane {name} --stage {stage} --case '{inputs}'",
                            request.arguments
                        ),
                        _ => String::new(),
                    };
                    Outcome::LaneFailed(format!("{way}{error}{again}"))
                }
            };
            add(entry(Some((name, stage)), outcome), progress)?;
            entries += 1;
            pages.next(entries);
        }
    }
    let peers: Vec<Peer<'_>> =
        lanes.iter().zip(*promises).map(|(lane, promises)| Peer { lane: lane.as_ref(), promises }).collect();
    let ran = summary.entries[before..].iter_mut().filter_map(|entry| match &mut entry.outcome {
        Outcome::Ran(report) => Some(&mut **report),
        Outcome::Refused(_) | Outcome::LaneFailed(_) | Outcome::KnownFailure { .. } => None,
    });
    if !interrupt::asked() {
        cross_check(&prepared, &peers, &mut ran.collect::<Vec<&mut Report>>());
    }
    // Another shader's failures are no regressions of the suite's own.
    if let (Some(path), None, false) = (&selected.regressions, &args.shader, failing.is_empty() || args.case.is_some())
    {
        // What was found is told in any case: a folder that takes no file is no reason to lose it.
        if let Err(error) = save_regressions(path, &suite.name, &failing) {
            progress.suspend(|| writeln!(err, "warning: failing cases are not saved: {error}"))?;
        }
    }
    Ok(())
}

/// The shader that is run under a suite.
fn shader_of(args: &CheckArgs, selected: &Selected) -> anyhow::Result<SourceFile> {
    match &args.shader {
        Some(path) => super::translate::read(path),
        None => Ok(selected.shader.clone()),
    }
}

/// The stages of a lane on which a suite runs.
fn stages(args: &CheckArgs, lane: &dyn Lane, prepared: &Prepared) -> Vec<Stage> {
    let asked = |stage: &Stage| args.stage.is_none_or(|s| s.admits(*stage));
    prepared.stages(lane).into_iter().filter(asked).collect()
}

/// Writes the run in every format for programs, each file in one step.
fn write_reports(folder: &Path, summary: &Summary) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder `{}`", folder.shown()))?;
    for format in report::check::FORMATS {
        let path = folder.join(format.file);
        let context = || format!("cannot write `{}`", path.shown());
        let text = (format.write)(summary).map_err(anyhow::Error::msg).with_context(context)?;
        fresh::write(&path, text.as_bytes()).with_context(context)?;
    }
    Ok(())
}

/// The ways in which a suite runs on a lane: stages, or sources of inputs where these are asked for.
fn ways(args: &CheckArgs, lane: &dyn Lane, prepared: &Prepared) -> Vec<(Stage, Option<Source>)> {
    let admitted = |stage: Stage| args.stage.is_none_or(|s| s.admits(stage));
    match &args.sources {
        // Sources are ways into a compute stage; a lane without one takes its inputs in one way.
        Some(_) if !lane.description().stages.contains(&Stage::Compute) => Vec::new(),
        Some(Sources(sources)) => {
            sources.iter().map(|&s| (stage_of(s), Some(s))).filter(|(stage, _)| admitted(*stage)).collect()
        }
        None => stages(args, lane, prepared).into_iter().map(|stage| (stage, None)).collect(),
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
