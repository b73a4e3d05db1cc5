//! Source text: files with line and column positions, byte spans, and edits that map positions
//! both ways. A leaf of the dependency graph.

mod edit;
mod source;

pub use edit::{Edit, EditConflict, EditList, Edited, PositionMap};
pub use source::{Position, SourceFile, Span, TextError};
