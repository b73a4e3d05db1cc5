//! Programs: shaders that are linked together.

mod around;
mod find;
pub mod link;
mod resolve;

use syntax::Stage;
use syntax::interface::{Storage, Variable};

use crate::project::ShaderFile;

pub use find::find;
pub use resolve::resolve;

/// The stages in the order of the pipeline.
const PIPELINE: [Stage; 6] =
    [Stage::Vertex, Stage::TessControl, Stage::TessEvaluation, Stage::Geometry, Stage::Fragment, Stage::Compute];

/// How a program is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// A host file makes it.
    Host,
    /// The configuration states it.
    Config,
    /// Its shaders have one name in one folder.
    Name,
}

/// The stages of one program, at most one shader each.
#[derive(Clone)]
pub struct Program<'p> {
    shaders: Vec<&'p ShaderFile>,
    known: Known,
    /// True when every stage is there, and nothing but its text decides its interface.
    complete: bool,
    /// Names of those of its shaders that are part of other programs too.
    shared: Vec<&'p str>,
}

impl<'p> Program<'p> {
    /// A program of these shaders, in the order of the pipeline; `all` says that none is missing. None
    /// without a shader.
    pub fn new(mut shaders: Vec<&'p ShaderFile>, all: bool) -> Option<Self> {
        let rank = |s: &&ShaderFile| PIPELINE.iter().position(|p| *p == s.shader.stage());
        shaders.sort_by_key(rank);
        let complete = all && shaders.iter().all(|s| s.is_plain());
        (!shaders.is_empty()).then_some(Self { shaders, complete, known: Known::Host, shared: Vec::new() })
    }

    /// The same program, known in this way.
    #[must_use]
    pub fn known(mut self, known: Known) -> Self {
        self.known = known;
        self
    }

    /// How the program is known.
    pub fn how_known(&self) -> Known {
        self.known
    }

    /// True when this shader of the program is part of other programs too.
    pub fn shares(&self, shader: &ShaderFile) -> bool {
        self.shared.contains(&shader.file.name())
    }

    /// The shaders, in the order of the pipeline.
    pub fn shaders(&self) -> &[&'p ShaderFile] {
        &self.shaders
    }

    /// The shader of a stage, when its interface is known.
    pub fn stage(&self, stage: Stage) -> Option<&'p ShaderFile> {
        self.shaders.iter().copied().find(|s| s.shader.stage() == stage && s.is_plain())
    }

    /// The vertex stage, when its interface is known.
    pub fn vertex(&self) -> Option<&'p ShaderFile> {
        self.stage(Stage::Vertex)
    }

    /// The declaration of an attribute.
    pub fn attribute(&self, name: &str) -> Option<(&'p ShaderFile, &'p Variable)> {
        let vertex = self.vertex()?;
        vertex.shader.interface().input(name).map(|v| (vertex, v))
    }

    /// The first declaration of a uniform outside blocks.
    pub fn uniform(&self, name: &str) -> Option<(&'p ShaderFile, &'p Variable)> {
        self.shaders.iter().copied().find_map(|s| s.shader.interface().uniform(name).map(|v| (s, v)))
    }

    /// Names of all uniforms outside blocks.
    pub fn uniforms(&self) -> impl Iterator<Item = &'p str> + '_ {
        self.shaders.iter().copied().flat_map(|s| s.shader.interface().uniforms.iter().map(|v| v.name.as_str()))
    }

    /// True when a block of uniforms or a buffer, its instance or a member has this name, in any stage.
    pub fn in_block(&self, name: &str) -> bool {
        let blocks = self.shaders.iter().flat_map(|s| &s.shader.interface().blocks);
        blocks.filter(|b| !matches!(b.storage, Storage::In | Storage::Out)).any(|block| {
            block.name.name == name
                || block.instance.as_ref().is_some_and(|i| i.name == name)
                || block.members.iter().any(|m| m.name.name == name)
        })
    }

    /// True when no stage is missing, and the interface of each is known.
    pub fn is_whole(&self) -> bool {
        self.complete
    }

    /// True when the interface of all stages is known, a vertex and a fragment stage (or a compute
    /// stage) among them: only then can a uniform be missing.
    pub fn is_complete(&self) -> bool {
        let has = |stage| self.shaders.iter().any(|s| s.shader.stage() == stage);
        self.complete && (has(Stage::Compute) || (has(Stage::Vertex) && has(Stage::Fragment)))
    }

    /// Neighbours in the pipeline: the stage that writes and the one that reads. Empty when the
    /// interface of a stage is not known.
    pub fn links(&self) -> impl Iterator<Item = (&'p ShaderFile, &'p ShaderFile)> + '_ {
        // A text without `main` is a part of its stage, and no stage before it.
        let stages = self.shaders.iter().copied().filter(|s| self.complete && s.shader.stage() != Stage::Library);
        let stages: Vec<&'p ShaderFile> = stages.collect();
        let links: Vec<_> = stages.windows(2).map(|w| (w[0], w[1])).collect();
        links.into_iter().filter(|(_, to)| to.shader.stage() != Stage::Compute)
    }

    /// The files, for messages.
    pub fn names(&self) -> String {
        self.shaders.iter().map(|s| s.file.name()).collect::<Vec<_>>().join(", ")
    }
}
