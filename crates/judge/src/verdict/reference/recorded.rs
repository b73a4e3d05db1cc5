//! Recorded values: rows of inputs with the outputs that belong to them.

use std::collections::HashMap;

use super::formula::list;
use super::{Expected, ReferenceError};
use base::value::Batch;
use program::Program;
use property::Sample;

/// What a file records for one set of inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedRow {
    /// Inputs, laid out as the program takes them.
    pub sample: Sample,
    /// The outputs, one variable after the other; NaN where none is recorded.
    pub outputs: Vec<f64>,
    /// How far each of them may be from what was meant: they are written with so many digits.
    pub slack: Vec<f64>,
}

/// Rows of recorded values.
#[derive(Clone, Debug)]
pub struct Recorded {
    by: String,
    outputs: Vec<String>,
    rows: Vec<RecordedRow>,
    /// The row for the words of an invocation and its case.
    find: HashMap<Vec<u32>, usize>,
}

impl Recorded {
    /// Rows with values of these outputs. `by` names the record in messages.
    ///
    /// # Errors
    /// Rows that contradict each other.
    pub fn new(by: String, outputs: Vec<String>, rows: Vec<RecordedRow>) -> Result<Self, ReferenceError> {
        let mut find: HashMap<Vec<u32>, usize> = HashMap::with_capacity(rows.len());
        for (k, row) in rows.iter().enumerate() {
            if let Some(first) = find.insert(key(&row.sample.invocation, &row.sample.case), k)
                && rows[first].outputs != row.outputs
            {
                return Err(ReferenceError::Contradiction { by, first: first + 1, second: k + 1 });
            }
        }
        Ok(Self { by, outputs, rows, find })
    }

    /// All rows, in the order of the file.
    pub fn rows(&self) -> &[RecordedRow] {
        &self.rows
    }

    /// The indices of the outputs that are recorded.
    pub(super) fn bind(&self, program: &Program) -> Result<Vec<usize>, ReferenceError> {
        let layout = program.output_layout();
        if layout.max_vertices.is_some() {
            let (by, gives) = (self.by.clone(), "gives one set of outputs");
            return Err(ReferenceError::Stage { by, gives, stage: "geometry stage" });
        }
        let index = |name: &String| {
            layout.vertex.index_of(name).ok_or_else(|| ReferenceError::NothingInCommon {
                by: self.by.clone(),
                gives: format!("`{name}`"),
                has: list(program, layout.vertex.fields()),
                help: "",
            })
        };
        self.outputs.iter().map(index).collect()
    }

    /// What is recorded for an invocation; nothing where there is no such row.
    pub(super) fn eval(&self, batch: &Batch, invocation: usize, expected: &mut Expected) {
        expected.clear();
        let row = self.find.get(&key(batch.invocation(invocation), batch.case_of(invocation)));
        if let Some(row) = row.map(|&row| &self.rows[row]) {
            expected.words.extend_from_slice(&row.outputs);
            expected.slack.extend_from_slice(&row.slack);
        }
    }
}

fn key(invocation: &[u32], case: &[u32]) -> Vec<u32> {
    [invocation, case].concat()
}
