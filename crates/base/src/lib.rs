//! What everything else names: source text with spans and edits, diagnostics as data, and values as bits.

pub mod diagnostic;
mod nearest;
pub mod text;
pub mod value;

pub use nearest::{did_you_mean, nearest};
