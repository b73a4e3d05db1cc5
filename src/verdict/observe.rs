//! What relations get to see: a lane's values with how far each may be off.

use super::expected::{Expected, Reference};
use super::tolerance::Tolerance;
use crate::lane::Actual;
use crate::property::Observed;
use crate::value::{Batch, Scalar};

/// The outputs of one invocation as numbers, each with its tolerance at the scale of the inputs.
/// The words are those of the formula's outputs, in their order.
pub fn observe(
    reference: &Reference,
    batch: &Batch,
    actual: &Actual,
    invocation: usize,
    tolerance: &Tolerance,
) -> Observed {
    observe_with(reference, &passed(reference, batch, invocation), actual, invocation, tolerance)
}

/// How much of the inputs' size passes through to each word that the formula gives: all that a
/// relation needs of the formula, and the same for every program that runs this batch.
pub fn passed(reference: &Reference, batch: &Batch, invocation: usize) -> Vec<f64> {
    let mut inputs = reference.scratch();
    reference.read_case(batch, invocation / batch.per_case, &mut inputs);
    reference.read_invocation(batch, invocation, &mut inputs);
    let mut expected = Expected::default();
    reference.eval(&inputs, &mut expected);
    reference.sensitivity(&inputs, &expected)
}

/// The same as [`observe`], with what [`passed`] gave.
pub fn observe_with(
    reference: &Reference,
    sensitivity: &[f64],
    actual: &Actual,
    invocation: usize,
    tolerance: &Tolerance,
) -> Observed {
    let vertices = actual.stored(invocation);
    let mut observed = Observed { vertices, words: Vec::new(), slack: Vec::new() };
    for vertex in 0..vertices {
        let words = actual.vertex(invocation, vertex);
        let base = vertex * reference.vertex_words;
        for output in &reference.outputs {
            let values = &words[output.actual.clone()];
            let real = |word: u32| match output.scalar {
                Scalar::F32 => f64::from(f32::from_bits(word)),
                Scalar::I32 => f64::from(word as i32),
                Scalar::U32 | Scalar::Bool => f64::from(word),
            };
            // The scale is the lane's own: a relation must not lean on the formula's value. Only the
            // sensitivity to the inputs is taken from it.
            let scale = values.iter().map(|&w| real(w).abs()).fold(0.0_f64, f64::max);
            for (k, &word) in values.iter().enumerate() {
                let passed = sensitivity.get(base + output.expected.start + k).copied().unwrap_or(f64::INFINITY);
                observed.words.push(real(word));
                observed.slack.push(tolerance.at(scale + passed));
            }
        }
    }
    observed
}
