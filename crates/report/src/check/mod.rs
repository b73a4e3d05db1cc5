//! Reports of `shadercheck check`.

mod block;
mod ci;
mod items;
mod json;
mod not_run;
mod notes;
mod reach;
mod survey;
mod table;
mod text;
mod translations;

pub use ci::ci;
pub use items::about;
pub use json::json;
pub(crate) use reach::facts as reached;
pub use table::{Table, short};
pub use text::{brief, finding, line, line_as, not_run, refusal, totals};
