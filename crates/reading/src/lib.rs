//! The files of a project, read once: shaders with their interface, as far as the front end could read them, what their
//! texts leave open, and the programs that they are linked into.
//!
//! Nothing here knows a rule: what a text is does not depend on who asks.

pub mod composed;
pub mod conditions;
mod config;
mod dialect;
pub mod es;
pub mod hlsl;
pub mod in_front;
pub mod included;
mod level;
mod linked;
pub mod open;
pub mod options;
pub mod prelude;
pub mod program;
mod project;
pub mod relocate;
mod settled;
mod slip;
pub mod variants;

pub use composed::{Composed, Composer};
pub use config::{Config, ProgramEntry, Variant};
pub use level::Level;
pub use linked::{HostName, Linked, linked};
pub use project::{Input, Project, ShaderFile, companions};
pub use settled::Settled;
