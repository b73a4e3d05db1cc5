//! Reports of `improve`.

mod json;
mod text;

use engine::improve::Report;
use serde::{Deserialize, Serialize};

pub use json::json;
pub use text::text;

/// A run of `improve`.
#[derive(Debug, Default)]
pub struct Summary {
    /// Seed of the inputs.
    pub seed: u64,
    /// What bounds are derived from.
    pub profile: String,
    /// The files, each with its expressions.
    pub files: Vec<FileReport>,
}

/// A file that was looked at.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct FileReport {
    /// Its name.
    pub file: String,
    /// Expressions for which something was looked for.
    pub expressions: Vec<Report>,
    /// Functions that were not looked at, each with the reason.
    pub not_run: Vec<(String, String)>,
    /// The change of the file that the first proposals make, as a unified diff.
    pub patch: Option<String>,
    /// True when the file was changed.
    pub written: bool,
}

impl Summary {
    /// Expressions with a proposal, and all.
    pub fn counts(&self) -> (usize, usize) {
        let all = || self.files.iter().flat_map(|file| &file.expressions);
        (all().filter(|report| !report.proposals.is_empty()).count(), all().count())
    }
}
