//! What the language brings along: functions (GLSL 4.60 specification, chapter 8) and variables
//! (chapter 7), and which version, profile, extension and stage has each.

mod functions;
mod since;
mod textures;
mod variables;

pub use functions::BuiltinFunction;
pub(crate) use functions::{Signature, functions, names as function_names};
pub(crate) use since::{
    Absent, WIDE_ATOMICS, function as function_absent, has_scalar, in_per_vertex, is_late, is_sized_name, type_since,
    variable as variable_absent,
};
pub use variables::is_given_by_a_stage;
pub(crate) use variables::{Builtin, names as variable_names, structure_type, variable};
