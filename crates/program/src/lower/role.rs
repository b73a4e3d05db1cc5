//! How a program is run.

use syntax::interface::{InputPrimitive, OutputPrimitive};

/// How the program is run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Role {
    /// A vertex stage: attributes in, `gl_Position` and varyings out.
    Vertex,
    /// A fragment stage: interpolated inputs in, colours out.
    Fragment,
    /// A compute stage.
    Compute,
    /// A geometry stage, turned into a function over the vertices of one primitive.
    Geometry(Primitives),
    /// One function of a library: parameters in, `out` parameters and the return value out. Also the `main` of a
    /// tessellation stage, for one invocation: the vertices of a patch in, its outputs out.
    Function {
        /// Name of the function.
        name: String,
    },
}

/// What a geometry stage takes and gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Primitives {
    /// Input primitive.
    pub input: InputPrimitive,
    /// Output primitive.
    pub output: OutputPrimitive,
    /// Declared limit of emitted vertices.
    pub max_vertices: u32,
}

impl Primitives {
    /// Vertices of one input primitive.
    pub fn input_vertices(&self) -> u32 {
        self.input.vertices()
    }
}
