//! The side that answers: engines in this process, until there is nothing more to read.

use std::collections::HashMap;
use std::io::{self, Read, Write};
use std::sync::Arc;

use super::message::{Answer, Ask, Pieces};
use super::planted::{Fault, Planted};
use super::wire::{Reader, Wire};
use super::{Engine, Work};
use crate::worker::{Frame, read_frame, write_frame};
use crate::{Actual, LaneError, Marks, Runner, Unavailable, native, vulkan};
use base::value::{Batch, Record};
use program::contain_whole;

/// Work that is ready.
struct Ready {
    runner: Box<dyn Runner>,
    invocation: Arc<Record>,
    case: Arc<Record>,
}

/// Answers; `fault` is what the engine does wrong on purpose.
///
/// # Errors
/// When what is read is no message, or nobody reads the answers.
pub fn serve(from: &mut dyn Read, to: &mut dyn Write, fault: Option<Fault>) -> io::Result<()> {
    let mut engine: Option<Box<dyn Engine>> = None;
    let mut ready: HashMap<u64, Ready> = HashMap::new();
    while let Some(Frame { message, words }) = read_frame::<Ask>(from)? {
        let mut answer = |answer: &Answer, words: &[u32]| -> io::Result<()> {
            write_frame(to, answer, &[words])?;
            to.flush()
        };
        match message {
            Ask::Devices => match vulkan::devices() {
                Ok(devices) => {
                    let names = devices.iter().map(|device| device.name.to_owned()).collect();
                    answer(&Answer::Devices { names }, &[])?;
                }
                Err(why) => answer(&Answer::NoDevices { why }, &[])?,
            },
            Ask::Open { lane } => match open(&lane) {
                Ok(opened) => {
                    let description = opened.description().clone();
                    engine = Some(match fault {
                        Some(fault) => Box::new(Planted::new(opened, fault)),
                        None => opened,
                    });
                    answer(&Answer::Opened { description }, &[])?;
                }
                Err(missing) => answer(&Answer::Missing { missing }, &[])?,
            },
            Ask::Prepare { id, capacity } => match prepare(engine.as_deref(), &words, capacity) {
                Ok(made) => {
                    let capacity = made.runner.capacity();
                    ready.insert(id, made);
                    answer(&Answer::Ready { id, capacity }, &[])?;
                }
                Err(error) => answer(&Answer::Refused { id, error }, &[])?,
            },
            Ask::Run { id, run, per_case, invocations, pieces } => {
                let result = match ready.get_mut(&id) {
                    None => Err(LaneError::Api("work that was never made ready".to_owned())),
                    Some(ready) => {
                        let batch = ready.batch(words, invocations, per_case);
                        let mut at = |invocation| answer(&Answer::At { run, invocation }, &[]);
                        ready.run(&batch, pieces, &mut at)
                    }
                };
                match result {
                    Ok((words, marks)) => answer(&Answer::Done { run, marks }, &words)?,
                    Err(error) => answer(&Answer::Failed { run, error }, &[])?,
                }
            }
            Ask::Drop { id } => drop(ready.remove(&id)),
        }
    }
    Ok(())
}

fn open(lane: &str) -> Result<Box<dyn Engine>, Unavailable> {
    if lane == native::NAME {
        return native::engine();
    }
    let gone = |why: String| Unavailable { why, remedy: vulkan::REMEDY.to_owned() };
    let devices = vulkan::devices().map_err(gone)?;
    match devices.iter().find(|device| device.name == lane) {
        Some(device) => (device.open)(),
        None => Err(gone(format!("the Vulkan loader shows no device of the lane `{lane}` any more"))),
    }
}

/// Work as it is read; `None` for words that are none.
fn work(words: &[u32]) -> Option<Work> {
    let mut from = Reader::new(words);
    let work = match u32::take(&mut from)? {
        0 => Work::Wgpu(Box::new(Wire::take(&mut from)?)),
        1 => Work::Native(Wire::take(&mut from)?),
        _ => return None,
    };
    from.is_empty().then_some(work)
}

fn prepare(engine: Option<&dyn Engine>, words: &[u32], capacity: usize) -> Result<Ready, LaneError> {
    let engine = engine.ok_or_else(|| LaneError::Api("a lane that was never opened".to_owned()))?;
    let work = work(words).ok_or_else(|| LaneError::Api("work that cannot be read".to_owned()))?;
    let runner = contained(|| engine.prepare(&work, capacity))?;
    let (invocation, case) = match work {
        Work::Wgpu(job) => (job.invocation, job.case),
        Work::Native(job) => (job.invocation, job.case),
    };
    Ok(Ready { runner, invocation, case })
}

/// A panic of the library in front of the driver is an error; the process is not used again after it.
fn contained<T>(work: impl FnOnce() -> Result<T, LaneError>) -> Result<T, LaneError> {
    contain_whole(work).unwrap_or_else(|panic| {
        let message = &panic.message;
        // It translates what the others are given.
        Err(match ["naga", "naga-types"].iter().any(|library| panic.is_of(library)) {
            true => LaneError::Translator(format!("naga panicked: {message}")),
            false => LaneError::Api(format!("a panic: {message}")),
        })
    })
}

impl Ready {
    fn batch(&self, mut invocations: Vec<u32>, count: usize, per_case: usize) -> Batch {
        let cases = invocations.split_off(count.min(invocations.len()));
        let (invocation_record, case_record) = (self.invocation.clone(), self.case.clone());
        Batch { invocation_record, case_record, per_case: per_case.max(1), invocations, cases }
    }

    /// Runs a batch, or pieces of it: these give no words, and are told before they begin.
    fn run(
        &mut self,
        batch: &Batch,
        pieces: Option<Pieces>,
        at: &mut dyn FnMut(usize) -> io::Result<()>,
    ) -> Result<(Vec<u32>, Marks), LaneError> {
        let Some(Pieces { of, size }) = pieces else {
            return contained(|| self.runner.run(batch)).map(Actual::into_words);
        };
        for first in of.clone().step_by(size.max(1)) {
            // Nobody reads this when the parent is gone, and then the next answer fails.
            let _ = at(first);
            let piece = batch.apart(first..(first + size).min(of.end).min(batch.invocation_count()));
            contained(|| self.runner.run(&piece))?;
        }
        Ok((Vec::new(), Marks::random()))
    }
}
