//! `fuzz --shard`: some of the functions, and what all of them are together.

use std::collections::BTreeSet;
use std::io::Write;

use serde::{Deserialize, Serialize};

use super::{FuzzArgs, IncludedText, Inputs, one_function, status_of};
use crate::cli::bar::Bar;
use crate::cli::check::Format;
use crate::cli::merge::Joined;
use crate::cli::shard::{Absent, Store};
use crate::cli::status::ExitStatus;
use base::text::fingerprint;
use engine::fuzz::{FunctionReport, Subject};
use engine::shard::{Identity, Shard};
use judge::profile::Promises;
use lanes::{Description, Lane, interrupt};
use report::fuzz::{FileReport, Summary, findings, json, line, totals};

/// What some shards found.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct ShardResult {
    lanes: Vec<Description>,
    unavailable: Absent,
    #[serde(default)]
    asked: BTreeSet<String>,
    files: Vec<Shared>,
}

/// Functions of a file, each with its number in the run.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Shared {
    file: String,
    functions: Vec<(u64, FunctionReport)>,
}

/// The name of the parameter that says whether notes are shown.
const NOTES: &str = "--notes";

/// Everything that the result of a run depends on.
fn identity(args: &FuzzArgs, shard: Shard, files: &[(&IncludedText, Vec<Subject>)], lanes: &[Description]) -> Identity {
    let mut identity = Identity::new("fuzz", args.input.seed, shard.count())
        .with("--samples", args.samples)
        .with(NOTES, args.notes)
        .with("--hostile", args.hostile)
        .with("--strict-integers", args.strict_integers)
        .with("--function", args.function.join(","))
        .with("--domain", args.input.domain.join("; "));
    for lane in lanes {
        identity = identity.with(&format!("lane `{}`", lane.name), &lane.driver);
    }
    for (source, _) in files {
        let text = fingerprint(source.file.text());
        identity = identity.with(&format!("file `{}`", source.name), format!("{text:016x}"));
    }
    identity
}

/// Runs one shard: function `k` of the run is done by shard `k mod N`.
///
/// # Errors
/// When a domain is wrong, or a file cannot be written.
#[expect(clippy::too_many_arguments, reason = "all that the command has set up")]
pub fn run(
    args: &FuzzArgs,
    shard: Shard,
    files: &[(&IncludedText, Vec<Subject>)],
    lanes: &[(&dyn Lane, Promises)],
    inputs: &mut Inputs<'_>,
    summary: Summary,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> anyhow::Result<ExitStatus> {
    let store = Store::new(&args.sharing.shard_dir, shard, identity(args, shard, files, &summary.lanes))?;
    let json = args.format == Format::Json;
    store.run(json, (out, err), |saved: Option<ShardResult>| {
        let mut found = saved.unwrap_or_else(|| ShardResult {
            lanes: summary.lanes,
            unavailable: Absent::new(summary.unavailable),
            asked: summary.asked.into_iter().collect(),
            files: files.iter().map(|(s, _)| Shared { file: s.name.clone(), functions: Vec::new() }).collect(),
        });
        let mut progress = Bar::new(!json);
        let mut number = 0;
        for (at, (source, subjects)) in files.iter().enumerate() {
            for subject in subjects {
                // Also where another shard runs the function: a domain that is wrong is told by all.
                let domain = inputs.domain(subject)?;
                let mine = number % shard.count() == shard.index();
                if mine && found.files[at].functions.iter().all(|(done, _)| *done != number) {
                    let function = one_function(args, source, subject, &domain, lanes, &mut progress)?;
                    // What a signal cut short is run again.
                    if interrupt::asked() {
                        return Ok(None);
                    }
                    found.files[at].functions.push((number, function));
                    store.save(&found)?;
                }
                number += 1;
            }
        }
        inputs.all_used()?;
        progress.finish();
        Ok(Some(found))
    })
}

impl Joined for ShardResult {
    fn join(&mut self, other: Self) -> anyhow::Result<()> {
        anyhow::ensure!(self.lanes == other.lanes, "the shards ran on different lanes");
        self.unavailable.join(other.unavailable);
        self.asked.extend(other.asked);
        let names = |found: &[Shared]| found.iter().map(|file| file.file.clone()).collect::<Vec<_>>();
        anyhow::ensure!(names(&self.files) == names(&other.files), "the shards ran different files");
        for (one, other) in self.files.iter_mut().zip(other.files) {
            one.functions.extend(other.functions);
            one.functions.sort_by_key(|(number, _)| *number);
        }
        Ok(())
    }

    fn print(
        self,
        identity: &Identity,
        as_json: bool,
        color: bool,
        out: &mut dyn Write,
        err: &mut dyn Write,
    ) -> anyhow::Result<ExitStatus> {
        let notes = identity.parameters.get(NOTES).is_some_and(|notes| notes == "true");
        let mut summary = Summary { seed: identity.seed, lanes: self.lanes, ..Summary::default() };
        summary.unavailable = self.unavailable.known();
        summary.asked = self.asked.into_iter().collect();
        let many = self.files.len() > 1;
        for Shared { file, functions } in self.files {
            if many && !as_json {
                writeln!(out, "{file}")?;
            }
            let functions: Vec<FunctionReport> = functions.into_iter().map(|(_, function)| function).collect();
            for function in functions.iter().filter(|_| !as_json) {
                out.write_all(line(function, color).as_bytes())?;
            }
            summary.files.push(FileReport { file, functions, ..FileReport::default() });
        }
        if as_json {
            out.write_all(json(&summary).as_bytes())?;
        } else {
            for file in &summary.files {
                out.write_all(findings(file, notes, color).as_bytes())?;
            }
            writeln!(out)?;
            out.write_all(totals(&summary, notes, color).as_bytes())?;
        }
        status_of(&summary, err)
    }
}
