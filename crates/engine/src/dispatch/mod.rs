//! Compute stages as whole dispatches: what invocations do to each other and to the buffers of a host.
//!
//! Nobody states what the host of a shader does. It is guessed as hosts are written: as many invocations as there are
//! elements, rounded up to whole workgroups, counts in uniforms that say so by their names, and buffers as long as the
//! shader needs them where the elements fill the workgroups. What depends on these guesses is told as such.
//!
//! ```text
//! Program ─ compile_dispatch ─▶ Kernel of a dispatch ─ host ─▶ scenarios, small ones first
//! scenario ─ interp::group ─▶ incidents ─ depends ─▶ findings, warnings, notes
//! ```

mod doubt;
mod draft;
mod host;
mod images;
mod orders;
mod placeholder;
mod races;
mod run;
mod setting;
mod shown;
mod stated;
mod tell;
mod widths;

use std::sync::Arc;

use program::interp::group::{Depends, Uses};
use program::interp::{self, Executable};
use program::{Program, Written};

pub use draft::Drafted;
pub use placeholder::with_host_numbers;
pub use run::run;
pub use shown::Shown;
pub use stated::open_meaning;

/// Invocations of the largest workgroup that is run; devices have 1,024 at most, or a few more.
const LARGEST: u64 = 1 << 11;

/// A compute stage that can be dispatched.
pub struct Dispatched {
    /// The stage as its author wrote it.
    pub program: Program,
    /// What the interpreter runs.
    pub executable: Arc<Executable>,
    /// Invocations of a workgroup.
    pub size: [u32; 3],
    depends: Depends,
    uses: Uses,
    /// Axes along which a host dispatches as many workgroups as its elements need.
    axes: Vec<usize>,
    /// Workgroups along each axis that the text names by their numbers, at least.
    named: [u32; 3],
    /// One workgroup is all that it is written for: nothing asks which one it is.
    alone: bool,
    /// The memory of a workgroup begins with zeros.
    zeroed: bool,
}

impl Dispatched {
    /// Makes a stage ready; `None` for what is no compute stage.
    ///
    /// # Errors
    /// What cannot be interpreted, with its place.
    pub fn new(program: &Program) -> Option<Result<Self, String>> {
        let size = program.workgroup_size()?;
        let invocations: u64 = size.iter().map(|&n| u64::from(n)).product();
        if invocations == 0 || invocations > LARGEST {
            let at = program.file.name();
            return Some(Err(format!("{at}: a workgroup of {invocations} invocations; {LARGEST} at most are run")));
        }
        let executable = match interp::compile_dispatch(program) {
            Ok(executable) => Arc::new(executable),
            Err(error) => return Some(Err(error.locate(program))),
        };
        let named = executable.named_groups();
        let reads_global = |axis: usize| executable.reads_global(axis) || named[axis] > 1;
        let alone = !(0..3).any(reads_global);
        let differs = |axis: &usize| size[*axis] > 1 || executable.reads_local(*axis) || reads_global(*axis);
        // Along an axis of which workgroups ask nothing, one is dispatched: all of them would do the same.
        let axes = (0..3).filter(differs).filter(|&axis| alone || reads_global(axis)).collect();
        let (depends, uses) = (executable.depends(), executable.uses());
        let zeroed = program.written == Written::Wgsl;
        Some(Ok(Self { program: program.clone(), executable, size, depends, uses, axes, named, alone, zeroed }))
    }
}
