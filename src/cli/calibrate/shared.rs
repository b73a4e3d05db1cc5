//! `calibrate --shard`: part of the samples of each operation, and what all parts are together.

use std::io::Write;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{CalibrateArgs, Ending, bar, conclude, open, request};
use crate::cli::check::Format;
use crate::cli::shard::{Earlier, Printed, Printing, Store};
use crate::cli::status::ExitStatus;
use engine::calibrate::{self, State};
use engine::session::{Join, Unlike};
use engine::shard::{Identity, Shard};
use judge::profile::Op;
use lanes::Lane;

/// What some shards measured.
#[derive(Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ShardResult(State);

const LANE: &str = "--lane";
const OUTPUT: &str = "--output";

/// Runs one shard.
///
/// # Errors
/// When the device fails, or a file cannot be written.
pub fn run(
    args: &CalibrateArgs,
    shard: Shard,
    ops: &[Op],
    lane: &dyn Lane,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> anyhow::Result<ExitStatus> {
    let description = lane.description();
    let names: Vec<&str> = ops.iter().map(|op| op.name()).collect();
    let output = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}.profile.toml", description.name)));
    let identity = Identity::new("calibrate", 0, shard.count())
        .with(LANE, description.name)
        .with("driver", &description.driver)
        .with("--builtin", names.join(","))
        .with("--exhaustive", args.exhaustive)
        .with("--samples", args.samples)
        .with("--search", args.searched())
        .with(OUTPUT, output.display());
    let store = Store::new(&args.sharing.shard_dir, shard, identity)?;
    let json = args.format == Format::Json;
    let Earlier::Reached(saved) = store.earlier::<State, State>(json, (out, err))? else {
        return Ok(ExitStatus::Clean);
    };
    let request = request(args, ops, lane, shard);
    let mut state = match saved {
        Some(saved) => saved.resume(&request)?,
        None => State::new(request.clone()),
    };
    let bar = bar(!json, request.total());
    bar.set_position(state.done());
    calibrate::run(lane, &mut state, &mut |state, op| {
        bar.set_message(op.name());
        bar.set_position(state.done());
        store.save(state).map_err(|error| std::io::Error::other(format!("{error:#}")))
    })?;
    bar.finish_and_clear();
    store.conclude(Some(&state), json, (out, err))
}

impl Join for ShardResult {
    fn join(&mut self, other: Self) -> Result<(), Unlike> {
        self.0.join(other.0).map_err(|error| Unlike(error.to_string()))
    }
}

impl Printed for ShardResult {
    /// Needs the device: its behaviours are probed, and its definitions confirmed.
    fn print(self, to: Printing<'_>) -> anyhow::Result<ExitStatus> {
        let parameter = |name: &str| to.identity.parameters.get(name);
        let lane = open(parameter(LANE), to.err)?;
        let (here, measured) = (&lane.description().driver, &self.0.request().driver);
        anyhow::ensure!(
            here == measured,
            "the shards measured {measured}, and this machine has {here}; merge where the device is"
        );
        let output = PathBuf::from(parameter(OUTPUT).map_or("measured.profile.toml", String::as_str));
        let ending = Ending { output: Some(&output), json: !to.format.is_text(), ..Ending::default() };
        conclude(&self.0, lane.as_ref(), &ending, to.out)
    }
}
