//! The order by which one sample is simpler than another.

use std::cmp::Ordering;

use crate::Sample;
use base::value::{Record, Scalar};

/// How hard a sample is to read: the sum over its words. A word that is that of `plainest` is free.
/// Then come 0, 1 and -1, powers of two by their distance from 1, and numbers with ever more
/// significant bits; infinity and NaN last. Whole numbers count by size.
///
/// `plainest` is [`super::Domain::simplest`] of the samples to be compared: next to the identity a
/// matrix of zeros is not simple.
pub fn complexity(sample: &Sample, plainest: &Sample) -> u64 {
    words(&sample.case_record, &sample.case, &plainest.case)
        + words(&sample.invocation_record, &sample.invocation, &plainest.invocation)
}

/// True when `a` comes strictly before `b`. The order is total on samples with the same records, and
/// each sample has finitely many before it: a search that only goes down ends.
pub fn simpler_than(a: &Sample, b: &Sample, plainest: &Sample) -> bool {
    compare(a, b, plainest) == Ordering::Less
}

/// The order behind [`simpler_than`]: by complexity, then by the words.
pub fn compare(a: &Sample, b: &Sample, plainest: &Sample) -> Ordering {
    let key = |s: &Sample| complexity(s, plainest);
    key(a).cmp(&key(b)).then_with(|| a.case.cmp(&b.case)).then_with(|| a.invocation.cmp(&b.invocation))
}

fn words(record: &Record, words: &[u32], plainest: &[u32]) -> u64 {
    let mut sum = 0;
    for (i, field) in record.fields().iter().enumerate() {
        let range = record.range(i);
        let pairs = words[range.clone()].iter().zip(&plainest[range]);
        sum += pairs.filter(|(a, b)| a != b).map(|(&w, _)| 1 + word(w, field.shape.scalar)).sum::<u64>();
    }
    sum
}

/// Complexity of one word.
fn word(word: u32, scalar: Scalar) -> u64 {
    match scalar {
        Scalar::F32 => float(word),
        Scalar::I32 => u64::from((word as i32).unsigned_abs()) * 2 + u64::from(word >> 31),
        Scalar::U32 => u64::from(word) * 2,
        Scalar::Bool => u64::from(word),
    }
}

/// One significant bit outweighs every distance of exponents.
const BIT: u64 = 1 << 10;

fn float(word: u32) -> u64 {
    let (negative, size) = (u64::from(word >> 31), word & 0x7fff_ffff);
    let (exponent, fraction) = (size >> 23, size & 0x007f_ffff);
    match (exponent, fraction) {
        (0, 0) => negative,
        (0xff, 0) => 40 * BIT + negative,
        // Payloads: the quiet NaN without one is the simplest.
        (0xff, _) => 50 * BIT + u64::from(fraction.count_ones()) * 2 + negative,
        _ => {
            // Significant bits behind the first; a subnormal's first bit is not the hidden one.
            let (leading, exponent) = match exponent {
                0 => (fraction, fraction.ilog2() as i32 - 149),
                _ => (fraction | 1 << 23, exponent as i32 - 127),
            };
            let bits = leading.ilog2() - leading.trailing_zeros();
            u64::from(bits) * BIT + u64::from(exponent.unsigned_abs()) * 2 + 2 + negative
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_are_ordered_as_people_read_them() {
        let order = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            2.0,
            4.0,
            -0.25,
            1024.0,
            f32::from_bits(1),
            1.5,
            3.0,
            0.625,
            7.0,
            0.1,
            f32::MAX,
            f32::INFINITY,
            f32::NAN,
        ];
        for pair in order.windows(2) {
            assert!(float(pair[0].to_bits()) < float(pair[1].to_bits()), "{} < {}", pair[0], pair[1]);
        }
    }

    #[test]
    fn whole_numbers_are_ordered_by_size() {
        let order = [0, 1, -1, 2, -2, 3, i32::MAX, i32::MIN];
        for pair in order.windows(2) {
            assert!(word(pair[0] as u32, Scalar::I32) < word(pair[1] as u32, Scalar::I32), "{pair:?}");
        }
    }
}
