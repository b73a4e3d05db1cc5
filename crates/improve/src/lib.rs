//! Other formulas for an expression of real numbers, and how many bits each loses in binary32.
//!
//! ```text
//! Term ─ rules ─▶ e-graph, each class with its values at the points ─ estimate of error ─▶ terms
//!      ─ run in binary32 at many points ─▶ Candidate, or two of them with a threshold between
//! ```
//!
//! What this crate finds is a proposal. Its rules hold in real numbers, its guards are looked up at points; whoever writes
//! a proposal into a text proves it first.
//!
//! Each class has its values in numbers of 320 bits at a few dozen points, so that a rule that is wrong at one of
//! them changes nothing. What lies between these points the search does not know: the proof compares the proposal
//! with the original at 2^20 points that the search has not seen, at the ends of ranges and at 0.

mod error;
mod extract;
mod graph;
mod lift;
mod normal;
mod proof;
mod real;
mod regimes;
pub mod rules;
mod search;
mod series;
mod single;
mod term;
#[cfg(test)]
mod tests;
mod write;

pub use egg::Id;
pub use error::{WORST, bits};
pub use graph::Points;
pub use proof::{Proof, prove};
pub use regimes::Split;
pub use search::{Candidate, Improved, Settings, cost, measure, search};
pub use single::{Losses, folded, reference, run};
pub use term::{Binary, Constant, Node, Term, Unary, parse, rooted};
pub use write::{Component, Dialect, LeafText, written};
