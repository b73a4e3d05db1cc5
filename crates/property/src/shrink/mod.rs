//! Shrinking in batches: every round asks for all candidates of all failing samples at once.

use std::collections::HashSet;

use super::Sample;

mod complexity;
mod moves;

pub use complexity::{complexity, simpler_than};
pub use moves::{Move, Moves};

/// Rounds after which shrinking stops even if it could go on.
pub const MOST_ROUNDS: usize = 200;

/// What a shrunk sample may be. A function from samples to `bool` is a domain without laws between
/// words.
pub trait Domain {
    /// True when the sample is one that the generators could have made.
    fn admits(&self, sample: &Sample) -> bool;

    /// The plainest sample with the records of this one: zeros, and the identity for matrices.
    fn simplest(&self, sample: &Sample) -> Sample {
        moves::plain(sample)
    }

    /// Version `k` of the sample with one group of inputs made plainer in a way that keeps the laws
    /// of the group. `None` when there is no such version.
    fn simpler(&self, _sample: &Sample, _group: usize, _k: usize) -> Option<Sample> {
        None
    }

    /// Number of groups that [`Domain::simpler`] knows.
    fn groups(&self) -> usize {
        0
    }
}

impl<F: Fn(&Sample) -> bool> Domain for F {
    fn admits(&self, sample: &Sample) -> bool {
        self(sample)
    }
}

/// A failing sample made as simple as its failure permits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shrunk {
    /// The sample as it was found.
    pub original: Sample,
    /// The simplest failing sample that was reached.
    pub sample: Sample,
    /// Rounds in which candidates of this sample were tried.
    pub rounds: usize,
    /// Candidates of this sample that were tried.
    pub tried: usize,
    /// Times that a candidate replaced the sample.
    pub accepted: usize,
    /// True when no candidate of the last round failed: nothing simpler was found. False when the
    /// cap on rounds ended the search.
    pub minimal: bool,
}

/// Says for each sample whether it fails.
pub type Oracle<'a, E> = dyn FnMut(&[Sample]) -> Result<Vec<bool>, E> + 'a;

/// Shrinks failing samples together. `oracle` says for each sample handed to it whether it fails;
/// it is called once a round, so that one dispatch serves all. What it fails to answer counts as
/// not failing. The samples in `failing` are taken to fail and are not asked for again.
///
/// A candidate is tried only if the domain admits it, and replaces its sample only if it fails and
/// is simpler by [`simpler_than`], an order without infinite descent: the search ends. The result
/// depends on the arguments alone.
///
/// # Errors
/// The first error of the oracle.
pub fn shrink<E>(failing: Vec<Sample>, domain: &dyn Domain, oracle: &mut Oracle<'_, E>) -> Result<Vec<Shrunk>, E> {
    let mut searches: Vec<Search> = failing.into_iter().map(|sample| Search::new(sample, domain)).collect();
    for _ in 0..MOST_ROUNDS {
        let mut batch = Vec::new();
        for search in &mut searches {
            search.propose(domain, &mut batch);
        }
        if batch.is_empty() {
            break;
        }
        let answers = oracle(&batch)?;
        let mut rest = batch.into_iter().zip(answers.into_iter().chain(std::iter::repeat(false)));
        for search in &mut searches {
            search.judge(&mut rest);
        }
    }
    Ok(searches.into_iter().map(|s| s.shrunk).collect())
}

/// One failing sample on its way.
struct Search {
    shrunk: Shrunk,
    moves: Moves,
    /// The plainest sample of the domain: where the search would like to end.
    plainest: Sample,
    /// Candidates that join several moves that each worked in the last round.
    joined: Vec<Sample>,
    /// Whether single words are tried: only when whole inputs cannot be made plainer any more.
    fine: bool,
    /// Number of candidates in this round.
    proposed: usize,
}

impl Search {
    fn new(sample: Sample, domain: &dyn Domain) -> Self {
        let moves = Moves::new(&sample, domain.groups());
        let plainest = domain.simplest(&sample);
        let shrunk = Shrunk { original: sample.clone(), sample, rounds: 0, tried: 0, accepted: 0, minimal: false };
        Self { shrunk, moves, plainest, joined: Vec::new(), fine: false, proposed: 0 }
    }

    /// Adds the candidates of this round to the batch.
    fn propose(&mut self, domain: &dyn Domain, batch: &mut Vec<Sample>) {
        self.proposed = 0;
        if self.shrunk.minimal {
            return;
        }
        loop {
            let mut seen = HashSet::new();
            let current = &self.shrunk.sample;
            let mut add = |candidate: Sample| {
                if simpler_than(&candidate, current, &self.plainest)
                    && domain.admits(&candidate)
                    && seen.insert((candidate.case.clone(), candidate.invocation.clone()))
                {
                    batch.push(candidate);
                    self.proposed += 1;
                }
            };
            self.joined.drain(..).for_each(&mut add);
            self.moves.candidates(current, &self.plainest, domain, self.fine, &mut add);
            if self.proposed > 0 {
                self.shrunk.rounds += 1;
                self.shrunk.tried += self.proposed;
                return;
            }
            if self.fine {
                self.shrunk.minimal = true;
                return;
            }
            self.fine = true;
        }
    }

    /// Takes the answers to the candidates of this round.
    fn judge(&mut self, rest: &mut dyn Iterator<Item = (Sample, bool)>) {
        if self.proposed == 0 {
            return;
        }
        let failing: Vec<Sample> = rest.take(self.proposed).filter(|(_, fails)| *fails).map(|(s, _)| s).collect();
        let Some(best) = failing.iter().min_by(|a, b| complexity::compare(a, b, &self.plainest)) else {
            // Single words come next; when they were tried as well, nothing simpler exists.
            self.shrunk.minimal = self.fine;
            self.fine = true;
            return;
        };
        self.joined = join(&self.shrunk.sample, &failing, &self.plainest);
        self.shrunk.sample = best.clone();
        self.shrunk.accepted += 1;
    }
}

/// Candidates that apply several failing changes of `base` at once: all that do not touch the same
/// words, simplest first, then halves, quarters and eighths of them. Independent changes are then
/// made in one round instead of one round each.
fn join(base: &Sample, failing: &[Sample], plainest: &Sample) -> Vec<Sample> {
    let mut order: Vec<&Sample> = failing.iter().collect();
    order.sort_by(|a, b| complexity::compare(a, b, plainest));
    let flat = |s: &Sample| [&s.case[..], &s.invocation[..]].concat();
    let old = flat(base);
    let mut taken = vec![false; old.len()];
    let mut changes: Vec<Vec<(usize, u32)>> = Vec::new();
    for sample in order {
        let new = flat(sample);
        let change: Vec<(usize, u32)> = (0..old.len()).filter(|&i| old[i] != new[i]).map(|i| (i, new[i])).collect();
        if change.iter().all(|&(i, _)| !taken[i]) {
            change.iter().for_each(|&(i, _)| taken[i] = true);
            changes.push(change);
        }
    }
    let mut joined = Vec::new();
    for parts in [1, 2, 4, 8] {
        let size = changes.len().div_ceil(parts);
        if size < 2 {
            break;
        }
        for chunk in changes.chunks(size) {
            let mut sample = base.clone();
            for &(i, word) in chunk.iter().flatten() {
                match i.checked_sub(sample.case.len()) {
                    None => sample.case[i] = word,
                    Some(i) => sample.invocation[i] = word,
                }
            }
            joined.push(sample);
        }
    }
    joined
}

#[cfg(test)]
mod tests;
