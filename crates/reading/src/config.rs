//! What a project says about itself, as far as rules need it. Data; reading `shadercheck.toml` is the
//! work of `cli`.

use std::collections::BTreeMap;

use crate::prelude::Wanted;
use analysis::range::Stated;
use hosts::Wrapper;

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
    /// Options of the shaders, beside those that their texts state.
    pub variants: Vec<Variant>,
    /// For shaders by their names, the macros that a host asks before it compiles them.
    pub asked_before: BTreeMap<String, Vec<String>>,
}

/// A macro with which shaders are compiled in several variants.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variant {
    /// The macro.
    pub name: String,
    /// What it may stand for; none for not being defined.
    pub values: Vec<Option<String>>,
}

impl Config {
    /// Names of libraries whose wrappers of OpenGL are known.
    pub const PRESETS: [&'static str; 3] = ["learnopengl", "qt", "gg"];

    /// True for a macro that decides whether the shader of this name is compiled at all.
    pub fn asks_before(&self, shader: &str, name: &str) -> bool {
        self.asked_before.get(shader).is_some_and(|names| names.iter().any(|own| own == name))
    }

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
