//! What is said between a lane and the process of its engine.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::{Description, LaneError, Marks, Unavailable};

/// What a process is asked.
#[derive(Debug, Serialize, Deserialize)]
pub enum Ask {
    /// Which devices the Vulkan loader shows.
    Devices,
    /// To open the engine of a lane.
    Open { lane: String },
    /// To make work ready under a number. Its words come behind.
    Prepare { id: u64, capacity: usize },
    /// To run a batch. The words of invocations, so many, and of cases come behind.
    Run { id: u64, run: u64, per_case: usize, invocations: usize, pieces: Option<Pieces> },
    /// To forget work.
    Drop { id: u64 },
}

/// A part of a batch that is run piece by piece, to find what does not come back.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Pieces {
    /// Invocations that are run.
    pub of: Range<usize>,
    /// Invocations of a piece.
    pub size: usize,
}

/// What it answers.
#[derive(Debug, Serialize, Deserialize)]
pub enum Answer {
    /// The names of lanes of devices, the first one first.
    Devices { names: Vec<String> },
    /// There is no device.
    NoDevices { why: String },
    /// The engine is open.
    Opened { description: Description },
    /// There is no such engine.
    Missing { missing: Unavailable },
    /// The work is ready for so many invocations.
    Ready { id: u64, capacity: usize },
    /// The work is refused.
    Refused { id: u64, error: LaneError },
    /// A piece from this invocation on is about to be run.
    At { run: u64, invocation: usize },
    /// The run is done; the words of all records come behind, and none after a run piece by piece.
    Done { run: u64, marks: Marks },
    /// The run failed.
    Failed { run: u64, error: LaneError },
}
