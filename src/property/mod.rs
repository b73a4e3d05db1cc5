//! Properties: strategies that make inputs, relations between outputs, batches of cases, shrinking.

mod relation;
pub mod relations;
mod sample;

pub use relation::{Claim, Observed, Relation};
pub use sample::Sample;
