//! `check --shard`: one part of the samples of every suite, and what the parts are together.

use std::collections::BTreeSet;
use std::io::Write;

use anyhow::Context;
use serde::{Deserialize, Serialize};

use super::expectations::{RunExpectations, Written};
use super::progress::Progress;
use super::select::Selected;
use super::{Asked, CheckArgs};
use crate::cli::shard::{Absent, Earlier, Printed, Printing, Store, Stored};
use crate::cli::status::ExitStatus;
use engine::check::{Check, Event, Found};
use engine::session::{self, Join, Observer, Reached, Unlike};
use engine::shard::{Identity, Shard};
use engine::suite::run::{Entry, LaneUsed, Outcome, Part, Summary};

/// What some shards found.
#[derive(Debug, Serialize, Deserialize)]
pub struct ShardResult {
    lanes: Vec<LaneUsed>,
    /// Lanes that were asked for and unavailable on some machine.
    unavailable: Absent,
    /// Lanes that were asked for by name, and those that have to judge something.
    #[serde(default)]
    asked: BTreeSet<String>,
    #[serde(default)]
    required: BTreeSet<String>,
    parts: Vec<Part>,
    /// What is expected to fail; applied when everything is joined.
    #[serde(alias = "ledgers")]
    expectations: Written,
}

/// Everything that the result of a run depends on.
fn identity(args: &CheckArgs, shard: Shard, selected: &[Selected], lanes: &[LaneUsed]) -> Identity {
    let mut identity = Identity::new("check", args.seed, shard.count());
    if let Some(samples) = args.samples {
        identity = identity.with("--samples", samples);
    }
    if let Some(profile) = &args.profile {
        identity = identity.with("--profile", profile);
    }
    if let Some(stage) = args.stage {
        identity = identity.with("--stage", format!("{stage:?}").to_lowercase());
    }
    identity = identity.with("--quick", args.quick);
    for LaneUsed { description, against } in lanes {
        let profiles = [Some(&against.promise), against.conformance.as_ref(), against.measured.as_ref()];
        let profiles: Vec<&str> = profiles.into_iter().flatten().map(String::as_str).collect();
        identity = identity.with(
            &format!("lane `{}`", description.name),
            format!("{} by {}", description.driver, profiles.join(", ")),
        );
    }
    for one in selected {
        let text = format!("{}\n{:?}\n{:?}", one.shader.text(), one.suite, one.saved);
        identity = identity.of(&format!("suite `{}` ({})", one.suite.name, one.argument), &text);
    }
    identity
}

/// Runs one shard.
///
/// # Errors
/// When a suite cannot run at all, a lane fails, or a file cannot be written.
pub fn run(
    args: &CheckArgs,
    mut check: Check<'_, Asked<'_>>,
    expectations: &RunExpectations,
    summary: Summary,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> anyhow::Result<ExitStatus> {
    let (shard, selected) = (check.shard.unwrap_or(Shard::WHOLE), check.suites.selected);
    let store = Store::new(&args.sharing.shard_dir, shard, identity(args, shard, selected, &summary.lanes))?;
    let Earlier::Reached(reached) = store.earlier::<Reached<Found>, ShardResult>(args.is_json(), (out, err))? else {
        return Ok(ExitStatus::Clean);
    };
    let mut tasks = super::tasks(args, &check);
    tasks.iter_mut().for_each(|task| task.samples = (task.samples / shard.count()).max(1));
    let progress = Progress::new(args.is_text() && !args.plain, selected.len(), tasks);
    let mut watch = Strict { selected, progress };
    let mut stored = Stored { store: &store, watch: &mut watch };
    let found = session::run(&mut check, Some(shard), reached.unwrap_or_default(), &mut stored)?;
    watch.progress.finish();
    let Summary { lanes, asked, required, unavailable, .. } = summary;
    let result = found.map(|Found { parts, of, .. }| ShardResult {
        lanes,
        unavailable: Absent::new(unavailable),
        asked: asked.into_iter().collect(),
        required: required.into_iter().collect(),
        parts,
        expectations: expectations.written(&of),
    });
    store.conclude(result.as_ref(), args.is_json(), (out, err))
}

/// A shard as it goes: a suite that cannot run ends it, and so does a lane that fails.
struct Strict<'a> {
    selected: &'a [Selected],
    progress: Progress,
}

impl Observer<Check<'_, Asked<'_>>> for Strict<'_> {
    fn event(&mut self, event: Event<'_>) -> anyhow::Result<()> {
        match event {
            Event::Prepared(suite, Err(error)) => {
                let name = &self.selected[suite].suite.name;
                let why = || format!("suite `{name}` cannot run; `shadercheck check` without --shard tells more");
                Err(error).with_context(why)
            }
            Event::Begun(task) => {
                let suite = (task.suite, &*task.prepared.suite.name);
                self.progress.start(suite, task.peer.name(), task.way.0, task.samples);
                Ok(())
            }
            Event::Ended(task, Err(error)) => {
                let (suite, lane) = (&task.prepared.suite.name, task.peer.name());
                Err(error).with_context(|| format!("suite `{suite}` on {lane}/{}", task.way.0))
            }
            Event::Prepared(_, Ok(_)) | Event::Ended(_, Ok(_)) | Event::Suite(..) => Ok(()),
        }
    }

    fn progress(&mut self, done: u64) {
        self.progress.at(done);
    }
}

impl Join for ShardResult {
    fn join(&mut self, other: Self) -> Result<(), Unlike> {
        Unlike::unless(self.lanes == other.lanes, "ran on different lanes")?;
        Unlike::unless(self.expectations == other.expectations, "expect different failures")?;
        self.unavailable.join(other.unavailable);
        self.asked.extend(other.asked);
        self.required.extend(other.required);
        let same = self.parts.len() == other.parts.len()
            && self.parts.iter().zip(&other.parts).all(|(one, other)| one.is_like(other));
        Unlike::unless(same, "ran different suites")?;
        self.parts.iter_mut().zip(other.parts).for_each(|(one, other)| one.join(other));
        Ok(())
    }
}

impl Printed for ShardResult {
    fn print(self, to: Printing<'_>) -> anyhow::Result<ExitStatus> {
        let (format, color) = (to.format, to.color);
        let (seed, lanes, asked, required) = (to.identity.seed, self.lanes, self.asked, self.required);
        let [asked, required] = [asked, required].map(|names| names.into_iter().collect());
        let mut summary = Summary { seed, lanes, asked, required, ..Summary::default() };
        summary.unavailable = self.unavailable.known();
        let expectations = self.expectations.read()?;
        for (number, part) in self.parts.into_iter().enumerate() {
            let report = part.report();
            let (suite, shader, on) = (report.suite.clone(), report.shader.clone(), (report.lane, report.stage));
            let mut entry = Entry { suite, shader, on: Some(on), outcome: Outcome::Ran(Box::new(report)) };
            expectations.apply(number, &mut entry, &summary.lanes);
            if format.is_text() {
                to.out.write_all(report::check::line(&entry, color).as_bytes())?;
            }
            summary.entries.push(entry);
        }
        summary.stale = expectations.stale();
        super::print(&summary, format, color, to.out)?;
        super::concluded(&summary, to.err)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::suite::run::Peer;
    use judge::profile::Promises;

    /// Runs the first of two shards of two suites from a state on; gives the parts at the end.
    fn parts(reached: Reached<Found>) -> Found {
        let folder = tempfile::tempdir().unwrap();
        let shard: Shard = "0/2".parse().unwrap();
        let store = Store::new(folder.path(), shard, Identity::new("check", 1, 2)).unwrap();
        let args = CheckArgs { samples: Some(64), seed: 1, ..CheckArgs::default() };
        let selected = super::super::select::select(&["sphere".to_owned(), "morph".to_owned()], false).unwrap();
        let lane = lanes::embedded::open().unwrap();
        let promises = Promises::of_lane(lane.description());
        let peers = vec![Peer { lane: lane.as_ref(), promises: &promises }];
        let mut check = Check::new(Asked { args: &args, selected: &selected }, peers);
        check.shard = Some(shard);
        let mut watch = Strict { selected: &selected, progress: Progress::new(false, 2, Vec::new()) };
        let mut stored = Stored { store: &store, watch: &mut watch };
        session::run(&mut check, Some(shard), reached, &mut stored).unwrap().unwrap()
    }

    #[test]
    fn a_shard_that_goes_on_keeps_the_parts_of_every_suite_in_their_places() {
        let text = |found: &Found| serde_json::to_string(found).unwrap();
        let whole = parts(Reached::default());
        assert_eq!(whole.parts.iter().map(|part| &*part.suite).collect::<Vec<_>>(), ["sphere", "morph"]);
        assert_eq!(whole.of, [0, 1]);
        for kept in 1..=whole.parts.len() {
            // The suites before the last are done, and of the last one its tasks.
            for done in [kept - 1, kept] {
                let mut part = whole.clone();
                part.parts.truncate(kept);
                part.of.truncate(kept);
                assert_eq!(text(&parts(Reached { done: done as u64, part })), text(&whole), "{kept} kept, {done} done");
            }
        }
    }
}
