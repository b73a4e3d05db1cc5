//! What lowering hands on.

use base::text::{Edited, SourceFile, Span};
use base::value::{Field, Shape};
use syntax::Stage;
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
    /// One function of a library: parameters in, `out` parameters and the return value out.
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

/// A variable of the interface and where the author declared it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variable {
    /// Name as the author wrote it.
    pub name: String,
    /// Shape of its value.
    pub shape: Shape,
    /// The name in the original text.
    pub span: Span,
    /// Location given to it, for attributes and varyings of a vertex stage.
    pub location: Option<u32>,
}

impl Variable {
    /// The variable as a field of a record.
    pub fn field(&self) -> Field {
        Field { name: self.name.clone(), shape: self.shape }
    }
}

/// A shader in the dialect that naga reads, with the way back to the author's text.
#[derive(Clone, Debug)]
pub struct Lowered {
    /// The author's text.
    pub file: SourceFile,
    /// The lowered text and the position map.
    pub edited: Edited,
    /// Stage of the text.
    pub stage: Stage,
    /// How the program is run.
    pub role: Role,
    /// Attributes of a vertex stage; inputs of a geometry stage, each an array over the vertices of
    /// the primitive (`gl_Position` stands for `gl_in[].gl_Position`); parameters of a function.
    pub inputs: Vec<Variable>,
    /// Uniforms, in order of declaration.
    pub uniforms: Vec<Variable>,
    /// Outputs that are captured: `gl_Position` first when it is written, then the user's outputs in
    /// order of declaration; for a function, `return` first, then `out` and `inout` parameters.
    pub outputs: Vec<Variable>,
    /// Macros that are given from outside: names and values.
    pub defines: Vec<(String, String)>,
}
