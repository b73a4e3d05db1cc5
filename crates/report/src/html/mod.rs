//! The page of a run: one file that needs no other and no network, with the charts beside it as files.
//! What is known is in the text of the page; the script turns pictures, filters and copies.

mod charts;
mod compare;
mod curve;
mod data;
mod finding;
mod known;
mod lanes;
mod matrix;
mod mutations;
mod page;
mod raster;
mod source;
mod suite;
mod text;

use serde_json::Value;

use base::text::SourceFile;
use engine::suite::run::{Entry, Gallery, Outcome, Promised, Summary};
use program::InputSource;

pub use compare::write as comparison;

use charts::Chart;
use text::slug;

/// What a page is made of.
pub struct Page<'a> {
    /// The run.
    pub summary: &'a Summary,
    /// The suites of the run.
    pub subjects: &'a [Subject],
    /// What was looked at for the page, for each entry of the run.
    pub galleries: &'a [Option<Gallery>],
    /// Lanes by name, with what is promised of their operations.
    pub promises: &'a [(String, Vec<Promised>)],
    /// Results of mutation testing, as `shadercheck mutate --format json` prints them.
    pub mutations: Option<&'a Value>,
}

/// A suite of a run.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Name, as suites and reports have it.
    pub name: String,
    /// What it is about, in a few words.
    pub title: String,
    /// What its shader is compared with: `formula`, `reference`.
    pub against: String,
    /// The shader that ran.
    pub shader: SourceFile,
}

/// The files of a page.
#[derive(Clone, Debug)]
pub struct Site {
    /// The page.
    pub index: String,
    /// Charts: names and contents.
    pub plots: Vec<(String, Vec<u8>)>,
}

/// Makes the page of a run.
///
/// # Errors
/// Why a chart cannot be encoded.
pub fn write(page: &Page<'_>) -> Result<Site, String> {
    let mut plots = Vec::new();
    for (entry, gallery) in page.summary.entries.iter().zip(page.galleries) {
        let Some(gallery) = gallery else { continue };
        let name = format!("{}-{}", slug(&entry.suite), slug(&way(entry)));
        let mut charts = Vec::new();
        if gallery.errors.words > 0 {
            charts.push((format!("{name}-errors"), Chart::Errors(&gallery.errors)));
        }
        if !gallery.errors.by_bound.is_empty() {
            charts.push((format!("{name}-bounds"), Chart::Bounds(&gallery.errors)));
        }
        for frame in 0..gallery.scene.as_ref().map_or(0, |scene| scene.frames.len()) {
            let number = if frame > 0 { format!("-{}", frame + 1) } else { String::new() };
            charts.extend(gallery.scene.as_ref().map(|s| (format!("{name}-map{number}"), Chart::Map(s, frame))));
        }
        for (name, chart) in charts {
            plots.push((format!("{name}.svg"), chart.svg(&name).into_bytes()));
            plots.push((format!("{name}.png"), chart.png()?));
        }
    }
    Ok(Site { index: page::page(page), plots })
}

/// Lane, and stage or source of an entry; empty for a suite that did not come that far.
fn way(entry: &Entry) -> String {
    let source = match &entry.outcome {
        Outcome::Ran(report) => report.source,
        Outcome::Refused(_) | Outcome::LaneFailed(_) | Outcome::KnownFailure { .. } => None,
    };
    match (entry.on, source) {
        (Some((lane, _)), Some(source)) => format!("{lane}/{}", InputSource::name(source)),
        (Some((lane, stage)), None) => format!("{lane}/{stage}"),
        (None, _) => String::new(),
    }
}

/// True for an entry with which a run does not pass.
fn fails(entry: &Entry) -> bool {
    match &entry.outcome {
        Outcome::Ran(report) => !report.errors().is_empty(),
        Outcome::Refused(_) | Outcome::LaneFailed(_) => true,
        Outcome::KnownFailure { .. } => false,
    }
}

/// Name of the part of the page about an entry.
fn anchor(entry: &Entry, number: usize) -> String {
    format!("{}-{}-{number}", slug(&entry.suite), slug(&way(entry)))
}

/// Name of the part of the page about a suite.
fn suite_anchor(name: &str) -> String {
    format!("suite-{}", slug(name))
}

/// Suites in their order, each with the numbers of its entries.
fn suites(summary: &Summary) -> Vec<(&str, Vec<usize>)> {
    let mut all: Vec<(&str, Vec<usize>)> = Vec::new();
    for (number, entry) in summary.entries.iter().enumerate() {
        match all.iter_mut().find(|(name, _)| *name == entry.suite) {
            Some((_, numbers)) => numbers.push(number),
            None => all.push((&entry.suite, vec![number])),
        }
    }
    all
}
