//! From files to pieces: shaders in literals of host code, in scripts and in documents, with the way back to their places,
//! and what the code around them says of them: look-ups, programs, feeds, macros.
//!
//! C and C++ are read by their syntax tree ([`cpp`]), other languages by their tokens ([`script`]).

mod body;
pub mod cpp;
pub mod defined;
pub mod depth;
pub mod document;
mod file;
pub mod language;
pub mod literal;
pub mod marks;
pub mod paths;
pub mod piece;
pub mod script;
pub mod sections;
pub mod setter;
pub mod spelling;
pub mod suggest;
pub mod wrapper;

pub use body::Body;
pub use cpp::{Embedded, HostPrograms, Lookup, LookupKind, Missing, ProgramSource, ShaderRef};
pub use file::{Found, HostFile, HostTree, comments, concerns_shaders};
pub use language::{HOST_EXTENSIONS, Language, SHADER_EXTENSIONS, language_of, language_of_file, stage_of};
pub use literal::Literal;
pub use piece::{Origin, Place};
pub use setter::Setter;
pub use wrapper::{Wrapped, Wrapper};
