//! `shadercheck refdata generate`.

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::cli::check::profile;
use crate::cli::check::select::{self, Selected};
use crate::cli::fresh::Fresh;
use crate::cli::shard::ShardArgs;
use crate::cli::status::ExitStatus;
use crate::refdata::write::{Format, Spill, Store};
use crate::refdata::{Generator, produce, scene};
use crate::shard::Shard;
use crate::suite::Expect;
use crate::suite::run::{DEFAULT_SEED, prepare};

/// Arguments of `shadercheck refdata generate`.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = "\
Expected outputs are real numbers, computed with some 100 bits and rounded once to binary64 (suites with a \
formula that comes with shadercheck), or what the shader means in binary64 (all others). The same arguments \
give the same bytes on every machine.

`docs/refdata.md` tells what is in the files.")]
pub struct GenerateArgs {
    /// Shipped suites by name, suite files (*.suite.toml), shaders with a suite beside them, and folders
    #[arg(value_name = "SUITE|FILE", required = true)]
    pub suites: Vec<String>,
    /// Format of the files
    #[arg(long, value_enum, default_value_t = FormatArg::Npz)]
    pub format: FormatArg,
    /// A file, or a folder for files that are called as their suites are
    #[arg(long, short, value_name = "FILE|DIR")]
    pub output: PathBuf,
    /// Samples of each suite; what the suite says without it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub samples: Option<u64>,
    /// Seed of the inputs: the same seed gives the same inputs everywhere
    #[arg(long, value_name = "S", default_value_t = DEFAULT_SEED)]
    pub seed: u64,
    /// What bounds are derived from: a shipped profile by name, a file that `calibrate` wrote, or `none`
    #[arg(long, value_name = "NAME|FILE", default_value = "vulkan-1.4")]
    pub profile: String,
    /// Write one part of the samples, I of N, counted from 0, to a file of its own in the folder; `auto`
    /// takes I and N from the environment, as for `check`
    #[arg(long, value_name = "I/N|auto")]
    pub shard: Option<String>,
}

/// Format of the files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FormatArg {
    /// Bits as texts with the decimals beside them
    Json,
    /// Arrays of NumPy
    Npz,
    /// Columns of Apache Parquet
    Parquet,
    /// A header for C and C++
    C,
    /// A table
    Csv,
    /// A scene in glTF 2.0 of a formula that is geometry; samples are its vertices, about
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
    let selected = select::select(&args.suites)?;
    let profile = profile::named(&args.profile)?;
    let sharing = ShardArgs { shard: args.shard.clone(), ..ShardArgs::default() };
    let shard = sharing.shard()?;
    anyhow::ensure!(
        shard.is_none() || args.format != FormatArg::Glb,
        "--shard shares out samples, and a scene has none; leave it out"
    );
    let paths = paths(&args.output, &selected, args.format, shard)?;
    for (selected, path) in selected.iter().zip(paths) {
        let failed = || format!("cannot write `{}`", path.display());
        let Some(format) = args.format.format() else {
            let name = match &selected.suite.expect {
                Expect::Formula(name) => name.as_str(),
                Expect::Reference(_) | Expect::Recorded(_) | Expect::Nothing => selected.suite.name.as_str(),
            };
            let bytes = scene::scene(name, args.samples.unwrap_or(VERTICES))?;
            write(&path, |mut store| store.write_all(&bytes)).with_context(failed)?;
            writeln!(out, "{}  glTF 2.0, {} bytes", path.display(), bytes.len())?;
            continue;
        };
        let samples = args.samples.unwrap_or(selected.suite.samples);
        let prepared = prepare(&selected.suite, &selected.shader)?;
        let generator = Generator::new(&prepared, profile.as_deref(), samples, args.seed)?;
        let blocks = shard.unwrap_or(Shard::WHOLE).range(generator.blocks());
        let bar = bar(&selected.suite.name, generator.rows_of(&blocks));
        let digest = write(&path, |store| {
            let sink = format.sink(&generator.document(&blocks), store, &spill);
            produce(&generator, blocks.clone(), &mut *sink?, &mut |done| bar.set_position(done))
        });
        bar.finish_and_clear();
        let digest = digest.with_context(failed)?;
        writeln!(out, "{}  {} samples  sha256 {digest}", path.display(), generator.rows_of(&blocks))?;
        err.flush()?;
    }
    Ok(ExitStatus::Clean)
}

/// Writes a file that appears when it is whole.
fn write<T>(path: &Path, fill: impl FnOnce(Box<dyn Store>) -> io::Result<T>) -> io::Result<T> {
    let fresh = Fresh::new(path)?;
    let done = fill(Box::new(fresh.file()?))?;
    fresh.keep()?;
    Ok(done)
}

fn spill() -> io::Result<Box<dyn Spill>> {
    Ok(Box::new(tempfile::tempfile()?))
}

/// The file of each suite.
fn paths(
    output: &Path,
    selected: &[Selected],
    format: FormatArg,
    shard: Option<Shard>,
) -> anyhow::Result<Vec<PathBuf>> {
    let (format, endings) = format.endings();
    let is_file = !output.is_dir() && output.extension().is_some();
    if is_file {
        anyhow::ensure!(
            shard.is_none(),
            "--shard writes a file for each part; name a folder in place of `{}`",
            output.display()
        );
        anyhow::ensure!(
            selected.len() == 1,
            "{} suites do not go into the one file `{}`; name a folder",
            selected.len(),
            output.display()
        );
        let ending = output.extension().unwrap_or_default().to_string_lossy();
        anyhow::ensure!(
            endings.contains(&&*ending),
            "`{}` does not end in `.{}`, which files of the format `{format}` do; --format chooses another",
            output.display(),
            endings[0]
        );
        return Ok(vec![output.to_owned()]);
    }
    std::fs::create_dir_all(output).with_context(|| format!("cannot make the folder `{}`", output.display()))?;
    let plain = |c: char| if c.is_alphanumeric() || "-_=,.".contains(c) { c } else { '_' };
    let name = |s: &Selected| s.suite.name.chars().map(plain).collect::<String>();
    // The parts of a suite lie in a folder of their own, which is a data set as a whole.
    let file = |s: &Selected| match shard {
        None => PathBuf::from(format!("{}.{}", name(s), endings[0])),
        Some(shard) => Path::new(&name(s)).join(format!("{}.{}", shard.stem(), endings[0])),
    };
    let paths: Vec<PathBuf> = selected.iter().map(|s| output.join(file(s))).collect();
    for (k, path) in paths.iter().enumerate() {
        anyhow::ensure!(!paths[..k].contains(path), "two suites would be written to `{}`", path.display());
        if let Some(folder) = path.parent() {
            let failed = || format!("cannot make the folder `{}`", folder.display());
            std::fs::create_dir_all(folder).with_context(failed)?;
        }
    }
    Ok(paths)
}

/// A bar on standard error; hidden when it is no terminal.
fn bar(suite: &str, samples: u64) -> ProgressBar {
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
