//! Reference data: inputs, what is expected of them, and how far a device may be off, in files that others
//! read; and the comparison of anyone's outputs with such a file.
//!
//! ```text
//! suite ─ sampler ─▶ inputs ─┬─ exact ──▶ expected, nearest, marks ─┐
//!                            └─ tape ───▶ bounds, doubts ───────────┴─▶ Block ─▶ writer ─▶ file
//! file ─ reader ─▶ Dataset ─┐
//! outputs ─ reader ─▶ Given ┴─ verify ─▶ verdict
//! ```
//!
//! A block is a pure function of the suite, the seed, the profile and its own number. Its arrays hold
//! bytes in the order of the least significant first, whatever the format of the file: every format reads
//! back to the same bytes, and one digest holds for all.
//!
//! Nothing here opens a file: writers and readers are handed what they write to and read from.

mod array;
mod bytes;
mod columns;
mod digest;
mod document;
mod flags;
mod generate;
mod inputs;
mod layout;
mod number;
mod produce;
pub mod read;
pub mod scene;
mod subject;
#[cfg(test)]
mod tests;
pub mod verify;
mod worker;
pub mod write;

pub use array::{Array, Per, Role, WordType};
pub use bytes::Bytes;
pub use digest::{Digest, run_key};
pub use document::{Document, SCHEMA, SCHEMA_VERSION, schema};
pub use flags::{Flag, Flags};
pub use generate::{Block, Generator, Unfit};
pub use produce::{CopyError, Forget, Keep, copy, produce};
pub use subject::{Bare, Origin, Subject};
