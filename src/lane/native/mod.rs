//! The lane `vulkan-glslang`: the author's own text, translated by glslang instead of naga, in the real vertex and
//! geometry stages of a Vulkan driver; outputs are captured by transform feedback.
//!
//! Bodies are compiled as they are written. Where glslang does not take a text for SPIR-V, as all below version 1.40,
//! the interface is rewritten in place by the same edits that make it readable for naga.

mod capture;
mod draw;
mod geometry;
mod glslang;
mod gpu;
mod interface;
mod spirv;
mod strips;
mod vertex;

#[cfg(test)]
mod tests;

use std::rc::Rc;

use super::{Api, Candidate, Description, Lane, LaneError, Runner, Stage, Unavailable, vulkan};
use crate::program::{Form, Kernel, Program, Role};

use glslang::{Kind, Translator};
use gpu::Gpu;

/// Name of the lane.
pub const NAME: &str = "vulkan-glslang";

/// What to do when the translator is missing.
const REMEDY: &str = "install it, for example `apt-get install glslang-tools` on Debian or Ubuntu";

/// The lane of this folder.
pub fn candidates() -> Vec<Candidate> {
    let about = "the author's text through glslang, in the real vertex and geometry stages of a Vulkan driver";
    vec![Candidate { name: NAME, about, open: Box::new(open), stand_in: false }]
}

/// Opens the first Vulkan device with transform feedback.
///
/// # Errors
/// [`Unavailable`] with the command that installs what is missing.
pub fn open() -> Result<Box<dyn Lane>, Unavailable> {
    open_with(<[u32]>::to_vec)
}

/// The same with a translator that errs: `fault` gives what is run in place of each module of SPIR-V that the
/// author's text became. For tests of what judges.
///
/// # Errors
/// As of [`open`].
pub fn open_with(fault: fn(&[u32]) -> Vec<u32>) -> Result<Box<dyn Lane>, Unavailable> {
    let missing = |remedy: &str| {
        let remedy = remedy.to_owned();
        move |why: String| Unavailable { why, remedy }
    };
    let translator = Translator::find().map_err(missing(REMEDY))?;
    let gpu = Gpu::open().map_err(missing(vulkan::REMEDY))?;
    let mut stages = vec![Stage::Vertex];
    stages.extend(gpu.geometry.then_some(Stage::Geometry));
    let description = Description {
        name: NAME,
        driver: format!("{}, glslang {}", gpu.driver, translator.version),
        executor: vulkan::executor(&gpu.name),
        front_end: "glslang".to_owned(),
        api: Api::Vulkan,
        stages,
    };
    Ok(Box::new(Native { gpu, translator, description, fault }))
}

struct Native {
    gpu: Rc<Gpu>,
    translator: Translator,
    description: Description,
    fault: fn(&[u32]) -> Vec<u32>,
}

impl Lane for Native {
    fn description(&self) -> &Description {
        &self.description
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        let program = &*kernel.program;
        let unsupported = |what: &str| Err(LaneError::Unsupported(what.to_owned()));
        if !is_the_text(program) {
            return unsupported("a program that is not the author's text");
        }
        if !program.textures.is_empty() {
            return unsupported("textures");
        }
        match (&kernel.form, &program.role) {
            (Form::Vertex { attributes, .. }, Role::Vertex) => {
                let words = self.module(program, Kind::Vertex)?;
                Ok(Box::new(vertex::VertexRunner::new(&self.gpu, &words, kernel, attributes, capacity)?))
            }
            (Form::Geometry, Role::Geometry(primitives)) => {
                if !self.gpu.geometry {
                    return unsupported("geometry stages, which this device lacks");
                }
                let words = self.module(program, Kind::Geometry)?;
                let (gpu, translator) = (&self.gpu, &self.translator);
                Ok(Box::new(geometry::GeometryRunner::new(gpu, translator, &words, kernel, *primitives, capacity)?))
            }
            (Form::Vertex { .. }, _) => unsupported("a program that is no vertex stage, as one"),
            (Form::Geometry, _) => unsupported("a program that is no geometry stage, as one"),
            (Form::Compute | Form::Uniforms | Form::Constants, _) => unsupported("compute stages"),
        }
    }
}

impl Native {
    /// The program as glslang translates it.
    fn module(&self, program: &Program, kind: Kind) -> Result<Vec<u32>, LaneError> {
        let lowered = &program.lowered;
        let translate = |text: &str| self.translator.translate(kind, text, &lowered.defines);
        let written = translate(lowered.file.text());
        // A geometry stage is lowered to something that is none.
        let rewritten = kind == Kind::Vertex && lowered.edited.text != lowered.file.text();
        let words = match written {
            Err(LaneError::Unsupported(_)) if rewritten => translate(&lowered.edited.text).or(written),
            written => written,
        };
        Ok((self.fault)(&words?))
    }
}

/// True when what a program gives is what its text gives: a program made for looking into has more.
fn is_the_text(program: &Program) -> bool {
    let declared = |name: &str| program.lowered.outputs.iter().any(|output| output.name == name);
    program.outputs.iter().all(|port| declared(&port.field.name))
}
