//! Reports of `shadercheck check`.

mod github;
mod items;
mod json;
mod junit;
mod markdown;
mod sarif;
mod survey;
mod text;
mod translations;

use crate::suite::run::Summary;

pub use json::json;
pub use text::{finding, line, totals};

/// A format for other programs.
pub struct Format {
    /// Its name, as a user writes it.
    pub name: &'static str,
    /// The file that holds it in a folder of reports.
    pub file: &'static str,
    /// The whole report of a run.
    ///
    /// # Errors
    /// Why the format cannot hold it.
    pub write: fn(&Summary) -> Result<String, String>,
}

/// All formats for other programs.
pub const FORMATS: [Format; 5] = [
    Format { name: "json", file: "report.json", write: |summary| Ok(json(summary)) },
    Format { name: "junit", file: "junit.xml", write: junit::junit },
    Format { name: "sarif", file: "report.sarif", write: |summary| Ok(sarif::sarif(summary)) },
    Format { name: "github", file: "annotations.txt", write: |summary| Ok(github::github(summary)) },
    Format { name: "markdown", file: "summary.md", write: |summary| Ok(markdown::markdown(summary)) },
];
