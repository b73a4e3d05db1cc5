//! Every word of every sample of a small batch, on all sides: what a person looks at.

use std::ops::Range;

use super::batch::judge_each;
use super::judge::{Verdict, real};
use super::observe::{Slack, slack_of};
use super::oracle::JudgeContext;
use super::parallel::parts;
use super::reference::{Evaluator, Expected};
use crate::tape::Tape;
use base::value::Batch;
use program::interp::{Machine, Number, OutputColumn, SLOTS};
use program::lane::Actual;

/// One sample with its verdict and all that was compared.
#[derive(Clone, Debug)]
pub struct Closeup {
    /// What the judge says.
    pub verdict: Verdict,
    /// The words of each vertex; one vertex for what emits none.
    pub vertices: Vec<Vec<Seen>>,
}

/// One output word on all sides. A side that has no such word has NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// What the formula says; NaN for an output that it does not give.
    pub expected: f64,
    /// What the shader means in real numbers.
    pub meaning: f64,
    /// What the lane gave.
    pub actual: f64,
    /// How far the lane may be from the meaning by the most lenient promise; infinite without one.
    pub promised: f64,
    /// The same by the measured profile; infinite without one.
    pub measured: f64,
}

impl Seen {
    /// A word that no side has.
    pub const NOTHING: Self = Self {
        expected: f64::NAN,
        meaning: f64::NAN,
        actual: f64::NAN,
        promised: f64::INFINITY,
        measured: f64::INFINITY,
    };

    /// What the lane's word is compared with: the formula where it says something, else the meaning.
    pub fn target(&self) -> f64 {
        if self.expected.is_nan() { self.meaning } else { self.expected }
    }

    /// Distance of the lane from its target; NaN where one of them is no number.
    pub fn error(&self) -> f64 {
        (self.actual - self.target()).abs()
    }

    /// What is promised; what was measured where nothing is.
    pub fn bound(&self) -> f64 {
        if self.promised.is_finite() { self.promised } else { self.measured }
    }
}

/// Looks at every invocation of a batch, in its order.
///
/// # Panics
/// When `actual` is not of this batch: a defect of the caller.
pub fn closeups(context: &JudgeContext<'_>, batch: &Batch, actual: &Actual) -> Vec<Closeup> {
    let count = batch.invocation_count();
    let verdicts = judge_each(context, batch, actual);
    let chunks = parts(
        count.div_ceil(SLOTS),
        || Viewer::new(context),
        |viewer, chunk| viewer.look(batch, actual, chunk * SLOTS..((chunk + 1) * SLOTS).min(count)),
    );
    let vertices = chunks.into_iter().flatten();
    verdicts.into_iter().zip(vertices).map(|(verdict, vertices)| Closeup { verdict, vertices }).collect()
}

/// What one thread looks with.
struct Viewer<'a> {
    context: JudgeContext<'a>,
    promise: Machine<'a, Tape<'a>>,
    measured: Option<Machine<'a, Tape<'a>>>,
    evaluator: Evaluator<'a>,
}

impl<'a> Viewer<'a> {
    fn new(context: &JudgeContext<'a>) -> Self {
        Self {
            context: *context,
            promise: context.oracle.tape(context.lenient()),
            measured: context.measured().map(|model| context.oracle.tape(model)),
            evaluator: Evaluator::new(context.reference),
        }
    }

    fn look(&mut self, batch: &Batch, actual: &Actual, range: Range<usize>) -> Vec<Vec<Vec<Seen>>> {
        let first = range.start;
        let promised = slack_of(&mut self.promise, batch, first);
        let measured: Option<Slack> = self.measured.as_mut().map(|machine| slack_of(machine, batch, first));
        let meanings = meanings(&mut self.promise, actual);
        let reference = self.context.reference;
        let invocations: Vec<usize> = range.clone().collect();
        self.evaluator.turn_to(batch, &invocations);
        let mut expected = Expected::default();
        let (width, room) = (self.promise.width(), self.promise.room());
        let mut all = Vec::with_capacity(range.len());
        for invocation in range {
            let slot = invocation - first;
            self.evaluator.expected(batch, invocation, slot, &mut expected);
            let (stored, emitting) = (actual.stored(invocation), self.promise.is_emitting());
            let meant = if emitting { (self.promise.emitted()[slot] as usize).min(room) } else { 1 };
            let count = stored.max(meant).max(expected.strips.len());
            let mut vertices = vec![vec![Seen::NOTHING; width]; count];
            for (vertex, words) in vertices.iter_mut().enumerate() {
                for (word, seen) in words.iter_mut().enumerate() {
                    if vertex < meant {
                        let at = vertex * width + word;
                        seen.meaning = meanings[at][slot];
                        seen.promised = promised[slot][at];
                        seen.measured = measured.as_ref().map_or(f64::INFINITY, |slack| slack[slot][at]);
                    }
                    if vertex < stored {
                        let found = actual.vertex(invocation, vertex)[word];
                        let scalar = actual.layout().vertex.scalar_of(word);
                        seen.actual = if actual.is_unwritten(found) { f64::NAN } else { real(found, scalar) };
                    }
                }
                for output in &reference.outputs {
                    let from = vertex * reference.vertex_words + output.expected.start;
                    for (k, word) in output.actual.clone().enumerate() {
                        words[word].expected = expected.words.get(from + k).copied().unwrap_or(f64::NAN);
                    }
                }
            }
            all.push(vertices);
        }
        all
    }
}

/// The exact values of the outputs, by vertex, then by word of the record.
fn meanings(machine: &mut Machine<'_, Tape<'_>>, actual: &Actual) -> Vec<[f64; SLOTS]> {
    let (room, width) = (machine.room(), machine.width());
    let mut values = Vec::with_capacity(room * width);
    for vertex in 0..room {
        for word in 0..width {
            values.push(match machine.output(vertex, word) {
                OutputColumn::Real(&column) => *machine.domain().values(column),
                OutputColumn::Word(words) => {
                    let scalar = actual.layout().vertex.scalar_of(word);
                    words.map(|word| <f64 as Number>::exact(word, scalar))
                }
            });
        }
    }
    values
}
