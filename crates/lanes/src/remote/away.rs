//! The side that asks: a lane whose engine is in another process.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::message::{Answer, Ask, Pieces};
use super::wire::{Wire, Writer};
use super::{Front, SIDE, Work};
use crate::vulkan::{self, Naga};
use crate::worker::{self, HeldJob, Loss, Program as Executable, SharedLine, Worker, with_inputs};
use crate::{
    Actual, Candidate, Description, Lane, LaneError, PATIENCE, Runner, Sharing, Unavailable, interned, interrupt,
};
use base::value::Batch;
use program::interp::{self, Binary32};
use program::{Form, Kernel, OutputLayout, Program};

/// Longest time for a process to start and to find its devices.
const OPENING: Duration = Duration::from_secs(60);
/// Longest time to make work ready.
const PREPARING: Duration = Duration::from_secs(240);
/// After so long it is asked whether the shader ends at all for every invocation.
const PROMPT: Duration = Duration::from_secs(10);
/// Longest time for a batch of invocations that all end: it may have the driver compile the shader, the first one and
/// later ones too. It is over before the engine gives the device up.
const BATCH: Duration = Duration::from_secs(PATIENCE.as_secs() - 30);
/// The same once a batch never came back.
const AFTER_A_LOSS: Duration = Duration::from_secs(40);
/// Longest time for a piece of a batch.
const PIECE: Duration = Duration::from_secs(20);
/// Invocations of the pieces in which the one that does not come back is looked for first.
const COARSE: usize = 256;

/// The way to a process of this program.
type EngineLine = worker::Line<Worker, Slow>;

/// True once a batch did not come back in its time.
#[derive(Default)]
struct Slow(bool);

impl EngineLine {
    fn to(program: &Executable) -> Self {
        Self::new(Worker::new(&program.with(SIDE), &[]), Slow::default())
    }

    fn ask(&mut self, ask: &Ask, words: &[&[u32]], limit: Duration) -> Result<Answer, Loss> {
        self.process.send(ask, words)?;
        Ok(self.process.receive(limit)?.0)
    }

    fn open(&mut self, lane: &str) -> Result<Description, Unavailable> {
        let lost = |loss: &Loss| missing(format!("its process {loss}"));
        match self.ask(&Ask::Open { lane: lane.to_owned() }, &[], OPENING).map_err(|loss| lost(&loss))? {
            Answer::Opened { description } => Ok(description),
            Answer::Missing { missing } => Err(missing),
            other => Err(lost(&self.nonsense(&other))),
        }
    }
}

fn missing(why: String) -> Unavailable {
    Unavailable { why, remedy: vulkan::REMEDY.to_owned() }
}

/// The lanes of the devices that the Vulkan loader shows to a process of this program.
///
/// # Errors
/// Why there are none, without a full stop.
pub fn devices(program: &'static Executable) -> Result<Vec<Candidate>, String> {
    let mut line = EngineLine::to(program);
    let lost = |loss: &Loss| format!("the process that looks for Vulkan drivers {loss}");
    let names = match line.ask(&Ask::Devices, &[], OPENING).map_err(|loss| lost(&loss))? {
        Answer::Devices { names } => names,
        Answer::NoDevices { why } => return Err(why),
        other => return Err(lost(&line.nonsense(&other))),
    };
    // The process is there: the first lane that is opened takes it.
    let spare = Arc::new(Mutex::new(Some(line)));
    let candidate = |(at, name): (usize, String)| {
        let (name, spare) = (interned(&name), spare.clone());
        let open = move || {
            let line = spare.lock().unwrap_or_else(PoisonError::into_inner).take();
            open_on(line.unwrap_or_else(|| EngineLine::to(program)), name, Box::new(Naga))
        };
        Candidate {
            name,
            about: vulkan::about(at == 0),
            open: Box::new(open),
            stand_in: false,
            named_only: false,
            extra: false,
        }
    };
    Ok(names.into_iter().enumerate().map(candidate).collect())
}

/// Opens a lane in a process of this program.
///
/// # Errors
/// [`Unavailable`] when the process does not start, or has no such lane.
pub fn open(program: &Executable, lane: &str, front: Box<dyn Front>) -> Result<Box<dyn Lane>, Unavailable> {
    open_on(EngineLine::to(program), lane, front)
}

fn open_on(mut line: EngineLine, lane: &str, front: Box<dyn Front>) -> Result<Box<dyn Lane>, Unavailable> {
    let description = line.open(lane)?;
    Ok(Box::new(Away { line: SharedLine::new(line), front, description }))
}

/// A lane whose engine is in another process.
struct Away {
    line: SharedLine<Worker, Slow>,
    front: Box<dyn Front>,
    description: Description,
}

impl Lane for Away {
    fn description(&self) -> &Description {
        &self.description
    }

    fn sharing(&self) -> Sharing<'_> {
        Sharing::InTurn(self)
    }

    fn dispatches(&self) -> bool {
        self.front.dispatches()
    }

    fn calls_functions(&self) -> bool {
        self.front.calls_functions()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        let mut writer = Writer::default();
        match self.front.work(kernel)? {
            Work::Wgpu(job) => (0_u32.put(&mut writer), job.put(&mut writer)),
            Work::Native(job) => (1_u32.put(&mut writer), job.put(&mut writer)),
        };
        let refused = |what| LaneError::Unsupported(format!("`{what}` of naga, in a process of its own"));
        let words = writer.finish().map_err(refused)?;
        let mut session = Session {
            held: HeldJob::new(&self.line),
            lane: self.description.name.to_owned(),
            words,
            wanted: capacity.max(1),
            capacity: 0,
            layout: kernel.output.clone(),
            program: kernel.program.clone(),
            loops: kernel.has_loops(),
            fixed: matches!(kernel.form, Form::Constants),
        };
        session.prepare()?;
        Ok(Box::new(session))
    }
}

/// Work that is ready in the other process.
struct Session {
    held: HeldJob<Worker, Slow>,
    lane: String,
    words: Vec<u32>,
    wanted: usize,
    capacity: usize,
    layout: OutputLayout,
    program: Arc<Program>,
    loops: bool,
    /// True for work that is for one batch.
    fixed: bool,
}

/// What came of a run in place of outputs.
enum Failure {
    /// The process answered.
    Message(LaneError),
    /// The process is gone, and had begun with the piece from here on.
    Lost(Loss, Option<usize>),
}

impl Session {
    fn prepare(&mut self) -> Result<(), LaneError> {
        let (id, line) = (self.held.id, self.held.line.clone());
        let mut line = line.hold();
        if self.held.is_ready(&line) {
            return Ok(());
        }
        let lost = |loss: Loss| match loss.is_late() {
            true => compiling(),
            false => loss.error(None, 0, "while the shader was made ready"),
        };
        if line.process.start().is_none() {
            // It was lost before.
            line.open(&self.lane).map_err(|missing| LaneError::Api(missing.to_string()))?;
        }
        let ask = Ask::Prepare { id, capacity: self.wanted };
        match line.ask(&ask, &[&self.words], PREPARING).map_err(lost)? {
            Answer::Ready { id: of, capacity } if of == id => {
                self.capacity = capacity.max(1);
                self.held.made(&line);
                Ok(())
            }
            Answer::Refused { id: of, error } if of == id => {
                renew(&mut line, &error);
                Err(error)
            }
            other => {
                let loss = line.nonsense(&other);
                Err(lost(loss))
            }
        }
    }

    fn once(
        &mut self,
        batch: &Batch,
        pieces: Option<Pieces>,
        limit: Duration,
        more: &mut dyn FnMut() -> Duration,
    ) -> Result<Actual, Failure> {
        self.prepare().map_err(Failure::Message)?;
        let mut line = self.held.line.hold();
        let run = line.number();
        let (id, per_case, invocations) = (self.held.id, batch.per_case, batch.invocations.len());
        let ask = Ask::Run { id, run, per_case, invocations, pieces: pieces.clone() };
        let sent = line.process.send(&ask, &[&batch.invocations, &batch.cases]);
        sent.map_err(|loss| Failure::Lost(loss, None))?;
        let mut at = None;
        loop {
            let received = line.process.receive_with(limit, more);
            match received.map_err(|loss| Failure::Lost(loss, at))? {
                (Answer::At { run: of, invocation }, _) if of == run => at = Some(invocation),
                (Answer::Done { run: of, marks }, words) if of == run => {
                    let count = if pieces.is_some() { 0 } else { batch.invocation_count() };
                    return Actual::accept(&self.layout, words, count, marks).map_err(Failure::Message);
                }
                (Answer::Failed { run: of, error }, _) if of == run => {
                    renew(&mut line, &error);
                    return Err(Failure::Message(error));
                }
                (other, _) => {
                    let loss = line.nonsense(&other);
                    return Err(Failure::Lost(loss, at));
                }
            }
        }
    }

    /// Looks for the invocation that takes the process along, in pieces. A batch that was given up for its time, and of
    /// which every piece comes back, is not hung but slow, and is run again with the time that it needs.
    fn narrowed(&mut self, first: &Loss, batch: &Batch, count: usize) -> Result<Actual, LaneError> {
        let apart = || Err(first.error(None, count, "and did not when parts of the batch were run by themselves"));
        if self.fixed || interrupt::asked() {
            return Err(first.error(None, count, ""));
        }
        let begun = Instant::now();
        let mut of = 0..count;
        let mut last = None;
        for size in [COARSE, 1] {
            if first.is_late() {
                self.compiled(batch)?;
            }
            let pieces = Pieces { of: of.clone(), size };
            match self.once(batch, Some(pieces), PIECE, &mut || Duration::ZERO) {
                Err(Failure::Lost(loss, Some(at))) => {
                    of = at..(at + size).min(count);
                    last = Some(loss);
                }
                Err(Failure::Lost(loss, None)) => return Err(loss.error(None, count, "")),
                Err(Failure::Message(error)) if last.is_none() => return Err(error),
                Ok(_) if last.is_none() && first.is_late() => {
                    let patience = BATCH + 4 * begun.elapsed();
                    return match self.once(batch, None, patience, &mut || Duration::ZERO) {
                        Err(Failure::Lost(loss, _)) => Err(loss.error(None, count, "")),
                        Err(Failure::Message(error)) => Err(error),
                        Ok(actual) => Ok(actual),
                    };
                }
                Ok(_) | Err(Failure::Message(_)) => return apart(),
            }
        }
        last.map_or_else(apart, |loss| Err(loss.error(Some(of.start), count, "")))
    }

    /// Has the driver compile the shader for a single invocation, for as long as that takes: what takes longer later is
    /// the shader.
    ///
    /// # Errors
    /// [`LaneError::Unsupported`] where the driver does not come back from an invocation that ends in the interpreter.
    fn compiled(&mut self, batch: &Batch) -> Result<(), LaneError> {
        let one = Pieces { of: 0..1, size: 1 };
        match self.once(batch, Some(one), PREPARING, &mut || Duration::ZERO) {
            Err(Failure::Lost(loss, _)) if loss.is_late() => Err(compiling()),
            // Others are found where they are looked for.
            Ok(_) | Err(Failure::Message(_) | Failure::Lost(..)) => Ok(()),
        }
    }
}

/// A driver that compiles for longer than anybody waits has not failed, and has given nothing.
fn compiling() -> LaneError {
    LaneError::Unsupported(format!("the driver was still compiling the shader after {} s", PREPARING.as_secs()))
}

/// A device that reports an error may be lost, or busy for good with what does not end: the process is ended, and the
/// next one opens it anew.
fn renew(line: &mut EngineLine, error: &LaneError) {
    if matches!(error, LaneError::Api(_)) {
        line.process.stop();
    }
}

/// The first invocation that does not end, as the interpreter finds it.
fn endless(program: &Program, batch: &Batch) -> Option<usize> {
    interp::compile(program).ok()?.run::<Binary32>(batch, interp::FUEL).ok()?.endless()
}

impl Runner for Session {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let count = self.count_of(batch, "invocations")?;
        let (program, loops) = (self.program.clone(), self.loops);
        let (mut named, mut late) = (None, false);
        let most = if self.held.line.hold().state.0 { AFTER_A_LOSS } else { BATCH };
        let mut more = || {
            let begun = Instant::now();
            named = if loops { endless(&program, batch) } else { None };
            late = true;
            if named.is_some() { Duration::ZERO } else { most.saturating_sub(PROMPT + begun.elapsed()) }
        };
        match self.once(batch, None, PROMPT, &mut more) {
            Ok(actual) => Ok(actual),
            Err(Failure::Message(error)) => Err(error),
            Err(Failure::Lost(loss, _)) => {
                self.held.line.hold().state.0 |= late && named.is_none();
                let result = match named {
                    Some(at) => Err(loss.error(Some(at), count, "")),
                    None => self.narrowed(&loss, batch, count),
                };
                result.map_err(|error| with_inputs(error, batch))
            }
        }
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.held.forget(|worker| worker.send(&Ask::Drop { id: self.held.id }, &[]));
    }
}
