//! Reports of `shadercheck check`.

mod json;
mod survey;
mod text;
mod translations;

pub use json::json;
pub use text::{finding, line, totals};
