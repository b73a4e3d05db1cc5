//! What a driver of OpenGL is asked to run, as data: texts, names and layouts, and nothing of naga. A job can be handed
//! to another process.

use serde::{Deserialize, Serialize};

use base::value::{Scalar, Shape};
use program::texture::TextureKind;

/// A stage with everything that a driver has to be told about it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Job {
    /// Texts of the stage, each compiled by itself and linked.
    pub texts: Vec<Text>,
    /// The stage that they make.
    pub stage: CaptureKind,
    /// A vertex stage in front of a geometry stage, which hands its attributes on.
    pub pass: Option<String>,
    /// Attributes of the vertex stage.
    pub attributes: Vec<Attribute>,
    /// For each vertex of an invocation, the words of the invocation's record that its attributes are, side by side.
    pub fed: Vec<Vec<u32>>,
    /// The word of that record that is `gl_VertexID`, where the stage reads it: each vertex is a draw of its own.
    pub vertex: Option<u32>,
    /// The word that is `gl_InstanceID`.
    pub instance: Option<u32>,
    /// Words of the record of an invocation.
    pub invocation_words: usize,
    /// Words of the record of a case.
    pub case_words: usize,
    /// Uniforms, in the order of the record of a case.
    pub uniforms: Vec<Named>,
    /// Outputs, in the order of the record of a vertex.
    pub outputs: Vec<Named>,
    /// What samplers are bound to.
    pub textures: Vec<Bound>,
    /// Storage buffers of a dispatch.
    pub buffers: Vec<StorageBuffer>,
}

/// A storage buffer of a dispatch.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StorageBuffer {
    /// Name of its block in the text.
    pub block: String,
    /// Its size.
    pub bytes: usize,
    /// Words of the record of an invocation that it holds before, each with its place in bytes.
    pub before: Vec<(u32, u32)>,
    /// Words of the record of outputs that it holds behind, each with its place in bytes.
    pub after: Vec<(u32, u32)>,
}

/// A text of a shader.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Text {
    /// What the driver compiles: the author's text, with macros that are given from outside behind its `#version`.
    pub text: String,
    /// Version of GLSL that it states.
    pub version: u32,
    /// True for GLSL ES.
    pub es: bool,
    /// Lines before the macros.
    pub before: u32,
    /// Lines of the macros.
    pub added: u32,
}

/// Which stage is captured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum CaptureKind {
    /// Points through a vertex stage.
    Vertex,
    /// Primitives through a geometry stage.
    Geometry {
        /// What is drawn.
        input: Input,
        /// What comes out, taken apart.
        output: Output,
        /// Declared limit of emitted vertices.
        max_vertices: u32,
    },
    /// Whole dispatches of a compute stage.
    Dispatch {
        /// Workgroups along x, y and z.
        groups: [u32; 3],
    },
}

/// Primitives that are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Input {
    /// One vertex.
    Points,
    /// Two vertices.
    Lines,
    /// Four vertices.
    LinesAdjacency,
    /// Three vertices.
    Triangles,
    /// Six vertices.
    TrianglesAdjacency,
}

/// Primitives of which strips consist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Output {
    /// One vertex.
    Points,
    /// Two vertices, each line after the first beginning where the one before ends.
    Lines,
    /// Three vertices, two of each triangle after the first being those of the one before.
    Triangles,
}

impl Output {
    /// Vertices of one primitive.
    pub fn vertices(self) -> usize {
        match self {
            Self::Points => 1,
            Self::Lines => 2,
            Self::Triangles => 3,
        }
    }

    /// Most primitives of so many emitted vertices.
    pub fn most(self, vertices: usize) -> usize {
        vertices.saturating_sub(self.vertices() - 1)
    }
}

/// A vertex attribute.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Attribute {
    /// Name in the text.
    pub name: String,
    /// Type of a component.
    pub scalar: Scalar,
    /// Components that are fed, 1 to 4.
    pub components: u8,
}

/// A uniform or an output.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Named {
    /// Name as OpenGL has it: members of a block bear the name of the block, not that of the instance.
    pub name: String,
    /// Shape of its value.
    pub shape: Shape,
}

/// A sampler with its texture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Bound {
    /// Name of the sampler.
    pub name: String,
    /// What kind of texture it takes.
    pub kind: TextureKind,
    /// Width, height, and depth or layers.
    pub size: [u32; 3],
    /// Four words a texel.
    pub words: Vec<u32>,
}

impl Job {
    /// True for a stage that reads numbers of the draw.
    pub fn reads_numbers(&self) -> bool {
        self.vertex.is_some() || self.instance.is_some()
    }

    /// Words of the outputs of one vertex.
    pub fn width(&self) -> usize {
        self.outputs.iter().map(|o| o.shape.words()).sum()
    }

    /// Vertices that one invocation is drawn with.
    pub fn vertices(&self) -> usize {
        self.fed.len()
    }

    /// Most words that one invocation can give.
    pub fn most_words(&self) -> usize {
        let vertices = match self.stage {
            CaptureKind::Vertex | CaptureKind::Dispatch { .. } => 1,
            CaptureKind::Geometry { output, max_vertices, .. } => {
                output.most(max_vertices as usize) * output.vertices()
            }
        };
        self.width() * vertices
    }
}

/// Inputs of one run, and what marks it.
#[derive(Clone, Debug)]
pub struct Inputs<'a> {
    /// Words of all invocations.
    pub invocations: &'a [u32],
    /// Words of all cases.
    pub cases: &'a [u32],
    /// Number of invocations.
    pub count: usize,
    /// Invocations of a case.
    pub per_case: usize,
    /// What the buffer holds before anything is drawn.
    pub sentinel: u32,
    /// Draws each invocation by itself and waits for it.
    pub one_by_one: bool,
}

/// What transform feedback wrote.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Captured {
    /// Words of all vertices, in the order in which they were captured.
    pub words: Vec<u32>,
    /// For a geometry stage, primitives of each invocation.
    pub primitives: Vec<u32>,
}
