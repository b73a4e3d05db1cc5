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
