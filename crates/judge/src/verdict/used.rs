//! How much of what a promise allows a lane makes use of.

use std::ops::Range;

use super::oracle::JudgeContext;
use crate::tape::Model;
use base::value::Batch;
use program::interp::{OutputColumn, SLOTS};
use program::lane::Actual;

/// An error beside its bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Used {
    /// The error over the bound.
    pub part: f64,
    /// Name of the component.
    pub component: String,
}

/// The largest error over its bound among some invocations, by the text of the specification; `None`
/// where no component has a bound. `rearranged` lets sums and products be regrouped.
///
/// Outputs whose bound is infinite or zero are left out, and so are invocations in which a comparison
/// could go either way.
///
/// # Panics
/// When `actual` is not of this batch: a defect of the caller.
pub fn used(
    context: &JudgeContext<'_>,
    rearranged: bool,
    batch: &Batch,
    actual: &Actual,
    range: Range<usize>,
) -> Option<Used> {
    assert_eq!(actual.count(), batch.invocation_count(), "outputs of another batch");
    let model = Model::Device { profile: context.promises.text, stage: context.stage, rearranged };
    let mut machine = context.oracle.tape(model);
    let record = &actual.layout().vertex;
    let mut most: Option<(f64, usize)> = None;
    for first in range.clone().step_by(SLOTS) {
        let slots = machine.run(batch, first).min(range.end - first);
        for vertex in 0..machine.room() {
            for word in 0..machine.width() {
                let OutputColumn::Real(&column) = machine.output(vertex, word) else { continue };
                let tape = machine.domain();
                let bounds = tape.bounds(column, &mut |_| false);
                let values = tape.values(column);
                for slot in (0..slots).filter(|&slot| vertex < actual.stored(first + slot)) {
                    let bound = bounds.bound[slot];
                    if tape.fork(slot).is_some() || !values[slot].is_finite() || !bound.is_finite() || bound == 0.0 {
                        continue;
                    }
                    let found = f32::from_bits(actual.vertex(first + slot, vertex)[word]);
                    let error = (f64::from(found) - values[slot]).abs();
                    let part = if error.is_nan() { f64::INFINITY } else { error / bound };
                    if most.is_none_or(|(most, _)| part > most) {
                        most = Some((part, word));
                    }
                }
            }
        }
    }
    most.map(|(part, word)| Used { part, component: record.word_name(word) })
}
