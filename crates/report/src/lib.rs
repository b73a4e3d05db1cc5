//! Reports: text and JSON out of what suites and rules found. Without the feature `run`, those of rules alone.

mod actions;
#[cfg(feature = "run")]
pub mod check;
#[cfg(feature = "run")]
pub mod ci;
#[cfg(feature = "run")]
pub mod compare;
pub mod diagnostics;
#[cfg(feature = "run")]
pub mod fuzz;
mod gitlab;
#[cfg(feature = "run")]
pub mod html;
#[cfg(feature = "run")]
pub mod improve;
pub mod lint;
#[cfg(feature = "run")]
pub mod mutate;
pub mod page;
#[cfg(feature = "run")]
pub mod prove;
#[cfg(feature = "run")]
pub mod refdata;
#[cfg(feature = "run")]
pub mod reproducible;
mod reviewdog;
mod sarif;
#[cfg(feature = "run")]
pub mod torture;
#[cfg(feature = "run")]
pub mod trace;
#[cfg(feature = "run")]
pub mod tune;
#[cfg(feature = "run")]
pub mod unit_test;
#[cfg(feature = "run")]
mod word;
