//! The program `shadercheck`: lint, property tests and reference data for shaders, on a machine without a GPU.
//!
//! Tests of shaders in Rust are the crate `shadercheck-test`. What is here is the command line, and changes without notice.

pub mod cli;

// Its catalogue is found by every program that links it.
#[cfg(feature = "run")]
use chapter as _;
