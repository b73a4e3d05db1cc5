//! What everything else names: source text with spans and edits, diagnostics as data, and values as bits.

pub mod diagnostic;
pub mod text;
pub mod value;
