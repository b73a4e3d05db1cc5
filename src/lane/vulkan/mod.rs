//! The `vulkan` lane: any Vulkan driver through wgpu, in the compute and in the vertex stage.

mod compute;
mod gpu;
mod texture;
mod uniforms;
mod vertex;

#[cfg(test)]
mod tests;

use super::{Api, Candidate, Description, Lane, LaneError, Runner, Stage, Unavailable};
use crate::program::{Form, Kernel, contain};

use gpu::Gpu;

/// What to do when no driver is found.
const REMEDY: &str = "install one, for example `apt-get install mesa-vulkan-drivers libvulkan1` on Debian or Ubuntu";

/// The lanes of Vulkan drivers.
pub fn candidates() -> Vec<Candidate> {
    let about = "any Vulkan driver, through wgpu";
    vec![Candidate { name: "vulkan", about, open: Box::new(open), stand_in: false }]
}

/// Opens the first Vulkan adapter that the loader shows.
///
/// # Errors
/// [`Unavailable`] with the command that installs a software driver.
pub fn open() -> Result<Box<dyn Lane>, Unavailable> {
    let missing = |why: String| Unavailable { why, remedy: REMEDY.to_owned() };
    // A broken driver may bring wgpu to panic: that is a missing lane, not the end of the run.
    let gpu = contain(Gpu::open).map_err(|panic| missing(format!("the Vulkan driver fails: {panic}")))?;
    let gpu = gpu.map_err(missing)?;
    let description = Description {
        name: "vulkan",
        driver: gpu.driver(),
        executor: gpu.executor(),
        front_end: "naga".to_owned(),
        api: Api::Vulkan,
        stages: gpu.stages(),
    };
    Ok(Box::new(Vulkan { gpu, description }))
}

struct Vulkan {
    gpu: Gpu,
    description: Description,
}

impl Lane for Vulkan {
    fn description(&self) -> &Description {
        &self.description
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        match &kernel.form {
            Form::Uniforms => Ok(Box::new(uniforms::UniformsRunner::new(&self.gpu, kernel, capacity)?)),
            Form::Compute | Form::Constants => Ok(Box::new(compute::ComputeRunner::new(&self.gpu, kernel, capacity)?)),
            Form::Vertex { .. } if !self.description.stages.contains(&Stage::Vertex) => {
                Err(LaneError::Unsupported("this device cannot write storage buffers in the vertex stage".to_owned()))
            }
            Form::Geometry => Err(LaneError::Unsupported("geometry stages; they run as compute".to_owned())),
            Form::Vertex { attributes, blocks } => {
                Ok(Box::new(vertex::VertexRunner::new(&self.gpu, kernel, attributes, blocks, capacity)?))
            }
        }
    }
}
