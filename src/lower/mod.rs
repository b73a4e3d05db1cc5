//! From desktop GLSL to the dialect that naga reads, as edits of the author's text.

mod lowered;

pub use lowered::{InputPrimitive, Lowered, OutputPrimitive, Primitives, Role, Variable};
