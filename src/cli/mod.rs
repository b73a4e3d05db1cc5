//! Placeholder.

pub mod explain;
pub mod lint;
pub mod status;
