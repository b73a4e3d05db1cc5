//! `shadercheck refdata verify`.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, ValueEnum};

use super::files;
use crate::cli::check::Format;
use crate::cli::status::ExitStatus;
use base::text::Shown;
use disk::fresh::Fresh;
use refdata::read::{self, Dataset, InputFormat, Sequence, Wanted};
use refdata::verify::{self, Element, Report, Rule, StreamError};

/// Arguments of `shadercheck refdata verify`.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = "\
Outputs are arrays or columns with the names of the reference (`gl_Position`, or `gl_Position.x` and so on), a \
single array, or raw binary32 numbers, all words of the first sample, then those of the second. Rows are matched \
with samples by a column `index`, by inputs (`input.NAME`, or NAME), or by their place.

Exit status: 0 every element with a bound is within it, and few elements have none; 1 findings; 2 a file cannot \
be read, or does not fit.")]
pub struct VerifyArgs {
    /// Reference file: json, npz, parquet or csv; or the folder with the parts that `--shard` wrote
    #[arg(value_name = "REF")]
    pub reference: PathBuf,
    /// Outputs to judge: npz, npy, parquet, csv, json, or raw binary32 numbers (raw, bin, f32)
    #[arg(value_name = "ACTUAL")]
    pub actual: PathBuf,
    /// Require the nearest binary32 number for every element, bit for bit
    #[arg(long)]
    pub exact: bool,
    /// Largest acceptable share of elements without a bound, in percent
    #[arg(long, value_name = "PERCENT", default_value_t = 100.0 * verify::MAX_UNBOUNDED, value_parser = percent)]
    pub max_unbounded: f64,
    /// Format of ACTUAL, if its extension does not give it
    #[arg(long, value_enum)]
    pub actual_format: Option<SourceArg>,
    /// Byte order of raw numbers
    #[arg(long, value_enum, default_value_t)]
    pub byte_order: ByteOrderArg,
    /// Write the verdict on every element to this file
    #[arg(long, value_name = "FILE.csv")]
    pub verdicts: Option<PathBuf>,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// A share in percent.
fn percent(text: &str) -> Result<f64, String> {
    let share = text.trim_end_matches('%').parse::<f64>().ok().filter(|share| (0.0..=100.0).contains(share));
    share.ok_or_else(|| format!("`{text}` is no percentage from 0 to 100"))
}

/// Format of outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SourceArg {
    /// An array of NumPy, or an archive of them
    Npz,
    /// Columns of Apache Parquet
    Parquet,
    /// A table
    Csv,
    /// An object of lists
    Json,
    /// Raw binary32 numbers
    Raw,
}

/// Order of the bytes of raw numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ByteOrderArg {
    /// Least significant byte first
    #[default]
    Little,
    /// Most significant byte first
    Big,
}

/// Runs the command.
///
/// # Errors
/// When a file cannot be read or does not fit the other, or output fails.
pub fn run(args: &VerifyArgs, out: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let format = match args.actual_format {
        Some(SourceArg::Npz) => InputFormat::Npz,
        Some(SourceArg::Parquet) => InputFormat::Parquet,
        Some(SourceArg::Csv) => InputFormat::Csv,
        Some(SourceArg::Json) => InputFormat::Json,
        Some(SourceArg::Raw) => InputFormat::Raw,
        None => files::source(&args.actual)?,
    };
    let order = match args.byte_order {
        ByteOrderArg::Little => read::ByteOrder::Little,
        ByteOrderArg::Big => read::ByteOrder::Big,
    };
    let folder = args.reference.is_dir();
    let parts = if folder { files::parts(&args.reference)? } else { vec![args.reference.clone()] };
    let documents = files::documents(&parts)?;
    let of_reference = || format!("`{}`", args.reference.shown());
    let of_actual = || format!("`{}`", args.actual.shown());
    let of_both = || format!("`{}` against `{}`", args.actual.shown(), args.reference.shown());
    let sequence = || -> anyhow::Result<Box<dyn Sequence + '_>> {
        Ok(match folder {
            true => Box::new(files::chain(&parts, &documents).with_context(of_reference)?),
            false => Box::new(files::blocks(&args.reference)?),
        })
    };
    let first = sequence()?;
    let wanted = Wanted::outputs(first.document());
    let actual = files::open(&args.actual)?;
    let rule = Rule { exact: args.exact, max_unbounded: args.max_unbounded / 100.0 };
    let streamed = |each: &mut dyn FnMut(&Element)| -> anyhow::Result<Option<Report>> {
        let mut windows = read::windows(format, &actual, order, &wanted).with_context(of_actual)?;
        verify::stream(&mut *sequence()?, &mut *windows, rule, each).map_err(|error| match error {
            StreamError::Reference(error) => anyhow::Error::new(error).context(of_reference()),
            StreamError::Actual(error) => anyhow::Error::new(error).context(of_actual()),
            StreamError::Verify(error) => anyhow::Error::new(error).context(of_both()),
        })
    };
    // Rows in another order are looked for in memory.
    let whole = |each: &mut dyn FnMut(&Element)| -> anyhow::Result<Report> {
        let reference = Dataset::of(&mut *sequence()?).with_context(of_reference)?;
        let actual = read::outputs(format, &actual, order, &wanted).with_context(of_actual)?;
        verify::verify(&reference, &actual, rule, each).with_context(of_both)
    };
    let report = match &args.verdicts {
        None => match streamed(&mut |_| {})? {
            Some(report) => report,
            None => whole(&mut |_| {})?,
        },
        Some(path) => match written(path, &streamed)? {
            Some(report) => report,
            None => written(path, &|each| whole(each).map(Some))?.context("the comparison gave no report")?,
        },
    };
    match args.format {
        Format::Text => out.write_all(report::refdata::text(&report).as_bytes())?,
        Format::Json => out.write_all(report::refdata::json(&report).as_bytes())?,
    }
    Ok(if report.findings.is_empty() { ExitStatus::Clean } else { ExitStatus::Findings })
}

/// What compares, and shows every element.
type Compare<'c> = &'c dyn Fn(&mut dyn FnMut(&Element)) -> anyhow::Result<Option<Report>>;

/// Compares, and writes the verdict on every element to a table, which is kept where there is a report.
fn written(path: &Path, compare: Compare<'_>) -> anyhow::Result<Option<Report>> {
    let failed = || format!("cannot write `{}`", path.shown());
    let fresh = Fresh::new(path).with_context(failed)?;
    let mut to = BufWriter::new(fresh.file().with_context(failed)?);
    let mut written = writeln!(to, "sample,component,expected,nearest_bits,actual,error,bound,verdict");
    let report = compare(&mut |element| {
        if written.is_ok() {
            written = line(&mut to, element);
        }
    })?;
    written.and_then(|()| to.flush()).with_context(failed)?;
    if report.is_some() {
        fresh.keep().with_context(failed)?;
    }
    Ok(report)
}

fn line(to: &mut dyn Write, element: &Element) -> io::Result<()> {
    let Element { sample, component, expected, nearest, actual, bound, verdict, .. } = element;
    let error = element.error();
    let verdict = verdict.name();
    writeln!(to, "{sample},{component},{expected:?},{nearest:08x},{actual:?},{error:e},{bound:e},{verdict}")
}
