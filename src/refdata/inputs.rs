//! The inputs of a formula, as a batch has them.

use std::ops::Range;

use crate::exact::Words;
use crate::exact::quick::Given;
use crate::formula::Param;
use crate::math::twofold::{Twofold, WIDTH};
use crate::value::{Batch, Record, Scalar};

/// Where a word of a formula's inputs comes from.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Route {
    pub from_case: bool,
    pub word: usize,
    pub scalar: Scalar,
}

/// Words of a formula's inputs, one after the other, that lie so in a record as well.
pub(super) struct Run {
    /// The first of them.
    pub from: Route,
    /// Their places in the list of the formula.
    pub to: Range<usize>,
}

/// The inputs of a formula for samples side by side.
pub(super) struct Inputs<'b> {
    batch: &'b Batch,
    routes: &'b [Route],
    /// Their numbers in the batch.
    rows: [usize; WIDTH],
    /// The case of all these samples, where it is one.
    pub case: Option<usize>,
}

impl<'b> Inputs<'b> {
    /// Of neighbours. Beyond the end of a batch the last sample is computed again.
    pub fn new(batch: &'b Batch, routes: &'b [Route], first: usize) -> Self {
        let one = first.is_multiple_of(batch.per_case) && batch.per_case.is_multiple_of(WIDTH);
        let last = batch.invocation_count().saturating_sub(1);
        let mut rows = [last; WIDTH];
        rows.iter_mut().zip(first..last).for_each(|(row, number)| *row = number);
        Self { batch, routes, rows, case: one.then(|| first / batch.per_case) }
    }

    /// Of samples anywhere, counted from one; the first of them in all places that are left.
    pub fn of(batch: &'b Batch, routes: &'b [Route], first: usize, rows: &[usize]) -> Self {
        let mut all = [first + rows[0]; WIDTH];
        all.iter_mut().zip(rows).for_each(|(to, row)| *to = first + row);
        Self { batch, routes, rows: all, case: None }
    }

    /// Hands the words to the quick phase.
    #[inline(always)]
    pub fn give(&self, case: usize, runs: &[Run], given: &mut Given) {
        let [own, shared] = [&self.batch.invocation_record, &self.batch.case_record].map(|record| record.words());
        given.case.resize(self.routes.len(), 0.0);
        given.own.resize(self.routes.len(), [0.0; WIDTH]);
        for Run { from, to } in runs {
            let Route { from_case, word, scalar } = *from;
            if from_case {
                let words = &self.batch.cases[case * shared + word..][..to.len()];
                let out = &mut given.case[to.clone()];
                match scalar {
                    // A loop of its own, which becomes vectors.
                    Scalar::F32 => {
                        out.iter_mut().zip(words).for_each(|(out, &word)| *out = number(word, Scalar::F32));
                    }
                    _ => out.iter_mut().zip(words).for_each(|(out, &word)| *out = number(word, scalar)),
                }
            } else {
                for lane in 0..WIDTH {
                    let words = &self.batch.invocations[self.rows[lane] * own + word..][..to.len()];
                    let out = &mut given.own[to.clone()];
                    out.iter_mut().zip(words).for_each(|(out, &word)| out[lane] = number(word, scalar));
                }
            }
        }
    }
}

impl<const SAFE: bool> Words<Twofold<SAFE>> for Inputs<'_> {
    #[inline(always)]
    fn word(&self, index: usize) -> Twofold<SAFE> {
        let Route { from_case, word, scalar } = self.routes[index];
        let Batch { per_case, .. } = *self.batch;
        let (words, stride) = if from_case {
            (&self.batch.cases, self.batch.case_record.words())
        } else {
            (&self.batch.invocations, self.batch.invocation_record.words())
        };
        let mut out = [0.0; WIDTH];
        if let (true, Some(case)) = (from_case, self.case) {
            out = [number(words[case * stride + word], scalar); WIDTH];
            return Twofold::of(out);
        }
        for (out, &row) in out.iter_mut().zip(&self.rows) {
            let row = if from_case { row / per_case } else { row };
            *out = number(words[row * stride + word], scalar);
        }
        Twofold::of(out)
    }
}

#[inline(always)]
fn number(word: u32, scalar: Scalar) -> f64 {
    match scalar {
        Scalar::F32 => f64::from(f32::from_bits(word)),
        Scalar::I32 => f64::from(word.cast_signed()),
        Scalar::U32 | Scalar::Bool => f64::from(word),
    }
}

/// Where the words of an input of a formula come from.
pub(super) fn routes(param: &Param, sides: [&Record; 2]) -> Vec<Route> {
    for (side, record) in sides.into_iter().enumerate() {
        if let Some(index) = record.index_of(param.name) {
            let scalar = record.fields()[index].shape.scalar;
            return record.range(index).map(|word| Route { from_case: side == 1, word, scalar }).collect();
        }
    }
    // The formula was bound to these records, so each of its inputs is in one.
    Vec::new()
}

/// Neighbours among the words of inputs, of one type.
pub(super) fn runs(routes: &[Route]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (index, route) in routes.iter().enumerate() {
        match runs.last_mut() {
            Some(Run { from, to }) if *route == (Route { word: from.word + to.len(), ..*from }) => to.end += 1,
            Some(_) | None => runs.push(Run { from: *route, to: index..index + 1 }),
        }
    }
    runs
}
