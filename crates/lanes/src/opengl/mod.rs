//! The lanes of OpenGL: the author's text as it stands, in the stage that it is for, through Mesa's own compiler, with
//! real uniforms and attributes, captured by transform feedback.
//!
//! The driver is chosen by the environment of a process, so each driver runs in a process of its own
//! ([`worker`](super::worker)). Where the program that has them is not there, the usual driver runs in this one.
//!
//! What the harness adds stands in texts of its own: a vertex stage in front of a geometry stage, a `main` that calls
//! a function. Records have no canary here. That they were written is proved by the driver's counts of primitives, a
//! sentinel in every word of the buffer, and room for one vertex behind it.

mod ask;
pub(crate) mod call;
mod context;
mod dispatch;
mod draw;
mod job;
mod open;
mod pass;
mod prepare;
mod record;
mod remote;
mod textures;
mod types;
mod uniforms;

#[cfg(test)]
mod tests;

use super::worker::with_inputs;
use super::{Actual, Description, Lane, LaneError, Marks, Runner, Sharing, check_asked};
use base::value::Batch;
use program::interp::{self, Binary32, Executable, Meaning};
use program::lower::Role;
use program::{Count, Drawn, Kernel, OutputLayout};

use ask::unsupported;
use job::{CaptureKind, Captured, Inputs, Job};
use prepare::{Ready, Refusal};

pub use open::candidates;
pub use remote::serve;

/// The argument of a process that serves these lanes.
pub const SIDE: &str = "opengl";

/// Where jobs run: in this process or in another one.
trait Backend: Sized + 'static {
    /// Which threads may run kernels on a lane of this kind.
    fn sharing(_: &OpenGl<Self>) -> Sharing<'_> {
        Sharing::Alone
    }

    /// Makes a job ready for at most `capacity` invocations.
    fn prepare(&self, job: &Job, capacity: usize) -> Result<Box<dyn Session>, Refusal>;
}

/// A job that is ready.
trait Session {
    /// Invocations that fit into one run.
    fn capacity(&self) -> usize;

    fn run(&mut self, inputs: &Inputs<'_>) -> Result<Captured, LaneError>;
}

/// In this process.
struct Here(std::rc::Rc<context::Context>);

impl Backend for Here {
    fn prepare(&self, job: &Job, capacity: usize) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Ready::new(&self.0, job, capacity)?))
    }
}

impl Session for Ready {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, inputs: &Inputs<'_>) -> Result<Captured, LaneError> {
        Self::run(self, inputs, &mut |_| {})
    }
}

struct OpenGl<B> {
    description: Description,
    backend: B,
    /// True where a loop without end would stop this process: the interpreter goes through it first.
    guarded: bool,
}

impl<B: Backend> Lane for OpenGl<B> {
    fn description(&self) -> &Description {
        &self.description
    }

    fn sharing(&self) -> Sharing<'_> {
        B::sharing(self)
    }

    fn calls_functions(&self) -> bool {
        true
    }

    fn dispatches(&self) -> bool {
        true
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        check_asked(kernel)?;
        let job = ask::job(kernel)?;
        // A driver may leave a loop that has no end, and go on with what it has.
        // Of a dispatch, the judge looks at every invocation before the lane is asked.
        let whole = matches!(job.stage, CaptureKind::Dispatch { .. });
        let loops = kernel.has_loops() && !whole;
        let interpreted = self.guarded || loops || matches!(job.stage, CaptureKind::Geometry { .. });
        let compile = || interp::compile(&kernel.program).map_err(|error| unsupported(error.locate(&kernel.program)));
        let meaning = interpreted.then(compile).transpose()?;
        let session = self.backend.prepare(&job, capacity.max(1)).map_err(|refusal| refused(refusal, kernel, &job))?;
        let (layout, drawn) = (kernel.output.clone(), kernel.program.drawn());
        Ok(Box::new(GlRunner { session, job, layout, drawn, meaning, guarded: self.guarded }))
    }
}

/// A kernel on a driver of OpenGL.
struct GlRunner {
    session: Box<dyn Session>,
    job: Job,
    layout: OutputLayout,
    /// Numbers of the draw that the stage reads.
    drawn: Vec<Drawn>,
    /// What the shader means to emit, and whether it ends.
    meaning: Option<Executable>,
    guarded: bool,
}

impl GlRunner {
    fn meaning(&self, batch: &Batch) -> Result<Option<Meaning<u32>>, LaneError> {
        let run = |e: &Executable| e.run::<Binary32>(batch, interp::FUEL);
        self.meaning.as_ref().map(run).transpose().map_err(|error| unsupported(error.to_string()))
    }
}

impl GlRunner {
    /// Softpipe runs four vertices at a time and fills up with zeros, which may be what does not end: where the
    /// interpreter finds an invocation without end, that one is named.
    fn named(&self, error: LaneError, batch: &Batch) -> LaneError {
        let endless = || match ends(self.meaning(batch).ok().flatten().as_ref(), 0) {
            Err(LaneError::Endless { invocation, .. }) => Some(invocation),
            _ => None,
        };
        match error {
            LaneError::Lost { how, invocation, count, inputs } => {
                LaneError::Lost { how, invocation: endless().or(invocation), count, inputs }
            }
            other => other,
        }
    }
}

impl Runner for GlRunner {
    fn capacity(&self) -> usize {
        self.session.capacity()
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let count = self.count_of(batch, "invocations")?;
        for drawn in &self.drawn {
            // The others are 0 in what is drawn here.
            let set = matches!(drawn.count, Count::Vertex | Count::Instance);
            let fits = |of: &[u32]| if set { drawn.of(of).map(drop) } else { drawn.must_be_zero(of) };
            (0..count).try_for_each(|k| fits(batch.invocation(k))).map_err(unsupported)?;
        }
        let mut meaning = None;
        if self.guarded {
            meaning = self.meaning(batch)?;
            ends(meaning.as_ref(), count)?;
        }
        let marks = Marks::random();
        let inputs = Inputs {
            invocations: &batch.invocations,
            cases: &batch.cases,
            count,
            per_case: batch.per_case,
            sentinel: marks.sentinel,
            one_by_one: false,
        };
        let captured = match self.session.run(&inputs) {
            Ok(captured) => captured,
            Err(error) => return Err(with_inputs(self.named(error, batch), batch)),
        };
        if meaning.is_none() {
            meaning = self.meaning(batch)?;
            ends(meaning.as_ref(), count)?;
        }
        let words = match self.job.stage {
            CaptureKind::Vertex | CaptureKind::Dispatch { .. } => {
                record::points(&self.layout, &captured, count, marks)?
            }
            CaptureKind::Geometry { output, .. } => {
                record::strips(&self.layout, (output, &captured), count, meaning.as_ref(), marks)?
            }
        };
        Actual::accept(&self.layout, words, count, marks)
    }
}

/// Refuses outputs of a batch in which an invocation has no end.
fn ends(meaning: Option<&Meaning<u32>>, count: usize) -> Result<(), LaneError> {
    match meaning.and_then(Meaning::endless) {
        Some(invocation) => Err(LaneError::Endless { invocation, count, rounds: interp::FUEL }),
        None => Ok(()),
    }
}

/// What a refusal is to the user: the driver's words, at places of the author's text.
fn refused(refusal: Refusal, kernel: &Kernel, job: &Job) -> LaneError {
    let alone = matches!(kernel.program.role, Role::Function { .. });
    let (text, log) = match refusal {
        // The text is for another stage, perhaps.
        Refusal::Text { log, .. } | Refusal::Link(log) if alone => {
            return unsupported(format!(
                "this text in a vertex stage: {}",
                log.trim().lines().next().unwrap_or_default()
            ));
        }
        Refusal::Lane(error) => return error,
        Refusal::Link(log) => return LaneError::Api(format!("the driver does not link the stage: {}", log.trim())),
        Refusal::Text { text, log } => (text, log),
    };
    let line = |line: &str| match position(line) {
        Some((at, rest)) => {
            let place = job.texts.get(text).and_then(|asked| ask::place(&kernel.program, text, asked, at));
            place.map_or_else(|| line.to_owned(), |place| format!("{place}: {}", rest.trim()))
        }
        None => line.trim().to_owned(),
    };
    let lines: Vec<String> = log.trim().lines().map(line).collect();
    LaneError::Api(format!("the driver does not compile the shader: {}", lines.join("\n  ")))
}

/// Line and column at the start of a line of a driver's log: `0:12(5): error: …` of Mesa, `0(12) : error C1008: …` of NVIDIA,
/// which tells no column.
fn position(line: &str) -> Option<((u32, u32), &str)> {
    let mesa = || {
        let (_, rest) = line.split_once(':')?;
        let (row, rest) = rest.split_once('(')?;
        let (column, rest) = rest.split_once("):")?;
        Some(((row.parse().ok()?, column.parse().ok()?), rest))
    };
    let nvidia = || {
        let (text, rest) = line.split_once('(')?;
        let (row, rest) = rest.split_once(") :")?;
        text.parse::<u32>().ok()?;
        Some(((row.parse().ok()?, 1), rest))
    };
    mesa().or_else(nvidia)
}
