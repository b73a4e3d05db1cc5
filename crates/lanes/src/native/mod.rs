//! The lane `vulkan-glslang`: the author's own text, translated by glslang instead of naga, in the real vertex and
//! geometry stages of a Vulkan driver, whose outputs are captured by transform feedback, and in compute stages as whole
//! dispatches.
//!
//! Bodies are compiled as they are written. Where glslang does not take a text for SPIR-V, as all below version 1.40,
//! the interface is rewritten in place by the same edits that make it readable for naga.

mod capture;
mod dispatch;
mod draw;
mod function;
mod geometry;
mod glslang;
mod gpu;
mod interface;
mod records;
mod spirv;
mod vertex;

#[cfg(test)]
mod tests;

use std::rc::Rc;
use std::sync::Arc;

use super::remote::{self, Engine, Front, Here, Work};
use super::{Api, Candidate, Description, Lane, LaneError, Runner, Stage, Unavailable, check_asked, vulkan, worker};
use base::text::printable;
use base::value::Record;
use program::{Attribute, BoundBuffer, Drawn, Form, Kernel, OutputLayout, Primitives, Program, Role, Written};

use function::Function;
use glslang::{TextStage, Translator};
use gpu::Gpu;

/// Name of the lane.
pub const NAME: &str = "vulkan-glslang";

/// What to do when the translator is missing.
const REMEDY: &str = "install it, for example `apt-get install glslang-tools` on Debian or Ubuntu";

/// The lane of this folder.
pub fn candidates() -> Vec<Candidate> {
    let about = "the author's text through glslang, in the real vertex and geometry stages of a Vulkan driver";
    vec![Candidate { name: NAME, about, open: Box::new(open), stand_in: false, named_only: false, extra: false }]
}

/// Opens the first Vulkan device with transform feedback, in a process of its own where there is a program for that.
///
/// # Errors
/// [`Unavailable`] with the command that installs what is missing.
pub fn open() -> Result<Box<dyn Lane>, Unavailable> {
    match worker::program() {
        None => open_with(<[u32]>::to_vec),
        Some(program) => remote::open(program, NAME, Box::new(Glslang::find(<[u32]>::to_vec)?)),
    }
}

/// The same in this process, with a translator that errs: `fault` gives what is run in place of each module of SPIR-V
/// that the author's text became. For tests of what judges.
///
/// # Errors
/// As of [`open`].
pub fn open_with(fault: fn(&[u32]) -> Vec<u32>) -> Result<Box<dyn Lane>, Unavailable> {
    let front = Glslang::find(fault)?;
    Ok(Box::new(Here::new(engine()?, Box::new(front))))
}

/// Opens the device in this process.
///
/// # Errors
/// As of [`open`].
pub fn engine() -> Result<Box<dyn Engine>, Unavailable> {
    let missing = |why: String| Unavailable { why, remedy: vulkan::REMEDY.to_owned() };
    let gpu = Gpu::open().map_err(missing)?;
    let translator = find()?;
    let mut stages = vec![Stage::Vertex];
    stages.extend(gpu.geometry.then_some(Stage::Geometry));
    let description = Description {
        name: NAME,
        driver: printable(&format!("{}, glslang {}", gpu.driver, translator.version)),
        executor: vulkan::executor(&gpu.name),
        front_end: "glslang".to_owned(),
        api: Api::Vulkan,
        stages,
    };
    Ok(Box::new(Native { gpu, description }))
}

fn find() -> Result<Translator, Unavailable> {
    Translator::find().map_err(|why| Unavailable { why, remedy: REMEDY.to_owned() })
}

/// What is run, and what it takes.
#[derive(Clone, Debug)]
pub struct Job {
    /// The stage with what it takes and gives.
    pub stage: Kinds,
    /// Its module of SPIR-V.
    pub module: Arc<[u32]>,
    /// What one invocation gets.
    pub invocation: Arc<Record>,
    /// What one case gets.
    pub case: Arc<Record>,
    /// What one invocation writes.
    pub output: OutputLayout,
    /// The words of its vertices as the module calls them.
    pub captured: Arc<Record>,
}

/// The stages.
#[derive(Clone, Debug)]
pub enum Kinds {
    /// A vertex stage.
    Vertex {
        /// Its attributes, in the order of the invocation record.
        attributes: Vec<Attribute>,
        /// Numbers of the draw that it reads.
        drawn: Vec<Drawn>,
    },
    /// A geometry stage.
    Geometry {
        /// What it takes and gives.
        primitives: Primitives,
        /// The module of the vertex stage in front of it.
        front: Arc<[u32]>,
    },
    /// A compute stage.
    Dispatch {
        /// Workgroups along x, y and z.
        groups: [u32; 3],
        /// Invocations of a workgroup.
        size: [u32; 3],
        /// Its buffers.
        buffers: Vec<BoundBuffer>,
    },
}

struct Native {
    gpu: Rc<Gpu>,
    description: Description,
}

impl Engine for Native {
    fn description(&self) -> &Description {
        &self.description
    }

    fn prepare(&self, work: &Work, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        let Work::Native(job) = work else { return Err(LaneError::Api("work of another lane".to_owned())) };
        match &job.stage {
            Kinds::Vertex { attributes, drawn } => {
                Ok(Box::new(vertex::VertexRunner::new(&self.gpu, job, (attributes, drawn), capacity)?))
            }
            Kinds::Dispatch { groups, size, buffers } => {
                Ok(Box::new(dispatch::DispatchRunner::new(&self.gpu, job, (*groups, *size, buffers), capacity)?))
            }
            Kinds::Geometry { .. } if !self.gpu.geometry => {
                Err(LaneError::Unsupported("geometry stages, which this device lacks".to_owned()))
            }
            Kinds::Geometry { primitives, front } => {
                Ok(Box::new(geometry::GeometryRunner::new(&self.gpu, front, job, *primitives, capacity)?))
            }
        }
    }
}

struct Glslang {
    translator: Translator,
    fault: fn(&[u32]) -> Vec<u32>,
}

impl Front for Glslang {
    fn work(&self, kernel: &Kernel) -> Result<Work, LaneError> {
        check_asked(kernel)?;
        let program = &*kernel.program;
        let unsupported = |what: &str| Err(LaneError::Unsupported(what.to_owned()));
        // A dispatch is the author's text, whose buffers are fed and read as a host does it.
        if program.instrumented && program.dispatch.is_none() {
            return unsupported("a program that is not the author's text");
        }
        if !program.textures.is_empty() {
            return unsupported("textures");
        }
        let (stage, module) = match (&kernel.form, &program.role) {
            (Form::Vertex { attributes, drawn, .. }, Role::Vertex) => {
                let (attributes, drawn) = (attributes.clone(), drawn.clone());
                (Kinds::Vertex { attributes, drawn }, self.module(program, TextStage::Vertex)?)
            }
            (Form::Geometry, Role::Geometry(primitives)) => {
                let module = self.module(program, TextStage::Geometry)?;
                let text = geometry::front(&module, &kernel.invocation, *primitives)?;
                let front = self.translator.translate(TextStage::Vertex, &text, &[])?.as_ref().into();
                (Kinds::Geometry { primitives: *primitives, front }, module)
            }
            (Form::Compute, Role::Function { name }) => return self.call(kernel, name),
            (Form::Vertex { .. }, _) => return unsupported("a program that is no vertex stage, as one"),
            (Form::Geometry, _) => return unsupported("a program that is no geometry stage, as one"),
            (Form::Dispatch { groups, buffers }, _) => {
                let size = program.workgroup_size().unwrap_or([1; 3]);
                let module = self.module(program, TextStage::Compute)?;
                let buffers = dispatch::bound(program, &module, buffers)?;
                (Kinds::Dispatch { groups: *groups, size, buffers }, module)
            }
            (Form::Compute | Form::Uniforms | Form::Constants, _) => {
                return unsupported("compute stages");
            }
        };
        let (invocation, case, output) = (kernel.invocation.clone(), kernel.case.clone(), kernel.output.clone());
        let captured = output.vertex.clone();
        Ok(Work::Native(Job { stage, module: module.into(), invocation, case, output, captured }))
    }

    fn calls_functions(&self) -> bool {
        true
    }

    fn dispatches(&self) -> bool {
        true
    }
}

impl Glslang {
    fn find(fault: fn(&[u32]) -> Vec<u32>) -> Result<Self, Unavailable> {
        Ok(Self { translator: find()?, fault })
    }

    /// A function that a stage calls which is put behind the text.
    fn call(&self, kernel: &Kernel, name: &str) -> Result<Work, LaneError> {
        let program = &*kernel.program;
        if program.written != Written::Glsl {
            return Err(LaneError::Unsupported("a program that is not written in GLSL".to_owned()));
        }
        let Function { text, defines, attributes, invocation, captured } = function::function(kernel, name)?;
        let defines = [&program.defines[..], &defines].concat();
        let words = self.translator.translate(TextStage::Vertex, &text, &defines)?;
        let (stage, module) = (Kinds::Vertex { attributes, drawn: Vec::new() }, (self.fault)(&words).into());
        let (case, output) = (kernel.case.clone(), kernel.output.clone());
        Ok(Work::Native(Job { stage, module, invocation, case, output, captured }))
    }

    /// The program as glslang translates it.
    fn module(&self, program: &Program, kind: TextStage) -> Result<Vec<u32>, LaneError> {
        if program.written != Written::Glsl {
            return Err(LaneError::Unsupported("a program that is not written in GLSL".to_owned()));
        }
        let translate = |text: &str| self.translator.translate(kind, text, &program.defines);
        let written = translate(program.file.text());
        // A geometry stage is lowered to something that is none.
        let rewritten = || program.rewritten().filter(|_| kind == TextStage::Vertex);
        let words = match written {
            Err(LaneError::Unsupported(_)) => match rewritten() {
                Some(text) => translate(&text).or(written),
                None => written,
            },
            written => written,
        };
        Ok((self.fault)(&words?))
    }
}
