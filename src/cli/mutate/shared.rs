//! `mutate --shard`: some of the mutants of every suite, and what all of them are together.

use std::io::Write;

use serde::{Deserialize, Serialize};

use super::{MutateArgs, Work, conclude};
use crate::cli::bar::Bar;
use crate::cli::check::Format;
use crate::cli::merge::Joined;
use crate::cli::shard::Store;
use crate::cli::status::ExitStatus;
use base::text::fingerprint;
use engine::mutate::{SuiteResult, Tested};
use engine::shard::{Identity, Shard};
use lanes::interrupt;
use report::mutate::Summary;

/// The name of the parameter with the lowest score that is no finding.
const FLOOR: &str = "--floor";

/// What some shards found.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct ShardResult {
    lane: String,
    suites: Vec<Shared>,
}

/// What became of a suite.
#[derive(Debug, Serialize, Deserialize)]
enum Shared {
    /// Mutants, each with its number in the suite.
    Tested { suite: String, shader: String, samples: u64, tested: Vec<(u64, Tested)> },
    /// No score can be given: the suite, and why.
    Failed { suite: String, why: String },
}

impl ShardResult {
    /// Adds the mutants of a shard.
    fn add(&mut self, shard: Shard, result: SuiteResult) {
        let SuiteResult { suite, shader, samples, tested } = result;
        let numbers = (0_u64..).map(|k| k * shard.count() + shard.index());
        self.suites.push(Shared::Tested { suite, shader, samples, tested: numbers.zip(tested).collect() });
    }
}

/// Runs one shard: some of the mutants of every suite.
///
/// # Errors
/// When a file cannot be read or written.
pub(super) fn run(
    work: &Work<'_>,
    shard: Shard,
    lane: &str,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> anyhow::Result<ExitStatus> {
    let mut texts = Vec::new();
    for one in work.selected {
        let text = format!("{}\n{:?}", work.shader(one)?.text(), one.suite);
        texts.push((format!("{} ({})", one.suite.name, one.argument), fingerprint(&text)));
    }
    let store = Store::new(&work.args.sharing.shard_dir, shard, identity(work.args, shard, lane, &texts))?;
    let json = work.args.format == Format::Json;
    store.run(json, (out, err), |saved: Option<ShardResult>| {
        let mut found = saved.unwrap_or_else(|| ShardResult { lane: lane.to_owned(), suites: Vec::new() });
        let mut progress = Bar::new(!json);
        for one in work.selected.iter().skip(found.suites.len()) {
            let result = work.suite(one, &mut progress)?;
            // Mutants that a signal left out are missing from a part.
            if interrupt::asked() {
                return Ok(None);
            }
            match result {
                Ok(result) => found.add(shard, result),
                Err(error) => {
                    found.suites.push(Shared::Failed { suite: one.suite.name.clone(), why: error.to_string() })
                }
            }
            store.save(&found)?;
        }
        progress.finish();
        Ok(Some(found))
    })
}

impl Joined for ShardResult {
    fn join(&mut self, other: Self) -> anyhow::Result<()> {
        anyhow::ensure!(self.lane == other.lane, "the shards ran on different lanes");
        anyhow::ensure!(self.suites.len() == other.suites.len(), "the shards ran different suites");
        for (one, other) in self.suites.iter_mut().zip(other.suites) {
            match (one, other) {
                (Shared::Tested { suite, tested, .. }, Shared::Tested { suite: same, tested: more, .. })
                    if *suite == same =>
                {
                    tested.extend(more);
                    tested.sort_by_key(|(number, _)| *number);
                }
                (Shared::Failed { suite, why }, Shared::Failed { suite: same, why: also }) if *suite == same => {
                    // Of two reasons one, whichever shard comes first.
                    if also < *why {
                        *why = also;
                    }
                }
                (Shared::Tested { suite, .. } | Shared::Failed { suite, .. }, _) => {
                    anyhow::bail!("suite `{suite}` passed on some shards and failed on others")
                }
            }
        }
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
        let mut summary = Summary { seed: identity.seed, lane: self.lane, ..Summary::default() };
        for suite in self.suites {
            match suite {
                Shared::Tested { suite, shader, samples, tested } => {
                    let tested = tested.into_iter().map(|(_, tested)| tested).collect();
                    summary.suites.push(SuiteResult { suite, shader, samples, tested });
                }
                Shared::Failed { suite, why } => {
                    writeln!(err, "error: {why}")?;
                    summary.failed.push((suite, why));
                }
            }
        }
        let floor = identity.parameters.get(FLOOR).and_then(|floor| floor.parse().ok()).unwrap_or(0.0);
        conclude(&summary, floor, json, out)
    }
}

/// Everything that the result of a run depends on.
fn identity(args: &MutateArgs, shard: Shard, lane: &str, texts: &[(String, u64)]) -> Identity {
    let mut identity = Identity::new("mutate", args.seed, shard.count())
        .with("--samples", args.samples)
        .with("--operator", args.operator.join(","))
        .with(FLOOR, args.floor)
        .with("lane", lane);
    for (suite, fingerprint) in texts {
        identity = identity.with(&format!("suite `{suite}`"), format!("{fingerprint:016x}"));
    }
    identity
}
