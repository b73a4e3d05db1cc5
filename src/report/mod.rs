//! Placeholder.

pub mod diagnostics;
