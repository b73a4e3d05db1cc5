//! What a lane is: a device with a pipeline that runs a kernel.

mod actual;
pub mod interrupt;

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fmt;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use thiserror::Error;

use crate::{Kernel, Program};
use base::text::printable;
use base::value::Batch;

pub use actual::{Actual, Marks};

/// How long a device may take for a batch. Longer than this, the shader does not end. The first batch has the driver
/// compile it, which took lavapipe more than a minute for blending with eight bones where twenty processes shared two
/// cores. What watches a device from another process gives it up sooner, so that it is not the device's word that comes
/// first: that says nothing of which invocation it is.
pub const PATIENCE: Duration = Duration::from_secs(240);

/// Stage of the pipeline in which a kernel runs on a lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Stage {
    /// A compute stage.
    Compute,
    /// A vertex stage with vertex buffers and uniform buffers.
    Vertex,
    /// A geometry stage of the API; lanes without one run such shaders as compute.
    Geometry,
}

impl Stage {
    /// `compute`, `vertex` or `geometry`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Compute => "compute",
            Self::Vertex => "vertex",
            Self::Geometry => "geometry",
        }
    }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Whose promises about numbers hold on a lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Api {
    /// Vulkan: what its specification and its conformance suite allow a driver.
    Vulkan,
    /// OpenGL: what the GLSL specification says of range and precision.
    OpenGl,
    /// WebGPU: what the specification of WGSL says of accuracy.
    WebGpu,
    /// Strict binary32 of IEEE 754: every operation rounded to nearest, in the order of the source.
    Binary32,
}

impl Api {
    /// `vulkan`, `opengl`, `webgpu` or `binary32`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vulkan => "vulkan",
            Self::OpenGl => "opengl",
            Self::WebGpu => "webgpu",
            Self::Binary32 => "binary32",
        }
    }
}

/// What a lane is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Description {
    /// Name of the lane, as `--lane` takes it.
    #[serde(with = "known")]
    pub name: LaneName,
    /// Device and driver with version.
    pub driver: String,
    /// What executes the shader, whatever API it is reached through: `gallivm` for llvmpipe and lavapipe alike.
    pub executor: String,
    /// What reads the shader and makes of it what the executor takes: `naga`, `glslang`, `Mesa`.
    pub front_end: String,
    /// Whose promises hold.
    pub api: Api,
    /// Stages in which it can run kernels.
    pub stages: Vec<Stage>,
}

impl Description {
    /// Executor and front end: lanes that share both say the same thing twice.
    pub fn group(&self) -> (&str, &str) {
        (&self.executor, &self.front_end)
    }
}

/// Name of a lane of the registry.
pub type LaneName = &'static str;

/// Names of lanes, where they are written down. What is read back may be a lane of another machine.
pub mod known {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    /// Writes a name.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn serialize<S: Serializer>(name: &str, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(name)
    }

    /// Reads the name of a lane.
    ///
    /// # Errors
    /// When it is no word of small letters, digits and hyphens.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<&'static str, D::Error> {
        find(&String::deserialize(from)?)
    }

    fn find<E: Error>(name: &str) -> Result<&'static str, E> {
        // The lane may be one of another machine, whose drivers are not here.
        let word = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        if name.is_empty() || name.len() > 64 || !name.chars().all(word) {
            return Err(E::custom(format!("`{name}` is no name of a lane")));
        }
        Ok(super::interned(name))
    }

    /// The same where there may be none.
    pub mod option {
        use super::{Deserialize, Deserializer, Serializer, find};

        /// Writes a name, or none.
        ///
        /// # Errors
        /// Those of the writer.
        pub fn serialize<S: Serializer>(name: &Option<&'static str>, to: S) -> Result<S::Ok, S::Error> {
            match name {
                Some(name) => to.serialize_some(name),
                None => to.serialize_none(),
            }
        }

        /// Reads the name of a lane, or none.
        ///
        /// # Errors
        /// When it is no word of small letters, digits and hyphens.
        pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<&'static str>, D::Error> {
            Option::<String>::deserialize(from)?.map(|name| find(&name)).transpose()
        }
    }
}

/// A lane that is not available here.
#[derive(Clone, Debug, Error, PartialEq, Eq, Serialize, Deserialize)]
#[error("{}; {}", printable(why), printable(remedy))]
pub struct Unavailable {
    /// What is missing, without a full stop.
    pub why: String,
    /// What makes it available, as an imperative sentence without a full stop.
    pub remedy: String,
}

/// Why a lane gave no outputs.
#[derive(Clone, Debug, Error, PartialEq, Eq, Serialize, Deserialize)]
pub enum LaneError {
    /// The device's API reported an error.
    #[error("{}", api(.0))]
    Api(String),
    /// The kernel needs something that the lane lacks.
    #[error("not supported on this lane: {}", printable(.0))]
    Unsupported(String),
    /// An invocation goes on without end.
    #[error("invocation {invocation} of {count} does not finish: a loop goes on after {rounds} rounds")]
    Endless {
        /// Index of the first such invocation.
        invocation: usize,
        /// Number of invocations of the dispatch.
        count: usize,
        /// Rounds of loops that an invocation may go through.
        rounds: u32,
    },
    /// The dispatch left the record of an invocation unwritten, or an older dispatch wrote it.
    #[error(
        "the record of invocation {invocation} of {count} was not written by this dispatch (found 0x{found:08x}, expected 0x{expected:08x})"
    )]
    NotWritten {
        /// Index of the invocation.
        invocation: usize,
        /// Number of invocations of the dispatch.
        count: usize,
        /// The word found in place of the canary.
        found: u32,
        /// The word that proves the writing.
        expected: u32,
    },
    /// The translator in front of the device crashed, hung or gave no module: a fault of it, and not of the text.
    #[error("the translator {}", printable(.0))]
    Translator(String),
    /// The process in which the lane runs crashed, hung or gave no sense; it is started again for what comes after.
    #[error("the process of the driver {}{}", printable(how), at(.invocation, *.count, .inputs))]
    Lost {
        /// How, in words that continue "the process of the driver".
        how: String,
        /// Index of the invocation that does it, where one does it by itself.
        invocation: Option<usize>,
        /// Number of invocations of the batch.
        count: usize,
        /// Inputs of the invocation, as `--case` takes them.
        inputs: String,
    },
}

impl LaneError {
    /// True where the executor or what drives it failed outright: it crashed, hung, lost the device or wrote nothing.
    pub fn is_failure(&self) -> bool {
        match self {
            Self::Lost { .. } | Self::NotWritten { .. } => true,
            Self::Api(text) => is_lost(text),
            Self::Unsupported(_) | Self::Endless { .. } | Self::Translator(_) => false,
        }
    }

    /// What it means where the language leaves the behaviour of the invocation undefined, in a clause.
    pub fn at_undefined(&self) -> String {
        match self {
            Self::Lost { how, .. } => format!("the process of the driver {}, which it may do there", printable(how)),
            other => format!("{other}, which may happen there"),
        }
    }

    /// The invocation at which it failed, where that is known.
    pub fn invocation(&self) -> Option<usize> {
        match self {
            Self::Lost { invocation, .. } => *invocation,
            Self::NotWritten { invocation, .. } | Self::Endless { invocation, .. } => Some(*invocation),
            Self::Api(_) | Self::Unsupported(_) | Self::Translator(_) => None,
        }
    }

    /// A kernel has a texture to which it gives no binding.
    pub fn unbound() -> Self {
        Self::Api("a texture without a binding".to_owned())
    }
}

/// An error of the API, with the two that say most about a device in words that are the same on every lane.
fn api(text: &str) -> String {
    // Logs of drivers end with line breaks.
    let text = &printable(text.trim_end());
    if is_lost(text) {
        format!("device lost: {text}")
    } else if is_out_of_memory(text) {
        format!("out of memory: {text}")
    } else {
        format!("the device reported an error: {text}")
    }
}

/// What drivers, loaders and wgpu say of a device that is gone.
fn is_lost(text: &str) -> bool {
    let text = text.to_ascii_lowercase();
    let gone =
        ["device is lost", "device has been lost", "device lost", "device was lost", "context_lost", "context lost"];
    gone.iter().any(|words| text.contains(words)) || text.contains("error_device_lost") || text.contains("0x0507")
}

/// The same of memory that is used up.
fn is_out_of_memory(text: &str) -> bool {
    let text = text.to_ascii_lowercase();
    let full = ["out of memory", "out_of_memory", "outofmemory", "memory allocation has failed", "0x0505"];
    full.iter().any(|words| text.contains(words))
}

fn at(invocation: &Option<usize>, count: usize, inputs: &str) -> String {
    match invocation {
        Some(at) if inputs.is_empty() => format!(", at invocation {at} of {count}"),
        Some(at) => format!(", at invocation {at} of {count}, with {inputs}"),
        None => String::new(),
    }
}

/// Which threads may run kernels on a lane.
#[derive(Clone, Copy)]
pub enum Sharing<'a> {
    /// Only the one that opened it.
    Alone,
    /// Any of them, and one at a time is the quickest: all that runs goes to one process.
    InTurn(&'a (dyn Lane + Sync)),
    /// Any of them, side by side.
    Free(&'a (dyn Lane + Sync)),
}

/// A device that runs kernels.
///
/// Contract: a runner gives the outputs of exactly the batch it was given, or an error. Before each
/// dispatch it fills the output buffer with [`Marks::sentinel`], hands a fresh [`Marks::canary`] to
/// the kernel, and builds [`Actual`] only through [`Actual::accept`], which proves that each record
/// was written. It never retries and never substitutes another device.
pub trait Lane {
    /// What this lane is.
    fn description(&self) -> &Description;

    /// Makes a kernel ready for batches of at most `capacity` invocations; the runner may take fewer
    /// at a time, see [`Runner::capacity`].
    ///
    /// # Errors
    /// [`LaneError`] when the device refuses the kernel.
    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError>;

    /// Which threads may run kernels on it.
    fn sharing(&self) -> Sharing<'_> {
        Sharing::Alone
    }

    /// What reads the text of a program on this lane.
    fn front_end(&self, _program: &Program) -> String {
        self.description().front_end.clone()
    }

    /// True for a lane that runs whole dispatches of a compute stage.
    fn dispatches(&self) -> bool {
        false
    }

    /// True for a lane without compute that runs functions in its vertex stage.
    fn calls_functions(&self) -> bool {
        false
    }
}

/// A kernel on a device.
pub trait Runner {
    /// Largest number of invocations of one batch.
    fn capacity(&self) -> usize;

    /// Runs a batch in one dispatch.
    ///
    /// # Errors
    /// [`LaneError`]; the outputs are then gone.
    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError>;

    /// How many invocations a batch has; `what` they are called where there are too many.
    ///
    /// # Errors
    /// [`LaneError::Unsupported`] for more than fit.
    fn count_of(&self, batch: &Batch, what: &str) -> Result<usize, LaneError> {
        let (count, most) = (batch.invocation_count(), self.capacity());
        if count > most {
            return Err(LaneError::Unsupported(format!("a batch of {count} {what}; {most} fit")));
        }
        Ok(count)
    }
}

/// The name of a lane that is found when the program runs, kept for as long as it runs.
pub fn interned(name: &str) -> LaneName {
    static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    match names.get(name) {
        Some(known) => known,
        None => {
            let name: &'static str = Box::leak(name.to_owned().into_boxed_str());
            names.insert(name);
            name
        }
    }
}

#[cfg(test)]
mod tests {
    use super::LaneError;

    #[test]
    fn a_lost_device_and_full_memory_are_reported_in_the_same_words_on_every_lane() {
        let reported = |text: &str| LaneError::Api(text.to_owned()).to_string();
        // As ash, wgpu and the lanes of OpenGL say it.
        for text in ["The logical or physical device has been lost", "Parent device is lost", "GL_CONTEXT_LOST"] {
            assert_eq!(reported(text), format!("device lost: {text}"));
            assert!(LaneError::Api(text.to_owned()).is_failure());
        }
        for text in ["A host memory allocation has failed", "Out of Memory", "GL_OUT_OF_MEMORY in the draws"] {
            assert_eq!(reported(text), format!("out of memory: {text}"));
            assert!(!LaneError::Api(text.to_owned()).is_failure());
        }
        assert_eq!(reported("anything else"), "the device reported an error: anything else");
    }
}
