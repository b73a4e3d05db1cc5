//! The way to a process, and what is ready there.

use std::fmt::Debug;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{Loss, Worker};

/// What is at the other end of a line: a process, and in tests what plays one.
pub trait Process {
    /// Which start of it is running; none when it does not.
    fn start(&self) -> Option<u64>;

    /// Ends it.
    fn stop(&mut self);
}

impl Process for Worker {
    fn start(&self) -> Option<u64> {
        Self::start(self)
    }

    fn stop(&mut self) {
        Self::stop(self);
    }
}

impl<P: Process + ?Sized> Process for Box<P> {
    fn start(&self) -> Option<u64> {
        (**self).start()
    }

    fn stop(&mut self) {
        (**self).stop();
    }
}

/// The way to a process, shared by everything that runs there, with what else a lane has to know of it.
pub struct Line<P, S = ()> {
    pub process: P,
    pub state: S,
    /// Number of the last job or run.
    last: u64,
}

impl<P: Process, S> Line<P, S> {
    pub fn new(process: P, state: S) -> Self {
        Self { process, state, last: 0 }
    }

    /// A number for a job or a run.
    pub fn number(&mut self) -> u64 {
        self.last += 1;
        self.last
    }

    /// An answer that is not one to what was asked.
    pub fn nonsense(&mut self, answer: &impl Debug) -> Loss {
        self.process.stop();
        Loss::nonsense(answer)
    }
}

/// A line that several jobs use, in turn.
pub struct SharedLine<P, S = ()>(Arc<Mutex<Line<P, S>>>);

impl<P, S> Clone for SharedLine<P, S> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<P, S> SharedLine<P, S> {
    pub fn new(line: Line<P, S>) -> Self {
        Self(Arc::new(Mutex::new(line)))
    }

    /// The line, once nobody else uses it. A job asks and waits for its answer before it lets go.
    pub fn hold(&self) -> MutexGuard<'_, Line<P, S>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A job that is made ready in a process under a number.
pub struct HeldJob<P, S = ()> {
    pub line: SharedLine<P, S>,
    pub id: u64,
    /// The start of the process at which it was made ready: a process that was started again knows nothing of it.
    start: Option<u64>,
}

impl<P: Process, S> HeldJob<P, S> {
    /// A job that is not ready yet.
    pub fn new(line: &SharedLine<P, S>) -> Self {
        Self { line: line.clone(), id: line.hold().number(), start: None }
    }

    /// True when the process that runs has it.
    pub fn is_ready(&self, line: &Line<P, S>) -> bool {
        self.start.is_some() && self.start == line.process.start()
    }

    /// States that the process that runs has it now.
    pub fn made(&mut self, line: &Line<P, S>) {
        self.start = line.process.start();
    }

    /// Has a process that still has it forget it.
    pub fn forget(&self, tell: impl FnOnce(&mut P) -> Result<(), Loss>) {
        let mut line = self.line.hold();
        if self.is_ready(&line) {
            // A process that is gone has forgotten it anyway.
            let _ = tell(&mut line.process);
        }
    }
}
