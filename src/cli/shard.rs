//! `--shard`: which part of a run this process does, and the folder in which the parts meet.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::cli::bar::Bar;
use crate::cli::reported::Reported;
use crate::cli::status::ExitStatus;
use base::text::Shown;
use disk::fresh;
use engine::session::{self, Job, Join, Observer, Reached, Seen};
use engine::shard::{self, Identity, Sealed, Shard, Sort};
use engine::suite::run::signal_name;
use lanes::{self, Unavailable, interrupt};

/// Arguments of every command that can be shared out.
#[derive(Args, Clone, Debug, Default)]
pub struct ShardArgs {
    /// Run one part of the run, I of N, counted from 0, and write its result to --shard-dir; `auto` takes I and N from
    /// Slurm, Kubernetes, AWS Batch, GitLab, Buildkite, or SHADERCHECK_SHARD_INDEX and SHADERCHECK_SHARD_COUNT;
    /// `shadercheck merge` joins the parts
    #[arg(long, value_name = "I/N|auto")]
    pub shard: Option<String>,
    /// Folder for the results of the parts; a part that was stopped continues from there when it is run again
    #[arg(long, value_name = "DIR", default_value = "shards", requires = "shard")]
    pub shard_dir: PathBuf,
}

/// How a result is printed, and where.
pub struct Printing<'p> {
    /// The run that it is of.
    pub identity: &'p Identity,
    /// How it is printed.
    pub format: Reported,
    /// With colours.
    pub color: bool,
    /// What is printed while a run goes is there already.
    pub live: bool,
    /// The signal that ended the run.
    pub interrupted: Option<u8>,
    /// The result.
    pub out: &'p mut dyn Write,
    /// What is said beside it.
    pub err: &'p mut dyn Write,
}

impl Printing<'_> {
    /// The status of a run that a signal ended, which is said; `None` for one that came to its end.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn ended(&mut self) -> anyhow::Result<Option<ExitStatus>> {
        let Some(signal) = self.interrupted else { return Ok(None) };
        let name = signal_name(signal);
        writeln!(self.err, "error: the run was interrupted by {name}; this is what was found until then")?;
        Ok(Some(ExitStatus::Interrupted(signal)))
    }
}

/// What a command found. It is printed by the same code after a run and after the merge of its parts.
pub trait Printed: Join {
    /// Prints what was found, and gives its status.
    ///
    /// # Errors
    /// When it cannot be written, or nothing could be found.
    fn print(self, to: Printing<'_>) -> anyhow::Result<ExitStatus>;
}

/// Where a run is seen: a bar on a terminal, the result, and what is said beside it.
pub struct Terminal<'a> {
    /// The progress.
    pub bar: Bar,
    /// How the result is printed.
    pub format: Reported,
    /// With colours.
    pub color: bool,
    /// The result.
    pub out: &'a mut dyn Write,
    /// Everything else.
    pub err: &'a mut dyn Write,
}

impl<'a> Terminal<'a> {
    /// With a bar where people look.
    pub fn new(format: impl Into<Reported>, color: bool, out: &'a mut dyn Write, err: &'a mut dyn Write) -> Self {
        let format = format.into();
        Self { bar: Bar::new(format.is_text()), format, color, out, err }
    }
}

/// A job of which its progress is seen, and what it says.
impl<J> Observer<J> for Terminal<'_>
where
    J: for<'e> Job<Error = anyhow::Error, Event<'e> = Seen<'e>>,
{
    fn event(&mut self, seen: Seen<'_>) -> anyhow::Result<()> {
        match seen {
            Seen::Begun { what, on, steps } => self.bar.start(what, on, steps),
            Seen::Said(text) => self.bar.suspend(|| self.err.write_all(text.as_bytes()))?,
        }
        Ok(())
    }

    fn progress(&mut self, done: u64) {
        self.bar.at(done);
    }
}

/// A run on the command line, seen at a terminal.
pub trait Watch<'a> {
    /// The terminal.
    fn terminal(&mut self) -> &mut Terminal<'a>;
}

impl<'a> Watch<'a> for Terminal<'a> {
    fn terminal(&mut self) -> &mut Terminal<'a> {
        self
    }
}

/// A shard as it goes: how far it is, is written down.
pub struct Stored<'s, W> {
    /// The files.
    pub store: &'s Store,
    /// Who watches besides.
    pub watch: &'s mut W,
}

impl<P: Serialize, J: Job<Part = P, Error = anyhow::Error>, W: Observer<J>> Observer<J> for Stored<'_, W> {
    fn event(&mut self, event: J::Event<'_>) -> anyhow::Result<()> {
        self.watch.event(event)
    }

    fn progress(&mut self, done: u64) {
        self.watch.progress(done);
    }

    fn checkpoint(&mut self, done: u64, part: &P) -> anyhow::Result<()> {
        self.store.save(&Reached { done, part })
    }

    fn end(&mut self, part: &P) -> anyhow::Result<()> {
        self.watch.end(part)
    }
}

impl ShardArgs {
    /// Runs a job that has found `part` before its first unit, and prints what came of it: the result of a whole run, or
    /// that a shard is done. `key` tells everything that the result depends on, for a number of shards.
    ///
    /// # Errors
    /// When the job fails, or a file cannot be read or written. A shard can then be run again, and goes on from its last
    /// checkpoint.
    pub fn run<'a, J: Job<Error = anyhow::Error>, W: Observer<J> + Watch<'a>>(
        &self,
        job: &mut J,
        part: J::Part,
        key: impl FnOnce(u64) -> Identity,
        watch: &mut W,
    ) -> anyhow::Result<ExitStatus>
    where
        J::Part: Printed,
    {
        let shard = self.shard()?;
        anyhow::ensure!(
            shard.is_none() || !matches!(watch.terminal().format, Reported::Service(_)),
            "a shard has no whole report; with --shard, --format is text or json"
        );
        let identity = key(shard.map_or(1, Shard::count));
        let Some(shard) = shard else {
            let found = session::run(job, None, Reached::nothing(part), watch)?;
            let Terminal { bar, format, color, out, err } = watch.terminal();
            bar.finish();
            let found = found.context("internal error, please report: a whole run gave nothing")?;
            let (identity, interrupted) = (&identity, interrupt::signal());
            let (format, color) = (*format, *color);
            let to = Printing { identity, format, color, live: true, interrupted, out: *out, err: *err };
            let status = found.print(to)?;
            out.flush()?;
            return Ok(status);
        };
        let store = Store::new(&self.shard_dir, shard, identity)?;
        let Terminal { format, out, err, .. } = watch.terminal();
        let json = !format.is_text();
        let earlier = match store.earlier::<Reached<J::Part>, J::Part>(json, (*out, *err))? {
            Earlier::Done => return Ok(ExitStatus::Clean),
            Earlier::Reached(earlier) => earlier.unwrap_or_else(|| Reached::nothing(part)),
        };
        let found = session::run(job, Some(shard), earlier, &mut Stored { store: &store, watch })?;
        let Terminal { bar, out, err, .. } = watch.terminal();
        bar.finish();
        store.conclude(found.as_ref(), json, (*out, *err))
    }

    /// The shard that is asked for; none for a whole run.
    ///
    /// # Errors
    /// When there is no such shard, or the environment names none.
    pub fn shard(&self) -> anyhow::Result<Option<Shard>> {
        match self.shard.as_deref() {
            None => Ok(None),
            Some("auto") => {
                let get = |name: &str| std::env::var(name).ok();
                Ok(Some(shard::detect(&get).context("--shard auto")?))
            }
            Some(text) => Ok(Some(text.parse().context("--shard")?)),
        }
    }
}

/// Lanes that were asked for and unavailable, as stored in results.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Absent(Vec<(String, Unavailable)>);

impl Absent {
    /// Of lanes by name.
    pub fn new(lanes: Vec<(&'static str, Unavailable)>) -> Self {
        Self(lanes.into_iter().map(|(name, why)| (name.to_owned(), why)).collect())
    }

    /// Adds those of another shard, in an order that does not depend on which comes first.
    pub fn join(&mut self, other: Self) {
        for one in other.0 {
            if !self.0.contains(&one) {
                self.0.push(one);
            }
        }
        self.0.sort_by(|a, b| (&a.0, &a.1.why, &a.1.remedy).cmp(&(&b.0, &b.1.why, &b.1.remedy)));
    }

    /// The lanes among those that this program knows, in its order.
    pub fn known(self) -> Vec<(&'static str, Unavailable)> {
        let place = |name: &str| lanes::registry().iter().position(|candidate| candidate.name == name);
        let mut known: Vec<_> = self.0.into_iter().filter_map(|(name, why)| Some((place(&name)?, why))).collect();
        known.sort_by_key(|(place, _)| *place);
        known.into_iter().map(|(place, why)| (lanes::registry()[place].name, why)).collect()
    }
}

/// The files of one shard in the folder.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    shard: Shard,
    identity: Identity,
}

/// What an earlier run of a shard left.
pub enum Earlier<S> {
    /// Its result, which is reported.
    Done,
    /// How far it got, if it began.
    Reached(Option<S>),
}

impl Store {
    /// Makes the folder, if need be, and sees that files can be written there: before the work, not after it.
    ///
    /// # Errors
    /// When the folder cannot be made or written to.
    pub fn new(folder: &Path, shard: Shard, identity: Identity) -> anyhow::Result<Self> {
        fs::create_dir_all(folder).with_context(|| format!("cannot make the folder `{}`", folder.shown()))?;
        let store = Self { folder: folder.to_owned(), shard, identity };
        fresh::probe(folder).with_context(|| format!("cannot write to the folder `{}`", folder.shown()))?;
        Ok(store)
    }

    /// The file with what the shard found.
    fn result_path(&self) -> PathBuf {
        self.folder.join(format!("{}.json", self.shard.stem()))
    }

    fn checkpoint_path(&self) -> PathBuf {
        self.folder.join(format!("{}.checkpoint", self.shard.stem()))
    }

    /// What this shard found when it was run before, if it came to its end. A file that is damaged is told on
    /// `err`, and counts as none.
    ///
    /// # Errors
    /// When the file is there and is of another run, or cannot be read.
    fn finished<T: DeserializeOwned>(&self, err: &mut dyn Write) -> anyhow::Result<Option<T>> {
        self.read(&self.result_path(), Sort::Result, err)
    }

    /// How far this shard got when it was run before. A file that is damaged is told on `err`, and counts as
    /// none.
    ///
    /// # Errors
    /// When the file is there and is of another run, or cannot be read.
    fn checkpoint<T: DeserializeOwned>(&self, err: &mut dyn Write) -> anyhow::Result<Option<T>> {
        self.read(&self.checkpoint_path(), Sort::Checkpoint, err)
    }

    /// What the shard left when it was run before: `T` is its result, `S` how far it got.
    ///
    /// # Errors
    /// When a file cannot be read, or is of another run.
    pub fn earlier<S: DeserializeOwned, T: DeserializeOwned>(
        &self,
        json: bool,
        (out, err): (&mut dyn Write, &mut dyn Write),
    ) -> anyhow::Result<Earlier<S>> {
        if self.finished::<T>(err)?.is_some() {
            self.report("was done before", json, out)?;
            return Ok(Earlier::Done);
        }
        let earlier = self.checkpoint(err)?;
        if earlier.is_some() {
            writeln!(err, "note: shard {} goes on from its checkpoint", self.shard)?;
        }
        Ok(Earlier::Reached(earlier))
    }

    /// Writes what the shard found, or says that a signal ended it before. The status is [`ExitStatus::Clean`] when the
    /// result is written, whatever was found: that is for the merge to tell.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn conclude<T: Serialize>(
        &self,
        found: Option<&T>,
        json: bool,
        (out, err): (&mut dyn Write, &mut dyn Write),
    ) -> anyhow::Result<ExitStatus> {
        if let Some(found) = found {
            self.finish(found)?;
            return self.report("is done", json, out);
        }
        let signal = interrupt::signal().context("the shard ended before its time")?;
        let (name, shard) = (signal_name(signal), self.shard);
        writeln!(err, "error: interrupted by {name}; shard {shard} goes on from its checkpoint when it is run again")?;
        Ok(ExitStatus::Interrupted(signal))
    }

    /// Says that the shard has its result, on `out`.
    fn report(&self, how: &str, json: bool, out: &mut dyn Write) -> anyhow::Result<ExitStatus> {
        let (shard, path) = (self.shard, self.result_path());
        if json {
            let value = serde_json::json!({
                "shard": shard.index(), "shards": shard.count(), "result": path.display().to_string(),
            });
            writeln!(out, "{value:#}")?;
        } else {
            writeln!(out, "shard {shard} {how}: {}", path.shown())?;
        }
        out.flush()?;
        Ok(ExitStatus::Clean)
    }

    fn read<T: DeserializeOwned>(&self, path: &Path, sort: Sort, err: &mut dyn Write) -> anyhow::Result<Option<T>> {
        let name = path.shown();
        let text = match fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(error).with_context(|| format!("cannot read `{name}`")),
        };
        let opened: Sealed<serde_json::Value> = match shard::open(&text) {
            Ok(opened) => opened,
            Err(error) => {
                writeln!(err, "note: `{name}` is not used: {error}")?;
                return Ok(None);
            }
        };
        self.identity.same(&opened.identity).with_context(|| {
            format!("`{name}` is of another run, this run being the one and the file the other; remove it or give another --shard-dir")
        })?;
        anyhow::ensure!(
            opened.sort == sort && opened.covers == [self.shard.index()],
            "`{name}` is of another shard; remove it or give another --shard-dir"
        );
        Ok(Some(serde_json::from_value(opened.found).with_context(|| format!("cannot read `{name}`"))?))
    }

    /// Notes how far the shard got.
    ///
    /// # Errors
    /// When the file cannot be written; the one before is then still there.
    pub fn save<T: Serialize>(&self, state: &T) -> anyhow::Result<()> {
        self.write(&self.checkpoint_path(), Sort::Checkpoint, state)
    }

    /// Writes what the shard found, and forgets how it got there.
    ///
    /// # Errors
    /// When the file cannot be written; nothing is then under its name.
    fn finish<T: Serialize>(&self, found: &T) -> anyhow::Result<()> {
        self.write(&self.result_path(), Sort::Result, found)?;
        let checkpoint = self.checkpoint_path();
        if checkpoint.exists() {
            fs::remove_file(&checkpoint).with_context(|| format!("cannot remove `{}`", checkpoint.shown()))?;
        }
        Ok(())
    }

    fn write<T: Serialize>(&self, path: &Path, sort: Sort, found: &T) -> anyhow::Result<()> {
        let sealed = Sealed { sort, identity: self.identity.clone(), covers: vec![self.shard.index()], found };
        let text = shard::seal(&sealed).context("what was found cannot be written down")?;
        fresh::write(path, text.as_bytes()).with_context(|| format!("cannot write `{}`", path.shown()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn store(folder: &Path, seed: u64) -> Store {
        let shard: Shard = "1/3".parse().unwrap();
        Store::new(folder, shard, Identity::new("check", seed, 3)).unwrap()
    }

    fn checkpoint(store: &Store) -> (anyhow::Result<Option<Vec<u64>>>, String) {
        let mut err = Vec::new();
        let found = store.checkpoint(&mut err);
        (found, String::from_utf8(err).unwrap())
    }

    #[test]
    fn a_shard_goes_on_from_its_checkpoint_and_is_done_once() {
        let folder = tempfile::tempdir().unwrap();
        let store = store(&folder.path().join("made/here"), 1);
        assert!(checkpoint(&store).0.unwrap().is_none());
        store.save(&vec![1_u64, 2]).unwrap();
        assert_eq!(checkpoint(&store).0.unwrap(), Some(vec![1, 2]));
        assert!(store.finished::<Vec<u64>>(&mut Vec::new()).unwrap().is_none(), "a checkpoint is no result");
        store.finish(&vec![3_u64]).unwrap();
        assert!(checkpoint(&store).0.unwrap().is_none());
        assert_eq!(store.finished::<Vec<u64>>(&mut Vec::new()).unwrap(), Some(vec![3]));
        let left: Vec<_> = fs::read_dir(&store.folder).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(left, ["shard-00001-of-00003.json"]);
    }

    #[test]
    fn a_damaged_checkpoint_is_reported_and_not_used() {
        let folder = tempfile::tempdir().unwrap();
        let store = store(folder.path(), 1);
        store.save(&vec![1_u64]).unwrap();
        let text = fs::read_to_string(store.checkpoint_path()).unwrap();
        fs::write(store.checkpoint_path(), &text[..text.len() / 2]).unwrap();
        let (found, reported) = checkpoint(&store);
        assert!(found.unwrap().is_none());
        assert!(reported.contains("is not used: the file is damaged"), "{reported}");
    }

    #[test]
    fn a_checkpoint_of_another_run_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        store(folder.path(), 1).save(&vec![1_u64]).unwrap();
        let error = format!("{:#}", checkpoint(&store(folder.path(), 2)).0.unwrap_err());
        assert!(error.contains("is of another run") && error.contains("the seed is `2` in one and `1`"), "{error}");
        // The file of one shard under the name of another.
        let other = Store { shard: "2/3".parse().unwrap(), ..store(folder.path(), 1) };
        fs::copy(store(folder.path(), 1).checkpoint_path(), other.checkpoint_path()).unwrap();
        assert!(checkpoint(&other).0.unwrap_err().to_string().contains("of another shard"));
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_reported_before_the_work() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        let error = Store::new(&file, Shard::WHOLE, Identity::new("check", 0, 1)).unwrap_err().to_string();
        assert!(error.starts_with("cannot make the folder"), "{error}");
    }

    #[test]
    fn no_shard_is_a_whole_run_and_a_wrong_one_is_reported() {
        assert_eq!(ShardArgs::default().shard().unwrap(), None);
        let args = ShardArgs { shard: Some("5/2".to_owned()), ..ShardArgs::default() };
        let error = format!("{:#}", args.shard().unwrap_err());
        assert!(error.starts_with("--shard: there is no shard 5 of 2"), "{error}");
    }
}
