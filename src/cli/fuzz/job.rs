//! The functions of a run of `fuzz`, one after the other, and what came of them.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::PathBuf;
use std::vec;

use serde::{Deserialize, Serialize};

use super::known::{self, Known};
use super::{FuzzArgs, IncludedText, Inputs, all_known, command, stub, subjects};
use crate::cli::improve;
use crate::cli::reported;
use crate::cli::shard::{Absent, Printed, Printing, Terminal, Watch};
use crate::cli::status::ExitStatus;
use base::diagnostic::{Diagnostic, Lang};
use base::text::{Shown as _, counted};
use engine::fuzz::{self, Domain, Finding, FunctionReport, FuzzFindingKind, Request, Subject};
use engine::session::{At, Job, Join, Observer, Unlike};
use engine::shard::Identity;
use judge::profile::Promises;
use lanes::{Description, Lane, Unavailable, interrupt};
use report::fuzz::{FileReport, Summary, ci, findings, json, line, totals};

/// The name of the parameter that says whether notes are shown.
const NOTES: &str = "--notes";

/// Everything that the result of a run depends on.
pub fn identity(args: &FuzzArgs, shards: u64, sources: &[IncludedText], lanes: &[Description]) -> Identity {
    let identity = Identity::new("fuzz", args.input.seed, shards)
        .with("--samples", args.samples)
        .with(NOTES, args.notes)
        .with("--arbitrary", args.arbitrary)
        .with("--strict-integers", args.strict_integers)
        .with("--function", args.function.join(","))
        .with("--domain", args.input.domain.join("; "))
        .on(lanes);
    sources.iter().fold(identity, |all, source| all.of(&format!("file `{}`", source.name), source.file.text()))
}

/// The functions of all files, read file by file.
pub struct Functions<'a> {
    args: &'a FuzzArgs,
    sources: &'a [IncludedText],
    lanes: Vec<(&'a dyn Lane, Promises)>,
    inputs: Inputs<'a>,
    /// What a file that does not compile is: a finding of a whole run, and the end of a shard.
    whole: bool,
    known: Vec<String>,
    /// Files that were read, and what is left of the last one.
    read: usize,
    left: vec::IntoIter<Subject>,
    /// Findings that are left out.
    baseline: Option<Known>,
}

/// What is seen of a run.
pub enum Event<'e> {
    /// A file was read; it is wrong in these ways.
    File(&'e IncludedText, &'e [Diagnostic]),
    /// A function begins.
    Function { what: &'e str, on: &'e str, steps: u64 },
}

impl<'a> Functions<'a> {
    /// All functions of the texts, on lanes.
    pub fn new(
        args: &'a FuzzArgs,
        sources: &'a [IncludedText],
        lanes: Vec<(&'a dyn Lane, Promises)>,
        inputs: Inputs<'a>,
        whole: bool,
    ) -> Self {
        let (known, left) = (Vec::new(), Vec::new().into_iter());
        Self { args, sources, lanes, inputs, whole, known, read: 0, left, baseline: None }
    }

    /// The same without findings that a file knows.
    #[must_use]
    pub fn knowing(self, baseline: Option<Known>) -> Self {
        Self { baseline, ..self }
    }
}

/// Lines of a function for which better formulas are looked for, which takes about a second each.
const IMPROVED: usize = 3;

impl Functions<'_> {
    /// Gives what loses digits the formula that loses fewer, where there is one.
    fn improved(&self, (file, subject, domain): (usize, &Subject, &Domain), function: &mut FunctionReport) {
        let source = &self.sources[file];
        let mut known: BTreeMap<usize, Option<String>> = BTreeMap::new();
        let loses = |finding: &&mut Finding| {
            finding.kind == FuzzFindingKind::IllConditioned && finding.part == fuzz::Part::Realistic
        };
        for finding in function.findings.iter_mut().filter(loses) {
            let Some(at) = finding.place.as_ref().map(|place| &place.at) else { continue };
            let own = source.author().is_ok_and(|own| own.name() == at.file);
            let Some(line) = at.position.filter(|_| own).map(|position| position.line) else { continue };
            if finding.severity == fuzz::Severity::Note || (known.len() == IMPROVED && !known.contains_key(&line)) {
                continue;
            }
            let formula = known
                .entry(line)
                .or_insert_with(|| improve::better((source, &self.args.input), (subject, domain), line));
            finding.better.clone_from(formula);
        }
    }
}

impl Job for Functions<'_> {
    type Unit = (usize, Subject, Domain);
    type Part = ShardResult;
    type Error = anyhow::Error;
    type Event<'e> = Event<'e>;

    fn unit(&mut self, _: u64, at: &mut At<'_, Self>) -> anyhow::Result<Option<Self::Unit>> {
        loop {
            if let Some(subject) = self.left.next() {
                let domain = self.inputs.domain(&subject)?;
                return Ok(Some((self.read - 1, subject, domain)));
            }
            let files = &mut at.part.files;
            let Some(source) = self.sources.get(self.read) else {
                if files.iter().all(|file| file.errors.is_empty()) {
                    all_known(&self.args.function, &self.known)?;
                }
                self.inputs.all_used()?;
                return Ok(None);
            };
            let asked = (&self.args.function[..], &self.args.input.define[..]);
            let (errors, subjects) = subjects(asked, source, &mut self.known)?;
            at.observer.event(Event::File(source, &errors))?;
            anyhow::ensure!(
                self.whole || errors.is_empty(),
                "`{}` does not compile, so that no part of the run can be done",
                source.name
            );
            if files.len() == self.read {
                files.push(File { file: source.name.clone(), notes: source.notes(), errors });
            }
            self.read += 1;
            self.left = subjects.into_iter();
        }
    }

    fn run(
        &mut self,
        (number, (file, subject, domain)): (u64, Self::Unit),
        at: &mut At<'_, Self>,
    ) -> anyhow::Result<()> {
        let args = self.args;
        let on = if args.all_lanes { "all lanes" } else { "lanes" };
        at.observer.event(Event::Function { what: &subject.label, on, steps: args.samples })?;
        let request = Request {
            samples: args.samples,
            seed: args.input.seed,
            case: args.case.clone(),
            notes: args.notes,
            arbitrary: args.arbitrary,
            strict_integers: args.strict_integers,
            first_lane: args.lane.is_empty() && !args.all_lanes,
            command: command(args, &self.sources[file]),
        };
        let function = fuzz::run(&subject, &domain, &self.lanes, &request);
        let mut function = function.map_err(|why| anyhow::anyhow!("--case: {why}"))?;
        if subject.made_up {
            function.as_warnings();
        }
        if args.case.is_none() && !interrupt::asked() {
            self.improved((file, &subject, &domain), &mut function);
        }
        let mut function = self.sources[file].softened(function);
        if let Some(baseline) = &mut self.baseline {
            baseline.cover(&mut function);
            at.part.note = baseline.note();
        }
        at.part.functions.push((number, file, function));
        Ok(())
    }
}

/// A run as it goes: a line for each function of a whole run, at once, so that what is known stays known where a limit of
/// time ends the run.
pub struct Lines<'a> {
    pub terminal: Terminal<'a>,
    pub args: &'a FuzzArgs,
    pub sources: &'a [IncludedText],
    pub many: bool,
    pub whole: bool,
    /// Functions that were told.
    pub told: usize,
}

impl<'a> Watch<'a> for Lines<'a> {
    fn terminal(&mut self) -> &mut Terminal<'a> {
        &mut self.terminal
    }
}

impl Observer<Functions<'_>> for Lines<'_> {
    fn event(&mut self, event: Event<'_>) -> anyhow::Result<()> {
        let Terminal { bar, format, out, err, .. } = &mut self.terminal;
        let people = format.is_text();
        match event {
            Event::Function { what, on, steps } => bar.start(what, on, steps),
            Event::File(source, errors) => bar.suspend(|| {
                if people || !self.whole {
                    source.notes().iter().try_for_each(|note| writeln!(err, "note: {note}"))?;
                }
                if !self.whole {
                    let shown = |error| report::diagnostics::text(error, Lang::En, false);
                    errors.iter().try_for_each(|error| err.write_all(shown(error).as_bytes()))?;
                }
                if people && self.whole && self.many { writeln!(out, "{}", source.heading()) } else { Ok(()) }
            })?,
        }
        Ok(())
    }

    fn end(&mut self, part: &ShardResult) -> anyhow::Result<()> {
        if !self.whole {
            return Ok(());
        }
        let Terminal { bar, format, color, out, err } = &mut self.terminal;
        for (_, file, function) in part.functions.iter().skip(self.told) {
            if format.is_text() {
                bar.suspend(|| {
                    out.write_all(line(function, *color).as_bytes())?;
                    out.flush()
                })?;
            }
            if self.args.write_suite {
                stub::write(&self.sources[*file], function, *err)?;
            }
        }
        self.told = part.functions.len();
        Ok(())
    }
}

/// What came of some functions.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct ShardResult {
    lanes: Vec<Description>,
    unavailable: Absent,
    #[serde(default)]
    asked: BTreeSet<String>,
    files: Vec<File>,
    /// Each with its number in the run and its file.
    functions: Vec<(u64, usize, FunctionReport)>,
    /// Where the reports of a whole run go.
    #[serde(skip)]
    reports: Option<PathBuf>,
    /// The file in which all findings of a whole run are recorded.
    #[serde(skip)]
    record: Option<PathBuf>,
    /// What is left out of a whole run.
    #[serde(skip)]
    note: Option<String>,
}

/// A file of the run.
#[derive(Debug, Default, Serialize, Deserialize)]
struct File {
    file: String,
    notes: Vec<String>,
    /// Why it does not compile, in a whole run.
    #[serde(skip)]
    errors: Vec<Diagnostic>,
}

impl ShardResult {
    /// Nothing yet, of lanes that were asked for and those that there are.
    pub fn nothing(asked: &[String], lanes: &[Box<dyn Lane>], missing: Vec<(&'static str, Unavailable)>) -> Self {
        let lanes = lanes.iter().map(|lane| lane.description().clone()).collect();
        let asked = asked.iter().cloned().collect();
        Self { lanes, unavailable: Absent::new(missing), asked, ..Self::default() }
    }

    /// The same, with a folder for the reports, and a file for all that is found.
    #[must_use]
    pub fn with_files(self, reports: Option<PathBuf>, record: Option<PathBuf>) -> Self {
        Self { reports, record, ..self }
    }

    /// The lanes that run.
    pub fn lanes(&self) -> &[Description] {
        &self.lanes
    }
}

impl Join for ShardResult {
    fn join(&mut self, other: Self) -> Result<(), Unlike> {
        Unlike::unless(self.lanes == other.lanes, "ran on different lanes")?;
        let names = |found: &Self| found.files.iter().map(|file| file.file.clone()).collect::<Vec<_>>();
        Unlike::unless(names(self) == names(&other), "ran different files")?;
        self.unavailable.join(other.unavailable);
        self.asked.extend(other.asked);
        self.functions.extend(other.functions);
        self.functions.sort_by_key(|(number, ..)| *number);
        Ok(())
    }
}

impl Printed for ShardResult {
    fn print(self, to: Printing<'_>) -> anyhow::Result<ExitStatus> {
        let (color, notes) = (to.color, to.identity.parameters.get(NOTES).is_some_and(|notes| notes == "true"));
        let mut summary = Summary { seed: to.identity.seed, lanes: self.lanes, ..Summary::default() };
        (summary.unavailable, summary.interrupted) = (self.unavailable.known(), to.interrupted);
        summary.asked = self.asked.into_iter().collect();
        let file = |File { file, notes, errors }| FileReport { file, notes, errors, ..FileReport::default() };
        summary.files = self.files.into_iter().map(file).collect();
        for (_, file, function) in self.functions {
            summary.files[file].functions.push(function);
        }
        if let Some(note) = &self.note {
            writeln!(to.err, "note: {note}")?;
        }
        if let Some(path) = &self.record {
            let count = known::record(path, summary.files.iter().flat_map(|file| &file.functions))?;
            writeln!(to.err, "{} recorded in {}", counted(count as u64, "finding"), path.shown())?;
            // A file that does not compile, and what did not run, cannot be put off.
            for error in summary.files.iter().flat_map(|file| &file.errors) {
                to.err.write_all(report::diagnostics::text(error, Lang::En, color).as_bytes())?;
            }
            return Ok(match status_of(&summary, to.err)? {
                ExitStatus::Findings if summary.totals().broken == 0 => ExitStatus::Clean,
                status => status,
            });
        }
        if let Some(folder) = &self.reports {
            reported::write_all(folder, &ci(&summary), &json(&summary))?;
        }
        if let Some(text) = to.format.of(|| ci(&summary), || json(&summary))? {
            to.out.write_all(text.as_bytes())?;
            return status_of(&summary, to.err);
        }
        for file in summary.files.iter().filter(|_| !to.live) {
            if summary.files.len() > 1 {
                writeln!(to.out, "{}", file.file)?;
            }
            file.functions.iter().try_for_each(|function| to.out.write_all(line(function, color).as_bytes()))?;
        }
        summary.files.iter().try_for_each(|file| to.out.write_all(findings(file, notes, color).as_bytes()))?;
        writeln!(to.out)?;
        to.out.write_all(totals(&summary, notes, color).as_bytes())?;
        status_of(&summary, to.err)
    }
}

fn status_of(summary: &Summary, err: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let totals = summary.totals();
    let shortcomings = summary.shortcomings();
    for shortcoming in &shortcomings {
        writeln!(err, "error: {shortcoming}")?;
    }
    Ok(if let Some(signal) = summary.interrupted {
        ExitStatus::Interrupted(signal)
    } else if !shortcomings.is_empty() {
        ExitStatus::Error
    } else if totals.findings + totals.broken > 0 {
        ExitStatus::Findings
    } else if totals.run == 0 {
        writeln!(err, "error: nothing could be run")?;
        ExitStatus::Error
    } else {
        ExitStatus::Clean
    })
}
