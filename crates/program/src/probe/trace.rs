//! Traces, decoded.

use thiserror::Error;

use super::{OperandSource, Probed};

/// An output word of a run, in some domain of numbers.
pub trait TraceWord: Copy {
    /// The value of an unsigned output.
    fn unsigned(self) -> Option<u32>;
    /// The value of a float output that is a small whole number.
    fn whole(self) -> Option<u32>;
    /// A constant as such a word.
    fn literal(value: f32) -> Self;
}

/// The bits of binary32 numbers, from a lane or from the interpreter.
impl TraceWord for u32 {
    fn unsigned(self) -> Option<u32> {
        Some(self)
    }

    fn whole(self) -> Option<u32> {
        f64::from(f32::from_bits(self)).whole()
    }

    fn literal(value: f32) -> Self {
        value.to_bits()
    }
}

/// Numbers of binary64, from the interpreter.
impl TraceWord for f64 {
    fn unsigned(self) -> Option<u32> {
        self.whole()
    }

    fn whole(self) -> Option<u32> {
        let value = self as u32;
        (f64::from(value) == self).then_some(value)
    }

    fn literal(value: f32) -> Self {
        Self::from(value)
    }
}

/// What one run of an expression gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Step<W> {
    /// Index of the point.
    pub point: usize,
    /// Its values, matrices column by column.
    pub values: Vec<W>,
    /// The values of the leaves of the point.
    pub leaves: Vec<W>,
}

/// What an invocation computed, in the order of execution.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace<W> {
    /// The steps that fitted.
    pub steps: Vec<Step<W>>,
    /// Words of all steps, those that did not fit included.
    pub words: u32,
    /// True when steps at the end did not fit.
    pub cut: bool,
}

impl<W> Trace<W> {
    /// Index of the first step at which two traces part: of different points, or values of which
    /// `agree` says no, or where one has ended and was not cut. `None` when they do not.
    pub fn first_difference<V>(
        &self,
        other: &Trace<V>,
        mut agree: impl FnMut(&Step<W>, &Step<V>) -> bool,
    ) -> Option<usize> {
        let parted = self.steps.iter().zip(&other.steps).position(|(a, b)| a.point != b.point || !agree(a, b));
        let (a, b) = (self.steps.len(), other.steps.len());
        let ended = (a < b && !self.cut) || (b < a && !other.cut);
        parted.or_else(|| ended.then_some(a.min(b)))
    }
}

/// Words that are no trace: the lane has damaged it.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum TraceError {
    /// Too few words for this program.
    #[error("an output record of {found} words holds no trace of {expected}")]
    Length {
        /// Words of the record.
        found: usize,
        /// Words of the trace and of what stands before it.
        expected: usize,
    },
    /// The counter is no number.
    #[error("the number of words of the trace was not written")]
    Count,
    /// No point has the number that stands there, or its step runs over the end.
    #[error("word {at} of the trace starts no step")]
    Step {
        /// Index of the word.
        at: usize,
    },
}

/// A scalar operation of a trace with its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Applied<W> {
    /// Index of the step.
    pub step: usize,
    /// Name as profiles list it.
    pub name: &'static str,
    /// Operands, from left to right.
    pub operands: Vec<W>,
    /// What the side that was traced made of the operands.
    pub result: W,
}

impl Probed {
    /// Decodes the trace in the output words of an invocation (of its vertex 0, on every role).
    ///
    /// # Errors
    /// [`TraceError`] when the words are none.
    pub fn trace<W: TraceWord>(&self, words: &[W]) -> Result<Trace<W>, TraceError> {
        let room = self.words as usize;
        let expected = self.program.output_layout().vertex.words();
        if words.len() != expected {
            return Err(TraceError::Length { found: words.len(), expected });
        }
        // The trace and its length are the last two outputs.
        let words = &words[expected - room - 1..];
        let wanted = words[room].unsigned().ok_or(TraceError::Count)?;
        let cut = wanted > self.words;
        let end = room.min(wanted as usize);
        let (mut at, mut steps) = (0, Vec::new());
        while at < end {
            // Points are numbered from 1, so that no word that is left blank is one.
            let number = words[at].whole().and_then(|n| (n as usize).checked_sub(1));
            let point = number.and_then(|n| self.points.get(n).map(|point| (n, point)));
            let Some((index, point)) = point.filter(|(_, point)| at + point.words() as usize <= end) else {
                if cut {
                    break;
                }
                return Err(TraceError::Step { at });
            };
            let own = &words[at + 1..at + point.words() as usize];
            let (values, leaves) = own.split_at(point.components as usize);
            steps.push(Step { point: index, values: values.to_vec(), leaves: leaves.to_vec() });
            at += point.words() as usize;
        }
        Ok(Trace { steps, words: wanted, cut })
    }

    /// The scalar operations of a trace whose operands and results are all known: every operation
    /// that an expression consists of alone, and of longer formulas those that only take what is seen
    /// and give what is seen. Operands are what the same run had there, so that each can be judged
    /// alone.
    pub fn applied<W: TraceWord>(&self, trace: &Trace<W>) -> Vec<Applied<W>> {
        // There is no recursion, so that the last value of a point is the one that is meant.
        let mut last: Vec<Option<&Step<W>>> = vec![None; self.points.len()];
        let mut all = Vec::new();
        for (at, step) in trace.steps.iter().enumerate() {
            let value = |source: &OperandSource| match *source {
                OperandSource::Point { point, component } => {
                    last[point].and_then(|step| step.values.get(component as usize).copied())
                }
                OperandSource::Leaf(k) => step.leaves.get(k).copied(),
                OperandSource::Literal(value) => Some(W::literal(value)),
                OperandSource::Operation(_) | OperandSource::Untraced => None,
            };
            for operation in &self.points[step.point].operations {
                let result = operation.result.and_then(|k| step.values.get(k as usize).copied());
                let operands: Option<Vec<W>> = operation.operands.iter().map(value).collect();
                if let (Some(operands), Some(result)) = (operands, result) {
                    all.push(Applied { step: at, name: operation.name, operands, result });
                }
            }
            last[step.point] = Some(step);
        }
        all
    }
}
