//! Suites that are part of the program.

use thiserror::Error;

use base::nearest;

use crate::catalogue;

/// A suite that comes with the program, with the text of its shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShippedSuite {
    /// Name of the suite.
    pub name: &'static str,
    /// Path of the suite file below `shaders/`.
    pub path: &'static str,
    /// Text of the suite file.
    pub toml: &'static str,
    /// File name of the shader.
    pub shader_name: &'static str,
    /// Text of the shader.
    pub shader_text: &'static str,
}

/// All suites that come with the program, in the order in which they are run and listed.
pub fn shipped() -> impl Iterator<Item = &'static ShippedSuite> {
    catalogue::suites()
}

/// A name that no shipped suite has.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error(
    "there is no suite `{name}`{}",
    .suggestion.map_or_else(|| format!("; suites are {}", names()), |s| format!("; did you mean `{s}`?"))
)]
pub struct UnknownSuite {
    /// The name.
    pub name: String,
    /// The suite with the most similar name.
    pub suggestion: Option<&'static str>,
}

fn names() -> String {
    shipped().map(|s| s.name).collect::<Vec<_>>().join(", ")
}

/// The shipped suite with this name.
///
/// # Errors
/// [`UnknownSuite`] with the most similar name.
pub fn find(name: &str) -> Result<&'static ShippedSuite, UnknownSuite> {
    shipped()
        .find(|s| s.name == name)
        .ok_or_else(|| UnknownSuite { name: name.to_owned(), suggestion: nearest(name, shipped().map(|s| s.name)) })
}
