//! Processes in which lanes run: started with an environment of their own, watched, and started again after a loss.
//!
//! A driver of OpenGL is chosen by the environment when a process starts; and a shader that does not end, or a driver
//! that crashes, takes its process along. So each lane of a driver has a process, and what happens to it is a result
//! like any other.
//!
//! After a loss, the batch runs again in pieces and then one invocation at a time, to name the invocation that
//! triggers it. An invocation that the interpreter finds to be endless is named without that search.

mod frame;
#[cfg(feature = "drivers")]
mod line;
pub mod tool;

#[cfg(test)]
mod tests;

use std::ffi::OsString;
use std::fmt;
use std::io::{BufReader, Read, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{LaneError, interrupt};
use base::value::{Batch, Record};

pub use frame::{Frame, read_frame, write_frame};
#[cfg(feature = "drivers")]
pub(crate) use line::{HeldJob, Line, Process, SharedLine};

/// Bytes of the error output of a process that are kept.
const KEPT: usize = 2048;
/// Words of a message that a pipe holds whether or not anybody reads; a longer one waits for the process.
const PIPED: usize = 4096;
/// Longest wait for a process to take a message: it answers all but a few small ones before the next is sent.
const TAKING: Duration = Duration::from_secs(60);

/// How often a wait looks whether the run was asked to end.
const LOOK: Duration = Duration::from_millis(200);

/// How a process is started that serves a lane.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// The executable.
    pub path: PathBuf,
    /// What the executable is started with, its own name left out.
    pub arguments: Vec<OsString>,
}

impl Program {
    /// The same with one more argument.
    #[must_use]
    pub fn with(&self, argument: &str) -> Self {
        let mut this = self.clone();
        this.arguments.push(argument.into());
        this
    }
}

static PROGRAM: OnceLock<Program> = OnceLock::new();

/// States the program that serves lanes, once; whoever has a command line knows where it is.
pub fn set_program(program: Program) {
    // The first one counts.
    let _ = PROGRAM.set(program);
}

/// The program that serves lanes; `None` in a library that is used by another program.
pub fn program() -> Option<&'static Program> {
    PROGRAM.get()
}

/// How a process was lost, in words that continue "the process".
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loss {
    how: String,
    /// True for a process that was ended because it took too long.
    late: bool,
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.how)
    }
}

impl Loss {
    /// A loss in words that continue "the process".
    pub fn new(how: impl Into<String>) -> Self {
        Self { how: how.into(), late: false }
    }

    /// True for a process that was ended because it took too long, whatever it was busy with.
    pub fn is_late(&self) -> bool {
        self.late
    }

    /// An answer that is not one to what was asked.
    pub fn nonsense(answer: &impl fmt::Debug) -> Self {
        let begin: String = format!("{answer:?}").chars().take(80).collect();
        Self::new(format!("gave an answer to something else: {begin}"))
    }

    /// As the error of a lane, at an invocation of so many.
    pub fn error(&self, invocation: Option<usize>, count: usize, when: &str) -> LaneError {
        let how = if when.is_empty() { self.how.clone() } else { format!("{} {when}", self.how) };
        LaneError::Lost { how, invocation, count, inputs: String::new() }
    }
}

/// Adds the inputs of the invocation that an error names.
pub fn with_inputs(error: LaneError, batch: &Batch) -> LaneError {
    match error {
        LaneError::Lost { how, invocation: Some(at), count, .. } if at < count => {
            let mut parts = Vec::new();
            let mut add = |record: &Record, words: &[u32]| {
                for (k, field) in record.fields().iter().enumerate() {
                    let words: Vec<String> = words[record.range(k)].iter().map(|w| format!("{w:08x}")).collect();
                    parts.push(format!("{}={}", field.name, words.join(",")));
                }
            };
            add(&batch.case_record, batch.case_of(at));
            add(&batch.invocation_record, batch.invocation(at));
            LaneError::Lost { how, invocation: Some(at), count, inputs: parts.join(" ") }
        }
        other => other,
    }
}

/// A process that serves a lane.
pub struct Worker {
    program: Program,
    environment: Vec<(&'static str, &'static str)>,
    running: Option<ChildProcess>,
    /// How often it was started.
    starts: u64,
}

struct ChildProcess {
    child: Child,
    to: ChildStdin,
    from: Receiver<std::io::Result<Option<Frame<serde_json::Value>>>>,
    complaints: Arc<Mutex<Vec<u8>>>,
    listener: JoinHandle<()>,
}

impl Worker {
    /// A process that is started when it is first spoken to.
    pub fn new(program: &Program, environment: &[(&'static str, &'static str)]) -> Self {
        Self { program: program.clone(), environment: environment.to_vec(), running: None, starts: 0 }
    }

    /// Which start of the process is running; none when it does not.
    pub fn start(&self) -> Option<u64> {
        self.running.as_ref().map(|_| self.starts)
    }

    fn running(&mut self) -> Result<&mut ChildProcess, Loss> {
        if self.running.is_none() {
            self.starts += 1;
            self.running = Some(ChildProcess::start(&self.program, &self.environment)?);
        }
        self.running.as_mut().ok_or_else(|| Loss::new("does not run"))
    }

    /// Sends a message; starts the process when it does not run.
    ///
    /// # Errors
    /// [`Loss`] when it cannot be started, or does not take the message in time; it is ended then.
    pub fn send<M: Serialize>(&mut self, message: &M, words: &[&[u32]]) -> Result<(), Loss> {
        self.send_within(message, words, TAKING)
    }

    fn send_within<M: Serialize>(&mut self, message: &M, words: &[&[u32]], limit: Duration) -> Result<(), Loss> {
        let ChildProcess { child, to, .. } = self.running()?;
        let long = words.iter().map(|words| words.len()).sum::<usize>() > PIPED;
        let mut hung = false;
        let sent = std::thread::scope(|scope| {
            let (done, sent) = channel::<()>();
            let hung = &mut hung;
            if long {
                // A pipe has no time limit: where nobody reads, the end of the process ends the writing.
                scope.spawn(move || {
                    if sent.recv_timeout(limit) == Err(RecvTimeoutError::Timeout) {
                        *hung = true;
                        let _ = child.kill();
                    }
                });
            }
            let written = write_frame(to, message, words).and_then(|()| to.flush());
            drop(done);
            written
        });
        sent.map_err(|error| match hung {
            true => self.lost(Some(&format!("took no message within {} s", limit.as_secs())), ""),
            false => self.lost(None, &error.to_string()),
        })
    }

    /// Waits for a message, for so long at most.
    ///
    /// # Errors
    /// [`Loss`] when there is none, or none that can be read; the process is ended then.
    pub fn receive<M: DeserializeOwned>(&mut self, limit: Duration) -> Result<(M, Vec<u32>), Loss> {
        self.receive_with(limit, &mut || Duration::ZERO)
    }

    /// The same; once the time is over, `more` says how much longer to wait.
    ///
    /// # Errors
    /// As of [`Worker::receive`].
    pub fn receive_with<M: DeserializeOwned>(
        &mut self,
        mut limit: Duration,
        more: &mut dyn FnMut() -> Duration,
    ) -> Result<(M, Vec<u32>), Loss> {
        let Some(running) = &mut self.running else { return Err(Loss::new("does not run")) };
        let mut received = waited(&running.from, limit);
        if matches!(received, Err(RecvTimeoutError::Timeout)) && !interrupt::asked() {
            let longer = more();
            limit += longer;
            received = waited(&running.from, longer);
        }
        let frame = match received {
            Ok(Ok(Some(frame))) => frame,
            Ok(Ok(None)) => return Err(self.lost(None, "")),
            Ok(Err(error)) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
                return Err(self.lost(None, "its answer is cut off"));
            }
            Ok(Err(error)) => return Err(self.lost(Some("gave an answer that cannot be read"), &error.to_string())),
            Err(RecvTimeoutError::Timeout) => {
                let how = match interrupt::asked() {
                    true => "gave no answer before the run was interrupted".to_owned(),
                    false => format!("gave no answer within {} s", limit.as_secs()),
                };
                return Err(Loss { late: !interrupt::asked(), ..self.lost(Some(&how), "") });
            }
            Err(RecvTimeoutError::Disconnected) => return Err(self.lost(None, "")),
        };
        // What it said before it answered is not why it may be lost later.
        running.complaints.lock().unwrap_or_else(PoisonError::into_inner).clear();
        let words = frame.words;
        match serde_json::from_value(frame.message) {
            Ok(message) => Ok((message, words)),
            Err(error) => Err(self.lost(Some("gave an answer that is none"), &error.to_string())),
        }
    }

    /// Ends the process, if it runs.
    pub fn stop(&mut self) {
        if let Some(running) = self.running.take() {
            running.end(Duration::ZERO);
        }
    }

    /// Ends the process and says how it was lost: by what it did, or else by how it ended.
    fn lost(&mut self, did: Option<&str>, detail: &str) -> Loss {
        let Some(running) = self.running.take() else { return Loss::new("does not run") };
        // A process that ended by itself may need a moment to be seen as ended.
        let patience = if did.is_none() { Duration::from_secs(2) } else { Duration::ZERO };
        let (status, complaints) = running.end(patience);
        let mut how = match (did, status) {
            (Some(did), _) => did.to_owned(),
            (None, Some(status)) => ended(status),
            (None, None) => "stopped answering".to_owned(),
        };
        if !detail.is_empty() {
            how = format!("{how} ({detail})");
        }
        let complaints = complaints.trim();
        if !complaints.is_empty() {
            how = format!("{how}; it said: {}", complaints.lines().next_back().unwrap_or_default());
        }
        Loss::new(how)
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.stop();
    }
}

impl ChildProcess {
    fn start(program: &Program, environment: &[(&str, &str)]) -> Result<Self, Loss> {
        let failed = |what: &str| Loss::new(format!("cannot be started: {what}"));
        let mut child = apart(&mut Command::new(&program.path))
            .args(&program.arguments)
            .envs(environment.iter().copied())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| failed(&error.to_string()))?;
        let (Some(to), Some(output), Some(mut errors)) = (child.stdin.take(), child.stdout.take(), child.stderr.take())
        else {
            return Err(failed("it has no pipes"));
        };
        let (send, from) = channel();
        // Threads of their own, since a pipe has no time limit. They end with the pipes.
        std::thread::spawn(move || {
            let mut output = BufReader::with_capacity(1 << 16, output);
            loop {
                let frame = read_frame(&mut output);
                let last = !matches!(frame, Ok(Some(_)));
                if send.send(frame).is_err() || last {
                    return;
                }
            }
        });
        let complaints = Arc::new(Mutex::new(Vec::new()));
        let kept = complaints.clone();
        let listener = std::thread::spawn(move || {
            let mut bytes = [0; 512];
            while let Ok(count @ 1..) = errors.read(&mut bytes) {
                let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
                kept.extend_from_slice(&bytes[..count]);
                let over = kept.len().saturating_sub(KEPT);
                kept.drain(..over);
            }
        });
        Ok(Self { child, to, from, complaints, listener })
    }

    /// Waits for the end for a while, then ends it. Gives the status of one that ended by itself, and its last words.
    fn end(self, patience: Duration) -> (Option<ExitStatus>, String) {
        let Self { mut child, to, from, complaints, listener } = self;
        drop((to, from));
        let step = Duration::from_millis(10);
        let mut waited = Duration::ZERO;
        let mut status = child.try_wait().ok().flatten();
        while status.is_none() && waited < patience {
            std::thread::sleep(step);
            waited += step;
            status = child.try_wait().ok().flatten();
        }
        if status.is_none() {
            // It is a child of this process that has not been waited for: the number is still its own.
            let _ = child.kill();
            let _ = child.wait();
        }
        // A child of the process may keep its error output open: what is not there soon is not waited for.
        for _ in 0..20 {
            if listener.is_finished() {
                break;
            }
            std::thread::sleep(step);
        }
        let complaints = complaints.lock().unwrap_or_else(PoisonError::into_inner);
        (status, String::from_utf8_lossy(&complaints).into_owned())
    }
}

/// Waits for so long at most, and not much longer once the run was asked to end.
fn waited<T>(from: &Receiver<T>, limit: Duration) -> Result<T, RecvTimeoutError> {
    let begun = Instant::now();
    let mut until = limit;
    loop {
        let left = until.saturating_sub(begun.elapsed());
        let received = from.recv_timeout(left.min(LOOK));
        if interrupt::asked() {
            until = until.min(begun.elapsed() + interrupt::GRACE);
            return match received {
                Err(RecvTimeoutError::Timeout) => from.recv_timeout(until.saturating_sub(begun.elapsed())),
                other => other,
            };
        }
        if !matches!(received, Err(RecvTimeoutError::Timeout)) || begun.elapsed() >= until {
            return received;
        }
    }
}

/// Keeps signals of the terminal from a child process, which its parent ends.
#[cfg(unix)]
fn apart(command: &mut Command) -> &mut Command {
    std::os::unix::process::CommandExt::process_group(command, 0)
}

#[cfg(not(unix))]
fn apart(command: &mut Command) -> &mut Command {
    command
}

/// How a process ended, in words that continue "the process".
fn ended(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        let name = match signal {
            4 => " (illegal instruction)",
            6 => " (abort)",
            7 => " (bus error)",
            8 => " (arithmetic error)",
            9 => " (killed)",
            11 => " (segmentation fault)",
            15 => " (terminated)",
            _ => "",
        };
        return format!("was ended by signal {signal}{name}");
    }
    match status.code() {
        Some(code) => format!("ended with status {code}"),
        None => "ended".to_owned(),
    }
}
