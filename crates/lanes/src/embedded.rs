//! The `embedded` lane: the interpreter in strict binary32. It needs no driver.
//!
//! It rounds every operation correctly and rearranges nothing, so it is no evidence about a driver:
//! it stands in where there is none, and it tells a shader that is wrong from a driver that is.
//!
//! `embedded-half` is the same as a phone may be: what is `mediump` or `lowp` is binary16.

use base::value::Batch;
use program::interp::group::InMemory;
use program::interp::{self, Binary32, Executable, Half, HazardKind, Meaning};
use program::{Form, Kernel, OutputLayout};

use super::{Actual, Api, Description, Lane, LaneError, LaneName, Marks, Runner, Sharing, Stage, Unavailable};

/// Opens the lane; it is always there.
///
/// # Errors
/// None; the signature is that of all lanes.
pub fn open() -> Result<Box<dyn Lane>, Unavailable> {
    Ok(opened(STRICT, "strict binary32", false))
}

/// Opens the lane on which `mediump` and `lowp` are binary16; it is always there.
///
/// # Errors
/// None; the signature is that of all lanes.
pub fn open_half() -> Result<Box<dyn Lane>, Unavailable> {
    Ok(opened(HALF, "strict binary16 for `mediump` and `lowp`, strict binary32 elsewhere", true))
}

/// Name of the lane of strict binary32.
pub const STRICT: &str = "embedded";

/// Name of the lane on which `mediump` and `lowp` are less than binary32.
pub const HALF: &str = "embedded-half";

/// True for a lane that is held against what is promised of `mediump` where a program has it.
pub fn lowers(lane: &dyn Lane) -> bool {
    lane.description().name == HALF
}

fn opened(name: LaneName, numbers: &str, half: bool) -> Box<dyn Lane> {
    let driver = format!("interpreter of shadercheck {}, {numbers}", env!("CARGO_PKG_VERSION"));
    let description = Description {
        name,
        driver,
        executor: "interpreter".to_owned(),
        // It takes the module as it is: nothing translates.
        front_end: "none".to_owned(),
        api: Api::Binary32,
        stages: vec![Stage::Compute],
    };
    Box::new(Embedded { description, half })
}

struct Embedded {
    description: Description,
    half: bool,
}

impl Lane for Embedded {
    fn description(&self) -> &Description {
        &self.description
    }

    fn dispatches(&self) -> bool {
        !self.half
    }

    fn sharing(&self) -> Sharing<'_> {
        Sharing::Free(self)
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
        let compile = if self.half { interp::compile_lowered } else { interp::compile };
        let executable =
            compile(&kernel.program).map_err(|error| LaneError::Unsupported(error.locate(&kernel.program)))?;
        let (layout, capacity) = (kernel.output.clone(), capacity.max(1));
        Ok(Box::new(EmbeddedRunner { executable, half: self.half, layout, capacity }))
    }
}

struct EmbeddedRunner {
    executable: Executable,
    half: bool,
    layout: OutputLayout,
    capacity: usize,
}

impl Runner for EmbeddedRunner {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        self.count_of(batch, "invocations")?;
        if self.executable.whole().is_some() {
            return dispatched((&self.executable, &self.layout), batch, 0, Binary32::default);
        }
        let meaning = match self.half {
            true => self.executable.run::<Half>(batch, interp::FUEL),
            false => self.executable.run::<Binary32>(batch, interp::FUEL),
        };
        accepted(&self.layout, &meaning.map_err(|error| LaneError::Api(error.to_string()))?)
    }
}

/// What a lane made of the interpreter wrote in large dispatches, each in an order and in a domain whose numbers are binary32.
///
/// # Errors
/// [`LaneError::Endless`] when a loop goes on for longer than any loop may.
pub fn dispatched<D: InMemory>(
    (executable, layout): (&Executable, &OutputLayout),
    batch: &Batch,
    order: u64,
    domain: impl Fn() -> D,
) -> Result<Actual, LaneError> {
    let (marks, count) = (Marks::random(), batch.invocation_count());
    let mut words = vec![marks.sentinel; layout.words() * count];
    for (invocation, record) in words.chunks_exact_mut(layout.words()).enumerate() {
        let ran = executable.run_whole(batch, invocation, order, &domain);
        let ran = ran.map_err(|error| LaneError::Api(error.to_string()))?;
        if !ran.whole {
            return Err(LaneError::Endless { invocation, count, rounds: interp::FUEL });
        }
        record[0] = marks.canary ^ invocation as u32;
        record[layout.header_words()..][..ran.words.len()].copy_from_slice(&ran.words);
    }
    Actual::accept(layout, words, count, marks)
}

/// What a lane made of the interpreter wrote: the records of all invocations.
///
/// # Errors
/// [`LaneError::Endless`] when an invocation ran out of fuel, which is [`interp::FUEL`].
pub fn accepted(layout: &OutputLayout, meaning: &Meaning<u32>) -> Result<Actual, LaneError> {
    let count = meaning.count();
    let endless = (0..count).find(|&i| meaning.flags(i).has(HazardKind::Fuel));
    if let Some(invocation) = endless {
        return Err(LaneError::Endless { invocation, count, rounds: interp::FUEL });
    }
    let marks = Marks::random();
    let mut words = vec![marks.sentinel; layout.words() * count];
    let geometry = layout.max_vertices.is_some();
    for (invocation, record) in words.chunks_exact_mut(layout.words()).enumerate() {
        record[0] = marks.canary ^ invocation as u32;
        if geometry {
            record[1] = meaning.emitted(invocation);
            record[2] = meaning.ended_strips(invocation);
        }
        let header = layout.header_words();
        let size = layout.vertex_words();
        for vertex in 0..meaning.stored(invocation) {
            let place = &mut record[header + vertex * size..][..size];
            let (strip, place) = place.split_at_mut(usize::from(geometry));
            strip.fill(meaning.strip(invocation, vertex));
            place.copy_from_slice(meaning.vertex(invocation, vertex));
        }
    }
    // What the shader left out bears the interpreter's own mark; here it is the sentinel again.
    for &(invocation, vertex, word) in meaning.unwritten() {
        let at = layout.header_words() + vertex * layout.vertex_words() + usize::from(geometry) + word;
        words[invocation * layout.words() + at] = marks.sentinel;
    }
    Actual::accept(layout, words, count, marks)
}
