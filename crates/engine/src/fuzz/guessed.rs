//! Values that were taken where nobody stated any: what is wrong at these, and right at others, rests on a guess.

use super::domain::Domain;
use super::finding::FuzzFindingKind;
use super::name::{Key, name};
use super::realistic::FAR;
use super::scan::{Look, scan};
use super::subject::Ready;
use base::value::Scalar;
use property::Sample;

/// Other whole numbers that a host may give: widths, lengths, counts.
const OTHERS: [u32; 5] = [1, 2, 3, 16, 64];

/// Samples with other values in the places of those that no name explains.
const REDRAWN: u64 = FAR + 1;

/// True where trouble with this name goes away with other values of inputs of which nobody stated the values: with other
/// whole numbers in uniforms, and for what operations on real numbers bring about with other values of all inputs that may
/// be anything.
pub(super) fn are_needed(
    ready: &Ready,
    domain: &Domain,
    (sizes, in_parts): (&[f64], bool),
    sample: &Sample,
    key: &Key,
) -> bool {
    let mut others = whole_numbers(domain, sample);
    if in_parts && is_of_values(key.0) {
        others.extend((0..REDRAWN).filter_map(|k| ready.realistic.redrawn(domain, sample, k)));
    }
    if others.is_empty() {
        return false;
    }
    let batch = Sample::batch(&others);
    let looks = scan(&ready.executable, &ready.kernel.output.vertex, &batch);
    let trouble: Vec<(usize, Look)> =
        looks.into_iter().enumerate().filter(|(_, look)| look.trouble.is_some()).collect();
    let found = name(ready, sizes, &batch, &trouble);
    found.iter().flatten().filter(|named| named.key() == *key).count() < others.len()
}

/// True for what depends on the values that come to an operation, and not on the text alone.
fn is_of_values(kind: FuzzFindingKind) -> bool {
    use FuzzFindingKind::{Infinite, Lost, NoValue, Overflow, Underflow};
    matches!(kind, NoValue | Infinite | Overflow | Underflow | Lost)
}

/// The sample with other whole numbers in uniforms.
fn whole_numbers(domain: &Domain, sample: &Sample) -> Vec<Sample> {
    let record = &sample.case_record;
    let whole = |k: &usize| matches!(record.fields()[*k].shape.scalar, Scalar::I32 | Scalar::U32);
    let open = |k: &usize| domain.case.get(*k).is_some_and(|input| !input.is_stated());
    let chosen: Vec<usize> = (0..record.fields().len()).filter(whole).filter(open).collect();
    let with = |number: &u32| {
        let mut other = sample.clone();
        chosen.iter().for_each(|&k| other.case[record.range(k)].fill(*number));
        other
    };
    if chosen.is_empty() { Vec::new() } else { OTHERS.iter().map(with).collect() }
}
