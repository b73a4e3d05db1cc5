//! Single operations as programs of their own: a kernel for each, and arguments at which it is worth running.

mod inputs;
pub mod kernel;

use crate::profile::Op;

pub use inputs::{Arguments, Inputs};
pub use kernel::expression;

/// Operations that a kernel of their own can run.
pub fn measurable() -> impl Iterator<Item = Op> {
    Op::ALL.into_iter().filter(|op| expression(*op).is_some())
}
