//! Functions of a project that wrap those of OpenGL.

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
