//! Reports of `shadercheck check`.

mod block;
mod github;
mod gitlab;
mod items;
mod json;
mod junit;
mod markdown;
mod not_run;
mod notes;
mod rdjson;
mod reach;
mod sarif;
mod survey;
mod table;
mod text;
mod translations;

use engine::suite::run::Summary;

pub use json::json;
pub(crate) use reach::facts as reached;
pub use sarif::about;
pub use table::{Table, short};
pub use text::{brief, finding, line, line_as, not_run, refusal, totals};

/// A format for other programs.
pub struct Format {
    /// Name, as `--format` takes it.
    pub name: &'static str,
    /// What it is for, in a few words.
    pub summary: &'static str,
    /// The file that holds it in a folder of reports.
    pub file: &'static str,
    /// The whole report of a run.
    ///
    /// # Errors
    /// Why the format cannot hold it.
    pub write: fn(&Summary) -> Result<String, String>,
}

/// All formats for other programs.
pub const FORMATS: &[&Format] = &[
    &json::FORMAT,
    &junit::FORMAT,
    &sarif::FORMAT,
    &github::FORMAT,
    &gitlab::FORMAT,
    &rdjson::FORMAT,
    &markdown::FORMAT,
];

/// The format of this name; none for the text, which is for people.
pub fn by_name(name: &str) -> Option<&'static Format> {
    FORMATS.iter().copied().find(|f| f.name == name)
}
