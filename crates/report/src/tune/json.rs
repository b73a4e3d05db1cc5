//! The report for programs. Keys may be added; none is renamed.

use serde::Serialize;

use super::text::allowed;
use super::{FileReport, Summary};
use engine::tune::{Row, Shown, word};

#[derive(Serialize)]
struct Root<'a> {
    status: &'static str,
    seed: u64,
    files: Vec<File<'a>>,
}

#[derive(Serialize)]
struct File<'a> {
    file: &'a str,
    function: &'a str,
    at: &'a str,
    inputs: Vec<Input<'a>>,
    outputs: Vec<Output<'a>>,
    declarations: Vec<Declaration<'a>>,
    smallest: bool,
    samples: u64,
    left_out: u64,
    jumps: u64,
    #[serde(with = "base::value::exact")]
    worst: f64,
    #[serde(with = "base::value::exact")]
    binary16: f64,
    beyond: Option<Why<'a>>,
    patch: Option<&'a str>,
    written: bool,
}

#[derive(Serialize)]
struct Input<'a> {
    name: &'a str,
    domain: &'a str,
}

#[derive(Serialize)]
struct Output<'a> {
    name: &'a str,
    allowed: String,
}

#[derive(Serialize)]
struct Declaration<'a> {
    what: &'a str,
    at: &'a str,
    now: Option<&'static str>,
    may_be: &'static str,
    /// In units of what is allowed.
    #[serde(with = "base::value::exact")]
    alone: f64,
    samples_off: f64,
    at_edges: f64,
    /// Texels of the textures whose coordinate it is, where `mediump` does not tell them apart.
    texels: Option<u32>,
    /// It is `highp` since the range of what goes into it is not stated.
    kept: bool,
    why: Option<Why<'a>>,
}

#[derive(Serialize)]
struct Why<'a> {
    message: &'a str,
    place: Option<String>,
    text: Option<&'a str>,
    inputs: Vec<Value<'a>>,
    output: &'a str,
    highp: String,
    mediump: String,
    #[serde(with = "base::value::exact")]
    ratio: f64,
}

#[derive(Serialize)]
struct Value<'a> {
    name: &'a str,
    values: &'a [String],
}

/// The report.
pub fn json(summary: &Summary) -> String {
    let all = || summary.files.iter().map(|file| &file.report);
    let status = if all().any(|report| report.beyond.is_some() || report.changes()[0] > 0) {
        "too low"
    } else if all().any(|report| report.changes()[1] > 0) {
        "can be lower"
    } else {
        "clean"
    };
    let root = Root { status, seed: summary.seed, files: summary.files.iter().map(file).collect() };
    serde_json::to_string_pretty(&root).unwrap_or_default() + "\n"
}

fn file(file: &FileReport) -> File<'_> {
    let report = &file.report;
    File {
        file: &file.file,
        function: &report.function,
        at: &report.at,
        inputs: report.inputs.iter().map(|(name, domain)| Input { name, domain }).collect(),
        outputs: report.outputs.iter().map(|(name, limit)| Output { name, allowed: allowed(*limit) }).collect(),
        declarations: report.rows.iter().map(declaration).collect(),
        smallest: report.smallest,
        samples: report.samples,
        left_out: report.left_out,
        jumps: report.jumps,
        worst: report.worst,
        binary16: report.binary16,
        beyond: report.beyond.as_ref().map(why),
        patch: file.patch.as_deref(),
        written: file.written,
    }
}

fn declaration(row: &Row) -> Declaration<'_> {
    Declaration {
        what: &row.declaration.what,
        at: &row.declaration.at,
        now: row.declaration.now.map(word),
        may_be: if row.high { "highp" } else { "mediump" },
        alone: row.alone,
        samples_off: row.alone_off[0],
        at_edges: row.alone_off[1],
        texels: row.texels,
        kept: row.kept,
        why: row.shown.as_ref().map(why),
    }
}

fn why(shown: &Shown) -> Why<'_> {
    Why {
        message: &shown.message,
        place: shown.place.as_ref().map(|place| place.at.to_string()),
        text: shown.place.as_ref().map(|place| place.text.as_str()),
        inputs: shown.inputs.iter().map(|input| Value { name: input.shown(), values: &input.decimal }).collect(),
        output: &shown.output,
        highp: format!("{:?}", shown.values[0]),
        mediump: format!("{:?}", shown.values[1]),
        ratio: shown.ratio,
    }
}
