//! Which ledger says what of a suite is expected to fail.

use std::path::Path;

use anyhow::Context;
use serde::{Deserialize, Serialize};

use super::CheckArgs;
use super::select::Selected;
use base::text::{Shown, SourceFile};
use disk::Problem;
use engine::catalogue;
use engine::suite;
use engine::suite::ledger::{self, Ledger};
use engine::suite::run::{Entry, LaneUsed};

/// What `--expectations` takes for no ledger at all.
const NONE: &str = "none";

/// The ledgers of a run.
#[derive(Debug, Default)]
pub struct Ledgers {
    read: Vec<(SourceFile, Ledger)>,
    /// For each suite, in the order of the run, the place of its ledger.
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

impl Ledgers {
    /// The ledgers of the suites: the one that is named, or that of each suite.
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
        let mut ledgers = Self { whole: folders && args.stage.is_none(), ..Self::default() };
        for suite in selected {
            let file = match (named, &suite.regressions) {
                (Some(path), _) => Some(read(Path::new(path))?),
                (None, Some(beside)) => suite::ledger_path(beside).map(|path| read(&path)).transpose()?,
                (None, None) => catalogue::expectations().map(|(name, text)| SourceFile::new(name, text)),
            };
            let place = file.map(|file| ledgers.add(file)).transpose()?;
            ledgers.of.push(place);
        }
        Ok(ledgers)
    }

    /// The place of a ledger, which is read when it is new.
    fn add(&mut self, file: SourceFile) -> anyhow::Result<usize> {
        if let Some(known) = self.read.iter().position(|(known, _)| known.name() == file.name()) {
            return Ok(known);
        }
        let ledger = ledger::parse(&file).map_err(|problems| {
            anyhow::anyhow!(problems.iter().map(Problem::to_string).collect::<Vec<_>>().join("\n"))
        })?;
        self.read.push((file, ledger));
        Ok(self.read.len() - 1)
    }

    /// Applies the ledger of a suite, given by its place in the run, to a result.
    pub fn apply(&self, suite: usize, entry: &mut Entry, lanes: &[LaneUsed]) {
        let ledger = self.of.get(suite).copied().flatten().and_then(|place| self.read.get(place));
        let lane = entry.on.and_then(|(name, _)| lanes.iter().find(|lane| lane.description.name == name));
        if let (Some((_, ledger)), Some(lane)) = (ledger, lane) {
            ledger.apply(entry, &lane.description);
        }
    }

    /// Entries that are about nothing that ran.
    pub fn stale(&self) -> Vec<String> {
        let all = self.read.iter().filter(|_| self.whole);
        all.flat_map(|(_, ledger)| ledger.stale()).collect()
    }

    /// The ledgers as a shard hands them over; `of` says for each part which suite it is of.
    pub fn written(&self, of: &[usize]) -> Written {
        let file = |(file, _): &(SourceFile, Ledger)| (file.name().to_owned(), file.text().to_owned());
        Written {
            files: self.read.iter().map(file).collect(),
            of: of.iter().map(|&suite| self.of.get(suite).copied().flatten()).collect(),
            whole: self.whole,
        }
    }
}

impl Written {
    /// The ledgers, in which parts stand for suites.
    ///
    /// # Errors
    /// When a ledger cannot be read, which the shard could.
    pub fn read(self) -> anyhow::Result<Ledgers> {
        let mut ledgers = Ledgers { whole: self.whole, ..Ledgers::default() };
        for (name, text) in self.files {
            ledgers.add(SourceFile::new(name, text))?;
        }
        Ok(Ledgers { of: self.of, ..ledgers })
    }
}

fn read(path: &Path) -> anyhow::Result<SourceFile> {
    suite::read_ledger(path).with_context(|| format!("cannot read the ledger `{}`", path.shown()))
}
