//! What follows from the text of a shader alone: which values an expression can take, what is written before it is read,
//! what the invocations of a work group do together, which numbers count pixels, and what names say.
//!
//! Nothing here judges: rules, hovers and readers of whole projects ask.

pub mod context;
pub mod emission;
pub mod entry;
pub mod flow;
pub mod forms;
pub mod kernel;
pub mod names;
pub mod numeric;
mod pixel_names;
mod pixel_units;
pub mod pixels;
pub mod range;
pub mod spelled;
pub mod uniformity;
