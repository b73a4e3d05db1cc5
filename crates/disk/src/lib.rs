//! Files that people name: source texts are read with a limit, TOML with the place of every value, and whatever is written
//! replaces its target as a whole.

pub mod fresh;
mod problem;
mod source;
pub mod table;

pub use problem::Problem;
pub use source::{MOST_BYTES, read_source};
