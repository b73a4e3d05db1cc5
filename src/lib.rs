//! Property tests, lint and reference data for shaders, on a machine without a GPU.

pub mod bound;
pub mod cli;
pub mod diagnostic;
pub mod formula;
pub mod fuzz;
pub mod glsl;
pub mod interp;
pub mod lane;
pub mod lint;
pub mod lower;
pub mod math;
pub mod mutate;
pub mod program;
pub mod property;
pub mod report;
pub mod suite;
pub mod text;
pub mod value;
pub mod verdict;
