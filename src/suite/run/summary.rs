//! A whole run: every suite on every lane, and what follows for the exit status.

use serde::{Deserialize, Serialize};

use super::{Report, RunError};
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
                Outcome::Refused(
                    RunError::Program { .. }
                    | RunError::Reference { .. }
                    | RunError::ReferenceProgram { .. }
                    | RunError::Recorded { .. }
                    | RunError::Law { .. }
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
