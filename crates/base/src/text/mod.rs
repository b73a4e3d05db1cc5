//! Source text: files with line and column positions, byte spans, encodings, and edits that map
//! positions both ways. A leaf of the dependency graph.

mod assembly;
mod edit;
mod encoding;
mod expansion;
mod fingerprint;
mod location;
mod source;

pub use assembly::Assembly;
pub use edit::{Edit, EditConflict, EditList, Edited, PositionMap};
pub use encoding::{Decoded, EncodeError, Encoding, Form, decode, decode_western};
pub use expansion::Expansion;
pub use fingerprint::fingerprint;
pub use location::Location;
pub use source::{Position, Shown, SourceFile, Span, TextError, printable};

/// A number of things: `1 finding`, `2 findings`.
pub fn counted(many: u64, word: &str) -> String {
    format!("{many} {word}{}", if many == 1 { "" } else { "s" })
}
