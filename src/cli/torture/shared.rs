//! `torture --shard`: some of the programs of a run, and what all of them are together.

use std::io::Write;

use serde::{Deserialize, Serialize};

use super::{TortureArgs, conclude, write_all};
use crate::cli::bar::Bar;
use crate::cli::check::Format;
use crate::cli::merge::Joined;
use crate::cli::shard::Store;
use crate::cli::status::ExitStatus;
use engine::session::Join;
use engine::shard::{Identity, Shard};
use engine::suite::run::Peer;
use engine::torture::Found;
use lanes::{Description, Stage};
use report::torture::Summary;

/// Programs between two checkpoints.
const SAVED: u64 = 8;
/// Name of the parameter with the command line.
const COMMAND: &str = "command";

/// What some shards found.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct ShardResult {
    lanes: Vec<Description>,
    /// Programs of the shard that are done, in their order; of a result, all.
    done: u64,
    found: Found,
}

fn identity(args: &TortureArgs, shard: Shard, lanes: &[Description]) -> Identity {
    let mut identity = Identity::new("torture", args.seed, shard.count())
        .with("--programs", args.programs)
        .with("--first", args.first)
        .with("--samples", args.samples)
        .with(COMMAND, args.command());
    for lane in lanes {
        identity = identity.with(&format!("lane `{}`", lane.name), &lane.driver);
    }
    identity
}

/// Runs one shard: program `k` of the run is done by shard `k mod N`.
///
/// # Errors
/// When a file cannot be written.
pub(super) fn run(
    args: &TortureArgs,
    shard: Shard,
    peers: &[Peer<'_>],
    summary: Summary,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> anyhow::Result<ExitStatus> {
    let store = Store::new(&args.sharing.shard_dir, shard, identity(args, shard, &summary.lanes))?;
    let json = args.format == Format::Json;
    store.run(json, (out, err), |saved: Option<ShardResult>| {
        let mut result = saved.unwrap_or_else(|| ShardResult { lanes: summary.lanes, ..ShardResult::default() });
        let own: Vec<u64> = (args.first..args.first.saturating_add(args.programs))
            .filter(|k| k % shard.count() == shard.index())
            .collect();
        let mut progress = Bar::new(!json);
        progress.start(&format!("shard {shard}"), "all lanes", Stage::Compute, own.len() as u64);
        for &index in own.iter().skip(result.done as usize) {
            if !result.found.program(index, peers, &args.asked()) {
                store.save(&result)?;
                return Ok(None);
            }
            result.done += 1;
            progress.at(result.done);
            if result.done.is_multiple_of(SAVED) {
                store.save(&result)?;
            }
        }
        progress.finish();
        if let Some(folder) = &args.out {
            write_all(folder, &result.found)?;
        }
        Ok(Some(result))
    })
}

impl Joined for ShardResult {
    fn join(&mut self, other: Self) -> anyhow::Result<()> {
        anyhow::ensure!(self.lanes == other.lanes, "the shards ran on different lanes");
        self.done += other.done;
        self.found.join(other.found)?;
        Ok(())
    }

    fn print(
        self,
        identity: &Identity,
        json: bool,
        _: bool,
        out: &mut dyn Write,
        err: &mut dyn Write,
    ) -> anyhow::Result<ExitStatus> {
        let command = identity.parameters.get(COMMAND).cloned().unwrap_or_default();
        let summary =
            Summary { seed: identity.seed, command, lanes: self.lanes, found: self.found, ..Summary::default() };
        conclude(&summary, json, out, err)
    }
}
