//! What a stage shares with its neighbours and the host: inputs, outputs, uniforms, blocks,
//! constants and layouts, each with the byte spans of its parts in the original text.

use std::fmt;

use super::Stage;
use super::ast::{ArrayDim, ExprId, Ident, Qualifiers};
use super::fold::Const;
use super::symbols::SymbolId;
use super::types::Type;
use base::text::Span;

/// The stage interface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Interface {
    /// Inputs in the order of the text; `attribute`, and `varying` of a fragment shader, too.
    pub inputs: Vec<Variable>,
    /// Outputs in the order of the text; `varying` of a vertex shader too.
    pub outputs: Vec<Variable>,
    /// Uniforms outside blocks, samplers and images included.
    pub uniforms: Vec<Variable>,
    /// Global `const` variables.
    pub constants: Vec<Variable>,
    /// Global variables without storage qualifier, and `shared` ones.
    pub globals: Vec<Variable>,
    /// Blocks of any storage.
    pub blocks: Vec<Block>,
    /// Layout of a geometry stage; all parts absent in other stages.
    pub geometry: GeometryLayout,
    /// Every `layout(…) in;`, `layout(…) out;`, `layout(std140) uniform;` in order.
    pub stage_layouts: Vec<StageLayout>,
}

impl Interface {
    /// The input of that name.
    pub fn input(&self, name: &str) -> Option<&Variable> {
        self.inputs.iter().find(|v| v.name == name)
    }

    /// The output of that name.
    pub fn output(&self, name: &str) -> Option<&Variable> {
        self.outputs.iter().find(|v| v.name == name)
    }

    /// The uniform of that name, outside blocks.
    pub fn uniform(&self, name: &str) -> Option<&Variable> {
        self.uniforms.iter().find(|v| v.name == name)
    }

    /// The global constant of that name.
    pub fn constant(&self, name: &str) -> Option<&Variable> {
        self.constants.iter().find(|v| v.name == name)
    }

    /// Inputs, outputs, uniforms, constants and other globals, outside blocks.
    pub fn variables(&self) -> impl Iterator<Item = &Variable> {
        self.inputs.iter().chain(&self.outputs).chain(&self.uniforms).chain(&self.constants).chain(&self.globals)
    }
}

/// Where a global variable lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Storage {
    /// Input of the stage.
    In,
    /// Output of the stage.
    Out,
    /// Set by the host.
    Uniform,
    /// Storage block.
    Buffer,
    /// Shared by a work group.
    Shared,
    /// `const`
    Const,
    /// A plain variable.
    Global,
}

/// A global variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name in the text; interfaces of stages are matched by it where there is no location.
    pub name: String,
    /// Place of the name.
    pub name_span: Span,
    /// Its type with all dimensions; sizes are folded, and an unsized geometry input has the
    /// number of vertices of the input primitive.
    pub ty: Type,
    /// Where it lives.
    pub storage: Storage,
    /// Its qualifiers, each with its place; `Qualifiers::storage()` gives the keyword.
    pub qualifiers: Qualifiers,
    /// Place of the type specifier, with the dimensions right behind it.
    pub type_span: Span,
    /// Dimensions behind the name, as written.
    pub dims: Vec<ArrayDim>,
    /// The initialiser.
    pub initializer: Option<ExprId>,
    /// Value of a constant, when it could be folded.
    pub value: Option<Const>,
    /// The whole statement, with the `;`.
    pub declaration_span: Span,
    /// Name, dimensions and initialiser, without the comma.
    pub declarator_span: Span,
    /// Index of the declaration among the items of the unit.
    pub item: usize,
    /// Position among the declarators of that declaration, from 0.
    pub position: usize,
    /// How many declarators the declaration has.
    pub siblings: usize,
    /// Its symbol: uses are found by it.
    pub symbol: SymbolId,
}

impl Variable {
    /// True for a specialization constant, `layout(constant_id = 3) const uint N = 32;`: a host may set another value.
    pub fn is_specialized(&self) -> bool {
        self.qualifiers.layout_entry("constant_id").is_some()
    }
}

/// A uniform, storage, input or output block.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Name of the block, with its place.
    pub name: Ident,
    /// Where it lives: `In`, `Out`, `Uniform` or `Buffer`.
    pub storage: Storage,
    /// The qualifiers of the block.
    pub qualifiers: Qualifiers,
    /// Members in the order of their layout.
    pub members: Vec<BlockMember>,
    /// The instance: name with place, if there is one.
    pub instance: Option<Ident>,
    /// Dimensions of the instance, as written.
    pub dims: Vec<ArrayDim>,
    /// Type of the instance: a structure of the members, or an array of it.
    pub ty: Type,
    /// Symbol of the instance, if there is one.
    pub symbol: Option<SymbolId>,
    /// The whole statement, with the `;`.
    pub span: Span,
    /// From `{` to `}`.
    pub body_span: Span,
    /// Index of the block among the items of the unit.
    pub item: usize,
}

/// A member of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockMember {
    /// Its name, with its place.
    pub name: Ident,
    /// Type with all dimensions; `Unsized` for the last array of a buffer.
    pub ty: Type,
    /// Its own qualifiers.
    pub qualifiers: Qualifiers,
    /// Place of the type specifier.
    pub type_span: Span,
    /// Dimensions behind the name, as written.
    pub dims: Vec<ArrayDim>,
    /// The whole member declaration, with the `;`.
    pub declaration_span: Span,
    /// Symbol of the member, when the block has no instance name.
    pub symbol: Option<SymbolId>,
}

/// A value with its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Located<T> {
    /// What the layout entry says.
    pub value: T,
    /// Its place: the layout entry.
    pub span: Span,
}

/// `layout(…) in;` and the like.
#[derive(Clone, Debug, PartialEq)]
pub struct StageLayout {
    /// The storage it applies to; none in `layout(…);` without a keyword.
    pub storage: Option<Storage>,
    /// The qualifiers with entries and places.
    pub qualifiers: Qualifiers,
    /// The whole statement, with the `;`.
    pub span: Span,
    /// Index among the items of the unit.
    pub item: usize,
}

/// Layout of a geometry stage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GeometryLayout {
    /// What one invocation takes; none where the text does not say.
    pub input: Option<Located<InputPrimitive>>,
    /// What is emitted; none where the text does not say.
    pub output: Option<Located<OutputPrimitive>>,
    /// Most vertices that one invocation may emit.
    pub max_vertices: Option<Located<u32>>,
    /// Invocations per primitive.
    pub invocations: Option<Located<u32>>,
}

/// Primitive that a geometry stage takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum InputPrimitive {
    /// `points`
    Points,
    /// `lines`
    Lines,
    /// `lines_adjacency`
    LinesAdjacency,
    /// `triangles`
    Triangles,
    /// `triangles_adjacency`
    TrianglesAdjacency,
}

impl InputPrimitive {
    /// The primitive of a layout key.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "points" => Self::Points,
            "lines" => Self::Lines,
            "lines_adjacency" => Self::LinesAdjacency,
            "triangles" => Self::Triangles,
            "triangles_adjacency" => Self::TrianglesAdjacency,
            _ => return None,
        })
    }

    /// The layout key.
    pub fn name(self) -> &'static str {
        match self {
            Self::Points => "points",
            Self::Lines => "lines",
            Self::LinesAdjacency => "lines_adjacency",
            Self::Triangles => "triangles",
            Self::TrianglesAdjacency => "triangles_adjacency",
        }
    }

    /// Vertices of one primitive: the length of `gl_in`.
    pub fn vertices(self) -> u32 {
        match self {
            Self::Points => 1,
            Self::Lines => 2,
            Self::LinesAdjacency => 4,
            Self::Triangles => 3,
            Self::TrianglesAdjacency => 6,
        }
    }
}

impl fmt::Display for InputPrimitive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Primitive that a geometry stage makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OutputPrimitive {
    /// `points`
    Points,
    /// `line_strip`
    LineStrip,
    /// `triangle_strip`
    TriangleStrip,
}

impl OutputPrimitive {
    /// The primitive of a layout key.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "points" => Self::Points,
            "line_strip" => Self::LineStrip,
            "triangle_strip" => Self::TriangleStrip,
            _ => return None,
        })
    }

    /// The layout key.
    pub fn name(self) -> &'static str {
        match self {
            Self::Points => "points",
            Self::LineStrip => "line_strip",
            Self::TriangleStrip => "triangle_strip",
        }
    }

    /// Vertices of one of the primitives into which a strip is cut.
    pub fn corners(self) -> usize {
        match self {
            Self::Points => 1,
            Self::LineStrip => 2,
            Self::TriangleStrip => 3,
        }
    }
}

impl fmt::Display for OutputPrimitive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Storage {
    /// What a storage qualifier means at file scope of a stage.
    pub fn of(qualifier: super::ast::StorageQualifier, stage: Stage) -> Self {
        use super::ast::StorageQualifier as Q;
        match qualifier {
            Q::Const => Self::Const,
            Q::In | Q::Attribute => Self::In,
            Q::Out | Q::InOut => Self::Out,
            Q::Varying if stage == Stage::Fragment => Self::In,
            Q::Varying => Self::Out,
            Q::Uniform => Self::Uniform,
            Q::Buffer => Self::Buffer,
            Q::Shared => Self::Shared,
        }
    }
}
