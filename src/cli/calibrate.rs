//! `shadercheck calibrate`: measures the operations of a device.

mod against;
mod contribute;
mod shared;
mod table;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use anyhow::Context;
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::cli::check::Format;
use crate::cli::shard::ShardArgs;
use crate::cli::status::ExitStatus;
use base::did_you_mean;
use base::text::{Shown, SourceFile};
use disk::fresh;
use engine::calibrate::{self, Document, Request, Standing, State, confirmed, measurable, probe};
use engine::shard::Shard;
use judge::profile::{self, Op, Profile};
use lanes::{Lane, Stage, open_first};

use against::{Comparison, Reference};
use contribute::Contribution;

pub use shared::ShardResult;

/// Results that a search computes for each sample, without --search. On two cores and llvmpipe, the search of a function
/// takes about two seconds then.
const SEARCHED: u64 = 64;

/// Arguments of `shadercheck calibrate`.
#[derive(Args, Clone, Debug)]
pub struct CalibrateArgs {
    /// Lane to measure [default: the first available]
    #[arg(long, value_name = "LANE")]
    pub lane: Option<String>,
    /// Run functions of one argument on all 2^32 arguments instead of samples
    #[arg(long)]
    pub exhaustive: bool,
    /// Only these operations, named as in the table
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub builtin: Vec<String>,
    /// Samples per operation, spread over all binades
    #[arg(long, value_name = "N", default_value_t = 1 << 22, value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    pub samples: u64,
    /// Results to compute in search of the worst arguments of each function of one argument, beside the samples; 0 for
    /// none [default: 64 for each sample]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..=1 << 40))]
    pub search: Option<u64>,
    /// File for the measured profile [default: LANE.profile.toml in this folder]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Compare with a profile, a file or a shipped one by name, instead of with what is promised: the status is 1 when the
    /// device is worse than it says; a profile is written only with -o
    #[arg(long, value_name = "FILE", conflicts_with = "shard")]
    pub against: Option<String>,
    /// Write the profile to send it to the project, and say how [default: the device and its version, in this folder]
    #[arg(long, value_name = "FILE", num_args = 0..=1, conflicts_with_all = ["output", "builtin", "shard", "against"])]
    pub contribute: Option<Option<PathBuf>>,
    /// Resume a run that was stopped, from the state beside the output
    #[arg(long)]
    pub resume: bool,
    /// Which part of the samples, or of the sweep
    #[command(flatten)]
    pub sharing: ShardArgs,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

impl CalibrateArgs {
    /// Results that the search of a function may compute.
    fn searched(&self) -> u64 {
        self.search.unwrap_or_else(|| self.samples.saturating_mul(SEARCHED))
    }
}

/// Runs the command: the table goes to `out`, the profile to its file, progress to `err`.
///
/// The status is [`ExitStatus::Findings`] when the device breaks a promise in a way that the
/// conformance suite would not accept either; with `--against`, when it is worse than that profile says.
///
/// # Errors
/// When there is no such lane or operation, the device fails, or a file cannot be read or written.
pub fn run(args: &CalibrateArgs, out: &mut dyn Write, err: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let shard = args.sharing.shard()?;
    let mut ops = operations(&args.builtin)?;
    let lane = open(args.lane.as_ref(), err)?;
    if args.builtin.is_empty() {
        let mut left_out = Vec::new();
        for op in std::mem::take(&mut ops) {
            if calibrate::runs(lane.as_ref(), op)? { &mut ops } else { &mut left_out }.push(op);
        }
        if !left_out.is_empty() {
            let names: Vec<&str> = left_out.iter().map(|op| op.name()).collect();
            writeln!(err, "note: not measured, because this driver does not run them alone: {}", names.join(", "))?;
        }
    }
    if let Some(shard) = shard {
        anyhow::ensure!(!args.resume, "--shard goes on by itself from its checkpoint; leave out --resume");
        return shared::run(args, shard, &ops, lane.as_ref(), out, err);
    }
    run_on(args, &ops, lane.as_ref(), out)
}

/// Runs the command on an open lane.
///
/// # Errors
/// When the device fails, or a file cannot be read or written.
pub fn run_on(args: &CalibrateArgs, ops: &[Op], lane: &dyn Lane, out: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let description = lane.description();
    let output = match (&args.contribute, &args.output) {
        (Some(file), _) => file.clone().unwrap_or_else(|| contribute::default_file(&description.driver)),
        (None, Some(file)) => file.clone(),
        (None, None) => PathBuf::from(format!("{}.profile.toml", description.name)),
    };
    let against = args.against.as_ref().map(|argument| Reference::new(argument, args.output.as_deref())).transpose()?;
    let saved = beside(&output);
    let request = request(args, ops, lane, Shard::WHOLE);
    let mut state = State::new(request.clone());
    let streamed = fresh::is_stream(&output);
    anyhow::ensure!(
        !(args.resume && streamed),
        "--resume goes on from the state beside the output, and `{}` is no regular file; name a file with -o",
        output.shown()
    );
    if args.resume && saved.exists() {
        state = read_state(&saved)?.resume(&request)?;
    }
    let bar = bar(args.format == Format::Text, request.total());
    bar.set_position(state.done());
    calibrate::run(lane, &mut state, &mut |state, op| {
        bar.set_message(op.name());
        bar.set_position(state.done());
        if streamed {
            return Ok(());
        }
        let text = serde_json::to_vec(state).map_err(std::io::Error::other)?;
        fresh::write(&saved, &text)
    })?;
    bar.finish_and_clear();
    let ending = Ending {
        output: (against.is_none() || args.output.is_some()).then_some(&output),
        against: against.as_ref(),
        contributed: args.contribute.is_some(),
        json: args.format == Format::Json,
    };
    let status = conclude(&state, lane, &ending, out)?;
    if !streamed && saved.exists() {
        fs::remove_file(&saved).with_context(|| format!("cannot remove `{}`", saved.shown()))?;
    }
    Ok(status)
}

fn request(args: &CalibrateArgs, ops: &[Op], lane: &dyn Lane, shard: Shard) -> Request {
    Request {
        ops: ops.iter().map(|op| op.name().to_owned()).collect(),
        samples: args.samples,
        exhaustive: args.exhaustive,
        search: args.searched(),
        driver: lane.description().driver.clone(),
        part: (shard.index(), shard.count()),
    }
}

/// What is done with a measurement.
#[derive(Default)]
struct Ending<'a> {
    /// Where the profile goes; nowhere without.
    output: Option<&'a PathBuf>,
    /// The profile that the device is compared with.
    against: Option<&'a Reference>,
    /// The profile is for everybody.
    contributed: bool,
    json: bool,
}

/// Writes the profile of a device that was measured, and prints the table.
fn conclude(state: &State, lane: &dyn Lane, ending: &Ending<'_>, out: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let description = lane.description();
    let compute = probe(lane, Stage::Compute)?;
    let vertex = description.stages.contains(&Stage::Vertex).then(|| probe(lane, Stage::Vertex)).transpose()?;
    let date = day_of(SystemTime::now());
    let vertex = vertex.as_ref();
    let document = Document { lane: description, state, compute: &compute, vertex, definitions: &[], date: &date };
    let bounds = read_back(&document.text())?;
    let definitions = confirmed(lane, &bounds)?;
    let text = Document { definitions: &definitions, ..document }.text();
    let profile = read_back(&text)?;
    if let Some(output) = ending.output {
        fresh::write(output, text.as_bytes()).with_context(|| format!("cannot write `{}`", output.shown()))?;
    }
    let comparison = ending.against.map(|then| then.compared(state, &profile));
    let written = ending.output.filter(|_| ending.contributed);
    let contribution = written.map(|file| Contribution { file, driver: &description.driver });
    let report = table::Report { lane: description, state, compute: &compute, vertex };
    if ending.json {
        let mut json = report.json();
        json["profile"] = ending.output.map(|output| output.shown().to_string()).into();
        json["against"] = comparison.as_ref().map(Comparison::json).into();
        json["contribution"] = contribution.as_ref().map(Contribution::json).into();
        writeln!(out, "{json:#}")?;
    } else {
        out.write_all(report.text().as_bytes())?;
        if let Some(output) = ending.output {
            writeln!(out, "\nThe measured profile is in {0}; use it with `check --profile {0}`.", output.shown())?;
        }
        for text in [comparison.as_ref().map(Comparison::text), contribution.as_ref().map(Contribution::text)] {
            text.map_or(Ok(()), |text| write!(out, "\n{text}"))?;
        }
    }
    let outside = || state.measurements().into_iter().any(|(op, tally)| Standing::of(op, tally) == Standing::Outside);
    let worse = comparison.map_or_else(outside, |comparison| !comparison.is_clean());
    Ok(if worse { ExitStatus::Findings } else { ExitStatus::Clean })
}

/// The profile that the text of one is.
fn read_back(text: &str) -> anyhow::Result<Profile> {
    let base = |name: &str| profile::by_name(name).cloned();
    profile::parse(&SourceFile::new("measurement", text), &base)
        .context("what was measured cannot be read back, which is a defect of this program")
}

/// The operations of these names; all that can be measured without any.
fn operations(names: &[String]) -> anyhow::Result<Vec<Op>> {
    let all: Vec<Op> = measurable().collect();
    let mut ops: Vec<Op> = Vec::new();
    for name in names {
        let Some(op) = all.iter().copied().find(|op| op.name() == name) else {
            let known = || all.iter().map(|op| op.name());
            let hint = did_you_mean(name, known(), "operations are");
            anyhow::bail!("there is no operation `{name}` to measure; {hint}");
        };
        if !ops.contains(&op) {
            ops.push(op);
        }
    }
    Ok(if names.is_empty() { all } else { ops })
}

/// Opens the lane of this name, or the first that is available.
fn open(name: Option<&String>, err: &mut dyn Write) -> anyhow::Result<Box<dyn Lane>> {
    let opened = open_first(name)?;
    for (name, missing) in &opened.missing {
        writeln!(err, "lane `{name}` is not available: {missing}")?;
    }
    opened.only().map_err(|_| anyhow::anyhow!("no lane can run here, so nothing was measured"))
}

/// The file with the state of an unfinished run.
fn beside(output: &Path) -> PathBuf {
    let mut name = output.as_os_str().to_owned();
    name.push(".state");
    PathBuf::from(name)
}

fn read_state(path: &Path) -> anyhow::Result<State> {
    let text = fs::read(path).with_context(|| format!("cannot read `{}`", path.shown()))?;
    serde_json::from_slice(&text)
        .with_context(|| format!("`{}` is no state of a calibration; remove it or leave out --resume", path.shown()))
}

/// The day of a moment in universal time, such as `2026-01-31`.
fn day_of(time: SystemTime) -> String {
    let seconds = time.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let mut days = seconds / 86_400;
    let mut year = 1970;
    let is_leap = |year: u64| year.is_multiple_of(4) && !year.is_multiple_of(100) || year.is_multiple_of(400);
    let length = |year| if is_leap(year) { 366 } else { 365 };
    while days >= length(year) {
        days -= length(year);
        year += 1;
    }
    let february = if is_leap(year) { 29 } else { 28 };
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    format!("{year}-{month:02}-{:02}", days + 1)
}

/// A bar on standard error; hidden when it is no terminal, or not wanted.
fn bar(wanted: bool, total: u64) -> ProgressBar {
    let target = if wanted { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(total), target);
    if let Ok(style) = ProgressStyle::with_template("{msg:12} [{bar:30}] {human_pos}/{human_len} {per_sec} {eta} left")
    {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_operation_is_refused_with_a_suggestion() {
        let error = operations(&["sine".to_owned()]).unwrap_err().to_string();
        assert_eq!(error, "there is no operation `sine` to measure; did you mean `sin`?");
        assert_eq!(operations(&["exp2".to_owned(), "exp2".to_owned()]).unwrap(), [Op::Exp2]);
        assert!(operations(&[]).unwrap().len() > 30);
    }

    #[test]
    fn days_are_those_of_the_calendar() {
        let day = |seconds| day_of(SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(seconds));
        assert_eq!((day(0), day(86_399), day(86_400)), ("1970-01-01".into(), "1970-01-01".into(), "1970-01-02".into()));
        assert_eq!((day(951_782_400), day(951_868_800)), ("2000-02-29".into(), "2000-03-01".into()));
        assert_eq!((day(1_798_675_200), day(1_798_761_600)), ("2026-12-31".into(), "2027-01-01".into()));
    }

    #[test]
    fn a_damaged_state_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.toml.state");
        fs::write(&path, "{").unwrap();
        let error = read_state(&path).unwrap_err().to_string();
        assert!(error.contains("p.toml.state` is no state of a calibration"), "{error}");
    }
}
