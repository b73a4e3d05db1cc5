//! A whole run as it goes: each result is printed, and goes to the summary and the page.

use std::io::Write;

use super::bundle::write_bundle;
use super::expectations::RunExpectations;
use super::page::Pages;
use super::progress::Progress;
use super::screen::Screen;
use super::select::Selected;
use super::{Asked, CheckArgs};
use engine::check::{Check, Event, Task};
use engine::session::Observer;
use engine::suite::run::{Entry, Outcome, Part, Prepared, Report, RunError, Summary, bundles, settle};
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
    fn shown(&mut self, task: &Task<'_>, report: &Report) -> anyhow::Result<()> {
        let (lane, stage) = (task.peer.lane, task.way.0);
        if let Some(folder) = &self.args.report_dir {
            for bundle in bundles(task.prepared, lane, stage, &task.request.promises, report)? {
                self.pages.attempt(write_bundle(folder, &bundle));
            }
        }
        self.pages.look(task.prepared, lane, stage, task.request, report);
        Ok(())
    }
}

impl Observer<Check<'_, Asked<'_>>> for Watched<'_> {
    fn event(&mut self, event: Event<'_>) -> anyhow::Result<()> {
        match event {
            Event::Prepared(suite, prepared) => self.prepared(suite, prepared),
            Event::Begun(task) => {
                let suite = (task.suite, &*task.prepared.suite.name);
                self.progress.start(suite, task.peer.name(), task.way.0, task.samples);
                Ok(())
            }
            Event::Ended(task, result) => self.result(task, result),
            Event::Suite(suite, prepared, parts) => self.suite(suite, prepared, parts),
        }
    }

    fn progress(&mut self, done: u64) {
        self.progress.at(done);
    }
}

impl Watched<'_> {
    fn prepared(&mut self, suite: usize, prepared: Result<&Prepared, RunError>) -> anyhow::Result<()> {
        let Selected { suite: about, shader, .. } = &self.selected[suite];
        self.pages.suite(&about.name, &about.title, shader, prepared.as_ref().ok().copied());
        let Err(error) = prepared else { return Ok(()) };
        let (name, shader) = (about.name.clone(), shader.name().to_owned());
        self.add(suite, Entry { suite: name, shader, on: None, outcome: Outcome::Refused(error) })?;
        self.ended(suite)
    }

    fn result(&mut self, task: &Task<'_>, result: Result<&Part, LaneError>) -> anyhow::Result<()> {
        let (name, (stage, source)) = (task.peer.name(), task.way);
        let outcome = match result {
            Ok(part) => {
                let report = part.clone().report();
                if !interrupt::asked() {
                    self.shown(task, &report)?;
                    self.failing.extend(report.failing.iter().cloned());
                }
                Outcome::Ran(Box::new(report))
            }
            Err(error) => {
                let way = source.map_or_else(String::new, |source| format!("{}: ", source.phrase()));
                let again = match &error {
                    LaneError::Lost { inputs, .. } if !inputs.is_empty() => format!(
                        "\n  reproduce  shadercheck check {} --lane {name} --stage {stage} --case '{inputs}'",
                        task.request.arguments
                    ),
                    _ => String::new(),
                };
                Outcome::LaneFailed(format!("{way}{error}{again}"))
            }
        };
        self.add(task.suite, task.entry(outcome))
    }

    fn suite(&mut self, suite: usize, prepared: &Prepared, parts: &[Part]) -> anyhow::Result<()> {
        let entries = &mut self.summary.entries[self.entries..];
        // What other lanes say of a deviation was not known when its line was printed.
        settle(entries, parts.to_vec());
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
