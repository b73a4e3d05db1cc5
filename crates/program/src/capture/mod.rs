//! Capture: a pass over the naga module that makes a program's outputs readable, as transform
//! feedback would, without changing its body. The program's entry point becomes an ordinary function;
//! a new entry point feeds it and stores what it gives.
//!
//! There are two kernels, since they test different things. The *compute* kernel runs one
//! invocation per vertex (or primitive, or call) with attributes and uniforms of every case read
//! from storage buffers. The *vertex* kernel is a real vertex stage with vertex buffers and uniform
//! buffers that writes a storage buffer.

mod author;
mod builder;
mod compute;
mod dispatch;
mod feed;
mod geometry;
mod trace;
mod vertex;
mod words;

use std::sync::Arc;

use naga::valid::ModuleInfo;

use super::{Drawn, Program, ProgramError};
use base::value::{Batch, Field, Record};

pub(super) use builder::{Builder, add_global};
pub use dispatch::BoundBuffer;
pub use vertex::{Attribute, UniformBlock, UniformPlace};
pub use words::shape_of;

/// Bindings of group 0 of every kernel.
pub mod binding {
    /// Uniform `vec4<u32>`: invocation count, invocations per case, canary, sentinel.
    pub const PARAMS: u32 = 0;
    /// Storage, written: one output record per invocation.
    pub const OUTPUTS: u32 = 1;
    /// Storage, read: the words of all invocations (compute kernel only).
    pub const INVOCATIONS: u32 = 2;
    /// Storage, read: the words of all cases (compute kernel only).
    pub const CASES: u32 = 3;
    /// Uniform: the words of one invocation (kernel of uniforms only).
    pub const BLOCK: u32 = 4;

    /// Group in which textures and storage of the program are bound; what stands above has the first two.
    pub const TEXTURES: u32 = 2;

    /// The binding of a texture or sampler in its group.
    pub fn of(module: &naga::Module, handle: naga::Handle<naga::GlobalVariable>) -> Option<u32> {
        module.global_variables[handle].binding.filter(|b| b.group == TEXTURES).map(|b| b.binding)
    }
}

/// The words of [`binding::BLOCK`] for each invocation of a batch, `stride` words from one to the next: its index, its
/// inputs and its uniforms.
pub fn uniform_blocks(batch: &Batch, stride: usize) -> Vec<u32> {
    let mut words = vec![0; stride * batch.invocation_count()];
    for (index, block) in words.chunks_exact_mut(stride).enumerate() {
        let (invocation, case) = (batch.invocation(index), batch.case_of(index));
        block[0] = index as u32;
        block[1..][..invocation.len()].copy_from_slice(invocation);
        block[1 + invocation.len()..][..case.len()].copy_from_slice(case);
    }
    words
}

/// Name of the entry point of a kernel.
pub const ENTRY_POINT: &str = "capture";

/// Name that the program's own entry point has in a kernel, where it is an ordinary function.
pub(super) const ENTRY_FUNCTION: &str = "sc_entry";

/// Invocations of a workgroup of the compute kernel.
pub const WORKGROUP: u32 = 64;

/// Layout of the output record of one invocation, in words:
/// `canary ^ invocation`, then for a pointwise program the outputs; for a geometry stage the number
/// of emitted vertices (emissions past the limit are counted, not stored), the number of ended
/// strips, and for each of `max_vertices` vertices its strip and its outputs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputLayout {
    /// The outputs of one vertex.
    pub vertex: Arc<Record>,
    /// For a geometry stage, the number of vertices that the record has room for.
    pub max_vertices: Option<u32>,
}

impl OutputLayout {
    /// True where nothing is written that could be judged; a geometry stage at least says how much it emits.
    pub fn is_empty(&self) -> bool {
        self.vertex.words() == 0 && self.max_vertices.is_none()
    }

    /// Words before the first vertex.
    pub fn header_words(&self) -> usize {
        if self.max_vertices.is_some() { 3 } else { 1 }
    }

    /// Words of one vertex, its strip number included for a geometry stage.
    pub fn vertex_words(&self) -> usize {
        self.vertex.words() + usize::from(self.max_vertices.is_some())
    }

    /// Words of the whole record of one invocation.
    pub fn words(&self) -> usize {
        self.header_words() + self.vertex_words() * self.max_vertices.unwrap_or(1) as usize
    }
}

/// A program made runnable: a validated module and what to feed it.
#[derive(Clone, Debug)]
pub struct Kernel {
    /// The module; its only entry point is [`ENTRY_POINT`].
    pub module: naga::Module,
    /// What the validator found out about it.
    pub info: ModuleInfo,
    /// What one invocation gets.
    pub invocation: Arc<Record>,
    /// What one case gets.
    pub case: Arc<Record>,
    /// What one invocation writes.
    pub output: OutputLayout,
    /// How it runs.
    pub form: Form,
    /// The program, for a lane that runs it without the capture.
    pub program: Arc<Program>,
}

/// Where a shader's inputs come from. Each way is another path through a compiler: constants are folded,
/// uniforms are the same for all invocations, attributes go through the vertex fetch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum InputSource {
    /// Literals in the module.
    Constants,
    /// A uniform buffer, anew for each invocation.
    Uniforms,
    /// Storage buffers.
    Storage,
    /// Vertex attributes; the shader's own uniforms are in a uniform buffer then.
    Attributes,
}

impl InputSource {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Constants, Self::Uniforms, Self::Storage, Self::Attributes];

    /// What it makes of inputs, in words: `inputs as constants`.
    pub fn phrase(self) -> &'static str {
        match self {
            Self::Constants => "inputs as constants",
            Self::Uniforms => "inputs as uniforms",
            Self::Storage => "inputs in storage",
            Self::Attributes => "inputs as attributes",
        }
    }

    /// Name in reports and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constants => "constants",
            Self::Uniforms => "uniforms",
            Self::Storage => "storage",
            Self::Attributes => "attributes",
        }
    }
}

/// The forms of a kernel.
#[derive(Clone, Debug)]
pub enum Form {
    /// A compute entry point; inputs are read from storage.
    Compute,
    /// A compute entry point for one invocation; a uniform buffer holds its index, its inputs and its
    /// uniforms, word by word.
    Uniforms,
    /// A compute entry point whose inputs are literals: it is for one batch.
    Constants,
    /// A vertex entry point.
    Vertex {
        /// Vertex attributes, in the order of the invocation record.
        attributes: Vec<Attribute>,
        /// Uniform blocks, bound in group 1 by index.
        blocks: Vec<UniformBlock>,
        /// Numbers of the draw that the shader reads. Where the vertex is one of them, the number of the record is that
        /// of the instance.
        drawn: Vec<Drawn>,
    },
    /// For a lane that runs the geometry stage of its API; the module is that of [`Form::Compute`].
    Geometry,
    /// A compute stage as its author wrote it: an invocation of a batch is a whole dispatch.
    Dispatch {
        /// Workgroups along x, y and z.
        groups: [u32; 3],
        /// What is bound.
        buffers: Vec<BoundBuffer>,
    },
}

impl Program {
    /// The compute kernel of this program.
    ///
    /// # Errors
    /// [`ProgramError::Unsupported`] when an input or output cannot be captured.
    pub fn compute_kernel(&self) -> Result<Kernel, ProgramError> {
        if let Some(dispatched) = &self.dispatch {
            return dispatch::kernel(self, dispatched);
        }
        compute::kernel(self, feed::Feed::Storage)
    }

    /// A kernel of this program that takes its inputs from a source; `batch` holds them where they become
    /// literals, and only its shape counts elsewhere. Unlike [`Program::vertex_kernel`], that for attributes
    /// is for every program.
    ///
    /// # Errors
    /// [`ProgramError::Unsupported`] when an input or output cannot be captured.
    pub fn kernel_from(&self, source: InputSource, batch: &Batch) -> Result<Kernel, ProgramError> {
        let feed = match source {
            InputSource::Constants => feed::Feed::Constants(batch),
            InputSource::Uniforms => feed::Feed::Uniforms,
            InputSource::Storage => feed::Feed::Storage,
            InputSource::Attributes => feed::Feed::Attributes,
        };
        compute::kernel(self, feed)
    }

    /// The vertex kernel of this program. `components` gives, for each attribute in order, how many
    /// components the host feeds; missing ones are filled by the vertex fetch with (0, 0, 0, 1).
    ///
    /// # Errors
    /// [`ProgramError::Unsupported`] when the program is no vertex stage, or an input or output
    /// cannot be captured.
    pub fn vertex_kernel(&self, components: &[u8]) -> Result<Kernel, ProgramError> {
        vertex::kernel(self, components)
    }

    /// The kernel of this program for a lane that has geometry stages.
    ///
    /// # Errors
    /// [`ProgramError::Unsupported`] when the program is no geometry stage, or an input or output cannot be captured.
    pub fn geometry_kernel(&self) -> Result<Kernel, ProgramError> {
        if !matches!(self.role, crate::lower::Role::Geometry(_)) {
            return Err(ProgramError::Unsupported { what: "a program that is no geometry stage, as one".to_owned() });
        }
        Ok(Kernel { form: Form::Geometry, ..self.compute_kernel()? })
    }

    /// What one invocation of this program takes.
    pub fn invocation_record(&self) -> Record {
        record(self.inputs.iter().map(|p| &p.field))
    }

    /// What one case of this program takes.
    pub fn case_record(&self) -> Record {
        record(self.uniforms.iter().map(|p| &p.field))
    }

    /// What this program gives.
    pub fn output_layout(&self) -> OutputLayout {
        let max_vertices = match self.role {
            crate::lower::Role::Geometry(primitives) => Some(primitives.max_vertices),
            crate::lower::Role::Vertex
            | crate::lower::Role::Fragment
            | crate::lower::Role::Compute
            | crate::lower::Role::Function { .. } => None,
        };
        OutputLayout { vertex: Arc::new(record(self.outputs.iter().map(|p| &p.field))), max_vertices }
    }
}

fn record<'a>(fields: impl Iterator<Item = &'a Field>) -> Record {
    Record::new(fields.cloned().collect())
}
