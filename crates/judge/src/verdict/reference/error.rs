//! Why what is expected does not fit a program.

use thiserror::Error;

/// Why what is expected does not fit a program.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum ReferenceError {
    /// The shader lacks an input.
    #[error("{by} needs an input `{name}` of type `{ty}`; the shader has {has}")]
    MissingInput {
        /// What gives the expectation, such as "the formula `sphere`".
        by: String,
        /// Name of the input.
        name: String,
        /// Type, as GLSL writes it, such as `vec4[8]`.
        ty: String,
        /// What the shader has.
        has: String,
    },
    /// The shader lacks an output.
    #[error("{by} gives an output `{name}` of type `{ty}`; the shader has {has}")]
    MissingOutput {
        /// What gives the expectation.
        by: String,
        /// Name of the output.
        name: String,
        /// Type, as GLSL writes it, such as `vec4[8]`.
        ty: String,
        /// What the shader has.
        has: String,
    },
    /// One side emits vertices, the other gives one set of outputs.
    #[error("{by} {gives}, which a {stage} does not")]
    Stage {
        /// What gives the expectation.
        by: String,
        /// What it gives.
        gives: &'static str,
        /// Stage of the shader.
        stage: &'static str,
    },
    /// Nothing of the shader is compared.
    #[error("{by} gives {gives}, and the shader has {has}: no output is in both{help}")]
    NothingInCommon {
        /// What gives the expectation.
        by: String,
        /// What it gives.
        gives: String,
        /// What the shader has.
        has: String,
        /// What to do; empty, or begins with `; `.
        help: &'static str,
    },
    /// The reference cannot be interpreted.
    #[error("{by} cannot be interpreted: {why}")]
    Interpreter {
        /// What gives the expectation.
        by: String,
        /// What the interpreter says.
        why: String,
    },
    /// Two rows of recorded values are about the same inputs.
    #[error("{by}: rows {first} and {second} have the same inputs and different outputs")]
    Contradiction {
        /// What gives the expectation.
        by: String,
        /// The first row, counted from 1.
        first: usize,
        /// The second row.
        second: usize,
    },
}
