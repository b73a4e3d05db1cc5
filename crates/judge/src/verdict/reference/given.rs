//! Functions of the caller.

use std::fmt;
use std::sync::Arc;

use super::formula::list;
use super::{Expected, ReferenceError};
use base::value::Batch;
use program::Program;
use property::Sample;

/// A function from inputs to the components of an output.
pub type GivenRule = dyn Fn(&Sample, &mut [f64]) + Send + Sync;

/// What one output should be, as a function of the inputs.
#[derive(Clone)]
pub struct Given {
    /// Name of the output; `return` for the value of a function.
    pub output: String,
    /// Writes the components of the output in order, matrices column by column, elements of arrays one
    /// after the other. NaN stands for an output without a value, which is inconclusive.
    pub rule: Arc<GivenRule>,
}

impl fmt::Debug for Given {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Given").field("output", &self.output).finish_non_exhaustive()
    }
}

/// The indices of the outputs that the rules give, in their order.
pub(super) fn bind(rules: &[Given], program: &Program) -> Result<Vec<usize>, ReferenceError> {
    let layout = program.output_layout();
    if layout.max_vertices.is_some() {
        let (by, gives) = ("the expectation".to_owned(), "gives one set of outputs");
        return Err(ReferenceError::Stage { by, gives, stage: "geometry stage" });
    }
    let index = |rule: &Given| {
        layout.vertex.index_of(&rule.output).ok_or_else(|| ReferenceError::NothingInCommon {
            by: "the expectation".to_owned(),
            gives: format!("`{}`", rule.output),
            has: list(program, layout.vertex.fields()),
            help: "",
        })
    };
    rules.iter().map(index).collect()
}

/// What the rules give for one invocation.
pub(super) fn eval(rules: &[Given], outputs: &[super::JudgedOutput], at: (&Batch, usize), expected: &mut Expected) {
    let (batch, invocation) = at;
    let sample = Sample {
        invocation_record: batch.invocation_record.clone(),
        case_record: batch.case_record.clone(),
        invocation: batch.invocation(invocation).to_vec(),
        case: batch.case_of(invocation).to_vec(),
    };
    expected.words.resize(outputs.last().map_or(0, |o| o.expected.end), 0.0);
    for (rule, output) in rules.iter().zip(outputs) {
        (rule.rule)(&sample, &mut expected.words[output.expected.clone()]);
    }
}
