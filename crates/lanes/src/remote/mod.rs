//! Lanes in halves: a front in this process makes of a kernel what is run, and an engine runs it, here or in a process
//! of its own, so that a shader that does not end and a driver that crashes take no more than that process.
//!
//! A library without the program `shadercheck` has no other process: the engine then runs in this one, with a limit
//! on the wait. `SHADERCHECK_WORKER` names another program to start for each lane, such as a script that runs it in a
//! debugger; tests plant faults there.

mod away;
mod message;
pub mod planted;
mod serve;
#[cfg(test)]
mod tests;
mod wire;

use super::{Description, Lane, LaneError, Runner, native, vulkan};
use program::Kernel;

pub use away::{devices, open};
pub use serve::serve;

/// The argument of a process that serves these lanes.
pub const SIDE: &str = "vulkan";

/// What is run.
#[derive(Clone, Debug)]
pub enum Work {
    /// A module of naga, through wgpu.
    Wgpu(Box<vulkan::Job>),
    /// SPIR-V from elsewhere, in the stages that it is for.
    Native(native::Job),
}

/// Makes work of kernels.
pub trait Front: Send + Sync {
    /// What is run for a kernel.
    ///
    /// # Errors
    /// [`LaneError`] where the kernel is not for this lane, or cannot be translated.
    fn work(&self, kernel: &Kernel) -> Result<Work, LaneError>;

    /// True for one that takes whole dispatches of a compute stage.
    fn dispatches(&self) -> bool {
        false
    }

    /// True for one that runs functions in a vertex stage.
    fn calls_functions(&self) -> bool {
        false
    }
}

/// Runs work.
pub trait Engine {
    /// What its lane is.
    fn description(&self) -> &Description;

    /// Makes work ready for batches of at most `capacity` invocations; the runner may take fewer at a time.
    ///
    /// # Errors
    /// [`LaneError`] when the device refuses it.
    fn prepare(&self, work: &Work, capacity: usize) -> Result<Box<dyn Runner>, LaneError>;
}

/// A lane whose engine is in this process.
pub struct Here {
    engine: Box<dyn Engine>,
    front: Box<dyn Front>,
}

impl Here {
    /// A lane of both halves.
    pub fn new(engine: Box<dyn Engine>, front: Box<dyn Front>) -> Self {
        Self { engine, front }
    }
}

impl Lane for Here {
    fn description(&self) -> &Description {
        self.engine.description()
    }

    fn dispatches(&self) -> bool {
        self.front.dispatches()
    }

    fn calls_functions(&self) -> bool {
        self.front.calls_functions()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        self.engine.prepare(&self.front.work(kernel)?, capacity)
    }
}
