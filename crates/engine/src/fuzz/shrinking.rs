//! Samples as small as they can be while the same operation brings about the same trouble.

use std::convert::Infallible;

use super::domain::{Domain, Shrinking, Within};
use super::name::{Key, Named, name};
use super::scan::{Look, scan};
use super::subject::Ready;
use crate::activity::shrink;
use lanes::interrupt;
use property::Sample;

/// Looks at samples and names their trouble.
pub fn names(ready: &Ready, sizes: &[f64], samples: &[Sample]) -> Vec<Option<Named>> {
    let batch = Sample::batch(samples);
    let looks = scan(&ready.executable, &ready.kernel.output.vertex, &batch);
    let open: Vec<(usize, Look)> = looks.into_iter().enumerate().filter(|(_, l)| l.trouble.is_some()).collect();
    let mut all = vec![None; samples.len()];
    for ((invocation, _), named) in open.iter().zip(name(ready, sizes, &batch, &open)) {
        all[*invocation] = named;
    }
    all
}

/// The smallest sample with this trouble, and what is known about it.
pub fn smallest(
    (ready, sizes): (&Ready, &[f64]),
    domain: &Domain,
    (sample, named): (Sample, Option<Named>),
    key: Key,
    within: Within<'_>,
) -> (Sample, Option<Named>) {
    let admits = Shrinking { domain, within };
    let same = |named: &Option<Named>| named.as_ref().is_some_and(|n| n.key() == key);
    let mut oracle = |samples: &[Sample]| -> Result<Vec<bool>, Infallible> {
        // Nothing is tried any more when the run is to end.
        Ok(if interrupt::asked() { Vec::new() } else { names(ready, sizes, samples).iter().map(same).collect() })
    };
    let found = match shrink(vec![sample.clone()], &admits, &mut oracle) {
        Ok(shrunk) => shrunk.into_iter().next().map_or_else(|| sample.clone(), |s| s.sample),
        Err(never) => match never {},
    };
    if found == sample || interrupt::asked() {
        return (sample, named);
    }
    let named = names(ready, sizes, std::slice::from_ref(&found)).pop().flatten();
    (found, named)
}
