//! A whole run: every suite on every lane, and what follows for the exit status.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::{Finding, Part, Report, RunError};
use judge::profile::Promises;
use lanes::{Description, Stage, Unavailable};

/// A run of `check`.
#[derive(Debug, Default)]
pub struct Summary {
    /// Seed of the inputs.
    pub seed: u64,
    /// Lanes that were used.
    pub lanes: Vec<LaneUsed>,
    /// Lanes that were asked for and are unavailable, by name.
    pub unavailable: Vec<(&'static str, Unavailable)>,
    /// Lanes that were asked for by name: a run without one of them is incomplete.
    pub asked: Vec<String>,
    /// Lanes that have to judge something.
    pub required: Vec<String>,
    /// The signal that ended the run before its time.
    pub interrupted: Option<u8>,
    /// Suites in order, once for each lane and stage.
    pub entries: Vec<Entry>,
    /// Expectations that are about nothing that ran, although their lane and driver did, one line each.
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
    pub fn new(description: Description, promises: &Promises) -> Self {
        let against = Against {
            promise: promises.text.name.clone(),
            conformance: promises.conformance.map(|p| p.name.clone()),
            measured: promises.measured.as_ref().map(|p| p.name.clone()),
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

/// `SIGINT`, `SIGTERM`, or the number of another signal.
pub fn signal_name(signal: u8) -> String {
    match signal {
        2 => "SIGINT".to_owned(),
        15 => "SIGTERM".to_owned(),
        other => format!("signal {other}"),
    }
}

/// What a suite came to on a stage of a lane, the worst last. Every report tells it in its own words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Standing {
    /// No sample was judged, and nothing is wrong: the lane cannot run it.
    NotRun,
    /// Samples were judged, and nothing is wrong.
    Passed,
    /// The same, and more than half of the samples are undetermined.
    Weak,
    /// It fails as expected.
    Known,
    /// Something is wrong.
    Failed,
    /// The lane failed.
    LaneFailed,
}

impl Standing {
    /// The word for it in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::NotRun => "not run",
            Self::Passed => "ok",
            Self::Weak => "weak",
            Self::Known => "known",
            Self::Failed | Self::LaneFailed => "FAIL",
        }
    }
}

impl Entry {
    /// What it came to.
    pub fn standing(&self) -> Standing {
        match &self.outcome {
            Outcome::Ran(report) => report.standing(),
            Outcome::Refused(_) => Standing::Failed,
            Outcome::LaneFailed(_) => Standing::LaneFailed,
            Outcome::KnownFailure { .. } => Standing::Known,
        }
    }

    /// Why no sample was judged, for an entry that did not run.
    pub fn not_run(&self) -> Option<String> {
        match &self.outcome {
            Outcome::Ran(report) if self.standing() == Standing::NotRun => Some(report.not_run()),
            Outcome::Ran(_) | Outcome::Refused(_) | Outcome::LaneFailed(_) | Outcome::KnownFailure { .. } => None,
        }
    }
}

impl Report {
    fn standing(&self) -> Standing {
        let undetermined = self.verdicts.undetermined_count();
        if !self.errors().is_empty() {
            Standing::Failed
        } else if !self.known.is_empty() {
            Standing::Known
        } else if self.judged() + undetermined == 0 {
            Standing::NotRun
        } else if undetermined > self.judged() {
            Standing::Weak
        } else {
            Standing::Passed
        }
    }

    fn not_run(&self) -> String {
        match (self.unsupported, &self.unsupported_because) {
            (0, _) => "no sample was run".to_owned(),
            (n, Some(why)) => format!("{n} samples not supported on this lane: {why}"),
            (n, None) => format!("{n} samples not supported on this lane"),
        }
    }
}

/// Puts the results of the jobs that ran into their entries, after the lanes were asked about each other's deviations.
pub fn settle(entries: &mut [Entry], parts: Vec<Part>) {
    let ran = entries.iter_mut().filter_map(|entry| match &mut entry.outcome {
        Outcome::Ran(report) => Some(report),
        Outcome::Refused(_) | Outcome::LaneFailed(_) | Outcome::KnownFailure { .. } => None,
    });
    ran.zip(parts).for_each(|(report, part)| **report = part.report());
}

/// What came of a suite.
#[derive(Debug)]
pub enum Outcome {
    /// It ran; the report says with which verdicts.
    Ran(Box<Report>),
    /// It could not be run: the shader does not compile, or suite and shader do not fit.
    Refused(RunError),
    /// The lane failed.
    LaneFailed(String),
    /// The lane failed, as expected.
    KnownFailure {
        /// Message of the failure.
        message: String,
        /// What expects it.
        expectation: Expectation,
    },
}

/// Why a failure is expected.
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

/// A finding that is expected.
#[derive(Clone, Debug)]
pub struct Known {
    /// What was found, as it would be reported without the entry.
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
    /// Samples that are inconclusive.
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
    /// The run itself could not be made as it was asked for: a lane is missing or judged nothing, or a suite does not
    /// fit its shader.
    Broken,
}

impl Summary {
    /// Failures that are expected: the entry, what failed in a word and in a line, and what expects it.
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

    /// Why the run is not the one that was asked for: a lane that is missing, or that judged nothing.
    pub fn shortcomings(&self) -> Vec<(&str, String)> {
        let mut all = Vec::new();
        for (name, missing) in &self.unavailable {
            if self.asked.iter().any(|asked| asked == name) {
                all.push((*name, format!("the lane `{name}` was asked for and is not available: {missing}")));
            }
        }
        if let Some(signal) = self.interrupted {
            let name = signal_name(signal);
            all.push(("run", format!("the run was interrupted by {name}; this is what was found until then")));
            return all;
        }
        for name in &self.required {
            let own = || self.entries.iter().filter(|entry| entry.on.is_some_and(|(lane, _)| lane == name));
            if own().all(|entry| entry.standing() == Standing::NotRun) {
                let why = own().find_map(Entry::not_run).unwrap_or_else(|| "no suite runs on it".to_owned());
                all.push((name, format!("the required lane `{name}` judged no sample: {why}")));
            }
        }
        all
    }

    /// How the run ended. A run that judged nothing has not passed, and neither has one without a lane that was asked
    /// for.
    pub fn status(&self) -> Status {
        let mut failed = false;
        for entry in &self.entries {
            match &entry.outcome {
                Outcome::Ran(report) => failed |= !report.errors().is_empty(),
                Outcome::Refused(RunError::Shader { .. } | RunError::Open { .. }) | Outcome::LaneFailed(_) => {
                    failed = true
                }
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
        if !self.shortcomings().is_empty() {
            Status::Broken
        } else if failed {
            Status::Fail
        } else if self.totals().judged == 0 {
            Status::Broken
        } else {
            Status::Pass
        }
    }
}
