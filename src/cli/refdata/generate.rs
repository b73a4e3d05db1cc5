//! `shadercheck refdata generate`.

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::files;
use super::item::{self, Item};
use super::work::Work;
use crate::cli::check::profile;
use crate::cli::shard::ShardArgs;
use crate::cli::status::ExitStatus;
use base::text::Shown;
use disk::fresh::{self, Fresh};
use engine::shard::Shard;
use engine::suite::Expect;
use engine::suite::run::{DEFAULT_SEED, prepare};
use judge::profile::Profile;
use refdata::read::Sequence;
use refdata::write::{Format, Spill, Store};
use refdata::{Document, Forget, Generator, Subject, copy, produce, scene};

/// Arguments of `shadercheck refdata generate`.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = "\
Expected outputs are real numbers, computed with some 100 bits and rounded once to binary64, for suites with a \
shipped formula; for suites with a reference or recorded values, the meaning of that shader in binary64, or \
those values; for all others, the meaning of the shader itself in binary64. The provenance gives the source and \
its accuracy. The same arguments give the same bytes on every machine.

A shader stands for the suites beside it that are about it. If there are none, each of its functions, or its \
stage, is a data set of its own, with inputs as in `fuzz`: from the domains that comments or --domain state, or \
else of ordinary sizes.

The page \"Reference data\" of the book (`docs/book/src/refdata.md`) describes the files.")]
pub struct GenerateArgs {
    /// Shipped suites by name, suite files (*.suite.toml), shaders, and folders
    #[arg(value_name = "SUITE|FILE", required = true)]
    pub suites: Vec<String>,
    /// Format of the files
    #[arg(long, value_enum, default_value_t = FormatArg::Npz)]
    pub format: FormatArg,
    /// A file, a device or pipe, or a folder for files with the names of their suites
    #[arg(long, short, value_name = "FILE|DIR")]
    pub output: PathBuf,
    /// Samples per suite [default: from the suite; 65536 for a shader without one]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub samples: Option<u64>,
    /// Seed of the inputs: the same seed gives the same inputs everywhere
    #[arg(long, value_name = "S", default_value_t = DEFAULT_SEED)]
    pub seed: u64,
    /// Profile for bounds: a shipped one by name, a file that `calibrate` wrote, or `none`. The default goes beyond the
    /// promises of the API: it uses what hardware does where `vulkan-1.4` promises nothing
    #[arg(long, value_name = "NAME|FILE", default_value = "vulkan-practice")]
    pub profile: String,
    /// For shaders without a suite: only functions of this name, or one overload by its types
    #[arg(long, value_name = "NAME")]
    pub function: Vec<String>,
    /// For shaders without a suite: values of an input, as for `fuzz`: `x=[0,1]`, `n=normalised`
    #[arg(long, value_name = "INPUT=DOMAIN", allow_hyphen_values = true)]
    pub domain: Vec<String>,
    /// For shaders without a suite: folders to search for included files
    #[arg(short = 'I', long = "include", value_name = "FOLDER")]
    pub include: Vec<PathBuf>,
    /// Write one part of the samples, I of N, counted from 0, to a file of its own in the folder; `auto` takes I and N
    /// from the environment, as for `check`. A part that was stopped continues when it is run again; `shadercheck
    /// merge` joins the parts
    #[arg(long, value_name = "I/N|auto")]
    pub shard: Option<String>,
}

/// Format of the files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FormatArg {
    /// Bits as text, with decimals beside them
    Json,
    /// Arrays of NumPy
    Npz,
    /// Columns of Apache Parquet
    Parquet,
    /// A header for C and C++; not with --shard
    C,
    /// A table
    Csv,
    /// A scene in glTF 2.0, for formulas that describe geometry; samples are the approximate number of vertices
    Glb,
}

impl FormatArg {
    /// The format of samples; none for a scene.
    fn format(self) -> Option<Format> {
        match self {
            Self::Json => Some(Format::Json),
            Self::Npz => Some(Format::Npz),
            Self::Parquet => Some(Format::Parquet),
            Self::C => Some(Format::C),
            Self::Csv => Some(Format::Csv),
            Self::Glb => None,
        }
    }

    /// Its name, and the endings of its files.
    fn endings(self) -> (&'static str, &'static [&'static str]) {
        match self {
            Self::Json => ("json", &["json"]),
            Self::Npz => ("npz", &["npz"]),
            Self::Parquet => ("parquet", &["parquet"]),
            Self::C => ("c", &["h", "hpp"]),
            Self::Csv => ("csv", &["csv"]),
            Self::Glb => ("glb", &["glb"]),
        }
    }
}

/// Vertices of a scene when none are asked for.
const VERTICES: u64 = 2048;

/// Runs the command.
///
/// # Errors
/// When a suite, a profile or the shader is wrong, or a file cannot be written; nothing is left under its
/// name then.
pub fn run(args: &GenerateArgs, out: &mut dyn Write, err: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let sharing = ShardArgs { shard: args.shard.clone(), ..ShardArgs::default() };
    let shard = sharing.shard()?;
    anyhow::ensure!(
        shard.is_none() || args.format != FormatArg::Glb,
        "--shard shares out samples, and a scene has none; leave it out"
    );
    anyhow::ensure!(
        shard.is_none() || args.format != FormatArg::C,
        "--shard writes parts that are read again, and nothing reads a header; take npz, and \
         `shadercheck merge DIR --out FILE.h` writes the header"
    );
    let profile = profile::named(&args.profile)?;
    let items = item::items(args, err)?;
    let names: Vec<&str> = items.iter().map(Item::name).collect();
    let paths = paths(&args.output, &names, args.format, shard)?;
    for (item, path) in items.iter().zip(paths) {
        let Some(format) = args.format.format() else {
            let bytes = scene::scene(item.formula(), args.samples.unwrap_or(VERTICES))?;
            let written = write(&path, |mut store| store.write_all(&bytes));
            written.with_context(|| format!("cannot write `{}`", path.shown()))?;
            writeln!(out, "{}  glTF 2.0, {} bytes", path.shown(), bytes.len())?;
            continue;
        };
        match item {
            Item::Suite(selected) => {
                let prepared = prepare(&selected.suite, &selected.shader)?;
                if prepared.program.is_large() {
                    let name = &prepared.suite.name;
                    let why = "no reference data is made of a dispatch whose buffers hold 4,096 words or more";
                    anyhow::ensure!(items.len() > 1, "`{name}`: {why}; name a smaller size");
                    writeln!(err, "note: `{name}` is left out: {why}")?;
                    continue;
                }
                let own = match prepared.suite.expect {
                    Expect::Recorded(_) => prepared.rows.len() as u64,
                    Expect::Formula(_) | Expect::Reference(_) | Expect::Nothing => prepared.suite.samples,
                };
                let samples = args.samples.unwrap_or(own);
                let job = Job { args, profile: profile.as_deref(), format, path: &path, shard };
                job.run(Subject::from(&prepared), samples, out, err)?;
            }
            Item::Bare(bare) => {
                let job = Job { args, profile: profile.as_deref(), format, path: &path, shard };
                job.run(Subject::from(&**bare), args.samples.unwrap_or(item::SAMPLES), out, err)?;
            }
        }
        err.flush()?;
    }
    Ok(ExitStatus::Clean)
}

/// One file that is to be written.
struct Job<'a> {
    args: &'a GenerateArgs,
    profile: Option<&'a Profile>,
    format: Format,
    path: &'a Path,
    shard: Option<Shard>,
}

impl Job<'_> {
    fn run(&self, subject: Subject<'_>, samples: u64, out: &mut dyn Write, err: &mut dyn Write) -> anyhow::Result<()> {
        let path = self.path.shown();
        let failed = || format!("cannot write `{path}`");
        let generator = Generator::new(subject, self.profile, samples, self.args.seed)?;
        let blocks = self.shard.unwrap_or(Shard::WHOLE).range(generator.blocks());
        let document = generator.document(&blocks);
        let rows = generator.rows_of(&blocks);
        let name = subject.name();
        if self.shard.is_some()
            && let Some(digest) = self.finished(&document, err)?
        {
            writeln!(out, "{path}  {rows} samples  sha256 {digest}  (was done before)")?;
            return Ok(());
        }
        let bar = bar(name, rows);
        let format = self.format;
        let digest = match self.shard {
            None => write(self.path, |store| {
                let mut sink = format.sink(&document, store, &spill)?;
                produce(&generator, blocks.clone(), &mut *sink, &Forget, &mut |done| bar.set_position(done))
            }),
            Some(shard) => {
                let work = Work::open(self.path, &document.line(), &generator).with_context(failed)?;
                let done = work.done(blocks.clone());
                if done > 0 {
                    writeln!(
                        err,
                        "note: shard {shard} of `{name}` goes on: {done} of its {} blocks are there",
                        blocks.end - blocks.start
                    )?;
                }
                let mut fresh = Fresh::within(work.folder(), self.path).with_context(failed)?;
                fresh.sync_early().with_context(failed)?;
                let store: Box<dyn Store> = Box::new(fresh.file().with_context(failed)?);
                let digest = format.sink(&document, store, &spill).and_then(|mut sink| {
                    produce(&generator, blocks.clone(), &mut *sink, &work, &mut |done| bar.set_position(done))
                });
                digest.and_then(|digest| fresh.keep().and_then(|()| work.remove()).map(|()| digest))
            }
        };
        bar.finish_and_clear();
        let digest = digest.with_context(failed)?;
        writeln!(out, "{path}  {rows} samples  sha256 {digest}")?;
        if generator.apart() > 0 {
            let what = if matches!(subject, Subject::Suite(_)) {
                format!("; `shadercheck check {name}` tells where")
            } else {
                String::new()
            };
            writeln!(
                err,
                "warning: `{name}`: for {} of {rows} samples the shader gives something else than is expected, by more \
                 than its bound{what}",
                generator.apart()
            )?;
        }
        Ok(())
    }

    /// The digest of the part, if it is there as a whole. One that is damaged is made again.
    fn finished(&self, document: &Document, err: &mut dyn Write) -> anyhow::Result<Option<String>> {
        let path = self.path.shown();
        if !self.path.exists() {
            return Ok(None);
        }
        let read = files::blocks(self.path).and_then(|mut blocks| {
            let known = blocks.document().clone();
            if known.same_run(document).is_ok() {
                copy(&mut blocks, None, &mut |_| {})?;
            }
            Ok(known)
        });
        let known = match read {
            Ok(known) => known,
            Err(error) => {
                writeln!(err, "note: `{path}` is not used, and made again: {error:#}")?;
                return Ok(None);
            }
        };
        if let Err(what) = known.same_run(document) {
            anyhow::bail!(
                "`{path}` is of another run, this run being the one and the file the other: {what}; remove it, or give \
                 another --output"
            );
        }
        anyhow::ensure!(
            (known.first, known.rows) == (document.first, document.rows),
            "`{path}` is of another shard; remove it, or give another --output"
        );
        Ok(Some(known.sha256))
    }
}

/// Writes a file that appears when it is whole.
pub(super) fn write<T>(path: &Path, fill: impl FnOnce(Box<dyn Store>) -> io::Result<T>) -> io::Result<T> {
    let mut fresh = Fresh::new(path)?;
    fresh.sync_early()?;
    let done = fill(Box::new(fresh.file()?))?;
    fresh.keep()?;
    Ok(done)
}

pub(super) fn spill() -> io::Result<Box<dyn Spill>> {
    Ok(Box::new(tempfile::tempfile()?))
}

/// The file of each suite.
fn paths(output: &Path, names: &[&str], format: FormatArg, shard: Option<Shard>) -> anyhow::Result<Vec<PathBuf>> {
    let (format, endings) = format.endings();
    let streamed = fresh::is_stream(output);
    if streamed || (!output.is_dir() && output.extension().is_some()) {
        anyhow::ensure!(
            shard.is_none(),
            "--shard writes a file for each part; name a folder in place of `{}`",
            output.shown()
        );
        anyhow::ensure!(
            names.len() == 1,
            "{} data sets do not go into the one file `{}`; name a folder ({})",
            names.len(),
            output.shown(),
            names.join(", ")
        );
        let ending = output.extension().unwrap_or_default().to_string_lossy();
        anyhow::ensure!(
            streamed || endings.contains(&&*ending),
            "`{}` does not end in `.{}`, which files of the format `{format}` do; --format chooses another",
            output.shown(),
            endings[0]
        );
        return Ok(vec![output.to_owned()]);
    }
    std::fs::create_dir_all(output).with_context(|| format!("cannot make the folder `{}`", output.shown()))?;
    // The parts of a suite lie in a folder of their own, which is a data set as a whole.
    let file = |name: &&str| match shard {
        None => PathBuf::from(format!("{}.{}", plain(name), endings[0])),
        Some(shard) => Path::new(&plain(name)).join(format!("{}.{}", shard.stem(), endings[0])),
    };
    let paths: Vec<PathBuf> = names.iter().map(|name| output.join(file(name))).collect();
    for (k, path) in paths.iter().enumerate() {
        anyhow::ensure!(!paths[..k].contains(path), "two suites would be written to `{}`", path.shown());
        if let Some(folder) = path.parent() {
            let failed = || format!("cannot make the folder `{}`", folder.shown());
            std::fs::create_dir_all(folder).with_context(failed)?;
        }
    }
    Ok(paths)
}

/// A name as a file may have it.
pub(super) fn plain(name: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || "-_=,.".contains(c) { c } else { '_' };
    name.chars().map(plain).collect()
}

/// A bar on standard error; hidden when it is no terminal.
pub(super) fn bar(suite: &str, samples: u64) -> ProgressBar {
    let shown = io::stderr().is_terminal();
    let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(samples), target);
    if let Ok(style) = ProgressStyle::with_template("{msg:20} [{bar:30}] {human_pos}/{human_len} {per_sec} {eta} left")
    {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_message(suite.to_owned());
    bar
}
