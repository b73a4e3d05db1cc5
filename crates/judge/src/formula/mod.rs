//! What a reference formula is: a function in binary64 with named inputs and outputs.
//!
//! The names are those of the shader's attributes, uniforms and outputs (of a function: its parameters, and `return`),
//! in the shader's order. Points are homogeneous columns, matrices act from the left. Where a formula has no value (a
//! direction of a zero vector, say) it writes NaN.

mod args;

pub use args::{Args, Emission, Kind, Param};

/// A named reference formula.
pub struct Formula {
    /// Name, as suites write it.
    pub name: &'static str,
    /// What it computes and where it comes from: equation number or reference.
    pub source: &'static str,
    /// Inputs in the order of [`Args`].
    pub inputs: &'static [Param],
    /// Outputs in order. Their words follow each other without padding.
    pub outputs: &'static [Param],
    /// How outputs come about.
    pub rule: Rule,
}

/// How a formula gives its outputs.
pub enum Rule {
    /// One set of outputs for each set of inputs: vertex stages and functions.
    Pointwise(fn(&Args<'_>, &mut [f64])),
    /// A list of vertices in strips for each set of inputs: geometry stages.
    Emission(fn(&Args<'_>, &mut Emission)),
}
