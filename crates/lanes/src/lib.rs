//! Lanes: what runs a kernel. A lane is a device with a pipeline; each is one file (or folder) and
//! one line of the registry.

pub mod assembler;
#[cfg(feature = "drivers")]
mod buffers;
pub mod compiler;
pub mod embedded;
#[cfg(feature = "drivers")]
pub mod native;
mod open;
#[cfg(feature = "drivers")]
pub mod opengl;
#[cfg(feature = "drivers")]
pub mod remote;
#[cfg(feature = "drivers")]
mod strips;
#[cfg(feature = "drivers")]
pub mod vulkan;
#[cfg(feature = "drivers")]
pub mod webgpu;
pub mod worker;

use std::sync::OnceLock;

pub use open::{Opened, StandIn, UnknownLane, Wanted, open_first};
pub use program::lane::{
    Actual, Api, Description, Lane, LaneError, LaneName, Marks, PATIENCE, Runner, Sharing, Stage, Unavailable,
    interned, interrupt, known,
};

/// A lane that may be had.
pub struct Candidate {
    /// Name, as `--lane` takes it.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// Looks for the device and opens it; says what is missing where there is none.
    pub open: Box<dyn Fn() -> Result<Box<dyn Lane>, Unavailable> + Send + Sync>,
    /// True for a lane that only stands in where no device is available; it runs beside devices when it
    /// is asked for by name.
    pub stand_in: bool,
    /// True for a lane that runs only where it is asked for by name.
    pub named_only: bool,
    /// True for a lane of a package that few have: where it is missing, it is told to those who ask for it by name.
    pub extra: bool,
}

/// All lanes that this build knows here: those that are always listed, and one for each further driver that is found.
/// They are looked for once.
pub fn registry() -> &'static [Candidate] {
    static ALL: OnceLock<Vec<Candidate>> = OnceLock::new();
    ALL.get_or_init(|| {
        let mut all = drivers();
        all.push(Candidate {
            name: "embedded",
            about: "interpreter in strict binary32, without any driver",
            open: Box::new(embedded::open),
            stand_in: true,
            named_only: false,
            extra: false,
        });
        all.push(Candidate {
            name: embedded::HALF,
            about: "the same with binary16 for `mediump` and `lowp`, as on phones",
            open: Box::new(embedded::open_half),
            stand_in: true,
            named_only: true,
            extra: false,
        });
        all
    })
}

/// Lanes of drivers.
#[cfg(feature = "drivers")]
fn drivers() -> Vec<Candidate> {
    let mut all = vulkan::candidates();
    all.extend(opengl::candidates());
    all.extend(native::candidates());
    all.extend(webgpu::candidates());
    all
}

/// How there come to be more lanes than these.
#[cfg(feature = "drivers")]
pub fn more(available: &[&Description]) -> Option<&'static str> {
    (available.iter().all(|lane| lane.executor != vulkan::SWIFTSHADER)).then_some(vulkan::MORE)
}

/// How there come to be more lanes than these.
#[cfg(not(feature = "drivers"))]
pub fn more(_: &[&Description]) -> Option<&'static str> {
    Some("this build has no lanes of drivers; those that run on a machine have them")
}

/// Lanes of drivers: none in a build without them.
#[cfg(not(feature = "drivers"))]
fn drivers() -> Vec<Candidate> {
    Vec::new()
}

/// Refuses what no driver is asked for yet.
///
/// # Errors
/// [`LaneError::Unsupported`] for `f16` and operations of subgroups, which the embedded lane alone runs.
#[cfg(feature = "drivers")]
fn check_asked(kernel: &program::Kernel) -> Result<(), LaneError> {
    let what = match &*kernel.program {
        program if program.has_halves() => "16-bit floats",
        program if program.uses_subgroups() => "operations of subgroups",
        _ => return Ok(()),
    };
    Err(LaneError::Unsupported(format!("{what}, which the embedded lane alone runs")))
}
