//! Which file says what of a suite is expected to fail.

use std::path::Path;

use anyhow::Context;
use serde::{Deserialize, Serialize};

use super::CheckArgs;
use super::select::Selected;
use base::text::{Shown, SourceFile};
use disk::Problem;
use engine::catalogue;
use engine::suite;
use engine::suite::expectations::{self, Expectations};
use engine::suite::run::{Entry, LaneUsed};

/// What `--expectations` takes for no file at all.
const NONE: &str = "none";

/// The expectations of a run.
#[derive(Debug, Default)]
pub struct RunExpectations {
    read: Vec<(SourceFile, Expectations)>,
    /// For each suite, in the order of the run, the place of its file.
    of: Vec<Option<usize>>,
    /// True when entries may be told that are about nothing that ran.
    whole: bool,
}

/// The same in the result of a shard.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Written {
    files: Vec<(String, String)>,
    /// For each part of the result.
    of: Vec<Option<usize>>,
    whole: bool,
}

impl RunExpectations {
    /// The expectations of the suites: the file that is named, or that of each suite.
    ///
    /// # Errors
    /// A file that cannot be read, and everything that is wrong in it.
    pub fn new(args: &CheckArgs, selected: &[Selected]) -> anyhow::Result<Self> {
        let named = args.expectations.as_deref();
        // A single case is looked at as it is, and what is known of a shader says nothing about another.
        if named == Some(NONE) || (named.is_none() && (args.case.is_some() || args.shader.is_some())) {
            return Ok(Self { of: vec![None; selected.len()], ..Self::default() });
        }
        let folders = args.suites.iter().all(|argument| Path::new(argument).is_dir());
        let mut expectations = Self { whole: folders && args.stage.is_none(), ..Self::default() };
        for suite in selected {
            let file = match (named, &suite.regressions) {
                (Some(path), _) => Some(read(Path::new(path))?),
                (None, Some(beside)) => suite::expectations_path(beside).map(|path| read(&path)).transpose()?,
                (None, None) => catalogue::expectations().map(|(name, text)| SourceFile::new(name, text)),
            };
            let place = file.map(|file| expectations.add(file)).transpose()?;
            expectations.of.push(place);
        }
        Ok(expectations)
    }

    /// The place of a file, which is read when it is new.
    fn add(&mut self, file: SourceFile) -> anyhow::Result<usize> {
        if let Some(known) = self.read.iter().position(|(known, _)| known.name() == file.name()) {
            return Ok(known);
        }
        let expectations = expectations::parse(&file).map_err(|problems| {
            anyhow::anyhow!(problems.iter().map(Problem::to_string).collect::<Vec<_>>().join("\n"))
        })?;
        self.read.push((file, expectations));
        Ok(self.read.len() - 1)
    }

    /// Applies the expectations of a suite, given by its place in the run, to a result.
    pub fn apply(&self, suite: usize, entry: &mut Entry, lanes: &[LaneUsed]) {
        let expectations = self.of.get(suite).copied().flatten().and_then(|place| self.read.get(place));
        let lane = entry.on.and_then(|(name, _)| lanes.iter().find(|lane| lane.description.name == name));
        if let (Some((_, expectations)), Some(lane)) = (expectations, lane) {
            expectations.apply(entry, &lane.description);
        }
    }

    /// Entries that are about nothing that ran.
    pub fn stale(&self) -> Vec<String> {
        let all = self.read.iter().filter(|_| self.whole);
        all.flat_map(|(_, expectations)| expectations.stale()).collect()
    }

    /// The expectations as a shard hands them over; `of` says for each part which suite it is of.
    pub fn written(&self, of: &[usize]) -> Written {
        let file = |(file, _): &(SourceFile, Expectations)| (file.name().to_owned(), file.text().to_owned());
        Written {
            files: self.read.iter().map(file).collect(),
            of: of.iter().map(|&suite| self.of.get(suite).copied().flatten()).collect(),
            whole: self.whole,
        }
    }
}

impl Written {
    /// The expectations, in which parts stand for suites.
    ///
    /// # Errors
    /// When a file cannot be read, which the shard could.
    pub fn read(self) -> anyhow::Result<RunExpectations> {
        let mut expectations = RunExpectations { whole: self.whole, ..RunExpectations::default() };
        for (name, text) in self.files {
            expectations.add(SourceFile::new(name, text))?;
        }
        Ok(RunExpectations { of: self.of, ..expectations })
    }
}

fn read(path: &Path) -> anyhow::Result<SourceFile> {
    suite::read_expectations(path).with_context(|| format!("cannot read the expectations `{}`", path.shown()))
}
