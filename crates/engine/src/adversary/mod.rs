//! A conforming device that is as bad as its profile allows, to test what judges devices.
//!
//! Each operation of binary32 numbers gives a binary32 number that the profile accepts, chosen by a
//! [`Strategy`]; where nothing is promised it gives anything, NaN included. Whoever calls a result of
//! this device wrong is wrong, unless a [`Fault`] was planted.
//!
//! What a device does is a function of the seed, the inputs of the invocation, the place in the
//! program and the operands: the same sample gives the same result again, wherever it stands in a
//! batch. Signs of zeros change by flushes alone, and `NaN` and infinity are found by `isnan` and
//! `isinf`, though no specification promises that.

mod choice;
mod device;
mod domain;
mod lane;
#[cfg(test)]
mod lowered;
mod memory;
#[cfg(test)]
mod programs;
#[cfg(test)]
mod tests;

pub use choice::{Place, Strategy};
pub use device::{Device, Fault};
pub use domain::{Adversary, Column};
pub use lane::AdversaryLane;
