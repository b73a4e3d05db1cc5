//! Reports: text and JSON out of what suites and rules found.

mod actions;
pub mod check;
pub mod diagnostics;
pub mod fuzz;
pub mod html;
pub mod lint;
pub mod mutate;
pub mod page;
pub mod refdata;
mod sarif;
