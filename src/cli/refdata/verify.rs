//! `shadercheck refdata verify`.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, ValueEnum};

use crate::cli::check::Format;
use crate::cli::fresh::Fresh;
use crate::cli::status::ExitStatus;
use crate::refdata::Role;
use crate::refdata::read::{self, Dataset, Source};
use crate::refdata::verify::{self, Element, Rule};
use crate::report;

/// Arguments of `shadercheck refdata verify`.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = "\
Outputs are arrays or columns that are called as in the reference: `gl_Position`, or `gl_Position.x` and so \
on; or a single array; or raw binary32 numbers, all words of the first sample, then those of the second. Rows \
are matched with samples by a column `index`, or by the inputs (`input.NAME`, or NAME), or by their place.

Exit status: 0 everything that has a bound is within it; 1 findings; 2 a file cannot be read, or does not \
fit.")]
pub struct VerifyArgs {
    /// Reference file: json, npz, parquet or csv; or the folder with the parts that `--shard` wrote
    #[arg(value_name = "REF")]
    pub reference: PathBuf,
    /// Outputs to judge: npz, npy, parquet, csv, json, or raw binary32 numbers (raw, bin, f32)
    #[arg(value_name = "ACTUAL")]
    pub actual: PathBuf,
    /// Every element has to be the nearest binary32 number, bit for bit
    #[arg(long)]
    pub exact: bool,
    /// Format of ACTUAL, where its ending does not tell
    #[arg(long, value_enum)]
    pub actual_format: Option<SourceArg>,
    /// Order of the bytes of raw numbers
    #[arg(long, value_enum, default_value_t)]
    pub byte_order: ByteOrderArg,
    /// Write the verdict on every element to this table
    #[arg(long, value_name = "FILE.csv")]
    pub verdicts: Option<PathBuf>,
    /// How the result is printed
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// Format of outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SourceArg {
    /// Arrays of NumPy, one or an archive of them
    Npz,
    /// Columns of Apache Parquet
    Parquet,
    /// A table
    Csv,
    /// An object of lists
    Json,
    /// binary32 numbers alone
    Raw,
}

/// Order of the bytes of raw numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ByteOrderArg {
    /// The least significant first
    #[default]
    Little,
    /// The most significant first
    Big,
}

fn source(path: &Path) -> anyhow::Result<Source> {
    let name = path.display().to_string();
    Source::of_name(&name)
        .with_context(|| format!("the ending of `{name}` tells no format; there are npz, parquet, csv, json and raw"))
}

/// The files of a folder that are reference files by their ending, in the order of their names.
fn parts(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let failed = || format!("cannot read the folder `{}`", folder.display());
    let mut paths: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(failed)? {
        let path = entry.with_context(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        // What is being written has a name that begins with a point.
        let is_part = !name.starts_with('.') && Source::of_name(&name).is_some_and(|source| source != Source::Raw);
        if is_part && path.is_file() {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// Runs the command.
///
/// # Errors
/// When a file cannot be read or does not fit the other, or output fails.
pub fn run(args: &VerifyArgs, out: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let open = |path: &Path| File::open(path).with_context(|| format!("cannot read `{}`", path.display()));
    let read = |path: &Path| -> anyhow::Result<Dataset> {
        Dataset::read(source(path)?, &mut open(path)?).with_context(|| format!("`{}`", path.display()))
    };
    let reference = if args.reference.is_dir() {
        let parts: Vec<Dataset> = parts(&args.reference)?.iter().map(|path| read(path)).collect::<Result<_, _>>()?;
        Dataset::join(parts).with_context(|| format!("`{}`", args.reference.display()))?
    } else {
        read(&args.reference)?
    };
    let format = match args.actual_format {
        Some(SourceArg::Npz) => Source::Npz,
        Some(SourceArg::Parquet) => Source::Parquet,
        Some(SourceArg::Csv) => Source::Csv,
        Some(SourceArg::Json) => Source::Json,
        Some(SourceArg::Raw) => Source::Raw,
        None => source(&args.actual)?,
    };
    let order = match args.byte_order {
        ByteOrderArg::Little => read::ByteOrder::Little,
        ByteOrderArg::Big => read::ByteOrder::Big,
    };
    let expected = reference.document.arrays.iter().filter(|array| array.role == Role::Expected);
    let width = expected.map(|array| array.words()).sum();
    let actual = read::outputs(format, &mut open(&args.actual)?, order, width)
        .with_context(|| format!("`{}`", args.actual.display()))?;
    let rule = Rule { exact: args.exact };
    let verify = |each: &mut dyn FnMut(&Element)| {
        verify::verify(&reference, &actual, rule, each)
            .with_context(|| format!("`{}` against `{}`", args.actual.display(), args.reference.display()))
    };
    let report = match &args.verdicts {
        None => verify(&mut |_| {})?,
        Some(path) => {
            let failed = || format!("cannot write `{}`", path.display());
            let fresh = Fresh::new(path).with_context(failed)?;
            let mut to = BufWriter::new(fresh.file().with_context(failed)?);
            let mut written = writeln!(to, "sample,component,expected,nearest_bits,actual,error,bound,verdict");
            let report = verify(&mut |element| {
                if written.is_ok() {
                    written = line(&mut to, element);
                }
            })?;
            written.and_then(|()| to.flush()).and_then(|()| fresh.keep()).with_context(failed)?;
            report
        }
    };
    match args.format {
        Format::Text => out.write_all(report::refdata::text(&report).as_bytes())?,
        Format::Json => out.write_all(report::refdata::json(&report).as_bytes())?,
    }
    Ok(if report.findings.is_empty() { ExitStatus::Clean } else { ExitStatus::Findings })
}

fn line(to: &mut dyn Write, element: &Element) -> io::Result<()> {
    let Element { sample, component, expected, nearest, actual, bound, verdict, .. } = element;
    let error = element.error();
    let verdict = verdict.name();
    writeln!(to, "{sample},{component},{expected:?},{nearest:08x},{actual:?},{error:e},{bound:e},{verdict}")
}
