//! What came of the files of a run, or of the shaders in them, for commands that report each by itself.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::shard::Printing;
use base::diagnostic::{Diagnostic, Lang};
use engine::session::{Join, Unlike};

/// What came of one file.
#[derive(Debug, Serialize, Deserialize)]
pub enum Outcome<T> {
    /// Its report.
    Report(T),
    /// It does not compile: its diagnostics.
    Broken(String),
    /// Why there is no report, in whole lines.
    Nothing(String),
}

impl<T> Outcome<T> {
    /// Of a file that does not compile.
    pub fn broken(errors: &[Diagnostic]) -> Self {
        Self::Broken(errors.iter().map(|error| report::diagnostics::text(error, Lang::En, false)).collect())
    }

    /// What is said of it beside the reports.
    pub fn said(&self) -> Option<&str> {
        match self {
            Self::Report(_) => None,
            Self::Broken(said) | Self::Nothing(said) => Some(said),
        }
    }
}

/// What came of some files, each with its number in the run.
#[derive(Debug, Serialize, Deserialize)]
pub struct Outcomes<T>(pub Vec<(u64, Outcome<T>)>);

impl<T> Outcomes<T> {
    /// The reports, and whether a file does not compile. What is said beside them is written, unless it was when it came up.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn reports(self, to: &mut Printing<'_>) -> std::io::Result<(Vec<T>, bool)> {
        let (mut reports, mut broken) = (Vec::new(), false);
        for (_, outcome) in self.0 {
            if let Some(said) = outcome.said().filter(|_| !to.live) {
                to.err.write_all(said.as_bytes())?;
            }
            match outcome {
                Outcome::Report(report) => reports.push(report),
                Outcome::Broken(_) => broken = true,
                Outcome::Nothing(_) => {}
            }
        }
        Ok((reports, broken))
    }
}

impl<T: Serialize + DeserializeOwned> Join for Outcomes<T> {
    fn join(&mut self, other: Self) -> Result<(), Unlike> {
        self.0.extend(other.0);
        self.0.sort_by_key(|(number, _)| *number);
        Ok(())
    }
}
