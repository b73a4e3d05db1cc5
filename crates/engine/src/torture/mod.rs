//! Random programs: valid by construction, run on every lane and through every translator, and made smaller where one of
//! them shows something.
//!
//! ```text
//! seed, number ─ generate ─▶ Program ─ print ─▶ text, suite ─ session ─▶ events
//!                               ▲                                          │
//!                               └────────────── shrink ◀───────────────────┘─ cause ─▶ folder
//! ```
//!
//! A program is one tree whatever its language, so that one generator and one shrinker serve both printers.

mod cause;
mod generate;
mod inputs;
mod operations;
mod print;
mod program;
mod run;
mod shrink;
mod write;

#[cfg(test)]
mod tests;

pub use cause::EventKind;
pub use generate::{Wish, generate};
pub use operations::{OPERATIONS, Operation};
pub use print::{Printed, print};
pub use program::{Form, Language, Program};
pub use run::{Asked, Cause, Found, NAME, Outcome, SAMPLES, trial};
pub use write::Folder;
