//! Properties: strategies that make inputs, relations between outputs, batches of cases, shrinking.

pub mod ball;
pub mod generators;
pub mod law;
mod own;
mod picture;
mod plan;
pub mod regressions;
mod relation;
pub mod rule;
mod sample;
mod sampler;
pub mod shrink;
mod strategy;
mod stream;

pub use own::Own;
pub use picture::{Axis, Picture, PictureKind};
pub use plan::{InputGroup, Plan, PlanError, pattern};
pub use relation::{Claim, Observed, Relation};
pub use sample::Sample;
pub use sample::{decode, encode};
pub use sampler::Sampler;
pub use strategy::{CaseStrategy, CaseTree};
pub use stream::{Stream, mix};
