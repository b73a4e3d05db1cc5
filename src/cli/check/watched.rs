//! A whole run as it goes: each result is printed, and goes to the summary and the page.

use std::io::Write;

use super::bundle::write_bundle;
use super::expectations::RunExpectations;
use super::page::Pages;
use super::progress::Progress;
use super::screen::Screen;
use super::select::Selected;
use super::{CheckArgs, request, shader_of};
use engine::session::{Earlier, Job, Observer};
use engine::suite::run::{Entry, Outcome, Part, Peer, Prepared, Report, Request, Summary, bundles, prepare, settle};
use engine::suite::save_regressions;
use lanes::{LaneError, interrupt};
use property::Sample;

/// A run of `check` that people watch.
pub struct Watched<'a> {
    pub args: &'a CheckArgs,
    pub selected: &'a [Selected],
    pub expectations: &'a RunExpectations,
    pub summary: Summary,
    pub progress: Progress,
    pub pages: Pages,
    pub screen: Screen,
    /// Entries of the suites before the one that runs.
    pub entries: usize,
    /// Suites that no lane had a stage for.
    pub unfit: Vec<&'a str>,
    /// Failing samples of the suite that runs.
    pub failing: Vec<Sample>,
    pub out: &'a mut dyn Write,
    pub err: &'a mut dyn Write,
}

impl Watched<'_> {
    /// Adds a result, and prints it.
    fn add(&mut self, suite: usize, mut entry: Entry) -> anyhow::Result<()> {
        self.expectations.apply(suite, &mut entry, &self.summary.lanes);
        self.progress.suspend(|| self.screen.entry(&entry, self.out))?;
        self.summary.entries.push(entry);
        self.pages.next(self.summary.entries.len());
        Ok(())
    }

    /// All results of a suite are there.
    fn ended(&mut self, suite: usize) -> anyhow::Result<()> {
        let (name, entries) = (&self.selected[suite].suite.name, &self.summary.entries[self.entries..]);
        if entries.is_empty() && !interrupt::asked() {
            self.unfit.push(name);
        }
        self.progress.suspend(|| self.screen.suite(name, entries, self.out))?;
        self.entries = self.summary.entries.len();
        Ok(())
    }

    /// The files and pictures of a result.
    fn shown(&mut self, job: &Job<'_>, report: &Report) -> anyhow::Result<()> {
        let (lane, stage) = (job.peer.lane, job.way.0);
        if let Some(folder) = &self.args.report_dir {
            for bundle in bundles(job.prepared, lane, stage, &job.request.promises, report)? {
                self.pages.attempt(write_bundle(folder, &bundle));
            }
        }
        self.pages.look(job.prepared, lane, stage, job.request, report);
        Ok(())
    }
}

impl Observer for Watched<'_> {
    type Error = anyhow::Error;

    fn prepare(&mut self, suite: usize) -> anyhow::Result<Option<Prepared>> {
        let selected = &self.selected[suite];
        let shader = shader_of(self.args, selected)?;
        let prepared = prepare(&selected.suite, &shader);
        self.pages.suite(&selected.suite.name, &selected.suite.title, &shader, prepared.as_ref().ok());
        match prepared {
            Ok(prepared) => Ok(Some(prepared)),
            Err(error) => {
                let (suite_name, shader) = (selected.suite.name.clone(), shader.name().to_owned());
                let outcome = Outcome::Refused(error);
                self.add(suite, Entry { suite: suite_name, shader, on: None, outcome })?;
                self.ended(suite)?;
                Ok(None)
            }
        }
    }

    fn request(&mut self, suite: usize, prepared: &Prepared, peer: Peer<'_>) -> anyhow::Result<Request> {
        request(self.args, &self.selected[suite], prepared, peer.promises.clone())
    }

    fn begin(&mut self, job: &Job<'_>) -> Earlier {
        self.progress.start((job.suite, &job.prepared.suite.name), job.peer.name(), job.way.0, job.samples);
        Earlier::Nothing
    }

    fn progress(&mut self, done: u64) {
        self.progress.at(done);
    }

    fn end(&mut self, job: &Job<'_>, result: Result<&Part, LaneError>) -> anyhow::Result<()> {
        let (name, (stage, source)) = (job.peer.name(), job.way);
        let outcome = match result {
            Ok(part) => {
                let report = part.clone().report();
                if !interrupt::asked() {
                    self.shown(job, &report)?;
                    self.failing.extend(report.failing.iter().cloned());
                }
                Outcome::Ran(Box::new(report))
            }
            Err(error) => {
                let way = source.map_or_else(String::new, |source| format!("{}: ", source.phrase()));
                let again = match &error {
                    LaneError::Lost { inputs, .. } if !inputs.is_empty() => format!(
                        "\n  reproduce  shadercheck check {} --lane {name} --stage {stage} --case '{inputs}'",
                        job.request.arguments
                    ),
                    _ => String::new(),
                };
                Outcome::LaneFailed(format!("{way}{error}{again}"))
            }
        };
        self.add(job.suite, job.entry(outcome))
    }

    fn suite(&mut self, suite: usize, prepared: &Prepared, parts: Vec<Part>) -> anyhow::Result<()> {
        let entries = &mut self.summary.entries[self.entries..];
        // What other lanes say of a deviation was not known when its line was printed.
        settle(entries, parts);
        entries.iter_mut().for_each(|entry| self.expectations.apply(suite, entry, &self.summary.lanes));
        let failing = std::mem::take(&mut self.failing);
        // Another shader's failures are no regressions of the suite's own.
        let saves = !failing.is_empty() && self.args.case.is_none() && self.args.shader.is_none();
        if let (Some(path), true) = (&self.selected[suite].regressions, saves) {
            // What was found is told in any case: a folder that takes no file is no reason to lose it.
            if let Err(error) = save_regressions(path, &prepared.suite.name, &failing) {
                self.progress.suspend(|| writeln!(self.err, "warning: failing cases are not saved: {error}"))?;
            }
        }
        self.ended(suite)
    }
}
