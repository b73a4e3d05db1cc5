//! What can be wrong with a suite file.

use std::path::PathBuf;

use thiserror::Error;

use base::text::{Shown, TextError};
use disk::Problem;
use property::regressions::RegressionError;

/// Everything that is wrong in a suite file, in the order of the file; never empty.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{}", .problems.iter().map(Problem::to_string).collect::<Vec<_>>().join("\n"))]
pub struct SuiteError {
    /// Each with its place in the file; at least one.
    pub problems: Vec<Problem>,
}

/// Why a suite, its shader or its regressions cannot be read or written.
#[derive(Debug, Error)]
pub enum LoadError {
    /// A file cannot be read.
    #[error("cannot read `{}`: {source}", path.shown())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The shader that a suite names cannot be read.
    #[error("{at}: cannot read the shader `{}`: {source}", path.shown())]
    Shader {
        /// Where the suite names it.
        at: String,
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A folder cannot be searched.
    #[error("cannot read the folder `{}`: {source}", path.shown())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Another file that a suite names cannot be read.
    #[error("{at}: cannot read the {what} `{}`: {source}", path.shown())]
    Named {
        /// Where the suite names it.
        at: String,
        /// What it is to the suite.
        what: &'static str,
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file that a shader includes is there, and cannot be read.
    #[error("{at}: cannot include `{path}`: {why}")]
    Include {
        /// Where the shader includes it.
        at: String,
        /// The file, as the shader names it.
        path: String,
        /// What the system says, or why it is no text.
        why: String,
    },
    /// A file cannot be written.
    #[error("cannot write `{}`: {source}", path.shown())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file is not text.
    #[error(transparent)]
    Text(#[from] TextError),
    /// The suite file is wrong.
    #[error(transparent)]
    Suite(#[from] SuiteError),
    /// The regression file is wrong.
    #[error(transparent)]
    Regression(#[from] RegressionError),
}

/// A texture of a suite that does not fit the shader.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{at}: {message}")]
pub struct RunTextureError {
    /// Where the suite states it.
    pub at: String,
    /// What is wrong.
    pub message: String,
}
