//! Reports of `shadercheck check`.

mod block;
#[cfg(feature = "run")]
mod ci;
#[cfg(feature = "run")]
mod items;
mod json;
mod not_run;
mod notes;
mod reach;
mod survey;
mod table;
mod text;
mod translations;

#[cfg(feature = "run")]
pub use ci::ci;
#[cfg(feature = "run")]
pub use items::about;
pub use json::json;
#[cfg(feature = "run")]
pub(crate) use reach::facts as reached;
pub use table::{Table, short};
pub use text::{brief, finding, line, line_as, not_run, refusal, totals};
