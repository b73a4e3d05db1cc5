//! `check --shard`: one part of the samples of every suite, and what the parts are together.

use std::collections::BTreeSet;
use std::io::Write;
use std::ops::ControlFlow;

use anyhow::Context;
use serde::{Deserialize, Serialize};

use super::ledger::{Ledgers, Written};
use super::progress::Progress;
use super::select::Selected;
use super::{CheckArgs, request, shader_of, stages};
use crate::cli::merge::Joined;
use crate::cli::shard::{Absent, Store, told};
use crate::cli::status::ExitStatus;
use base::text::fingerprint;
use engine::shard::{Identity, Shard};
use engine::suite::run::{
    Entry, LaneUsed, Outcome, Part, Peer, Sampled, Share, Summary, cross_check_parts, prepare, run_part, signal_name,
};
use judge::profile::Promises;
use lanes::{Lane, interrupt};

/// What some shards found.
#[derive(Debug, Serialize, Deserialize)]
pub struct Found {
    lanes: Vec<LaneUsed>,
    /// Lanes that were wanted and could not be had, on some machine.
    unavailable: Absent,
    /// Lanes that were asked for by name, and those that have to judge something.
    #[serde(default)]
    asked: BTreeSet<String>,
    #[serde(default)]
    required: BTreeSet<String>,
    parts: Vec<Part>,
    /// What is expected to fail; applied when everything is joined.
    ledgers: Written,
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

/// Runs one shard. The status is [`ExitStatus::Clean`] when its result is written, whatever was found: that is
/// for the merge to tell.
///
/// # Errors
/// When a suite cannot run at all, a lane fails, or a file cannot be written. The shard can then be run again, and
/// goes on from its last checkpoint.
#[expect(clippy::too_many_arguments, reason = "all that the command has set up")]
pub fn run(
    args: &CheckArgs,
    shard: Shard,
    selected: &[Selected],
    ledgers: &Ledgers,
    lanes: &[Box<dyn Lane>],
    promises: &[Promises],
    summary: Summary,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> anyhow::Result<ExitStatus> {
    let store = Store::new(&args.sharing.shard_dir, shard, identity(args, shard, selected, &summary.lanes)?)?;
    if store.finished::<Found>(err)?.is_some() {
        return told(&store, "was done before", args.is_json(), out);
    }
    let mut state: State = store.checkpoint(err)?.unwrap_or_default();
    if state.under_way.is_some() || !state.done.is_empty() {
        writeln!(err, "note: shard {shard} goes on from its checkpoint")?;
    }
    let mut tasks = super::tasks(args, selected, lanes);
    tasks.iter_mut().for_each(|task| task.samples = (task.samples / shard.count()).max(1));
    let mut progress = Progress::new(args.is_text() && !args.plain, selected.len(), tasks);
    let mut place = 0;
    let mut of: Vec<usize> = Vec::new();
    for (number, one) in selected.iter().enumerate() {
        let name = &one.suite.name;
        let prepared = prepare(&one.suite, &shader_of(args, one)?)
            .with_context(|| format!("suite `{name}` cannot run; `shadercheck check` without --shard tells more"))?;
        let mut untold = true;
        let first = place;
        for (lane, promises) in lanes.iter().zip(promises) {
            let request = request(args, one, &prepared, promises.clone())?;
            for stage in stages(args, lane.as_ref(), &prepared) {
                let told = std::mem::take(&mut untold);
                place += 1;
                of.push(number);
                if place <= state.done.len() {
                    continue;
                }
                let samples = request.samples_of(&one.suite) / shard.count();
                progress.start((number, name), lane.description().name, stage, samples);
                let resume = state.under_way.take().filter(|(at, _)| *at == place).map(|(_, sampled)| sampled);
                let mut failed = None;
                let mut save = |sampled: &Sampled| {
                    let state = StateRef { done: &state.done, under_way: Some((place, sampled)) };
                    match store.save(&state) {
                        Ok(()) if interrupt::asked() => ControlFlow::Break(()),
                        Ok(()) => ControlFlow::Continue(()),
                        Err(error) => {
                            failed = Some(error);
                            ControlFlow::Break(())
                        }
                    }
                };
                let share = Share { shard, resume, save: &mut save, partial: false };
                let part = run_part(&prepared, lane.as_ref(), stage, &request, share, &mut |n| progress.at(n));
                if let (Err(_) | Ok(None), Some(signal), None) = (&part, interrupt::signal(), &failed) {
                    return stopped(shard, signal, err);
                }
                let part = part.with_context(|| format!("suite `{name}` on {}/{stage}", lane.description().name))?;
                let Some(mut part) = part else {
                    return Err(failed.unwrap_or_else(|| anyhow::anyhow!("stopped")));
                };
                if told && shard.is_first() {
                    part.check_translations(&prepared, &request);
                }
                state.done.push(part);
                store.save(&StateRef { done: &state.done, under_way: None })?;
                if let Some(signal) = interrupt::signal() {
                    return stopped(shard, signal, err);
                }
            }
        }
        let peers: Vec<Peer<'_>> =
            lanes.iter().zip(promises).map(|(lane, promises)| Peer { lane: lane.as_ref(), promises }).collect();
        cross_check_parts(&prepared, &peers, &mut state.done[first..place]);
    }
    progress.finish();
    let unavailable = Absent::new(summary.unavailable);
    let ledgers = ledgers.written(&of);
    let Summary { lanes, asked, required, .. } = summary;
    let (asked, required) = (asked.into_iter().collect(), required.into_iter().collect());
    store.finish(&Found { lanes, unavailable, asked, required, parts: state.done, ledgers })?;
    told(&store, "is done", args.is_json(), out)
}

/// A shard that a signal ends has its checkpoint.
fn stopped(shard: Shard, signal: u8, err: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let name = signal_name(signal);
    writeln!(err, "error: interrupted by {name}; shard {shard} goes on from its checkpoint when it is run again")?;
    Ok(ExitStatus::Interrupted(signal))
}

impl Joined for Found {
    fn join(&mut self, other: Self) -> anyhow::Result<()> {
        anyhow::ensure!(self.lanes == other.lanes, "the shards ran on different lanes");
        anyhow::ensure!(self.ledgers == other.ledgers, "the shards expect different failures");
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
        let ledgers = self.ledgers.read()?;
        for (number, part) in self.parts.into_iter().enumerate() {
            let report = part.report();
            let (suite, shader, on) = (report.suite.clone(), report.shader.clone(), (report.lane, report.stage));
            let mut entry = Entry { suite, shader, on: Some(on), outcome: Outcome::Ran(Box::new(report)) };
            ledgers.apply(number, &mut entry, &summary.lanes);
            if !json {
                out.write_all(report::check::line(&entry, color).as_bytes())?;
            }
            summary.entries.push(entry);
        }
        summary.stale = ledgers.stale();
        super::print(&summary, json, color, out)?;
        super::concluded(&summary, err)
    }
}
