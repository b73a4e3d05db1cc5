//! Reports of `shadercheck check`.

mod json;
mod text;

pub use json::json;
pub use text::{finding, line, totals};
