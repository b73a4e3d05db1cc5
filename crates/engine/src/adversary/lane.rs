//! The device as a lane.

use std::sync::Arc;

use base::value::Batch;
use judge::profile::Profile;
use lanes::{Actual, Api, Description, Lane, LaneError, Runner, Stage, embedded};
use program::interp::{self, Executable, Laws};
use program::{Form, Kernel, OutputLayout};
use property::{Stream, mix};

use super::choice::Strategy;
use super::device::{Device, Fault};
use super::domain::Adversary;

/// Runs kernels in their compute form on a device that errs as far as its profile allows.
#[derive(Clone, Debug)]
pub struct AdversaryLane {
    description: Description,
    device: Device,
    laws: Option<Laws>,
    lowers: bool,
    seed: u64,
}

impl Adversary {
    /// A lane of such devices. `stage` says by which rules subnormal numbers are flushed.
    /// `rearrange` lets it compute sums and products in another order, by distributivity too, if the
    /// profile allows that.
    pub fn lane(profile: &Profile, stage: Stage, strategy: Strategy, seed: u64, rearrange: bool) -> AdversaryLane {
        let driver = format!("adversary by {}, {stage}, {strategy:?}, seed {seed:#x}", profile.name);
        AdversaryLane {
            description: Description {
                name: "adversary",
                driver,
                executor: "adversary".to_owned(),
                front_end: "naga".to_owned(),
                api: Api::Vulkan,
                stages: vec![Stage::Compute],
            },
            device: Device::new(profile, stage, strategy, seed),
            laws: (rearrange && profile.rearrangement).then_some(Laws::Distribution),
            lowers: false,
            seed,
        }
    }
}

impl AdversaryLane {
    /// The same with a planted fault.
    #[must_use]
    pub fn with_fault(self, fault: Fault) -> Self {
        Self { device: self.device.with_fault(fault), ..self }
    }

    /// The same, which does what is `mediump` or `lowp` as badly as GLSL ES and Vulkan allow.
    #[must_use]
    pub fn lowering(self) -> Self {
        Self { lowers: true, ..self }
    }

    /// The same, which rearranges by these laws whatever the profile says.
    #[must_use]
    pub fn with_laws(self, laws: Laws) -> Self {
        Self { laws: Some(laws), ..self }
    }
}

impl Lane for AdversaryLane {
    fn description(&self) -> &Description {
        &self.description
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        match kernel.form {
            Form::Compute | Form::Dispatch { .. } => {}
            Form::Geometry => {
                return Err(LaneError::Unsupported("geometry stages; they run as compute".to_owned()));
            }
            Form::Vertex { .. } => {
                return Err(LaneError::Unsupported("the interpreter has no vertex fetch".to_owned()));
            }
            Form::Uniforms | Form::Constants => {
                return Err(LaneError::Unsupported("the interpreter takes its inputs in one way".to_owned()));
            }
        }
        let compile = if self.lowers { interp::compile_lowered } else { interp::compile };
        let compiled = compile(&kernel.program);
        let mut executable = compiled.map_err(|error| LaneError::Unsupported(error.locate(&kernel.program)))?;
        if let Some(laws) = self.laws {
            let mut stream = Stream::new(mix(self.seed, 1));
            executable = executable.rearranged(laws, &mut |n| stream.below(n));
        }
        Ok(Box::new(AdversaryRunner {
            executable,
            device: Arc::new(self.device.clone()),
            order: mix(self.seed, 2),
            layout: kernel.output.clone(),
            capacity: capacity.max(1),
        }))
    }
}

struct AdversaryRunner {
    executable: Executable,
    device: Arc<Device>,
    /// Of workgroups, and of their invocations at memory.
    order: u64,
    layout: OutputLayout,
    capacity: usize,
}

impl Runner for AdversaryRunner {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        self.count_of(batch, "invocations")?;
        let domain = || Adversary::new(Arc::clone(&self.device));
        if self.executable.whole().is_some() {
            return embedded::dispatched((&self.executable, &self.layout), batch, self.order, domain);
        }
        let meaning = self.executable.run_with(batch, interp::FUEL, domain);
        embedded::accepted(&self.layout, &meaning.map_err(|error| LaneError::Api(error.to_string()))?)
    }
}
