//! The interpreter on small functions, against values derived without it.

mod control;
mod dispatched;
mod faults;
mod functions;
mod memory;
mod operators;
mod ranges;
mod rearrange;
mod refusals;
mod support;
mod wide;

pub(in crate::interp) use support::{kernel, wgsl};
