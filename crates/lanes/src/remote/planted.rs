//! Engines that do something wrong on purpose, for tests of what becomes of it.

use std::str::FromStr;
use std::time::Duration;

use super::{Engine, Work};
use crate::{Actual, Description, LaneError, Runner};
use base::value::Batch;

/// What an engine does wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// It writes noise in place of records.
    Garbage,
    /// The device is lost in the first run, and stays so.
    LostDevice,
    /// Every run uses up the memory of the device.
    OutOfMemory,
    /// The process ends in a crash where the first input is above a half.
    Crash,
    /// The process does not come back where the first input is above a half.
    Hang,
}

impl FromStr for Fault {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Ok(match name {
            "garbage" => Self::Garbage,
            "lost-device" => Self::LostDevice,
            "out-of-memory" => Self::OutOfMemory,
            "crash" => Self::Crash,
            "hang" => Self::Hang,
            _ => return Err(format!("`{name}` is no fault; use garbage, lost-device, out-of-memory, crash or hang")),
        })
    }
}

/// An engine with a fault.
pub struct Planted {
    engine: Box<dyn Engine>,
    fault: Fault,
}

impl Planted {
    /// Plants a fault.
    pub fn new(engine: Box<dyn Engine>, fault: Fault) -> Self {
        Self { engine, fault }
    }
}

impl Engine for Planted {
    fn description(&self) -> &Description {
        self.engine.description()
    }

    fn prepare(&self, work: &Work, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        Ok(Box::new(Wrong { runner: self.engine.prepare(work, capacity)?, fault: self.fault }))
    }
}

struct Wrong {
    runner: Box<dyn Runner>,
    fault: Fault,
}

impl Runner for Wrong {
    fn capacity(&self) -> usize {
        self.runner.capacity()
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let first = |i: usize| batch.invocation(i).first().copied().map_or(0.0, f32::from_bits);
        let hit = (0..batch.invocation_count()).any(|i| first(i) > 0.5);
        match self.fault {
            Fault::Garbage => {
                let noise = |word: u32| word.wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995;
                self.runner.run(batch).map(|actual| actual.altered(noise))
            }
            Fault::LostDevice => Err(LaneError::Api("the device is lost".to_owned())),
            // In the words of Vulkan's loader.
            Fault::OutOfMemory => Err(LaneError::Api("A device memory allocation has failed".to_owned())),
            Fault::Crash if hit => std::process::abort(),
            Fault::Hang if hit => loop {
                std::thread::sleep(Duration::from_secs(1));
            },
            Fault::Crash | Fault::Hang => self.runner.run(batch),
        }
    }
}
