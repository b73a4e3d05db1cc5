//! What a project says about itself, as far as rules need it. Data; reading `shadercheck.toml` is the
//! work of `cli`.

use crate::prelude::Wanted;
use analysis::range::Stated;

/// What a project says about itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Config {
    /// Ranges of uniforms and inputs.
    pub ranges: Vec<Stated>,
    /// Programs whose stages cannot be found out from host code.
    pub programs: Vec<ProgramEntry>,
    /// Functions of the project that wrap those of OpenGL.
    pub wrappers: Vec<Wrapper>,
    /// Libraries whose wrappers are known, by their names in [`Config::PRESETS`].
    pub presets: Vec<String>,
    /// What hosts put around the shaders.
    pub prelude: Wanted,
}

impl Config {
    /// Names of libraries whose wrappers of OpenGL are known.
    pub const PRESETS: [&'static str; 3] = ["learnopengl", "qt", "gg"];

    /// The stated range of a variable, the first that matches.
    pub fn range_of(&self, name: &str) -> Option<(f64, f64)> {
        analysis::range::stated(&self.ranges, name)
    }
}

/// Shaders that are linked together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ProgramEntry {
    /// Paths of the shaders, from the folder of the configuration.
    pub shaders: Vec<String>,
    /// Paths of the host files that use the program.
    pub hosts: Vec<String>,
}

/// What a wrapped function does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrapped {
    /// Asks for the location of a uniform by name.
    UniformLocation,
    /// Asks for the location of an attribute by name.
    AttributeLocation,
    /// Sets a uniform by name.
    SetUniform,
    /// Makes a program from shader files or texts.
    LoadProgram,
}

impl Wrapped {
    /// All kinds, with the names that a configuration has for them.
    pub const ALL: [(&'static str, Self); 4] = [
        ("uniform-location", Self::UniformLocation),
        ("attribute-location", Self::AttributeLocation),
        ("set-uniform", Self::SetUniform),
        ("load-program", Self::LoadProgram),
    ];
}

/// A function of the project that wraps one of OpenGL.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wrapper {
    /// Name of the function or method, without its class.
    pub function: String,
    /// What it does.
    pub kind: Wrapped,
    /// Index of the argument that holds the name; 0 is the first. For [`Wrapped::LoadProgram`] of the
    /// first shader file.
    pub argument: usize,
    /// GLSL type that it sets (`mat4`), for [`Wrapped::SetUniform`].
    pub sets: Option<String>,
}
