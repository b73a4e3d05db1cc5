//! Reports of `tune`.

mod json;
mod text;

use engine::tune::Report;
use serde::{Deserialize, Serialize};

pub use json::json;
pub use text::text;

/// A run of `tune`.
#[derive(Debug, Default)]
pub struct Summary {
    /// Seed of the inputs and of the devices.
    pub seed: u64,
    /// The files.
    pub files: Vec<FileReport>,
}

/// A file that was tuned.
#[derive(Debug, Serialize, Deserialize)]
pub struct FileReport {
    /// Its name.
    pub file: String,
    /// What came of its function.
    pub report: Report,
    /// The change of the file, as a unified diff.
    pub patch: Option<String>,
    /// True when the file was changed.
    pub written: bool,
}
