//! `raw_weights`: weights whose sum is not one.

use base::value::{Scalar, Shape};

use super::{Generator, Group, Options, Place, RangeRule, SPECIAL, Stream, every_shape, float};

/// Weights in a range above zero, not all zero, with any sum. Special: a single weight, equal
/// weights, edge values.
pub struct RawWeights;

impl RawWeights {
    /// Makes one weight the largest of the range when all are zero.
    fn not_all_zero(group: &Group, at: usize, out: &mut [u32]) {
        if out.iter().all(|&w| float(w) == 0.0) {
            out[at] = group.range().hi().to_bits();
        }
    }
}

impl Generator for RawWeights {
    fn name(&self) -> &str {
        "raw_weights"
    }

    fn about(&self) -> &str {
        "weights in `range` that are not negative, not all zero, and have any sum"
    }

    fn range(&self) -> RangeRule {
        RangeRule::Default(0.0, 1.0)
    }

    fn check(&self, shapes: &[Shape], options: &Options) -> Result<(), String> {
        if let Some([lo, hi]) = options.range
            && (lo < 0.0 || hi as f32 <= 0.0)
        {
            return Err(format!("generator `raw_weights` needs 0 <= lo and 0 < hi, not [{lo}, {hi}]"));
        }
        every_shape(self.name(), shapes, "floats, vectors and arrays of them", |s| {
            s.scalar == Scalar::F32 && s.columns == 1
        })
    }

    fn fill(&self, group: &Group, _place: Place, stream: &mut Stream, out: &mut [u32]) {
        let range = group.range();
        let at = stream.below(out.len());
        if stream.one_in(SPECIAL) {
            let (kind, value) = (stream.below(3), range.ordinary(stream.bits()));
            for word in out.iter_mut() {
                *word = match kind {
                    0 => range.clamp(0.0),
                    1 => value,
                    _ => range.special(stream.bits()),
                }
                .to_bits();
            }
        } else {
            for word in out.iter_mut() {
                *word = range.ordinary(stream.bits()).to_bits();
            }
        }
        Self::not_all_zero(group, at, out);
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        words.iter().all(|&w| group.range().contains(float(w))) && words.iter().any(|&w| float(w) > 0.0)
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        out.fill(group.range().clamp(0.0).to_bits());
        out[0] = group.range().clamp(1.0).to_bits();
    }

    fn simpler(&self, group: &Group, words: &[u32], k: usize, out: &mut [u32]) -> bool {
        // A single weight.
        if k >= words.len() {
            return false;
        }
        out.fill(group.range().clamp(0.0).to_bits());
        out[k] = group.range().clamp(1.0).to_bits();
        true
    }
}
