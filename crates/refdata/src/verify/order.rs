//! Which row of the outputs belongs to which sample: by a column `index`, by inputs, or by place.

use std::collections::{HashMap, VecDeque};

use super::{Finding, VerifyError};
use crate::array::{Array, Per, Role};
use crate::read::{Column, Dataset, Table};

/// Rows by sample.
pub(super) struct Order {
    /// For each sample of the reference, its row.
    pub rows: Vec<Option<usize>>,
    /// How they were found.
    pub by: &'static str,
    /// What is wrong with them.
    pub findings: Vec<Finding>,
}

/// The row of an array for a sample of the file.
pub(super) fn row_of(array: &Array, per_case: u64, sample: usize) -> usize {
    match array.per {
        Per::Sample => sample,
        Per::Case => sample / per_case.max(1) as usize,
    }
}

/// Counts what is wrong, with the first place.
#[derive(Default)]
struct Tally {
    count: u64,
    first: u64,
}

impl Tally {
    fn see(&mut self, at: usize) {
        if self.count == 0 {
            self.first = at as u64;
        }
        self.count += 1;
    }

    fn finding(&self, make: fn(u64, u64) -> Finding) -> Option<Finding> {
        (self.count > 0).then(|| make(self.count, self.first))
    }
}

impl Order {
    pub fn find(reference: &Dataset, actual: &Table, rows: usize) -> Result<Self, VerifyError> {
        if let Some(index) = actual.column("index").filter(|column| column.width == 1) {
            same_rows(index, rows)?;
            let first = reference.document.first;
            let sample = |row: usize| -> Option<usize> {
                let index = u64::try_from(index.numbers.whole(row)?).ok()?;
                usize::try_from(index.checked_sub(first)?).ok()
            };
            return Ok(Self::by(reference, rows, "index", &sample, Finding::ExtraRows));
        }
        match Inputs::find(reference, actual, rows)? {
            Some(inputs) => {
                let samples = inputs.match_rows(rows);
                Ok(Self::by(reference, rows, "inputs", &|row| samples[row], Finding::OtherInputs))
            }
            None => Ok(Self::by(reference, rows, "place", &|row| Some(row), Finding::ExtraRows)),
        }
    }

    fn by(
        reference: &Dataset,
        rows: usize,
        by: &'static str,
        sample: &dyn Fn(usize) -> Option<usize>,
        stray: fn(u64, u64) -> Finding,
    ) -> Self {
        let samples = reference.document.rows as usize;
        let mut order = Self { rows: vec![None; samples], by, findings: Vec::new() };
        let [mut strays, mut repeated, mut misordered, mut missing] = [0; 4].map(|_: u8| Tally::default());
        let mut last = None;
        for row in 0..rows {
            match sample(row).filter(|&sample| sample < samples) {
                None => strays.see(row),
                Some(sample) if order.rows[sample].is_some() => repeated.see(row),
                Some(sample) => {
                    if last.is_some_and(|last| sample < last) {
                        misordered.see(row);
                    }
                    last = Some(sample);
                    order.rows[sample] = Some(row);
                }
            }
        }
        let first = reference.document.first;
        (0..samples).filter(|&sample| order.rows[sample].is_none()).for_each(|sample| missing.see(sample));
        missing.first += first;
        order.findings = [
            missing.finding(Finding::MissingSamples),
            strays.finding(stray),
            repeated.finding(Finding::Repeated),
            misordered.finding(Finding::Misordered),
        ]
        .into_iter()
        .flatten()
        .collect();
        order
    }
}

fn same_rows(column: &Column, rows: usize) -> Result<(), VerifyError> {
    if column.rows() == rows {
        return Ok(());
    }
    let (name, others) = (column.name.clone(), rows);
    Err(VerifyError::Rows { name, rows: column.rows(), other: "the outputs".into(), others })
}

/// Inputs that the outputs come with: those of samples, as far as they are there.
struct Inputs<'a> {
    samples: usize,
    /// Columns with the array that they are to be compared with, and the word.
    columns: Vec<(&'a Column, usize, &'a Array, &'a [u8], usize)>,
}

impl<'a> Inputs<'a> {
    fn find(reference: &'a Dataset, actual: &'a Table, rows: usize) -> Result<Option<Self>, VerifyError> {
        let arrays = reference.document.arrays.iter().zip(&reference.arrays);
        let mut columns = Vec::new();
        for (array, bytes) in arrays.filter(|(array, _)| array.role == Role::Input && array.per == Per::Sample) {
            for name in [array.name.clone(), array.variable.clone()] {
                let whole = actual.column(&name).filter(|column| column.width == array.words());
                let parts: Option<Vec<(&Column, usize)>> = match whole {
                    Some(column) => Some((0..array.words()).map(|word| (column, word)).collect()),
                    None => array.components.iter().map(|c| Some((actual.column(&format!("{name}{c}"))?, 0))).collect(),
                };
                // `gl_Position` may be an input and an output.
                let is_output = name == array.variable
                    && reference.document.arrays.iter().any(|a| a.role == Role::Expected && a.variable == name);
                if let Some(parts) = parts.filter(|_| !is_output) {
                    for (word, (column, place)) in parts.into_iter().enumerate() {
                        same_rows(column, rows)?;
                        columns.push((column, place, array, &bytes[..], word));
                    }
                    break;
                }
            }
        }
        let samples = reference.document.rows as usize;
        Ok((!columns.is_empty()).then_some(Self { samples, columns }))
    }

    fn key(&self, row: usize) -> Vec<u32> {
        let word = |(column, place, array, ..): &(&Column, usize, &Array, &[u8], usize)| {
            let at = row * column.width + place;
            match array.dtype {
                crate::WordType::F4 => column.numbers.bits(at),
                _ => column.numbers.whole(at).unwrap_or_default() as u32,
            }
        };
        self.columns.iter().map(word).collect()
    }

    fn own(&self, sample: usize) -> Vec<u32> {
        let word = |(_, _, array, bytes, word): &(&Column, usize, &Array, &[u8], usize)| {
            let at = sample * array.stride() + 4 * word;
            let b = &bytes[at..at + 4];
            u32::from_le_bytes([b[0], b[1], b[2], b[3]])
        };
        self.columns.iter().map(word).collect()
    }

    /// The sample of each row. Where the inputs of a row are those of its own place, that is where it
    /// belongs; several samples with the same inputs are handed out in their order.
    fn match_rows(&self, rows: usize) -> Vec<Option<usize>> {
        let here = |row: usize| row < self.samples && self.own(row) == self.key(row);
        let mut found: Vec<Option<usize>> = (0..rows).map(|row| here(row).then_some(row)).collect();
        if found.iter().all(Option::is_some) {
            return found;
        }
        let mut open: HashMap<Vec<u32>, VecDeque<usize>> = HashMap::new();
        for sample in 0..self.samples {
            let taken = |sample: usize| found.get(sample).is_some_and(Option::is_some);
            let places = open.entry(self.own(sample)).or_default();
            // One that is taken stays until there is another: one more row of its inputs is a repetition.
            if !taken(sample) && places.front().is_some_and(|&first| taken(first)) {
                places.clear();
            }
            if !taken(sample) || places.is_empty() {
                places.push_back(sample);
            }
        }
        for (row, sample) in found.iter_mut().enumerate().filter(|(_, sample)| sample.is_none()) {
            let Some(places) = open.get_mut(&self.key(row)) else { continue };
            *sample = if places.len() > 1 { places.pop_front() } else { places.front().copied() };
        }
        found
    }
}
