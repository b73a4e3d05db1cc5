//! piglit's tests of built-in functions, run by interpreter and lanes.

pub mod convert;
pub mod format;
pub mod judge;
