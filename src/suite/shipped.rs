//! The suites that are part of the binary.

use thiserror::Error;

use crate::property::nearest;

/// A suite that comes with this crate, with the text of its shader.
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

/// One entry: folder, name of the suite, extension of the shader.
macro_rules! suites {
    ($($folder:literal $name:literal $extension:literal;)*) => {
        &[$(ShippedSuite {
            name: $name,
            path: concat!($folder, "/", $name, ".suite.toml"),
            toml: include_str!(concat!("../../shaders/", $folder, "/", $name, ".suite.toml")),
            shader_name: concat!($name, ".", $extension),
            shader_text: include_str!(concat!("../../shaders/", $folder, "/", $name, ".", $extension)),
        }),*]
    };
}

/// All suites that come with this crate, in the order in which they are run and listed.
pub fn shipped() -> &'static [ShippedSuite] {
    suites! {
        "chapter9" "sphere" "vert";
        "chapter9" "cylinder" "vert";
        "chapter9" "morph" "vert";
        "chapter9" "morph_targets" "vert";
        "chapter9" "joints" "vert";
        "chapter9" "two_bones" "vert";
        "chapter9" "segment_distance" "glsl";
        "chapter9" "bone_weight" "glsl";
        "chapter9" "skinning" "vert";
        "hair" "hermite" "glsl";
        "hair" "catmull_rom" "glsl";
        "hair" "cardinal" "glsl";
        "hair" "kochanek_bartels" "glsl";
        "hair" "hair" "geom";
    }
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
    shipped().iter().map(|s| s.name).collect::<Vec<_>>().join(", ")
}

/// The shipped suite with this name.
///
/// # Errors
/// [`UnknownSuite`] with the most similar name.
pub fn find(name: &str) -> Result<&'static ShippedSuite, UnknownSuite> {
    shipped().iter().find(|s| s.name == name).ok_or_else(|| UnknownSuite {
        name: name.to_owned(),
        suggestion: nearest(name, shipped().iter().map(|s| s.name)),
    })
}
