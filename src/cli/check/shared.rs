//! `check --shard`: one part of the samples of every suite, and what the parts are together.

use std::collections::BTreeSet;
use std::io::Write;

use anyhow::Context;
use serde::{Deserialize, Serialize};

use super::expectations::{RunExpectations, Written};
use super::progress::Progress;
use super::select::Selected;
use super::{CheckArgs, request, shader_of};
use crate::cli::merge::Joined;
use crate::cli::shard::{Absent, Store};
use crate::cli::status::ExitStatus;
use base::text::fingerprint;
use engine::session::{Earlier, Job, Observer, Session};
use engine::shard::{Identity, Shard};
use engine::suite::run::{Entry, LaneUsed, Outcome, Part, Peer, Prepared, Request, Sampled, Summary, prepare};
use lanes::{LaneError, interrupt};

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

/// How far a shard is.
#[derive(Default, Serialize, Deserialize)]
struct State {
    done: Vec<Part>,
    /// The suite under way: its place among those that are done, and its samples so far.
    under_way: Option<(usize, Sampled)>,
}

/// The same, to be written.
#[derive(Serialize)]
struct StateRef<'a> {
    done: &'a [Part],
    under_way: Option<(usize, &'a Sampled)>,
}

/// Everything that the result of a run depends on.
fn identity(args: &CheckArgs, shard: Shard, selected: &[Selected], lanes: &[LaneUsed]) -> anyhow::Result<Identity> {
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
        let shader = shader_of(args, one)?;
        let text = format!("{}\n{:?}\n{:?}", shader.text(), one.suite, one.saved);
        identity = identity
            .with(&format!("suite `{}` ({})", one.suite.name, one.argument), format!("{:016x}", fingerprint(&text)));
    }
    Ok(identity)
}

/// Runs one shard.
///
/// # Errors
/// When a suite cannot run at all, a lane fails, or a file cannot be written.
pub fn run(
    args: &CheckArgs,
    session: &Session<'_>,
    selected: &[Selected],
    expectations: &RunExpectations,
    summary: Summary,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> anyhow::Result<ExitStatus> {
    let shard = session.shard.unwrap_or(Shard::WHOLE);
    let store = Store::new(&args.sharing.shard_dir, shard, identity(args, shard, selected, &summary.lanes)?)?;
    store.run(args.is_json(), (out, err), |state: Option<State>| {
        let mut tasks = super::tasks(args, session, selected);
        tasks.iter_mut().for_each(|task| task.samples = (task.samples / shard.count()).max(1));
        let progress = Progress::new(args.is_text() && !args.plain, selected.len(), tasks);
        let state = state.unwrap_or_default();
        let mut stored = Stored { args, selected, store: &store, state, progress, of: Vec::new() };
        session.run(selected.len(), &mut stored)?;
        stored.progress.finish();
        if interrupt::asked() {
            return Ok(None);
        }
        let Summary { lanes, asked, required, unavailable, .. } = summary;
        Ok(Some(ShardResult {
            lanes,
            unavailable: Absent::new(unavailable),
            asked: asked.into_iter().collect(),
            required: required.into_iter().collect(),
            parts: stored.state.done,
            expectations: expectations.written(&stored.of),
        }))
    })
}

/// A shard as it goes: every batch and every result is written down.
struct Stored<'a> {
    args: &'a CheckArgs,
    selected: &'a [Selected],
    store: &'a Store,
    state: State,
    progress: Progress,
    /// For each job that began, the suite that it is of.
    of: Vec<usize>,
}

impl Observer for Stored<'_> {
    type Error = anyhow::Error;

    fn prepare(&mut self, suite: usize) -> anyhow::Result<Option<Prepared>> {
        let one = &self.selected[suite];
        let prepared = prepare(&one.suite, &shader_of(self.args, one)?);
        let name = &one.suite.name;
        let why = || format!("suite `{name}` cannot run; `shadercheck check` without --shard tells more");
        Ok(Some(prepared.with_context(why)?))
    }

    fn request(&mut self, suite: usize, prepared: &Prepared, peer: Peer<'_>) -> anyhow::Result<Request> {
        request(self.args, &self.selected[suite], prepared, peer.promises.clone())
    }

    fn begin(&mut self, job: &Job<'_>) -> Earlier {
        self.of.push(job.suite);
        let place = self.of.len();
        if let Some(part) = self.state.done.get(place - 1) {
            return Earlier::Done(Box::new(part.clone()));
        }
        self.progress.start((job.suite, &job.prepared.suite.name), job.peer.name(), job.way.0, job.samples);
        match self.state.under_way.take().filter(|(at, _)| *at == place) {
            Some((_, sampled)) => Earlier::Begun(Box::new(sampled)),
            None => Earlier::Nothing,
        }
    }

    fn progress(&mut self, done: u64) {
        self.progress.at(done);
    }

    fn checkpoint(&mut self, sampled: &Sampled) -> anyhow::Result<()> {
        self.store.save(&StateRef { done: &self.state.done, under_way: Some((self.of.len(), sampled)) })
    }

    fn end(&mut self, job: &Job<'_>, result: Result<&Part, LaneError>) -> anyhow::Result<()> {
        let part = result
            .with_context(|| format!("suite `{}` on {}/{}", job.prepared.suite.name, job.peer.name(), job.way.0))?;
        self.state.done.push(part.clone());
        self.store.save(&StateRef { done: &self.state.done, under_way: None })
    }

    fn suite(&mut self, suite: usize, _: &Prepared, parts: Vec<Part>) -> anyhow::Result<()> {
        // They now hold what other lanes say of a deviation. Parts of later suites may be there from an earlier run.
        let first = self.of.partition_point(|&of| of < suite);
        self.state.done.splice(first..first + parts.len(), parts);
        Ok(())
    }
}

impl Joined for ShardResult {
    fn join(&mut self, other: Self) -> anyhow::Result<()> {
        anyhow::ensure!(self.lanes == other.lanes, "the shards ran on different lanes");
        anyhow::ensure!(self.expectations == other.expectations, "the shards expect different failures");
        self.unavailable.join(other.unavailable);
        self.asked.extend(other.asked);
        self.required.extend(other.required);
        let same = self.parts.len() == other.parts.len()
            && self.parts.iter().zip(&other.parts).all(|(one, other)| one.is_like(other));
        anyhow::ensure!(same, "the shards ran different suites");
        self.parts.iter_mut().zip(other.parts).for_each(|(one, other)| one.join(other));
        Ok(())
    }

    fn print(
        self,
        identity: &Identity,
        json: bool,
        color: bool,
        out: &mut dyn Write,
        err: &mut dyn Write,
    ) -> anyhow::Result<ExitStatus> {
        let (seed, lanes, asked, required) = (identity.seed, self.lanes, self.asked, self.required);
        let [asked, required] = [asked, required].map(|names| names.into_iter().collect());
        let mut summary = Summary { seed, lanes, asked, required, ..Summary::default() };
        summary.unavailable = self.unavailable.known();
        let expectations = self.expectations.read()?;
        for (number, part) in self.parts.into_iter().enumerate() {
            let report = part.report();
            let (suite, shader, on) = (report.suite.clone(), report.shader.clone(), (report.lane, report.stage));
            let mut entry = Entry { suite, shader, on: Some(on), outcome: Outcome::Ran(Box::new(report)) };
            expectations.apply(number, &mut entry, &summary.lanes);
            if !json {
                out.write_all(report::check::line(&entry, color).as_bytes())?;
            }
            summary.entries.push(entry);
        }
        summary.stale = expectations.stale();
        super::print(&summary, json, color, out)?;
        super::concluded(&summary, err)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use judge::profile::Promises;

    /// Runs the first of two shards of two suites from a state on; gives the parts at the end.
    fn parts(done: Vec<Part>) -> Vec<Part> {
        let folder = tempfile::tempdir().unwrap();
        let shard: Shard = "0/2".parse().unwrap();
        let store = Store::new(folder.path(), shard, Identity::new("check", 1, 2)).unwrap();
        let args = CheckArgs { samples: Some(64), seed: 1, ..CheckArgs::default() };
        let selected = super::super::select::select(&["sphere".to_owned(), "morph".to_owned()], false).unwrap();
        let lane = lanes::embedded::open().unwrap();
        let promises = Promises::of_lane(lane.description());
        let peers = vec![Peer { lane: lane.as_ref(), promises: &promises }];
        let session = Session { shard: Some(shard), ..Session::new(peers) };
        let (state, progress) = (State { done, under_way: None }, Progress::new(false, 2, Vec::new()));
        let mut stored = Stored { args: &args, selected: &selected, store: &store, state, progress, of: Vec::new() };
        session.run(selected.len(), &mut stored).unwrap();
        assert_eq!(stored.of, [0, 1]);
        stored.state.done
    }

    #[test]
    fn a_shard_that_goes_on_keeps_the_parts_of_every_suite_in_their_places() {
        let text = |parts: &[Part]| serde_json::to_string(parts).unwrap();
        let whole = parts(Vec::new());
        assert_eq!(whole.iter().map(|part| &*part.suite).collect::<Vec<_>>(), ["sphere", "morph"]);
        for kept in 1..=whole.len() {
            assert_eq!(text(&parts(whole[..kept].to_vec())), text(&whole), "{kept} kept");
        }
    }
}
