//! A batch with the formula's values computed once, for many programs that are judged on it.

use std::borrow::Cow;
use std::sync::OnceLock;

use rayon::prelude::*;

use super::batch::{CHUNK, Failure};
use super::expected::{Expected, Reference};
use super::judge::{FLUSHED, Senses, Verdict, component_name, judge_with};
use super::tolerance::Tolerance;
use crate::lane::Actual;
use crate::value::{Batch, Scalar};

/// A batch and what the formula says about every invocation of it.
pub struct Expectations {
    reference: Reference,
    tolerance: Tolerance,
    batch: Batch,
    expected: Vec<Expected>,
    /// Sensitivity to the inputs, computed where some verdict needs it.
    sensitivity: Vec<OnceLock<Box<[f64]>>>,
}

/// How far one program's outputs are from another's.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Movement {
    /// Invocations with an output that differs in any bit.
    pub samples: u64,
    /// Largest distance between judged outputs, in units of their tolerance; infinite for a NaN and
    /// for another number of vertices.
    pub tolerances: f64,
    /// The component that moved by that much, such as `gl_Position.x`; none when no judged
    /// component moved.
    pub component: Option<String>,
}

impl Movement {
    /// Adds what was seen on other invocations.
    pub fn merge(&mut self, later: Self) {
        self.samples += later.samples;
        if later.component.is_some() && (self.component.is_none() || later.tolerances > self.tolerances) {
            self.tolerances = later.tolerances;
            self.component = later.component;
        }
    }
}

impl Expectations {
    /// Evaluates the formula on a batch.
    pub fn new(reference: &Reference, batch: Batch, tolerance: Tolerance) -> Self {
        let count = batch.invocation_count();
        let expected = (0..count)
            .into_par_iter()
            .with_min_len(CHUNK.min(64))
            .map(|invocation| {
                let mut expected = Expected::default();
                reference.eval(&inputs(reference, &batch, invocation), &mut expected);
                expected
            })
            .collect();
        let sensitivity = std::iter::repeat_with(OnceLock::new).take(count).collect();
        Self { reference: reference.clone(), tolerance, batch, expected, sensitivity }
    }

    /// The batch.
    pub fn batch(&self) -> &Batch {
        &self.batch
    }

    /// The first invocation that deviates. Judging stops there.
    ///
    /// # Panics
    /// When `actual` is not of this batch: a defect of the caller.
    pub fn first_deviation(&self, actual: &Actual) -> Option<Failure> {
        let count = self.batch.invocation_count();
        assert_eq!(actual.count(), count, "outputs of another batch");
        (0..count).into_par_iter().with_min_len(64).find_map_first(|invocation| match self.judge(actual, invocation) {
            Verdict::Deviate(deviation) => Some(Failure { invocation, deviation }),
            Verdict::Agree { .. } | Verdict::Undetermined(_) => None,
        })
    }

    /// Invocations that agree or deviate, not those that decide nothing.
    ///
    /// # Panics
    /// When `actual` is not of this batch: a defect of the caller.
    pub fn judged(&self, actual: &Actual) -> u64 {
        let count = self.batch.invocation_count();
        assert_eq!(actual.count(), count, "outputs of another batch");
        let decides = |&i: &usize| !matches!(self.judge(actual, i), Verdict::Undetermined(_));
        (0..count).into_par_iter().with_min_len(64).filter(decides).count() as u64
    }

    /// Judges one invocation.
    fn judge(&self, actual: &Actual, invocation: usize) -> Verdict {
        let senses = |_: &mut dyn FnMut(&[f64]) -> bool| Senses {
            sensitivity: Cow::Borrowed(self.sensitivity(invocation)),
            vectors: self.reference.vector_size(&inputs(&self.reference, &self.batch, invocation)),
        };
        judge_with(&self.reference, &senses, &self.expected[invocation], actual, invocation, &self.tolerance)
    }

    fn sensitivity(&self, invocation: usize) -> &[f64] {
        self.sensitivity[invocation].get_or_init(|| {
            let inputs = inputs(&self.reference, &self.batch, invocation);
            self.reference.sensitivity(&inputs, &self.expected[invocation]).into()
        })
    }

    /// How far `after` is from `before`. Only components on which the judge decides count towards
    /// the distance; bits are compared everywhere.
    ///
    /// # Panics
    /// When one of them is not of this batch: a defect of the caller.
    pub fn movement(&self, before: &Actual, after: &Actual) -> Movement {
        let count = self.batch.invocation_count();
        assert_eq!((before.count(), after.count()), (count, count), "outputs of another batch");
        let chunks: Vec<Movement> = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut movement = Movement::default();
                for invocation in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
                    self.moved(before, after, invocation, &mut movement);
                }
                movement
            })
            .collect();
        let mut all = Movement::default();
        chunks.into_iter().for_each(|chunk| all.merge(chunk));
        all
    }

    fn moved(&self, before: &Actual, after: &Actual, invocation: usize, movement: &mut Movement) {
        let vertices = before.stored(invocation);
        let shape = |a: &Actual| {
            let strips: Vec<u32> = (0..a.stored(invocation)).map(|v| a.strip(invocation, v)).collect();
            (a.emitted(invocation), strips)
        };
        let mut differs = false;
        if before.layout().max_vertices.is_some() && shape(before) != shape(after) {
            differs = true;
            if before.emitted(invocation) != after.emitted(invocation) {
                movement.tolerances = f64::INFINITY;
                movement.component = Some("the number of vertices".to_owned());
            }
        }
        for vertex in 0..vertices.min(after.stored(invocation)) {
            let (old, new) = (before.vertex(invocation, vertex), after.vertex(invocation, vertex));
            // The word that stands for "not written" is another one for each program.
            let same = |(&old, &new): (&u32, &u32)| old == new || (before.is_unwritten(old) && after.is_unwritten(new));
            if old.iter().zip(new).all(same) {
                continue;
            }
            differs = true;
            for output in self.reference.outputs.iter().filter(|o| o.scalar == Scalar::F32) {
                let base = vertex * self.reference.vertex_words + output.expected.start;
                let Some(values) = self.expected[invocation].words.get(base..base + output.expected.len()) else {
                    continue;
                };
                let scale = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                for (k, value) in values.iter().enumerate() {
                    let at = output.actual.start + k;
                    let real = |word: u32| f64::from(f32::from_bits(word));
                    let distance = (real(old[at]) - real(new[at])).abs();
                    // At the output's own scale the tolerance is smallest, and cheap to have.
                    let no_more = distance <= movement.tolerances * self.tolerance.at(scale);
                    if old[at] == new[at] || no_more || value.is_nan() || scale < FLUSHED {
                        continue;
                    }
                    let full = scale + self.sensitivity(invocation).get(base + k).copied().unwrap_or(f64::INFINITY);
                    let tolerances = distance / self.tolerance.at(full);
                    let tolerances = if tolerances.is_nan() { f64::INFINITY } else { tolerances };
                    // The judge leaves these open.
                    let open = !full.is_finite() || (tolerances > 1.0 && self.tolerance.is_useless(full, scale));
                    if !open && tolerances > movement.tolerances {
                        movement.tolerances = tolerances;
                        movement.component = Some(component_name(after, output, k));
                    }
                }
            }
        }
        movement.samples += u64::from(differs);
    }
}

fn inputs(reference: &Reference, batch: &Batch, invocation: usize) -> Vec<f64> {
    let mut inputs = reference.scratch();
    reference.read_case(batch, invocation / batch.per_case, &mut inputs);
    reference.read_invocation(batch, invocation, &mut inputs);
    inputs
}

#[cfg(test)]
mod tests {
    use super::Movement;

    #[test]
    fn the_larger_movement_wins_and_samples_add_up() {
        let moved = |samples, tolerances, component: Option<&str>| Movement {
            samples,
            tolerances,
            component: component.map(str::to_owned),
        };
        let mut all = moved(1, 0.5, Some("a"));
        all.merge(moved(2, 0.0, None));
        all.merge(moved(3, 0.25, Some("b")));
        assert_eq!(all, moved(6, 0.5, Some("a")));
        all.merge(moved(1, f64::INFINITY, Some("c")));
        assert_eq!(all, moved(7, f64::INFINITY, Some("c")));
    }
}
