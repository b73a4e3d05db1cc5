//! Whole numbers of a host that nobody stated: what is wrong at those that were taken, and right at others, rests on a guess.

use super::domain::Domain;
use super::name::{Key, name};
use super::scan::{Look, scan};
use super::subject::Ready;
use base::value::Scalar;
use property::Sample;

/// Other numbers that a host may give: widths, lengths, counts.
const OTHERS: [u32; 5] = [1, 2, 3, 16, 64];

/// True where trouble with this name goes away with other whole numbers in uniforms of which nobody stated the values.
pub(super) fn are_needed(ready: &Ready, domain: &Domain, sizes: &[f64], sample: &Sample, key: &Key) -> bool {
    let record = &sample.case_record;
    let whole = |k: &usize| matches!(record.fields()[*k].shape.scalar, Scalar::I32 | Scalar::U32);
    let open = |k: &usize| domain.case.get(*k).is_some_and(|input| !input.is_stated());
    let chosen: Vec<usize> = (0..record.fields().len()).filter(whole).filter(open).collect();
    if chosen.is_empty() {
        return false;
    }
    let others = OTHERS.map(|number| {
        let mut other = sample.clone();
        chosen.iter().for_each(|&k| other.case[record.range(k)].fill(number));
        other
    });
    let batch = Sample::batch(&others);
    let looks = scan(&ready.executable, &ready.kernel.output.vertex, &batch);
    let trouble: Vec<(usize, Look)> =
        looks.into_iter().enumerate().filter(|(_, look)| look.trouble.is_some()).collect();
    let found = name(ready, sizes, &batch, &trouble);
    found.iter().flatten().filter(|named| named.key() == *key).count() < OTHERS.len()
}
