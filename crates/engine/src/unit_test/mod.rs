//! Tests that stand in a shader: functions with `@test` in WGSL, which assert with the functions of the package `wgsl_test`,
//! and comments that begin with `@test` in GLSL.
//!
//! An assertion decides nothing where the shader runs: it writes down what it was given. So each expectation is held against
//! what every lane gives, and against real numbers with what a conforming device may be off, which tells a tolerance that
//! holds by luck from one that always holds.
//!
//! ```text
//! file ─ mark ─▶ the same text with a function for each test, which returns what was recorded ─▶ Ready
//! Ready ─┬─ trace: strict binary32 beside real numbers with bounds ─┬─▶ Expectation with its verdict
//!        └─ lanes ──────────────────────────────────────────────────┘
//! ```

mod comment;
mod mark;
mod module;
mod mutants;
mod record;
mod run;
mod verdict;

pub use mark::{Marked, UnitTest, mark};
pub use mutants::{Build, Passing, mutate};
pub use run::{Ran, Request, batch, run};
pub use verdict::{Expectation, Found, Kind, OnLane, Verdict};
