//! A whole run: every suite on every lane, and what follows for the exit status.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::{Finding, Report, RunError};
use crate::bound::profile::Rulings;
use crate::lane::{Description, Stage, Unavailable};

/// A run of `check`.
#[derive(Debug, Default)]
pub struct Summary {
    /// Seed of the inputs.
    pub seed: u64,
    /// Lanes that were used.
    pub lanes: Vec<LaneUsed>,
    /// Lanes that were wanted and could not be had, by name.
    pub unavailable: Vec<(&'static str, Unavailable)>,
    /// Suites in order, once for each lane and stage.
    pub entries: Vec<Entry>,
    /// Entries of ledgers that are about nothing that ran, although their lane and driver did, one line each.
    pub stale: Vec<String>,
}

/// A lane with what its results are held against.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LaneUsed {
    /// The lane.
    pub description: Description,
    /// The profiles.
    pub against: Against,
}

/// Profiles by name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Against {
    /// The text of the specification.
    pub promise: String,
    /// What the conformance suite accepts.
    pub conformance: Option<String>,
    /// What the device was measured to keep.
    pub measured: Option<String>,
}

impl LaneUsed {
    /// A lane, held against some profiles.
    pub fn new(description: Description, rulings: &Rulings) -> Self {
        let against = Against {
            promise: rulings.text.name.clone(),
            conformance: rulings.conformance.map(|p| p.name.clone()),
            measured: rulings.measured.as_ref().map(|p| p.name.clone()),
        };
        Self { description, against }
    }
}

/// One suite on one stage of one lane.
#[derive(Debug)]
pub struct Entry {
    /// Name of the suite.
    pub suite: String,
    /// The shader, as it was named.
    pub shader: String,
    /// Lane and stage; `None` when the suite did not get that far.
    pub on: Option<(&'static str, Stage)>,
    /// What came of it.
    pub outcome: Outcome,
}

/// What came of a suite.
#[derive(Debug)]
pub enum Outcome {
    /// It ran.
    Ran(Box<Report>),
    /// It could not be run: the shader does not compile, or suite and shader do not fit.
    Refused(RunError),
    /// The lane failed.
    LaneFailed(String),
    /// The lane failed, as a ledger expects.
    KnownFailure {
        /// How it failed.
        message: String,
        /// What expects it.
        expectation: Expectation,
    },
}

/// What a ledger says of a failure that it expects.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expectation {
    /// `file:line:column` of the entry.
    pub at: String,
    /// Why the failure is expected.
    pub reason: String,
    /// Where more is told.
    pub link: Option<String>,
}

impl fmt::Display for Expectation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}", self.reason, self.at)?;
        self.link.as_ref().map_or(Ok(()), |link| write!(f, ", {link}"))?;
        f.write_str(")")
    }
}

/// A finding that a ledger expects.
#[derive(Clone, Debug)]
pub struct Known {
    /// The finding.
    pub finding: Finding,
    /// What expects it.
    pub expectation: Expectation,
}

/// Counted samples of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Samples that agree or deviate.
    pub judged: u64,
    /// Samples that agree.
    pub agreed: u64,
    /// Samples that deviate.
    pub deviated: u64,
    /// Samples that decide nothing.
    pub undetermined: u64,
    /// Samples that a lane could not run.
    pub unsupported: u64,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Samples were judged, and nothing is wrong.
    Pass,
    /// Something is wrong with a shader or a lane.
    Fail,
    /// The run itself could not be made: no lane, or a suite that does not fit its shader.
    Broken,
}

impl Summary {
    /// Failures that ledgers expect: the entry, what failed in a word and in a line, and what expects it.
    pub fn known(&self) -> Vec<(&Entry, &'static str, &str, &Expectation)> {
        let mut all = Vec::new();
        for entry in &self.entries {
            match &entry.outcome {
                Outcome::Ran(report) => {
                    for Known { finding, expectation } in &report.known {
                        all.push((entry, finding.kind.name(), finding.message.as_str(), expectation));
                    }
                }
                Outcome::KnownFailure { message, expectation } => {
                    all.push((entry, "lane", message.as_str(), expectation));
                }
                Outcome::Refused(_) | Outcome::LaneFailed(_) => {}
            }
        }
        all
    }

    /// All samples.
    pub fn totals(&self) -> Totals {
        let mut totals = Totals::default();
        for entry in &self.entries {
            if let Outcome::Ran(report) = &entry.outcome {
                totals.judged += report.judged();
                totals.agreed += report.verdicts.agreed;
                totals.deviated += report.verdicts.deviated;
                totals.undetermined += report.verdicts.undetermined_count();
                totals.unsupported += report.unsupported;
            }
        }
        totals
    }

    /// How the run ended. A run that judged nothing has not passed.
    pub fn status(&self) -> Status {
        let mut failed = false;
        for entry in &self.entries {
            match &entry.outcome {
                Outcome::Ran(report) => failed |= !report.errors().is_empty(),
                Outcome::Refused(RunError::Shader { .. }) | Outcome::LaneFailed(_) => failed = true,
                Outcome::KnownFailure { .. } => {}
                Outcome::Refused(
                    RunError::Program { .. }
                    | RunError::Reference { .. }
                    | RunError::ReferenceProgram { .. }
                    | RunError::Recorded { .. }
                    | RunError::Law { .. }
                    | RunError::Texture { .. }
                    | RunError::Plan { .. },
                ) => {
                    return Status::Broken;
                }
            }
        }
        if failed {
            Status::Fail
        } else if self.totals().judged == 0 {
            Status::Broken
        } else {
            Status::Pass
        }
    }
}
