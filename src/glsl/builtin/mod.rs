//! What the language brings along: functions (GLSL 4.60 specification, chapter 8) and variables
//! (chapter 7). Which version brought each is not checked here; rules about versions are lint
//! rules.

mod functions;
mod textures;
mod variables;

pub(crate) use functions::{Signature, functions, names as function_names};
pub(crate) use variables::{Builtin, names as variable_names, variable};
