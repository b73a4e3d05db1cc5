//! Looks for the arguments at which a function of one argument errs most.
//!
//! The largest error of samples is a lower bound of the largest of all. The search raises it. It computes some results in
//! every binade, then more in those with the largest errors, then all results of the worst binades; in between, it follows the
//! worst arguments to others that have something in common with them: the next floats, the same significand in other
//! binades, the same reduced argument. It knows neither the time nor what was sampled before, so that it ends alike
//! wherever it runs.

use std::collections::BTreeSet;

use judge::profile::{BINS, Op};
use judge::single::{Inputs, kernel};
use lanes::{Lane, LaneError};

use super::device::MeasuredDevice;
use super::write::{MARGIN, ROUNDED};
use super::{CalibrateError, Judge, Tally, Worst};

/// Words whose results one invocation computes.
const GROUP: u32 = kernel::SWEEP as u32;
/// Groups of a binade.
const GROUPS: u32 = (1 << 23) / GROUP;
/// An odd number near [`GROUPS`]/φ: its multiples visit all groups of a binade, evenly from the start.
const STRIDE: u32 = 324_031;
/// The part of the budget for the first look at all binades, and as much for the second at the worst of them.
const LOOK: u64 = 8;
/// The part of the budget that is left to follow what the last binade showed.
const LAST: u64 = 32;
/// Binades of each figure that get the second look.
const WORST_BINADES: usize = 16;
/// Binades of each figure whose worst argument is followed.
const FOLLOWED: usize = 4;
/// Binades that are computed whole for a figure without raising it before it counts as found.
const PATIENCE: u32 = 4;
/// Groups on both sides of an argument that is followed.
const NEAR: i64 = 128;
/// Periods on both sides of an argument that is followed.
const PERIODS: i32 = 64;
/// Times that arguments are followed at most.
const ROUNDS: usize = 32;

/// The largest errors of some results.
#[derive(Clone, Copy, Default, PartialEq)]
struct Figures([Worst; 5]);

impl Figures {
    fn of(tally: &Tally) -> Self {
        let all = [tally.worst_ulp(), tally.worst_abs()];
        Self([tally.ratio, tally.promised_ulp, tally.promised_abs, all[0], all[1]])
    }

    fn merge(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(one, other)| one.merge(other));
    }

    /// True where the results round to nearest as far as they are known, so that there is nothing to look for.
    fn round(&self) -> bool {
        self.size(0) <= 1.0 && self.size(3) <= ROUNDED
    }

    /// A figure as a number that can be compared.
    fn size(&self, figure: usize) -> f64 {
        let value = self.0[figure].value();
        if value.is_nan() { f64::INFINITY } else { value }
    }
}

/// The tally of a search with a budget of so many results. `progress` gets how many were computed so far.
///
/// # Errors
/// [`CalibrateError`] when the lane fails, and what `progress` gives.
pub(super) fn worst(
    lane: &dyn Lane,
    op: Op,
    judge: &Judge<'_>,
    budget: u64,
    progress: &mut dyn FnMut(u64) -> Result<(), CalibrateError>,
) -> Result<Tally, CalibrateError> {
    let device = match MeasuredDevice::new(lane, op, true) {
        // Not every driver runs the kernel of a sweep; then the samples are what there is.
        Err(CalibrateError::Lane(LaneError::Unsupported(_))) => return Ok(Tally::default()),
        device => device?,
    };
    let bins = vec![SearchedBin::default(); BINS];
    let mut search =
        Search { device, op, judge, budget, progress, tally: Tally::default(), bins, followed: BTreeSet::new() };
    search.look_at_all()?;
    if !search.best().round() {
        search.follow()?;
        search.look_at_the_worst()?;
        search.follow()?;
        search.sweep()?;
        search.follow()?;
    }
    Ok(search.tally)
}

#[derive(Clone, Default)]
struct SearchedBin {
    figures: Figures,
    /// Groups that were computed, in the order of their visits.
    visits: u32,
}

struct Search<'a> {
    device: MeasuredDevice,
    op: Op,
    judge: &'a Judge<'a>,
    budget: u64,
    progress: &'a mut dyn FnMut(u64) -> Result<(), CalibrateError>,
    tally: Tally,
    bins: Vec<SearchedBin>,
    /// Words that were followed.
    followed: BTreeSet<u32>,
}

impl Search<'_> {
    /// Some results of every binade, and those for special arguments.
    fn look_at_all(&mut self) -> Result<(), CalibrateError> {
        let bins: Vec<u32> = (0..BINS as u32).filter(|bin| is_finite(bin << 23)).collect();
        let inputs = Inputs::new(self.op);
        let specials = (0..inputs.special_count() as u64).map(|k| inputs.at(k)[0] & !(GROUP - 1)).collect();
        self.compute(specials)?;
        self.visit(&bins, self.budget / LOOK)
    }

    /// More results of the binades that are worst in some figure.
    fn look_at_the_worst(&mut self) -> Result<(), CalibrateError> {
        let figures = 0..self.best().0.len();
        let bins: BTreeSet<u32> = figures.flat_map(|figure| self.ranked(figure).take(WORST_BINADES)).collect();
        self.visit(&Vec::from_iter(bins), self.budget / LOOK)
    }

    /// All results of the worst binade of each figure, then of the next, until they raise the figure no more, or no
    /// binade is left whose errors come near.
    fn sweep(&mut self) -> Result<(), CalibrateError> {
        let mut patience = [PATIENCE; 5];
        loop {
            let before = self.best();
            let mut next = BTreeSet::new();
            let mut asked = Vec::new();
            for figure in (0..patience.len()).filter(|figure| patience[*figure] > 0) {
                let comes_near = |bin: &u32| {
                    let bin = &self.bins[*bin as usize];
                    bin.visits < GROUPS && bin.figures.size(figure) * MARGIN >= before.size(figure)
                };
                if let Some(bin) = self.ranked(figure).find(comes_near) {
                    next.insert(bin);
                    asked.push(figure);
                }
            }
            let left = self.left().saturating_sub(self.budget / LAST);
            if next.is_empty() || left < u64::from(GROUP) {
                return Ok(());
            }
            let whole = 1 << 23;
            if left >= whole * next.len() as u64 {
                let words = next.iter().flat_map(|bin| (0..GROUPS).map(move |k| bin << 23 | (k * GROUP))).collect();
                next.iter().for_each(|bin| self.bins[*bin as usize].visits = GROUPS);
                self.compute(words)?;
            } else {
                self.visit(&Vec::from_iter(next), left)?;
            }
            let after = self.best();
            for figure in asked {
                // What is raised by less than that is found.
                let raised = after.size(figure) > 1.001 * before.size(figure);
                patience[figure] = if raised { PATIENCE } else { patience[figure] - 1 };
            }
        }
    }

    /// Results at arguments that have something in common with the worst ones, as long as that leads further.
    fn follow(&mut self) -> Result<(), CalibrateError> {
        for _ in 0..ROUNDS {
            let before = self.best();
            let bins = &self.bins;
            let worst = (0..before.0.len()).flat_map(|figure| {
                let ranked = self.ranked(figure).take(FOLLOWED);
                ranked.map(move |bin| bins[bin as usize].figures.0[figure].at[0])
            });
            let seeds: BTreeSet<u32> = worst.filter(|word| !self.followed.contains(word)).collect();
            let words = seeds.iter().flat_map(|word| kin(self.op, *word));
            let words: Vec<u32> = words.filter(|word| self.bins[(word >> 23) as usize].visits < GROUPS).collect();
            self.followed.extend(seeds);
            self.compute(words)?;
            if self.best() == before {
                break;
            }
        }
        Ok(())
    }

    /// The next groups of binades, evenly spread, `results` in all.
    fn visit(&mut self, bins: &[u32], results: u64) -> Result<(), CalibrateError> {
        let share = (results / u64::from(GROUP) / bins.len().max(1) as u64).clamp(1, GROUPS.into()) as u32;
        let mut words = Vec::new();
        for bin in bins {
            let visits = &mut self.bins[*bin as usize].visits;
            let next = *visits..GROUPS.min(*visits + share);
            *visits = next.end;
            words.extend(next.map(|k| bin << 23 | (k.wrapping_mul(STRIDE) % GROUPS * GROUP)));
        }
        self.compute(words)
    }

    /// Computes groups, as many as the budget has left.
    fn compute(&mut self, mut words: Vec<u32>) -> Result<(), CalibrateError> {
        words.sort_unstable();
        words.dedup();
        words.truncate((self.left() / u64::from(GROUP)) as usize);
        let (tally, bins, progress) = (&mut self.tally, &mut self.bins, &mut self.progress);
        self.device.words(self.judge, words.into_iter(), &mut |parts| {
            for (bin, part) in parts {
                bins[bin].figures.merge(&Figures::of(&part));
                tally.merge(&part);
            }
            progress(tally.samples)
        })
    }

    fn left(&self) -> u64 {
        self.budget.saturating_sub(self.tally.samples)
    }

    fn best(&self) -> Figures {
        let mut best = Figures::default();
        self.bins.iter().for_each(|bin| best.merge(&bin.figures));
        best
    }

    /// The bins with an error, the largest first.
    fn ranked(&self, figure: usize) -> impl Iterator<Item = u32> + use<> {
        let size = |bin: u32| self.bins[bin as usize].figures.size(figure);
        let mut bins: Vec<u32> = (0..BINS as u32).filter(|bin| size(*bin) > 0.0).collect();
        bins.sort_by(|a, b| size(*b).total_cmp(&size(*a)));
        bins.into_iter()
    }
}

/// The groups of arguments that have something in common with one.
fn kin(op: Op, word: u32) -> Vec<u32> {
    let group = word & !(GROUP - 1);
    let near = (-NEAR..=NEAR).filter_map(|k| u32::try_from(i64::from(group) + k * i64::from(GROUP)).ok());
    let same_significand = (0..BINS as u32).map(|bin| bin << 23 | (group & 0x007f_ffff));
    let x = f64::from(f32::from_bits(word));
    let same_reduced = period(op).into_iter().flat_map(|period| {
        let steps = (-PERIODS..=PERIODS).flat_map(move |k| [x, -x].map(|x| x + f64::from(k) * period));
        steps.map(|x| (x as f32).to_bits() & !(GROUP - 1))
    });
    near.chain(same_significand).chain(same_reduced).filter(|word| is_finite(*word)).collect()
}

/// By what an argument can change and be reduced to the same, or its opposite.
fn period(op: Op) -> Option<f64> {
    match op {
        Op::Sin | Op::Cos | Op::Tan => Some(std::f64::consts::PI),
        Op::Exp | Op::Sinh | Op::Cosh | Op::Tanh => Some(std::f64::consts::LN_2),
        Op::Exp2 | Op::Fract | Op::Floor | Op::Ceil | Op::Trunc | Op::RoundEven => Some(1.0),
        _ => None,
    }
}

fn is_finite(word: u32) -> bool {
    word & 0x7f80_0000 != 0x7f80_0000
}

#[cfg(test)]
mod tests;
