//! `shadercheck merge`: joins what the shards of a run found.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use serde_json::Value;

use super::reported::{self, Reported};
use super::shard::{Printed, Printing};
use super::status::ExitStatus;
use super::{calibrate, check, compare, fuzz, improve, mutate, refdata, torture, tune};
use base::text::Shown;
use disk::fresh;
use engine::shard::{self, Identity, Sealed, Shard, Sort};

/// Arguments of `shadercheck merge`.
#[derive(Args, Clone, Debug, Default)]
#[command(after_long_help = "\
A folder stands for the results of shards in it, shard-I-of-N.json. Every shard must be there once, and all must \
be of one run: the same command, version, seed and parameters. The report and the exit status are those of the \
run without shards.

With --out, the joined result is also written to a file, which may be joined again, so that 10000 results can be \
joined in groups. Shards may then be missing.

For reference data (`refdata generate --shard`), the parts are listed with the SHA-256 of the whole, which is \
that of the run without shards; readers take a folder of Parquet files as one data set. --out FILE writes the \
file of the run without shards, in the format of its extension (npz, parquet, csv, json, h); a folder gets one \
file for each suite.")]
pub struct MergeArgs {
    /// Folders and files with results [default: the folder `shards`]
    #[arg(value_name = "DIR|FILE")]
    pub paths: Vec<PathBuf>,
    /// Write the joined result to this file, even if shards are missing
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Format of the result
    #[arg(long, value_parser = reported::parser(), default_value = "text")]
    pub format: Reported,
}

/// A result and the file that it was read from.
type Read = (PathBuf, Sealed<Value>);

/// Runs the command.
///
/// # Errors
/// When a file cannot be read or is damaged, a shard is missing or there twice, or the shards are not of one run.
pub fn run(args: &MergeArgs, out: &mut dyn Write, err: &mut dyn Write, color: bool) -> anyhow::Result<ExitStatus> {
    let paths = if args.paths.is_empty() { vec![PathBuf::from("shards")] } else { args.paths.clone() };
    let data = refdata::join::parts(&paths)?;
    let results: Vec<PathBuf> = files(&paths)?.into_iter().filter(|file| !data.contains(file)).collect();
    if let (Some(data), Some(result)) = (data.first(), results.first()) {
        anyhow::bail!(
            "`{}` is a part of reference data, and `{}` is none; merge them one after the other",
            data.shown(),
            result.shown()
        );
    }
    if !data.is_empty() {
        return refdata::join::run(args, data, out);
    }
    let mut all: Vec<Read> = Vec::new();
    for file in results {
        let name = file.shown();
        let text = fs::read_to_string(&file).with_context(|| format!("cannot read `{name}`"))?;
        let sealed: Sealed<Value> = shard::open(&text).with_context(|| format!("`{name}`"))?;
        anyhow::ensure!(
            sealed.sort == Sort::Result,
            "`{name}` is a checkpoint of a shard that did not end; run it again"
        );
        all.push((file, sealed));
    }
    let Some((first, rest)) = all.split_first() else {
        let folders: Vec<String> = paths.iter().map(|p| format!("`{}`", p.shown())).collect();
        anyhow::bail!(
            "{} holds no results of shards (shard-*.json), and no parts of reference data",
            folders.join(", ")
        );
    };
    let identity = first.1.identity.clone();
    for (file, sealed) in rest {
        identity
            .same(&sealed.identity)
            .with_context(|| format!("`{}` and `{}` are of different runs", first.0.shown(), file.shown()))?;
    }
    let here = Identity::new("", 0, 1).version;
    anyhow::ensure!(
        identity.version == here,
        "the results are of version {} of the tool, and this is version {here}; merge with the same version",
        identity.version
    );
    let covers = covered(&all)?;
    let missing: Vec<u64> = (0..identity.shards).filter(|index| !covers.contains_key(index)).collect();
    if !missing.is_empty() && args.out.is_none() {
        anyhow::bail!("{}", missing_parts(&missing, &identity, &paths));
    }
    let covers: Vec<u64> = covers.into_keys().collect();
    let merge = Merge { args, identity, covers, missing, paths: &paths, color };
    // The others find no faults at a place.
    let told = ["check", "compare", compare::OF_TWINS, "fuzz"];
    if let Reported::Service(service) = args.format
        && !told.contains(&merge.identity.command.as_str())
    {
        let command = &merge.identity.command;
        anyhow::bail!("a result of `{command}` has no findings for `{}`: --format is text or json", service.name);
    }
    match merge.identity.command.as_str() {
        "check" => merge.of::<check::ShardResult>(all, out, err),
        "compare" => merge.of::<compare::ShardResult>(all, out, err),
        compare::OF_TWINS => merge.of::<compare::TwinsResult>(all, out, err),
        "improve" => merge.of::<improve::ShardResult>(all, out, err),
        "tune" => merge.of::<tune::ShardResult>(all, out, err),
        "fuzz" => merge.of::<fuzz::ShardResult>(all, out, err),
        "mutate" => merge.of::<mutate::ShardResult>(all, out, err),
        "torture" => merge.of::<torture::ShardResult>(all, out, err),
        "calibrate" => merge.of::<calibrate::ShardResult>(all, out, err),
        other => anyhow::bail!("the results are of the command `{other}`, which this version cannot merge"),
    }
}

struct Merge<'a> {
    args: &'a MergeArgs,
    identity: Identity,
    covers: Vec<u64>,
    missing: Vec<u64>,
    paths: &'a [PathBuf],
    color: bool,
}

impl Merge<'_> {
    fn of<T: Printed>(self, all: Vec<Read>, out: &mut dyn Write, err: &mut dyn Write) -> anyhow::Result<ExitStatus> {
        let mut joined: Option<T> = None;
        for (file, sealed) in all {
            let found: T =
                serde_json::from_value(sealed.found).with_context(|| format!("cannot read `{}`", file.shown()))?;
            match &mut joined {
                None => joined = Some(found),
                Some(joined) => joined.join(found).with_context(|| format!("`{}`", file.shown()))?,
            }
        }
        let Some(joined) = joined else { return Ok(ExitStatus::Error) };
        if let Some(path) = &self.args.out {
            let (identity, covers) = (self.identity.clone(), self.covers.clone());
            let text = shard::seal(&Sealed { sort: Sort::Result, identity, covers, found: &joined })?;
            fresh::write(path, text.as_bytes()).with_context(|| format!("cannot write `{}`", path.shown()))?;
        }
        if !self.missing.is_empty() {
            writeln!(err, "note: {}", missing_parts(&self.missing, &self.identity, self.paths))?;
            return Ok(ExitStatus::Clean);
        }
        let (identity, format, color) = (&self.identity, self.args.format, self.color);
        let (live, interrupted) = (false, None);
        let status = joined.print(Printing { identity, format, color, live, interrupted, out: &mut *out, err })?;
        out.flush()?;
        Ok(status)
    }
}

/// The files that the arguments name, those of a folder by name.
fn files(paths: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let mut all = Vec::new();
    for path in paths {
        if !path.is_dir() {
            all.push(path.clone());
            continue;
        }
        let begin = all.len();
        let entries = fs::read_dir(path).with_context(|| format!("cannot read the folder `{}`", path.shown()))?;
        for entry in entries {
            let entry = entry.with_context(|| format!("cannot read the folder `{}`", path.shown()))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.starts_with("shard-") && name.ends_with(".json") {
                all.push(entry.path());
            }
        }
        all[begin..].sort();
    }
    Ok(all)
}

/// The shards that are there, each with its file. One that is there twice is refused.
fn covered(all: &[Read]) -> anyhow::Result<BTreeMap<u64, &Path>> {
    let mut covers: BTreeMap<u64, &Path> = BTreeMap::new();
    for (file, sealed) in all {
        let count = sealed.identity.shards;
        for &index in &sealed.covers {
            Shard::new(index, count).with_context(|| format!("`{}`", file.shown()))?;
            if let Some(other) = covers.insert(index, file) {
                anyhow::bail!("shard {index}/{count} is there twice: in `{}` and in `{}`", other.shown(), file.shown());
            }
        }
    }
    Ok(covers)
}

/// Shards that are named before the rest is counted.
const NAMED: usize = 10;

fn missing_parts(missing: &[u64], identity: &Identity, paths: &[PathBuf]) -> String {
    let count = identity.shards;
    let begun = |&index: &u64| {
        let stem = Shard::new(index, count).map(Shard::stem).unwrap_or_default();
        paths.iter().any(|path| path.join(format!("{stem}.checkpoint")).exists())
    };
    let name = |index: &u64| format!("{index}{}", if begun(index) { " (begun)" } else { "" });
    let mut names: Vec<String> = missing.iter().take(NAMED).map(name).collect();
    if missing.len() > NAMED {
        names.push(format!("{} more", missing.len() - NAMED));
    }
    format!(
        "of {count} shards {} {} missing: {}; run each again with --shard {}/{count} and the same arguments",
        missing.len(),
        if missing.len() == 1 { "is" } else { "are" },
        names.join(", "),
        missing.first().copied().unwrap_or_default()
    )
}
