//! Host code in C and C++, by its syntax tree.

pub mod attach;
pub mod constants;
pub mod creation;
pub mod embedded;
pub mod fed;
pub mod feeds;
pub mod group;
pub mod index;
pub mod lookup;
pub mod presets;
pub mod program;
pub mod programs;
pub mod stringized;
pub mod tree;
pub mod wrappers;

pub use embedded::Embedded;
pub use fed::Fed;
pub use feeds::{Feeds, User};
pub use group::is_shader_name;
pub use lookup::{Lookup, LookupKind, Missing};
pub use presets::PRESETS;
pub use program::{ProgramSource, ShaderRef, named_shaders};
pub use programs::HostPrograms;
pub use tree::quoted_includes;
pub use wrappers::of_project as wrappers_of_project;
