//! Reports: text and JSON out of what suites and rules found. The feature `lint` brings those of rules, `suites` those of
//! suites, and `run` all that runs shaders.

#[cfg(feature = "lint")]
mod actions;
#[cfg(feature = "suites")]
pub mod check;
#[cfg(feature = "run")]
pub mod ci;
#[cfg(feature = "run")]
pub mod compare;
pub mod diagnostics;
#[cfg(feature = "run")]
pub mod fuzz;
#[cfg(feature = "lint")]
mod gitlab;
#[cfg(feature = "run")]
pub mod html;
#[cfg(feature = "run")]
pub mod improve;
#[cfg(feature = "lint")]
pub mod lint;
#[cfg(feature = "run")]
pub mod mutate;
#[cfg(feature = "lint")]
pub mod page;
#[cfg(feature = "run")]
pub mod prove;
#[cfg(feature = "run")]
pub mod refdata;
#[cfg(feature = "run")]
pub mod reproducible;
#[cfg(feature = "lint")]
mod reviewdog;
#[cfg(feature = "lint")]
mod sarif;
#[cfg(feature = "run")]
pub mod torture;
#[cfg(feature = "run")]
pub mod trace;
#[cfg(feature = "run")]
pub mod tune;
#[cfg(feature = "run")]
pub mod unit_test;
#[cfg(feature = "suites")]
mod word;
