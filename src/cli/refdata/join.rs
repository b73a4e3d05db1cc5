//! `shadercheck merge` for parts of reference data.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde_json::json;

use super::{files, generate};
use crate::cli::merge::MergeArgs;
use crate::cli::reported::Reported;
use crate::cli::status::ExitStatus;
use base::text::Shown as _;
use disk::fresh;
use refdata::read::{InputFormat, Sequence};
use refdata::write::Format;
use refdata::{CopyError, Document, copy};

/// The parts of reference data that these paths name: files, and folders with parts in them or in the folders
/// of their suites.
///
/// # Errors
/// When a folder cannot be read.
pub fn parts(paths: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let mut all = Vec::new();
    for path in paths {
        if !path.is_dir() {
            if is_part(path, false) {
                all.push(path.clone());
            }
            continue;
        }
        let mut folders = vec![path.clone()];
        let failed = || format!("cannot read the folder `{}`", path.shown());
        for entry in fs::read_dir(path).with_context(failed)? {
            let entry = entry.with_context(failed)?;
            let hidden = entry.file_name().to_string_lossy().starts_with('.');
            if !hidden && entry.path().is_dir() {
                folders.push(entry.path());
            }
        }
        folders.sort();
        for folder in folders {
            all.extend(files::parts(&folder)?.into_iter().filter(|file| is_part(file, true)));
        }
    }
    Ok(all)
}

/// True for a file of reference data; in a folder, only for one that is called as a part is.
fn is_part(path: &Path, named: bool) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    match InputFormat::of_name(&name) {
        Some(InputFormat::Npz | InputFormat::Parquet | InputFormat::Csv) => !named || name.starts_with("shard-"),
        // The results of other commands are JSON too.
        Some(InputFormat::Json) => (!named || name.starts_with("shard-")) && begins_with(path, b"{\"provenance\""),
        Some(InputFormat::Raw) | None => false,
    }
}

fn begins_with(path: &Path, beginning: &[u8]) -> bool {
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(beginning.len() as u64).read_to_end(&mut bytes));
    read.is_ok() && bytes == beginning
}

/// Shards that are named.
const NAMED: usize = 10;

/// The files of each suite with their documents.
type Suites = BTreeMap<String, (Vec<PathBuf>, Vec<(String, Document)>)>;

/// What became of one data set.
struct Joined {
    document: Document,
    parts: Vec<PathBuf>,
    file: Option<PathBuf>,
}

/// Joins parts, or looks whether they are whole.
///
/// # Errors
/// When a part cannot be read or is damaged, is missing, doubled or of another run, or the joined file cannot be
/// written.
pub fn run(args: &MergeArgs, paths: Vec<PathBuf>, out: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let mut suites = Suites::new();
    for (path, document) in paths.iter().zip(files::documents(&paths)?) {
        let suite = suites.entry(document.1.suite.name.clone()).or_default();
        suite.0.push(path.clone());
        suite.1.push(document);
    }
    let targets = targets(args.out.as_deref(), &suites)?;
    let mut all = Vec::new();
    for ((name, (paths, documents)), file) in suites.iter().zip(targets) {
        let reported = || format!("`{name}`{}", begun(paths));
        let mut chain = files::chain(paths, documents).with_context(reported)?;
        let order = chain.order().to_vec();
        let bar = generate::bar(name, chain.document().rows);
        let mut progress = |done| bar.set_position(done);
        let document = match &file {
            None => copy(&mut chain, None, &mut progress).with_context(reported)?,
            Some((path, format)) => joined(&mut chain, path, *format, &mut progress).with_context(reported)?,
        };
        bar.finish_and_clear();
        let parts = order.iter().map(|&k| paths[k].clone()).collect();
        all.push(Joined { document, parts, file: file.map(|(path, _)| path) });
    }
    match args.format {
        Reported::Text => text(&all, out)?,
        Reported::Json => writeln!(out, "{:#}", listing(&all))?,
        Reported::Service(service) => {
            anyhow::bail!("reference data has no findings for `{}`: --format is text or json", service.name)
        }
    }
    out.flush()?;
    Ok(ExitStatus::Clean)
}

/// Writes the joined file, which is the one of the run without shards.
fn joined(
    chain: &mut dyn Sequence,
    path: &Path,
    format: Format,
    progress: &mut dyn FnMut(u64),
) -> anyhow::Result<Document> {
    let failed = || format!("cannot write `{}`", path.shown());
    let begin = chain.document().without_digest();
    let mut unread = None;
    let written = generate::write(path, |store| {
        let mut sink = format.sink(&begin, store, &generate::spill)?;
        match copy(chain, Some(&mut *sink), progress) {
            Ok(document) => Ok(document),
            Err(CopyError::Write(error)) => Err(error),
            Err(CopyError::Read(error)) => {
                unread = Some(error);
                Err(io::Error::other("a part cannot be read"))
            }
        }
    });
    match unread {
        Some(error) => Err(error.into()),
        None => written.with_context(failed),
    }
}

/// The joined file of each suite, if one is asked for.
fn targets(out: Option<&Path>, suites: &Suites) -> anyhow::Result<Vec<Option<(PathBuf, Format)>>> {
    let Some(out) = out else { return Ok(suites.iter().map(|_| None).collect()) };
    let format = |path: &Path| {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        let known = Format::ALL.into_iter().find(|format| format.name() == ending);
        known.or_else(|| matches!(&*ending, "h" | "hpp").then_some(Format::C))
    };
    let streamed = fresh::is_stream(out);
    if streamed || (!out.is_dir() && out.extension().is_some()) {
        anyhow::ensure!(
            suites.len() == 1,
            "{} suites do not go into the one file `{}`; name a folder ({})",
            suites.len(),
            out.shown(),
            suites.keys().map(String::as_str).collect::<Vec<_>>().join(", ")
        );
        // A device has no ending: it gets the format of the parts.
        let named = suites.values().filter(|_| streamed).find_map(|(paths, _)| paths.first()).map_or(out, |part| part);
        let format = format(named).with_context(|| {
            format!("the ending of `{}` names no format; there are npz, parquet, csv, json and h", out.shown())
        })?;
        return Ok(vec![Some((out.to_owned(), format))]);
    }
    fs::create_dir_all(out).with_context(|| format!("cannot make the folder `{}`", out.shown()))?;
    let target = |(name, (paths, _)): (&String, &(Vec<PathBuf>, _))| {
        let ending = paths.first()?.extension()?.to_string_lossy().into_owned();
        let path = out.join(format!("{}.{ending}", generate::plain(name)));
        let format = format(&path)?;
        Some((path, format))
    };
    Ok(suites.iter().map(target).collect())
}

/// The number of a part, and of how many, by its name.
fn number(path: &Path) -> Option<(u64, u64)> {
    let stem = path.file_stem()?.to_str()?;
    let (index, count) = stem.strip_prefix("shard-")?.split_once("-of-")?;
    Some((index.parse().ok()?, count.parse().ok()?))
}

/// What to say of shards that are not there, or were begun.
fn begun(paths: &[PathBuf]) -> String {
    let mut said = String::new();
    let numbers: Option<Vec<(u64, u64)>> = paths.iter().map(|path| number(path)).collect();
    if let Some(&[(_, count), ..]) = numbers.as_deref()
        && let Some(numbers) = numbers.filter(|all| all.iter().all(|(_, other)| *other == count))
    {
        let missing = (0..count).filter(|&index| !numbers.contains(&(index, count)));
        let names: Vec<String> = missing.map(|index| format!("{index}/{count}")).take(NAMED).collect();
        if !names.is_empty() {
            said = format!(", without shard {}", names.join(", "));
        }
    }
    let Some(folder) = paths.first().and_then(|path| path.parent()) else { return said };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .filter_map(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            Some(name.strip_prefix('.')?.strip_suffix(".work")?.to_owned())
        })
        .collect();
    names.sort();
    if !names.is_empty() {
        said = format!("{said} ({} is not whole yet)", names.join(", "));
    }
    said
}

fn text(all: &[Joined], out: &mut dyn Write) -> io::Result<()> {
    for Joined { document, parts, file } in all {
        let (name, rows, digest) = (&document.suite.name, document.rows, &document.sha256);
        let count = if parts.len() == 1 { "1 part".to_owned() } else { format!("{} parts", parts.len()) };
        writeln!(out, "{name}  {rows} samples in {count}  sha256 {digest}")?;
        match file {
            Some(file) => writeln!(out, "  {}", file.shown())?,
            None => parts.iter().try_for_each(|part| writeln!(out, "  {}", part.shown()))?,
        }
    }
    Ok(())
}

fn listing(all: &[Joined]) -> serde_json::Value {
    let each = |Joined { document, parts, file }: &Joined| {
        let parts: Vec<String> = parts.iter().map(|part| part.display().to_string()).collect();
        json!({
            "suite": document.suite.name, "samples": document.rows, "seed": document.seed,
            "sha256": document.sha256, "parts": parts, "file": file.as_ref().map(|file| file.display().to_string()),
        })
    };
    json!({ "datasets": all.iter().map(each).collect::<Vec<_>>() })
}
