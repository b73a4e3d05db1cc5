//! Running suites and single functions on lanes: inputs, batches, verdicts, shrinking and parts of a run; mutants of
//! shaders, measurements of devices, and a device that errs as far as it may.

#![cfg_attr(
    not(feature = "tools"),
    allow(dead_code, unused_imports, reason = "parts of `fuzz` serve the tools, and suites take others")
)]

#[cfg(feature = "tools")]
pub mod accuracy;
pub mod activity;
pub mod adversary;
#[cfg(feature = "tools")]
mod bits;
#[cfg(feature = "tools")]
pub mod calibrate;
pub mod catalogue;
pub mod check;
#[cfg(feature = "tools")]
pub mod compare;
pub mod completion;
#[cfg(feature = "tools")]
pub mod corners;
pub mod coverage;
pub mod dispatch;
mod elsewhere;
pub mod fuzz;
pub mod guess;
#[cfg(feature = "tools")]
pub mod improve;
mod input_value;
#[cfg(feature = "tools")]
pub mod mutate;
#[cfg(feature = "tools")]
pub mod prove;
#[cfg(feature = "tools")]
pub mod reproducible;
pub mod session;
pub mod shard;
pub mod suite;
#[cfg(feature = "tools")]
pub mod torture;
#[cfg(feature = "tools")]
pub mod trace;
#[cfg(feature = "tools")]
pub mod tune;
#[cfg(feature = "tools")]
pub mod unit_test;

pub use input_value::InputValue;
