//! One invocation with its uniforms.

use std::sync::Arc;

use base::value::{Batch, Record, Scalar};

/// The inputs of a single invocation: words of its own and words of its case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Layout of `invocation`.
    pub invocation_record: Arc<Record>,
    /// Layout of `case`.
    pub case_record: Arc<Record>,
    /// Words of the attributes, primitive inputs or arguments.
    pub invocation: Vec<u32>,
    /// Words of the uniforms.
    pub case: Vec<u32>,
}

impl Sample {
    /// One invocation of a batch.
    pub fn of(batch: &Batch, invocation: usize) -> Self {
        Self {
            invocation_record: batch.invocation_record.clone(),
            case_record: batch.case_record.clone(),
            invocation: batch.invocation(invocation).to_vec(),
            case: batch.case_of(invocation).to_vec(),
        }
    }

    /// Samples as a batch with one invocation a case.
    ///
    /// # Panics
    /// Without a sample: there is no layout then.
    pub fn batch(samples: &[Self]) -> Batch {
        let first = &samples[0];
        let (invocation, case) = (first.invocation_record.clone(), first.case_record.clone());
        let mut batch = Batch::with_capacity(invocation, case, 1, samples.len());
        for sample in samples {
            batch.invocations.extend_from_slice(&sample.invocation);
            batch.cases.extend_from_slice(&sample.case);
        }
        batch
    }

    /// The words of an input by name; `None` when there is no such input.
    pub fn words(&self, name: &str) -> Option<&[u32]> {
        if let Some(i) = self.invocation_record.index_of(name) {
            return Some(&self.invocation[self.invocation_record.range(i)]);
        }
        self.case_record.index_of(name).map(|i| &self.case[self.case_record.range(i)])
    }

    /// The words of an input by name, to be changed.
    pub fn words_mut(&mut self, name: &str) -> Option<&mut [u32]> {
        if let Some(i) = self.invocation_record.index_of(name) {
            return Some(&mut self.invocation[self.invocation_record.range(i)]);
        }
        self.case_record.index_of(name).map(|i| &mut self.case[self.case_record.range(i)])
    }

    /// The values of an input as binary64 numbers, whatever its scalar type; empty when there is no
    /// such input.
    pub fn get(&self, name: &str) -> Vec<f64> {
        let scalar = self.scalar(name);
        let words = self.words(name).unwrap_or(&[]);
        words.iter().map(|&w| decode(w, scalar)).collect()
    }

    /// Sets an input from binary64 numbers, each rounded to the nearest value of its scalar type.
    /// Does nothing when there is no such input.
    ///
    /// # Panics
    /// When the number of values is not that of the input's words: a defect of the caller.
    pub fn set(&mut self, name: &str, values: &[f64]) {
        let scalar = self.scalar(name);
        if let Some(words) = self.words_mut(name) {
            assert_eq!(words.len(), values.len(), "{name}");
            for (word, &value) in words.iter_mut().zip(values) {
                *word = encode(value, scalar);
            }
        }
    }

    fn scalar(&self, name: &str) -> Scalar {
        [&self.invocation_record, &self.case_record]
            .into_iter()
            .find_map(|r| r.index_of(name).map(|i| r.fields()[i].shape.scalar))
            .unwrap_or(Scalar::F32)
    }
}

/// The number that a word of this scalar type stands for.
pub fn decode(word: u32, scalar: Scalar) -> f64 {
    match scalar {
        Scalar::F32 => f64::from(f32::from_bits(word)),
        Scalar::I32 => f64::from(word as i32),
        Scalar::U32 => f64::from(word),
        Scalar::Bool => f64::from(u32::from(word != 0)),
    }
}

/// The word of this scalar type nearest to a number.
pub fn encode(value: f64, scalar: Scalar) -> u32 {
    match scalar {
        Scalar::F32 => (value as f32).to_bits(),
        Scalar::I32 => value.round() as i32 as u32,
        Scalar::U32 => value.round() as u32,
        Scalar::Bool => u32::from(value != 0.0),
    }
}
