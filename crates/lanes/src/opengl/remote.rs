//! Jobs of OpenGL in another process: the messages of both sides.

use std::collections::HashMap;
use std::io::{Read, Write};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::context::{Context, REMEDY};
use super::job::{Captured, Inputs, Job};
use super::prepare::{Ready, Refusal};
use super::{Backend, OpenGl, Session};
use crate::worker::{Frame, HeldJob, Line, Loss, SharedLine, Worker, read_frame, write_frame};
use crate::{LaneError, Sharing, Unavailable};

/// Longest time for the start of a driver.
const OPENING: Duration = Duration::from_secs(30);
/// Longest time for the compilation of a stage.
const COMPILING: Duration = Duration::from_secs(30);
/// Longest time for a batch of many invocations, which takes a second where nothing is wrong.
const BATCH: Duration = Duration::from_secs(20);
/// Longest time for a single invocation.
const SINGLE: Duration = Duration::from_secs(5);

/// What a process is asked.
#[derive(Debug, Serialize, Deserialize)]
enum Ask {
    /// Which driver it has.
    Open,
    /// To make a job ready under a number.
    Prepare { id: u64, job: Box<Job>, capacity: usize },
    /// To run a job. The words of invocations and cases come behind.
    Run { id: u64, run: u64, invocations: usize, count: usize, per_case: usize, sentinel: u32, one_by_one: bool },
    /// To forget a job.
    Drop { id: u64 },
}

/// What it answers.
#[derive(Debug, Serialize, Deserialize)]
enum Answer {
    /// The driver.
    Opened { renderer: String, version: String },
    /// There is no driver.
    Missing { why: String },
    /// The job is ready for so many invocations.
    Ready { id: u64, capacity: usize },
    /// The job is refused.
    Refused { id: u64, refusal: Refusal },
    /// An invocation is about to be drawn by itself.
    At { run: u64, invocation: usize },
    /// What was captured; its words come behind.
    Captured { run: u64, primitives: Vec<u32> },
    /// The run failed.
    Failed { run: u64, error: LaneError },
}

/// A driver in another process.
pub struct Remote {
    line: SharedLine<Worker>,
    pub renderer: String,
    pub version: String,
}

impl Remote {
    /// Starts the process, and asks for its driver.
    ///
    /// # Errors
    /// [`Unavailable`] when the process does not start, or has no driver.
    pub fn open(worker: Worker) -> Result<Self, Unavailable> {
        let missing = |why: String| Unavailable { why, remedy: REMEDY.to_owned() };
        let mut line = Line::new(worker, ());
        let opened = line.process.send(&Ask::Open, &[]).and_then(|()| line.process.receive(OPENING));
        let (opened, _) = opened.map_err(|loss| missing(format!("its process {loss}")))?;
        match opened {
            Answer::Opened { renderer, version } => Ok(Self { line: SharedLine::new(line), renderer, version }),
            Answer::Missing { why } => Err(missing(why)),
            other => Err(missing(format!("its process {}", line.nonsense(&other)))),
        }
    }
}

impl Backend for Remote {
    fn sharing(lane: &OpenGl<Self>) -> Sharing<'_> {
        Sharing::InTurn(lane)
    }

    fn prepare(&self, job: &Job, capacity: usize) -> Result<Box<dyn Session>, Refusal> {
        let mut away = Away { held: HeldJob::new(&self.line), job: job.clone(), wanted: capacity, capacity: 0 };
        away.prepare()?;
        Ok(Box::new(away))
    }
}

/// A job that is ready in the other process.
struct Away {
    held: HeldJob<Worker>,
    job: Job,
    wanted: usize,
    capacity: usize,
}

impl Away {
    fn prepare(&mut self) -> Result<(), Refusal> {
        let (id, line) = (self.held.id, self.held.line.clone());
        let mut line = line.hold();
        if self.held.is_ready(&line) {
            return Ok(());
        }
        let lost = |loss: Loss| Refusal::Lane(loss.error(None, 0, "while the shader was compiled"));
        let ask = Ask::Prepare { id, job: Box::new(self.job.clone()), capacity: self.wanted };
        line.process.send(&ask, &[]).map_err(lost)?;
        let (answer, _) = line.process.receive(COMPILING).map_err(lost)?;
        match answer {
            Answer::Ready { id: of, capacity } if of == id => {
                self.capacity = capacity.max(1);
                self.held.made(&line);
                Ok(())
            }
            Answer::Refused { id: of, refusal } if of == id => Err(refusal),
            other => {
                let loss = line.nonsense(&other);
                Err(lost(loss))
            }
        }
    }

    /// Runs a batch; gives the invocation that was drawn last where the process is lost.
    fn once(&mut self, inputs: &Inputs<'_>, limit: Duration) -> Result<Captured, Failure> {
        self.prepare().map_err(|refusal| match refusal {
            Refusal::Lane(error) => Failure::Message(error),
            Refusal::Text { log, .. } | Refusal::Link(log) => Failure::Message(LaneError::Api(log)),
        })?;
        let mut line = self.held.line.hold();
        let run = line.number();
        let ask = Ask::Run {
            id: self.held.id,
            run,
            invocations: inputs.invocations.len(),
            count: inputs.count,
            per_case: inputs.per_case,
            sentinel: inputs.sentinel,
            one_by_one: inputs.one_by_one,
        };
        let sent = line.process.send(&ask, &[inputs.invocations, inputs.cases]);
        sent.map_err(|loss| Failure::Lost(loss, None))?;
        let mut at = None;
        loop {
            match line.process.receive(limit).map_err(|loss| Failure::Lost(loss, at))? {
                (Answer::At { run: of, invocation }, _) if of == run => at = Some(invocation),
                (Answer::Captured { run: of, primitives }, words) if of == run => {
                    return Ok(Captured { words, primitives });
                }
                (Answer::Failed { run: of, error }, _) if of == run => return Err(Failure::Message(error)),
                (other, _) => {
                    let loss = line.nonsense(&other);
                    return Err(Failure::Lost(loss, at));
                }
            }
        }
    }
}

enum Failure {
    /// The process answered.
    Message(LaneError),
    /// The process is gone, and was at this invocation.
    Lost(Loss, Option<usize>),
}

impl Session for Away {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, inputs: &Inputs<'_>) -> Result<Captured, LaneError> {
        let first = match self.once(inputs, BATCH) {
            Ok(captured) => return Ok(captured),
            Err(Failure::Message(error)) => return Err(error),
            Err(Failure::Lost(loss, _)) => loss,
        };
        // Once more, one by one, in a new process: the last invocation that was begun is the one that does it.
        let alone = Inputs { one_by_one: true, ..inputs.clone() };
        let begun = Instant::now();
        match self.once(&alone, SINGLE) {
            // Each of them came back: the driver is not hung but slow, and gets the time that it needs.
            Ok(_) if first.is_late() => match self.once(inputs, BATCH + 4 * begun.elapsed()) {
                Ok(captured) => Ok(captured),
                Err(Failure::Message(error)) => Err(error),
                Err(Failure::Lost(loss, at)) => Err(loss.error(at, inputs.count, "")),
            },
            Err(Failure::Lost(loss, at)) => Err(loss.error(at, inputs.count, "")),
            Err(Failure::Message(error)) => Err(error),
            Ok(_) => Err(first.error(None, inputs.count, "and did not when each invocation was drawn by itself")),
        }
    }
}

impl Drop for Away {
    fn drop(&mut self) {
        self.held.forget(|worker| worker.send(&Ask::Drop { id: self.held.id }, &[]));
    }
}

/// The other side: answers until there is nothing more to read.
///
/// # Errors
/// When what is read is no message, or nobody reads the answers.
pub fn serve(from: &mut dyn Read, to: &mut dyn Write) -> std::io::Result<()> {
    let context = Context::open();
    let mut ready: HashMap<u64, Ready> = HashMap::new();
    while let Some(Frame { message, words }) = read_frame::<Ask>(from)? {
        let mut answer = |answer: &Answer, words: &[u32]| -> std::io::Result<()> {
            write_frame(to, answer, &[words])?;
            to.flush()
        };
        match (message, &context) {
            (Ask::Open, Ok(context)) => {
                let (renderer, version) = (context.renderer.clone(), context.version.clone());
                answer(&Answer::Opened { renderer, version }, &[])?;
            }
            (Ask::Open, Err(why)) => answer(&Answer::Missing { why: why.clone() }, &[])?,
            (Ask::Prepare { id, job, capacity }, context) => {
                let made = match context {
                    Ok(context) => Ready::new(context, &job, capacity),
                    Err(why) => Err(LaneError::Api(why.clone()).into()),
                };
                match made {
                    Ok(made) => {
                        let capacity = made.capacity;
                        ready.insert(id, made);
                        answer(&Answer::Ready { id, capacity }, &[])?;
                    }
                    Err(refusal) => answer(&Answer::Refused { id, refusal }, &[])?,
                }
            }
            (Ask::Run { id, run, invocations, count, per_case, sentinel, one_by_one }, _) => {
                let Some(job) = ready.get_mut(&id) else {
                    let error = LaneError::Api("a job that was never made ready".to_owned());
                    answer(&Answer::Failed { run, error }, &[])?;
                    continue;
                };
                let (invocations, cases) = words.split_at(invocations.min(words.len()));
                let inputs = Inputs { invocations, cases, count, per_case, sentinel, one_by_one };
                // Nobody reads these when the parent is gone, and then the next answer fails.
                let done = job.run(&inputs, &mut |invocation| drop(answer(&Answer::At { run, invocation }, &[])));
                match done {
                    Ok(Captured { words, primitives }) => answer(&Answer::Captured { run, primitives }, &words)?,
                    Err(error) => answer(&Answer::Failed { run, error }, &[])?,
                }
            }
            (Ask::Drop { id }, _) => drop(ready.remove(&id)),
        }
    }
    Ok(())
}
