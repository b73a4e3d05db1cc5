//! What came of a check.

use std::fmt;

use thiserror::Error;

/// Why nothing could be checked: a shader that does not compile, inputs that do not fit it, no lane.
#[derive(Clone, Error)]
#[error("{message}")]
pub struct Error {
    pub(crate) message: String,
}

/// The message itself: `unwrap` in a test prints it with its lines, as `?` does.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Error {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self { message: message.into() }
    }
}

/// What came of a check, on all lanes together.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub(crate) judged: u64,
    pub(crate) undetermined: u64,
    pub(crate) passed: bool,
    pub(crate) report: String,
}

impl Outcome {
    /// True when samples were judged and nothing is wrong.
    pub fn passed(&self) -> bool {
        self.passed
    }

    /// Samples that agree or deviate.
    pub fn judged(&self) -> u64 {
        self.judged
    }

    /// Samples that are inconclusive: what is allowed to a device leaves them open.
    pub fn undetermined(&self) -> u64 {
        self.undetermined
    }

    /// What was found, for people: what deviates by how much, the smallest inputs that show it, and how to
    /// run them again. For a check that passed, a line for each lane and stage.
    pub fn report(&self) -> &str {
        &self.report
    }
}
