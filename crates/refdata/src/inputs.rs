//! The inputs of a formula, as a batch has them.

use std::ops::Range;

use base::value::{Batch, Record, Scalar};
use chapter::exact::Words;
use chapter::exact::quick::Given;
use judge::formula::Param;
use number::twofold::{Twofold, WIDTH};

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
        let one = first % batch.per_case + WIDTH <= batch.per_case;
        let last = batch.invocation_count().saturating_sub(1);
        let mut rows = [last; WIDTH];
        rows.iter_mut().zip(first..last).for_each(|(row, number)| *row = number);
        Self { batch, routes, rows, case: one.then(|| first / batch.per_case) }
    }

    /// Of samples anywhere, by their numbers less `first`; the first of them in all places that are left.
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
                for slot in 0..WIDTH {
                    let words = &self.batch.invocations[self.rows[slot] * own + word..][..to.len()];
                    let out = &mut given.own[to.clone()];
                    out.iter_mut().zip(words).for_each(|(out, &word)| out[slot] = number(word, scalar));
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use base::value::{Field, Shape};

    /// Cases of `per_case` samples, whose words are their numbers: those of cases from 1000 on.
    fn batch(cases: usize, per_case: usize) -> Batch {
        let record = |name: &str, shape| Arc::new(Record::new(vec![Field { name: name.into(), shape }]));
        let bits = |n: usize| (n as f32).to_bits();
        Batch {
            invocation_record: record("own", Shape::VEC2),
            case_record: record("shared", Shape::VEC3),
            per_case,
            invocations: (0..cases * per_case * 2).map(bits).collect(),
            cases: (1000..1000 + cases * 3).map(bits).collect(),
        }
    }

    /// The second word of the samples, then two words of their case.
    fn list() -> Vec<Route> {
        let route = |from_case, word| Route { from_case, word, scalar: Scalar::F32 };
        vec![route(false, 1), route(true, 1), route(true, 2)]
    }

    fn columns(inputs: &Inputs<'_>) -> Vec<[f64; WIDTH]> {
        (0..3).map(|k| *Words::<Twofold<false>>::word(inputs, k).rounded()).collect()
    }

    #[test]
    fn both_phases_get_the_words_of_their_samples() {
        let (batch, routes) = (batch(3, 40), list());
        let runs = runs(&routes);
        assert_eq!(runs.iter().map(|run| run.to.clone()).collect::<Vec<_>>(), [0..1, 1..3]);
        // Sixteen samples of one case, or of two, or fewer than there are.
        for (first, case) in
            [(0, Some(0)), (16, Some(0)), (24, Some(0)), (25, None), (32, None), (40, Some(1)), (112, None)]
        {
            let inputs = Inputs::new(&batch, &routes, first);
            assert_eq!(inputs.case, case, "{first}");
            let expected = |slot: usize| {
                let row = (first + slot).min(119);
                [row * 2 + 1, 1000 + row / 40 * 3 + 1, 1000 + row / 40 * 3 + 2].map(|n| n as f64)
            };
            let accurate = columns(&inputs);
            for slot in 0..WIDTH {
                assert_eq!([accurate[0][slot], accurate[1][slot], accurate[2][slot]], expected(slot), "{first}");
            }
            let Some(case) = case else { continue };
            let mut given = Given::default();
            inputs.give(case, &runs, &mut given);
            for slot in 0..WIDTH {
                assert_eq!([given.own[0][slot], given.case[1], given.case[2]], expected(slot), "{first}");
            }
        }
    }

    #[test]
    fn samples_from_anywhere_have_their_own_words() {
        let (batch, routes) = (batch(3, 40), list());
        let accurate = columns(&Inputs::of(&batch, &routes, 16, &[3, 70, 24]));
        let slot = |k: usize| [accurate[0][k], accurate[1][k], accurate[2][k]];
        assert_eq!(
            [slot(0), slot(1), slot(2)],
            [[39.0, 1001.0, 1002.0], [173.0, 1007.0, 1008.0], [81.0, 1004.0, 1005.0]]
        );
        assert_eq!(slot(15), slot(0));
    }
}
