//! The process of Node, and kernels that are ready there.

use std::path::Path;
use std::time::Duration;

use super::messages::{Adapter, Answer, Ask, Job, Missing};
use crate::worker::{HeldJob, Line, Loss, Process, SharedLine, Worker};
use crate::{LaneError, Marks};
use base::value::Batch;

/// Longest time for the start of Node and of a driver.
const OPENING: Duration = Duration::from_secs(30);
/// Longest time for the compilation of a kernel.
const COMPILING: Duration = Duration::from_secs(30);
/// Longest time for a batch, which takes a second where nothing is wrong.
pub const BATCH: Duration = Duration::from_secs(20);
/// Longest time for a few invocations.
pub const FEW: Duration = Duration::from_secs(5);

/// Whoever answers: a process, and in tests what plays one.
pub trait Peer: Process {
    /// Says something that has no answer.
    fn send(&mut self, ask: &Ask, words: &[&[u32]]) -> Result<(), Loss>;

    /// Asks something, and waits for the answer for so long at most.
    fn ask(&mut self, ask: &Ask, words: &[&[u32]], limit: Duration) -> Result<(Answer, Vec<u32>), Loss>;
}

impl Peer for Worker {
    fn send(&mut self, ask: &Ask, words: &[&[u32]]) -> Result<(), Loss> {
        self.send(ask, words)
    }

    fn ask(&mut self, ask: &Ask, words: &[&[u32]], limit: Duration) -> Result<(Answer, Vec<u32>), Loss> {
        self.send(ask, words)?;
        self.receive(limit)
    }
}

/// A device in another process.
#[derive(Clone)]
pub struct Remote {
    line: SharedLine<Box<dyn Peer>, NodeDevice>,
    pub adapter: Adapter,
}

/// What is known of the device of a process.
struct NodeDevice {
    folder: String,
    /// The start of the process that has a device.
    opened: Option<u64>,
}

impl Line<Box<dyn Peer>, NodeDevice> {
    /// Asks for a device, of a process that was not asked yet.
    fn open(&mut self) -> Result<Option<Adapter>, Missing> {
        if self.state.opened.is_some() && self.state.opened == self.process.start() {
            return Ok(None);
        }
        let ask = Ask::Open { folder: self.state.folder.clone() };
        let lost = |loss: Loss| Missing::Process(format!("`{}` {loss}", super::NODE));
        match self.process.ask(&ask, &[], OPENING).map_err(lost)?.0 {
            Answer::Opened(adapter) => {
                self.state.opened = self.process.start();
                Ok(Some(*adapter))
            }
            Answer::Missing { why, driver: true } => Err(Missing::Driver(why)),
            Answer::Missing { why, driver: false } => Err(Missing::Package(why)),
            other => Err(lost(self.nonsense(&other))),
        }
    }
}

impl Remote {
    /// Starts the process, and asks for its device.
    ///
    /// # Errors
    /// [`Missing`] when the process does not start, or has none.
    pub fn open(peer: Box<dyn Peer>, folder: &Path) -> Result<Self, Missing> {
        let folder = folder.to_string_lossy().into_owned();
        let mut line = Line::new(peer, NodeDevice { folder, opened: None });
        match line.open()? {
            Some(adapter) => Ok(Self { line: SharedLine::new(line), adapter }),
            None => Err(Missing::Process("it was open before it was opened".to_owned())),
        }
    }

    /// Makes a kernel ready, whose number is given here; `texels` are those of its textures.
    ///
    /// # Errors
    /// [`LaneError`] when it is refused, or the process is lost.
    pub fn prepare(&self, job: Job, texels: Vec<u32>) -> Result<Away, LaneError> {
        let held = HeldJob::new(&self.line);
        let job = Job { id: held.id, ..job };
        let mut away = Away { held, job, texels };
        away.prepare()?;
        Ok(away)
    }
}

/// A kernel that is ready in the other process.
pub struct Away {
    held: HeldJob<Box<dyn Peer>, NodeDevice>,
    pub job: Job,
    texels: Vec<u32>,
}

/// Why a run gave nothing.
pub enum Failure {
    /// The process answered.
    Message(LaneError),
    /// The process is gone.
    Lost(Loss),
}

impl Away {
    fn prepare(&mut self) -> Result<(), LaneError> {
        let line = self.held.line.clone();
        let mut line = line.hold();
        if self.held.is_ready(&line) {
            return Ok(());
        }
        line.open().map_err(|missing| match missing {
            Missing::Process(why) | Missing::Package(why) | Missing::Driver(why) => LaneError::Api(why),
        })?;
        let lost = |loss: Loss| loss.error(None, 0, "while the shader was compiled");
        let ask = Ask::Prepare(Box::new(self.job.clone()));
        match line.process.ask(&ask, &[&self.texels], COMPILING).map_err(lost)?.0 {
            Answer::Ready { id } if id == self.job.id => {
                self.held.made(&line);
                Ok(())
            }
            Answer::Refused { id, line, column, why } if id == self.job.id => {
                Err(LaneError::Api(refusal(&self.job.code, line, column, &why)))
            }
            other => Err(lost(line.nonsense(&other))),
        }
    }

    /// Runs a batch whose inputs are these, with this canary.
    pub fn run(
        &mut self,
        batch: &Batch,
        inputs: &[&[u32]],
        marks: Marks,
        limit: Duration,
    ) -> Result<Vec<u32>, Failure> {
        self.prepare().map_err(Failure::Message)?;
        let mut line = self.held.line.hold();
        let run = line.number();
        let ask = Ask::Run {
            id: self.job.id,
            run,
            count: batch.invocation_count(),
            per_case: batch.per_case,
            canary: marks.canary,
            lengths: inputs.iter().map(|input| input.len()).collect(),
        };
        match line.process.ask(&ask, inputs, limit).map_err(Failure::Lost)? {
            (Answer::Done { run: of }, words) if of == run => Ok(words),
            (Answer::Failed { run: of, why }, _) if of == run => Err(Failure::Message(LaneError::Api(why))),
            (other, _) => Err(Failure::Lost(line.nonsense(&other))),
        }
    }
}

/// What Tint or Dawn says of a text, with the line that it speaks of.
fn refusal(code: &str, line: usize, column: usize, why: &str) -> String {
    let why = why.lines().next().unwrap_or_default();
    match line.checked_sub(1).and_then(|at| code.lines().nth(at)) {
        Some(text) => format!("Tint refuses the WGSL of this kernel at {line}:{column}: {why}: `{}`", text.trim()),
        None => format!("Dawn refuses this kernel: {why}"),
    }
}

impl Drop for Away {
    fn drop(&mut self) {
        self.held.forget(|peer| peer.send(&Ask::Drop { id: self.held.id }, &[]));
    }
}
