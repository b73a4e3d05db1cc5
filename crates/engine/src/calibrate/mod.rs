//! Measures the operations of a device against exact values, and holds them against a promise.
//!
//! References are computed in binary64: within 2 ULP of binary64, and so within 2^-27 ULP of a binary32
//! result. An error that a table shows is good to that much.
//!
//! The work is cut into blocks. What was measured after a block is a [`State`], which can be written
//! down and continued.

mod against;
mod definition;
mod device;
mod probe;
mod search;
mod tally;
mod write;

use std::ops::Range;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use judge::profile::{Entry, Op, Profile, Rule, by_name};
use judge::single::kernel;
use lanes::{Lane, LaneError, Stage};
use program::ProgramError;

use device::MeasuredDevice;

pub use against::{Worsened, freer, worsened};
pub use definition::confirmed;
pub use judge::single::{Arguments, Inputs, expression, measurable};
pub use probe::{Behaviour, Fusion, probe};
pub use tally::{Judge, Tally, Worst};
pub use write::Document;

/// Words of one block of an exhaustive sweep; a power of two.
const SWEEP_BLOCK: u64 = 1 << 26;
/// Words that parts of an exhaustive sweep are multiples of: all numbers of one sign and exponent.
const SWEEP_UNIT: u64 = 1 << 23;
/// Samples of one block of a measurement by samples.
const SAMPLE_BLOCK: u64 = 1 << 22;
/// Words that are finite numbers of one sign.
const FINITE: u64 = 0x7f80_0000;

/// Why a device could not be measured.
#[derive(Debug, Error)]
pub enum CalibrateError {
    /// A kernel could not be made.
    #[error(transparent)]
    Program(ProgramError),
    /// The lane failed.
    #[error(transparent)]
    Lane(LaneError),
    /// A probe gave what neither of its alternatives gives.
    #[error("the probe for {what} gave {found:e}, which is no result of any rule; the device computes wrongly")]
    Odd {
        /// What was probed, such as `a product with a sum`.
        what: &'static str,
        /// What the device gave.
        found: f32,
    },
    /// A state was made by another request.
    #[error("the saved state is of another run: {what}; remove it or leave out --resume")]
    OtherRun {
        /// Which parameter differs, and how.
        what: String,
    },
    /// The state could not be saved.
    #[error("cannot save the state: {0}")]
    Save(std::io::Error),
}

/// What to measure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Request {
    /// Names of the operations, in the order of the table.
    pub ops: Vec<String>,
    /// Samples of each operation; specials come on top.
    pub samples: u64,
    /// All arguments of functions of one argument.
    pub exhaustive: bool,
    /// Results that the search for the worst arguments may compute, for each function of one argument that is not
    /// run on all of them; 0 for no search.
    #[serde(default)]
    pub search: u64,
    /// Device and driver.
    pub driver: String,
    /// Which part of the samples of each operation: its number from 0, and of how many.
    #[serde(default = "whole")]
    pub part: (u64, u64),
}

/// The part that is everything.
pub fn whole() -> (u64, u64) {
    (0, 1)
}

impl Request {
    fn operations(&self) -> Vec<Op> {
        self.ops.iter().filter_map(|name| Op::by_name(name)).collect()
    }

    /// True when all arguments of `op` are tried.
    pub fn sweeps(&self, op: Op) -> bool {
        self.exhaustive && op.arity() == Some(1)
    }

    /// Samples of an operation.
    pub fn size(&self, op: Op) -> u64 {
        if self.sweeps(op) { 2 * FINITE } else { self.samples + Inputs::new(op).special_count() as u64 }
    }

    /// The samples of an operation that belong to this part.
    pub fn range(&self, op: Op) -> Range<u64> {
        let size = self.size(op);
        // A dispatch of a sweep begins at a multiple of its size.
        let unit = if self.sweeps(op) { SWEEP_UNIT } else { 1 };
        let (index, count) = self.part;
        let at = |k: u64| {
            let units = u128::from(size.div_ceil(unit)) * u128::from(k) / u128::from(count.max(1));
            (units as u64).saturating_mul(unit).min(size)
        };
        at(index)..at(index + 1)
    }

    /// What the search for the worst arguments of an operation may compute. A search is not cut into parts: of several
    /// parts, each does that of some operations.
    fn searched(&self, op: Op) -> u64 {
        let (index, count) = self.part;
        let place = self.ops.iter().position(|name| name == op.name()).unwrap_or(0) as u64;
        let here = place % count.max(1) == index;
        if op.arity() == Some(1) && !self.exhaustive && here { self.search } else { 0 }
    }

    /// The positions of an operation in this part: those of its samples, and behind them as many as the search may
    /// compute.
    fn positions(&self, op: Op) -> Range<u64> {
        let range = self.range(op);
        range.start..range.end + self.searched(op)
    }

    /// Samples of all operations in this part, with what the search may compute.
    pub fn total(&self) -> u64 {
        self.operations().into_iter().map(|op| self.positions(op)).map(|range| range.end - range.start).sum()
    }
}

/// True when a lane runs an operation alone: not every driver has every version of GLSL.
///
/// # Errors
/// [`CalibrateError`] when the lane fails for another reason.
pub fn runs(lane: &dyn Lane, op: Op) -> Result<bool, CalibrateError> {
    match lane.prepare(&kernel::pointwise(op)?, 1) {
        Ok(_) => Ok(true),
        Err(LaneError::Unsupported(_)) => Ok(false),
        Err(error) => Err(error.into()),
    }
}

/// What was measured so far.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    request: Request,
    /// Tallies of the operations of the request that are complete, and of the one under way.
    tallies: Vec<Tally>,
    /// Samples of the last tally, and what its search has computed; all when it is complete.
    position: u64,
}

impl State {
    /// A state before the first sample.
    pub fn new(request: Request) -> Self {
        Self { request, tallies: Vec::new(), position: 0 }
    }

    /// This state, if it is of the same request.
    ///
    /// # Errors
    /// [`CalibrateError::OtherRun`] with what differs.
    pub fn resume(self, request: &Request) -> Result<Self, CalibrateError> {
        let (was, is) = (&self.request, request);
        let differs = [
            ("device", was.driver != is.driver, was.driver.clone(), is.driver.clone()),
            ("operations", was.ops != is.ops, was.ops.join(","), is.ops.join(",")),
            ("part", was.part != is.part, format!("{:?}", was.part), format!("{:?}", is.part)),
            ("samples", was.samples != is.samples, was.samples.to_string(), is.samples.to_string()),
            ("search", was.search != is.search, was.search.to_string(), is.search.to_string()),
            ("exhaustive", was.exhaustive != is.exhaustive, was.exhaustive.to_string(), is.exhaustive.to_string()),
        ];
        match differs.into_iter().find(|(_, differs, ..)| *differs) {
            Some((what, _, was, is)) => Err(CalibrateError::OtherRun { what: format!("{what} was {was} and is {is}") }),
            None => Ok(self),
        }
    }

    /// Samples done.
    pub fn done(&self) -> u64 {
        let complete = self.tallies.len().saturating_sub(1);
        let mut ranges = self.request.operations().into_iter().map(|op| self.request.positions(op));
        let sizes: u64 = ranges.by_ref().take(complete).map(|range| range.end - range.start).sum();
        let begin = ranges.next().map_or(0, |range| range.start);
        sizes + if self.tallies.is_empty() { 0 } else { self.position.saturating_sub(begin) }
    }

    /// Adds what was measured on another part of the same samples; the order does not matter. The result is a
    /// state of the whole once all parts are joined.
    ///
    /// # Errors
    /// [`CalibrateError::OtherRun`] when the other is no part of this, or one of both is not complete.
    pub fn join(&mut self, other: Self) -> Result<(), CalibrateError> {
        let is = Request { part: other.request.part, ..self.request.clone() };
        let other = other.resume(&is)?;
        let complete = |state: &Self| state.tallies.len() == state.request.ops.len();
        if !complete(self) || !complete(&other) {
            return Err(CalibrateError::OtherRun { what: "a part of it is not complete".to_owned() });
        }
        self.request.part = whole();
        self.tallies.iter_mut().zip(&other.tallies).for_each(|(one, other)| one.merge(other));
        self.position = self.request.operations().last().map_or(0, |op| self.request.positions(*op).end);
        Ok(())
    }

    /// Each operation with its tally.
    pub fn measurements(&self) -> Vec<(Op, &Tally)> {
        self.request.operations().into_iter().zip(&self.tallies).collect()
    }

    /// What is measured, and how densely.
    pub fn request(&self) -> &Request {
        &self.request
    }
}

/// Measures what is still to do. `saved` gets the state after every block, and the name of the
/// operation.
///
/// # Errors
/// [`CalibrateError`]; what was saved can be continued.
pub fn run(
    lane: &dyn Lane,
    state: &mut State,
    saved: &mut dyn FnMut(&State, Op) -> std::io::Result<()>,
) -> Result<(), CalibrateError> {
    let (text, suite) = promises();
    for (index, op) in state.request.operations().into_iter().enumerate() {
        let Range { start, end: size } = state.request.range(op);
        let end = state.request.positions(op).end;
        let complete = index + 1 < state.tallies.len() || (index + 1 == state.tallies.len() && state.position >= end);
        if complete {
            continue;
        }
        if index == state.tallies.len() {
            state.tallies.push(Tally::default());
            state.position = start;
        }
        let judge = Judge::new(op, text, suite, Stage::Compute);
        let sweeps = state.request.sweeps(op);
        if state.position < size {
            let mut device = MeasuredDevice::new(lane, op, sweeps)?;
            let block = if sweeps { SWEEP_BLOCK } else { SAMPLE_BLOCK };
            while state.position < size {
                let to = size.min(state.position + block);
                state.tallies[index].merge(&device.block(&judge, state.position..to)?);
                state.position = to;
                saved(state, op).map_err(CalibrateError::Save)?;
            }
        }
        if size < end {
            // What a search found is kept when it is over: one that was stopped begins anew.
            state.position = size;
            let found = search::worst(lane, op, &judge, end - size, &mut |computed| {
                state.position = (size + computed).min(end - 1);
                saved(state, op).map_err(CalibrateError::Save)
            })?;
            state.tallies[index].merge(&found);
            state.position = end;
            saved(state, op).map_err(CalibrateError::Save)?;
        }
    }
    Ok(())
}

/// The text of the specification that devices promise, and the rule of its conformance suite.
pub fn promises() -> (&'static Profile, &'static Profile) {
    let shipped = |name| by_name(name).unwrap_or_else(|| unreachable!("the profile `{name}` is part of the program"));
    (shipped("vulkan-1.4"), shipped("vulkan-cts"))
}

/// How the measured errors of an operation relate to what is promised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// All within the text of the specification.
    Inside,
    /// Some outside of the text, all accepted by the conformance suite.
    InsideSuite,
    /// Some that the conformance suite does not accept.
    Outside,
    /// Nothing is promised.
    NoPromise,
}

impl Standing {
    /// Of an operation with its tally.
    pub fn of(op: Op, tally: &Tally) -> Self {
        let (text, _) = promises();
        let promised = match text.entry(op) {
            Entry::Promised(pieces) => pieces.iter().any(|p| p.rule != Rule::NoPromise),
            Entry::Measured(_) => true,
        };
        match (promised, tally.outside_suite, tally.outside_text) {
            (false, ..) => Self::NoPromise,
            (true, 0, 0) => Self::Inside,
            (true, 0, _) => Self::InsideSuite,
            (true, ..) => Self::Outside,
        }
    }

    /// A few words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Inside => "inside",
            Self::InsideSuite => "inside the conformance rule only",
            Self::Outside => "outside",
            Self::NoPromise => "no promise",
        }
    }
}

#[cfg(test)]
mod tests;
