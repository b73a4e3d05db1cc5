//! `index`: whole numbers in a range.

use base::value::{Scalar, Shape};

use super::{Generator, Group, Options, Place, RangeRule, Role, SPECIAL, Stream, View, every_shape};
use crate::sample::{decode, encode};

/// Whole numbers in a range, both ends included, for int, uint and bool inputs. Special: the ends.
pub struct Index;

/// The ends of the range as whole numbers.
fn ends(group: &Group) -> (i64, i64) {
    let [lo, hi] = group.options().range.unwrap_or_default();
    (lo as i64, hi as i64)
}

impl Generator for Index {
    fn name(&self) -> &str {
        "index"
    }

    fn about(&self) -> &str {
        "whole numbers in `range`, both ends included"
    }

    fn range(&self) -> RangeRule {
        RangeRule::Required
    }

    fn check(&self, shapes: &[Shape], options: &Options) -> Result<(), String> {
        every_shape(self.name(), shapes, "int, uint, bool and vectors and arrays of them", |s| {
            s.scalar != Scalar::F32
        })?;
        let [lo, hi] = options.range.unwrap_or_default();
        if lo.fract() != 0.0 || hi.fract() != 0.0 {
            return Err(format!("generator `index` needs whole numbers as range, not [{lo}, {hi}]"));
        }
        for shape in shapes {
            let (least, most) = match shape.scalar {
                Scalar::I32 => (f64::from(i32::MIN), f64::from(i32::MAX)),
                Scalar::U32 => (0.0, f64::from(u32::MAX)),
                Scalar::Bool | Scalar::F32 => (0.0, 1.0),
            };
            if lo < least || hi > most {
                return Err(format!("range [{lo}, {hi}] does not fit {shape}, which holds {least} to {most}"));
            }
        }
        Ok(())
    }

    fn fill(&self, group: &Group, _place: Place, stream: &mut Stream, out: &mut [u32]) {
        let (lo, hi) = ends(group);
        let special = stream.one_in(SPECIAL);
        for (word, &scalar) in out.iter_mut().zip(group.scalars()) {
            let value = match (special, stream.bits() & 1) {
                (true, 0) => lo,
                (true, _) => hi,
                (false, _) => lo + (((stream.bits() >> 32) * ((hi - lo) as u64 + 1)) >> 32) as i64,
            };
            *word = encode(value as f64, scalar);
        }
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        let [lo, hi] = group.options().range.unwrap_or_default();
        words
            .iter()
            .zip(group.scalars())
            .all(|(&w, &scalar)| (lo..=hi).contains(&decode(w, scalar)) && (scalar != Scalar::Bool || w <= 1))
    }

    fn role(&self) -> Role {
        Role::Follows
    }

    fn arrange(&self, group: &Group, view: &View, out: &mut [u32]) {
        let (lo, hi) = ends(group);
        let along = (view.at[0] * (hi - lo + 1) as f64).floor() as i64;
        for (word, &scalar) in out.iter_mut().zip(group.scalars()) {
            *word = encode((lo + along).min(hi) as f64, scalar);
        }
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        let (lo, hi) = ends(group);
        for (word, &scalar) in out.iter_mut().zip(group.scalars()) {
            *word = encode(0i64.clamp(lo, hi) as f64, scalar);
        }
    }
}
