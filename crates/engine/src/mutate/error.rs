//! Why a suite cannot be put to the test.

use thiserror::Error;

use crate::suite::run::RunError;
use lanes::LaneError;
use program::ProgramError;

/// Why no score can be given. None of these is about a mutant: they are about the original.
#[derive(Debug, Error)]
pub enum MutateError {
    /// The suite and its shader cannot be run.
    #[error(transparent)]
    Suite(#[from] RunError),
    /// The suite is about a dispatch so large that no mutant of it is judged in reasonable time.
    #[error("suite `{suite}`: no mutants of a dispatch whose buffers hold 4,096 words or more; name a smaller size")]
    Large {
        /// Name of the suite.
        suite: String,
    },
    /// The kernel cannot be made.
    #[error("suite `{suite}`: {source}")]
    Program {
        /// Name of the suite.
        suite: String,
        /// Why it cannot be made.
        source: ProgramError,
    },
    /// The original does not pass its own suite, so that a failing mutant would say nothing.
    #[error(
        "suite `{suite}`: the unchanged shader fails ({why}), so no mutant can be told from it; run `shadercheck check {suite}` and repair the shader or the suite first"
    )]
    Original {
        /// Name of the suite.
        suite: String,
        /// The first failure of the unchanged shader.
        why: String,
    },
    /// The lane failed on the original.
    #[error("suite `{suite}`: {source}")]
    Lane {
        /// Name of the suite.
        suite: String,
        /// How the lane failed.
        source: LaneError,
    },
    /// No sample was judged, so that no mutant could be killed.
    #[error("suite `{suite}`: none of {samples} samples was judged; widen the domain of its inputs")]
    Vacuous {
        /// Name of the suite.
        suite: String,
        /// Samples that were run.
        samples: u64,
    },
}
