//! Two samples on different sides of a question, brought as near to each other as the domain permits.

use super::question::UNASKED;
use super::watch::Key;
use super::{EdgeSearch, PAIRS, SLOTS, rank, ranked, scalar, word, word_mut};
use base::value::Scalar;
use property::Sample;

/// Cuts that are tried where the domain does not admit the one in the middle.
const CUTS: usize = 24;
/// Samples of one pair that are tried at a time.
const WAYS: usize = 15;
/// How far from an edge a sample lies beside it as well, relative to numbers of size 1.
const BESIDE: [f32; 2] = [3e-6, 5e-5];

/// A pair under way. Up to a cut, the words that differ are those of the second sample.
struct EdgePair {
    key: Key,
    samples: [Sample; 2],
    /// The side of the first sample.
    side: i8,
    /// Words in which the two differ.
    differ: Vec<usize>,
    /// Cuts on the side of the first sample, and on another one.
    cuts: [usize; 2],
    /// The word that makes the difference, with the places of its values on both sides.
    last: Option<(usize, [i64; 2])>,
    /// What was tried in this round, and on which side it is.
    sides: Vec<(i64, i8)>,
    done: bool,
}

impl EdgePair {
    fn new(key: Key, side: i8, samples: [Sample; 2]) -> Self {
        let count = super::words(&samples[0]);
        let differ: Vec<usize> = (0..count).filter(|&at| word(&samples[0], at) != word(&samples[1], at)).collect();
        let cuts = [0, differ.len()];
        Self { key, samples, side, differ, cuts, last: None, sides: Vec::new(), done: false }
    }

    fn cut(&self, at: usize) -> Sample {
        let mut sample = self.samples[0].clone();
        for &at in &self.differ[..at] {
            *word_mut(&mut sample, at) = word(&self.samples[1], at);
        }
        sample
    }

    fn with(&self, at: usize, rank: i64) -> Sample {
        let mut sample = self.cut(self.cuts[0]);
        *word_mut(&mut sample, at) = ranked(rank, scalar(&self.samples[0], at));
        sample
    }

    /// The next samples to be tried, with where they lie, in order: at most `ways`, which divide what is between the two
    /// sides evenly. None when the pair is as near as it gets.
    fn next(&mut self, ways: i64, admits: &dyn Fn(&Sample) -> bool) -> Vec<(i64, Sample)> {
        if self.last.is_none() && self.cuts[1] - self.cuts[0] <= 1 {
            let Some(&at) = self.differ.get(self.cuts[0]) else { return Vec::new() };
            let kind = scalar(&self.samples[0], at);
            self.last = Some((at, [0, 1].map(|k| rank(word(&self.samples[k], at), kind))));
        }
        let between = |near: i64, far: i64| {
            let mut all: Vec<i64> = (1..=ways).map(|k| near + (far - near) * k / (ways + 1)).collect();
            all.dedup();
            all.retain(|&at| at != near && at != far);
            all
        };
        let admitted = |(at, sample): (i64, Sample)| admits(&sample).then_some((at, sample));
        if let Some((word, [near, far])) = self.last {
            // One step of a word has no middle, and neighbours of more than one way may round to the nearer end.
            let mut all = between(near, far);
            if all.is_empty() && (far - near).abs() > 1 {
                all.push(near + (far - near) / 2);
            }
            return all.into_iter().filter_map(|at| admitted((at, self.with(word, at)))).collect();
        }
        let [low, high] = self.cuts.map(|cut| cut as i64);
        let tried = between(low, high).into_iter().filter_map(|at| admitted((at, self.cut(at as usize))));
        let tried: Vec<_> = tried.collect();
        if !tried.is_empty() {
            return tried;
        }
        // Words that belong together are taken together.
        let middle = low + (high - low) / 2;
        let around = (0..high - low).map(|k| if k % 2 == 0 { middle + k / 2 } else { middle - (k + 1) / 2 });
        let inside = around.filter(|at| (low + 1..high).contains(at)).take(CUTS);
        inside.map(|at| (at, self.cut(at as usize))).find_map(admitted).into_iter().collect()
    }

    /// Takes the sides of what was tried.
    fn answer(&mut self, tried: &[(i64, i8)]) {
        let other = tried.iter().position(|&(_, side)| side != self.side);
        let near = other.unwrap_or(tried.len()).checked_sub(1).map(|k| tried[k].0);
        let far = other.map(|k| tried[k].0);
        for (k, at) in [near, far].into_iter().enumerate().filter_map(|(k, at)| Some((k, at?))) {
            match &mut self.last {
                Some((_, ends)) => ends[k] = at,
                None => self.cuts[k] = at as usize,
            }
        }
    }

    /// The nearest samples on both sides, and some beside them.
    fn found(&self, admits: &dyn Fn(&Sample) -> bool, found: &mut Vec<Sample>) {
        let Some((at, [near, far])) = self.last else {
            found.extend(self.cuts.map(|cut| self.cut(cut)));
            return;
        };
        let kind = scalar(&self.samples[0], at);
        let step = (far - near).signum();
        let mut ranks = vec![near, far, far + step, near - step];
        if kind == Scalar::F32 {
            let value = f32::from_bits(ranked(far, kind));
            for beside in BESIDE.map(|part| part * value.abs().max(1.0)) {
                ranks.extend([value + beside, value - beside].map(|x| rank(x.to_bits(), kind)));
            }
        }
        found.extend(ranks.into_iter().map(|rank| self.with(at, rank)).filter(|sample| {
            let finite = kind != Scalar::F32 || f32::from_bits(word(sample, at)).is_finite();
            finite && admits(sample)
        }));
    }
}

impl EdgeSearch<'_> {
    /// Brings pairs of samples on different sides near to each other. Gives the samples at the edges between.
    pub(super) fn bisect(&mut self) -> Vec<Sample> {
        let domain = self.domain;
        let admits = |sample: &Sample| domain.admits(sample);
        let mut pairs = self.pairs();
        loop {
            pairs.iter_mut().for_each(|pair| pair.sides.clear());
            let active = pairs.iter().filter(|pair| !pair.done).count();
            let ways = (SLOTS / active.max(1)).clamp(1, WAYS) as i64;
            let (mut tried, mut of) = (Vec::new(), Vec::new());
            for (k, pair) in pairs.iter_mut().enumerate().filter(|(_, pair)| !pair.done) {
                let next = pair.next(ways, &admits);
                pair.done = next.is_empty();
                for (at, sample) in next {
                    tried.push(sample);
                    of.push((k, at));
                }
            }
            if tried.is_empty() {
                break;
            }
            let Some(watch) = self.try_all(&tried) else { break };
            for (slot, (k, at)) in of.into_iter().enumerate() {
                let side = watch.answer(pairs[k].key).map_or(UNASKED, |answers| answers.sides[slot]);
                pairs[k].sides.push((at, side));
            }
            for pair in pairs.iter_mut().filter(|pair| !pair.done) {
                let sides = std::mem::take(&mut pair.sides);
                pair.answer(&sides);
            }
        }
        let mut found = Vec::new();
        pairs.iter().for_each(|pair| pair.found(&admits, &mut found));
        found
    }

    /// Pairs that were not taken before: one of every question first, then more of each.
    fn pairs(&mut self) -> Vec<EdgePair> {
        let mut candidates = Vec::new();
        for (&key, sides) in &self.known {
            let on: Vec<(i8, &Vec<usize>)> = sides.on.iter().map(|(&side, kept)| (side, kept)).collect();
            // Between less and greater lies equal.
            let (less, greater) = (sides.on.get(&-1), sides.on.get(&1));
            let across: Vec<_> = match (less, greater, key.question) {
                (_, _, super::Question::Whole(_)) | (None, _, _) | (_, None, _) => {
                    on.windows(2).map(|two| (two[0], two[1])).collect()
                }
                (Some(less), Some(greater), _) => vec![((-1, less), (1, greater))],
            };
            for ((side, from), (_, to)) in across {
                for (k, (&a, &b)) in from.iter().zip(to).enumerate() {
                    if !sides.halved.contains(&(a, b)) {
                        candidates.push((k + key.round.min(2), key, side, a, b));
                    }
                }
            }
        }
        candidates.sort_by_key(|&(turn, key, ..)| (turn, key));
        candidates.truncate(PAIRS.min(SLOTS));
        let taken = candidates.into_iter().map(|(_, key, side, a, b)| {
            self.known.entry(key).or_default().halved.insert((a, b));
            EdgePair::new(key, side, [self.pool[a].clone(), self.pool[b].clone()])
        });
        taken.collect()
    }
}
