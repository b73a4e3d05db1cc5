//! A dispatch of many invocations: what a suite states of it goes into the buffers, and the words of its outputs come out.
//!
//! Small dispatches are one program ([`dispatched`](crate::Program::dispatched)), whose code is written for each
//! invocation: everything is known of every word. Large ones are run side by side, with what is known of a word in the
//! word.
//!
//! Time and memory then grow with the operations, and not with their product with the outputs. A decision that a
//! rounding may turn opens what its invocation writes, what is read of that, and each memory whose places depend on
//! real numbers. Small dispatches stay one program because bounds by a sweep are tighter, and because a failure can
//! be shrunk.

use std::sync::Arc;

use super::super::{Executable, InterpError};
use super::{Buffer, Dispatch, InMemory, Outcome, Space};
use crate::capture::BoundBuffer;
use crate::interp::Site;
use crate::{Form, Program, UniformPlace, Written};
use base::value::Batch;

/// How a large dispatch is run.
#[derive(Clone, Debug)]
pub struct Whole {
    size: [u32; 3],
    groups: [u32; 3],
    zeroed: bool,
    /// For each memory, the buffer that is bound to it; none for the memory of a workgroup.
    bound: Vec<Option<BoundBuffer>>,
    /// Words of all outputs.
    outputs: usize,
}

/// What the outputs of a large dispatch are, one word after the other as in the output record.
#[derive(Clone, Debug)]
pub struct Ran<C> {
    /// Bits of each word.
    pub words: Vec<u32>,
    /// Each word as a number of the domain.
    pub cells: Vec<C>,
    /// True for words of which nothing is known, for a decision before them could have gone the other way.
    pub open: Vec<bool>,
    /// The first such decision.
    pub doubted: Option<Site>,
    /// How much work it was: rounds of loops, each for as many invocations as go side by side.
    pub rounds: u64,
    /// False where a loop goes on for longer than any loop may, or the run was asked to end.
    pub whole: bool,
}

/// Rounds of loops of one invocation at most: a reference may be one loop over all that buffers hold, and over their products.
const FUEL: u32 = 1 << 26;

/// Rounds of loops of all invocations together at most.
const WORK: u64 = 1 << 34;

impl Whole {
    /// How the dispatch of a program is run. `executable` is its stage as its author wrote it.
    pub(in crate::interp) fn of(program: &Program, executable: &Executable) -> Result<Self, InterpError> {
        let kernel = program.compute_kernel();
        let kernel = kernel
            .map_err(|error| InterpError::Unsupported { what: error.to_string(), span: naga::Span::default() })?;
        let (Form::Dispatch { groups, buffers }, Some(size)) = (kernel.form, program.workgroup_size()) else {
            return Err(InterpError::internal("a dispatch of what is no compute stage".to_owned()));
        };
        let mut buffers = buffers.into_iter();
        let bound = |shape: &super::MemoryShape| match shape.space {
            Space::Workgroup => None,
            Space::Storage { .. } if shape.is_image() => None,
            Space::Storage { .. } | Space::Uniform => buffers.next(),
        };
        let bound = executable.memories.iter().map(bound).collect();
        let zeroed = program.written == Written::Wgsl;
        Ok(Self { size, groups, zeroed, bound, outputs: kernel.output.vertex_words() })
    }

    /// What the host puts into the buffers for an invocation of a batch.
    fn buffers(&self, executable: &Executable, batch: &Batch, invocation: usize) -> Vec<Buffer> {
        let both = executable.memories.iter().zip(&self.bound);
        both.map(|(shape, about)| {
            about.as_ref().map_or_else(Buffer::default, |about| about.filled(shape, batch, invocation))
        })
        .collect()
    }
}

impl BoundBuffer {
    /// What it holds before the dispatch that an invocation of a batch is.
    pub fn filled(&self, shape: &super::MemoryShape, batch: &Batch, invocation: usize) -> Buffer {
        let unit = shape.unit as usize;
        let mut words = vec![0; self.bytes as usize / unit];
        let record = if self.uniform { batch.case_of(invocation) } else { batch.invocation(invocation) };
        for &UniformPlace { word, byte } in &self.before {
            words[byte as usize / unit] = record[word as usize];
        }
        let elements = shape.array.as_ref().map_or(0, |array| (words.len() as u32 - array.offset) / array.stride);
        Buffer { words, elements, sides: [0; 3] }
    }
}

impl Executable {
    /// How it is run where it is a large dispatch: by [`Executable::run_whole`] alone.
    pub fn whole(&self) -> Option<&Arc<Whole>> {
        self.whole.as_ref()
    }

    /// True when some number is a real one.
    pub fn has_reals(&self) -> bool {
        self.reals > 0
    }

    /// Runs the dispatch that an invocation of a batch is, in a domain and an [order](Dispatch::order).
    ///
    /// # Errors
    /// [`InterpError::Internal`] for what is no large dispatch.
    pub fn run_whole<D: InMemory>(
        &self,
        batch: &Batch,
        invocation: usize,
        order: u64,
        domain: impl Fn() -> D,
    ) -> Result<Ran<D::Cell>, InterpError> {
        let whole = self.whole.as_ref().ok_or_else(|| InterpError::internal("no large dispatch".to_owned()))?;
        let buffers = whole.buffers(self, batch, invocation);
        let dispatch = Dispatch {
            size: whole.size,
            groups: whole.groups,
            buffers: &buffers,
            zeroed: whole.zeroed,
            outside: 0,
            fuel: FUEL,
            work: WORK,
            watched: false,
            order,
            turns: super::Turns::default(),
            subgroup: super::WIDTH,
        };
        let (Outcome { contents, findings, doubted, rounds, whole: ended, .. }, left) =
            self.dispatch_in(&dispatch, domain);
        let endless = findings.iter().any(|finding| finding.kind == super::HazardKind::Fuel);
        let zero = D::cell(0);
        let mut ran = Ran {
            words: vec![0; whole.outputs],
            cells: vec![zero; whole.outputs],
            open: vec![false; whole.outputs],
            doubted,
            rounds,
            whole: ended && !endless,
        };
        for (k, (about, shape)) in whole.bound.iter().zip(&self.memories).enumerate() {
            for place in about.iter().flat_map(|about| &about.after) {
                let (to, from) = (place.word as usize, (place.byte / shape.unit) as usize);
                ran.words[to] = contents[k][from];
                ran.cells[to] = left[k].cell(from).unwrap_or_else(|| D::cell(contents[k][from]));
                ran.open[to] = left[k].is_open(from);
            }
        }
        Ok(ran)
    }
}
