//! Running suites and single functions on lanes: inputs, batches, verdicts, shrinking and parts of a run; mutants of
//! shaders, measurements of devices, and a device that errs as far as it may.

pub mod accuracy;
pub mod activity;
pub mod adversary;
mod bits;
pub mod calibrate;
pub mod catalogue;
pub mod check;
pub mod compare;
pub mod completion;
pub mod corners;
pub mod coverage;
pub mod dispatch;
mod elsewhere;
pub mod fuzz;
pub mod guess;
pub mod improve;
mod input_value;
pub mod mutate;
pub mod prove;
pub mod reproducible;
pub mod session;
pub mod shard;
pub mod suite;
pub mod torture;
pub mod trace;
pub mod tune;
pub mod unit_test;

pub use input_value::InputValue;
