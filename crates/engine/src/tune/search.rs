//! The smallest set of declarations that have to be `highp`.

use std::collections::HashMap;

use super::Tuning;
use super::trial::Outcome;
use crate::adversary::Strategy;
use base::value::Batch;
use lanes::interrupt;
use property::Sample;

/// Sets that are tried to find a smaller one, beyond which the first that cannot be reduced is taken.
const TRIALS: usize = 300;

/// A set of declarations.
#[derive(Clone, Debug)]
pub struct Found {
    /// True for those in it.
    pub high: Vec<bool>,
    /// No smaller one holds.
    pub smallest: bool,
}

/// A search on samples that grow.
pub struct Search<'a> {
    tuning: &'a Tuning<'a>,
    samples: Vec<Sample>,
    known: HashMap<Vec<bool>, Outcome>,
}

impl<'a> Search<'a> {
    pub fn new(tuning: &'a Tuning<'a>, samples: Vec<Sample>) -> Self {
        Self { tuning, samples, known: HashMap::new() }
    }

    /// A sample at which a set that was found does not hold.
    pub fn add(&mut self, sample: Sample) {
        self.samples.push(sample);
        // What did not hold does not hold on more samples.
        self.known.retain(|_, outcome| !outcome.holds());
    }

    /// The samples.
    pub fn batch(&self) -> Batch {
        Sample::batch(&self.samples)
    }

    fn outcome(&mut self, high: &[bool]) -> Result<Outcome, String> {
        if let Some(known) = self.known.get(high) {
            return Ok(known.clone());
        }
        if interrupt::asked() {
            return Err("interrupted".to_owned());
        }
        let tuning = self.tuning;
        let ready = tuning.built(&tuning.declarations.stated(tuning.file, high))?;
        let outcome = tuning.outcome(&ready, &self.batch(), &Strategy::ALL);
        self.known.insert(high.to_vec(), outcome.clone());
        Ok(outcome)
    }

    fn holds(&mut self, high: &[bool]) -> Result<bool, String> {
        Ok(self.outcome(high)?.holds())
    }

    fn count(&self) -> usize {
        self.tuning.declarations.all.len()
    }

    /// What one declaration does that alone is `mediump`.
    pub fn alone(&mut self, k: usize) -> Result<Outcome, String> {
        let mut high = vec![true; self.count()];
        high[k] = false;
        self.outcome(&high)
    }

    /// The smallest set: what cannot be lowered alone is in each, and of the others as few as do.
    ///
    /// # Errors
    /// Where a text does not compile, or the process is asked to end.
    pub fn smallest(&mut self) -> Result<Found, String> {
        let mut needed = vec![false; self.count()];
        let mut errors = Vec::new();
        for (k, needed) in needed.iter_mut().enumerate() {
            let alone = self.alone(k)?;
            *needed = !alone.holds() || self.tuning.texels(k).is_some() || self.tuning.kept[k];
            errors.push(alone.worst);
        }
        if self.holds(&needed)? {
            return Ok(Found { high: needed, smallest: true });
        }
        // From what errs least alone to what errs most, then those that the data reach first and last.
        let mut free: Vec<usize> = (0..self.count()).filter(|&k| !needed[k]).collect();
        free.sort_by(|&a, &b| errors[a].total_cmp(&errors[b]));
        let forward: Vec<usize> = (0..self.count()).filter(|&k| !needed[k]).collect();
        let backward: Vec<usize> = forward.iter().rev().copied().collect();
        let mut best: Option<Vec<bool>> = None;
        for order in [&free, &forward, &backward] {
            let reduced = self.reduced(order)?;
            if best.as_ref().is_none_or(|best| size(&reduced) < size(best)) {
                best = Some(reduced);
            }
        }
        let mut best = best.unwrap_or_else(|| vec![true; self.count()]);
        let least = size(&needed);
        let mut tried = 0;
        for more in 1..size(&best) - least {
            let mut found = None;
            let finished = each_choice(&forward, more, &mut |chosen| {
                tried += 1;
                if tried > TRIALS {
                    return Ok(false);
                }
                let mut high = needed.clone();
                chosen.iter().for_each(|&k| high[k] = true);
                if self.holds(&high)? {
                    found = Some(high);
                }
                Ok(found.is_none())
            })?;
            if let Some(high) = found {
                best = high;
                return Ok(Found { high: best, smallest: true });
            }
            if !finished {
                return Ok(Found { high: best, smallest: false });
            }
        }
        Ok(Found { high: best, smallest: true })
    }

    /// All are `highp`; then each in turn is lowered where that holds.
    fn reduced(&mut self, order: &[usize]) -> Result<Vec<bool>, String> {
        let mut high = vec![true; self.count()];
        for &k in order {
            high[k] = false;
            high[k] = !self.holds(&high)?;
        }
        Ok(high)
    }
}

fn size(high: &[bool]) -> usize {
    high.iter().filter(|high| **high).count()
}

/// Calls `f` with each choice of `count` of these until it says no; true where it was called with all.
fn each_choice(
    of: &[usize],
    count: usize,
    f: &mut dyn FnMut(&[usize]) -> Result<bool, String>,
) -> Result<bool, String> {
    let mut at: Vec<usize> = (0..count).collect();
    if count > of.len() {
        return Ok(true);
    }
    loop {
        let chosen: Vec<usize> = at.iter().map(|&k| of[k]).collect();
        if !f(&chosen)? {
            return Ok(false);
        }
        let Some(last) = (0..count).rev().find(|&k| at[k] < of.len() - count + k) else { return Ok(true) };
        at[last] += 1;
        for k in last + 1..count {
            at[k] = at[k - 1] + 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_choice_comes_once() {
        let mut all = Vec::new();
        let done = each_choice(&[4, 7, 9, 11], 2, &mut |chosen| {
            all.push(chosen.to_vec());
            Ok(true)
        });
        assert_eq!((done, all.len()), (Ok(true), 6));
        all.dedup();
        assert_eq!((all.len(), all[5].clone()), (6, vec![9, 11]));
    }
}
