//! What a device decides where its profile leaves it a choice.

use judge::profile::{Interval, grid};
use property::{Stream, mix};

/// Which of the accepted results a device gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Strategy {
    /// Any of them, evenly over the interval.
    Random,
    /// One of the two ends, by chance.
    Extreme,
    /// The greatest.
    Upward,
    /// The least.
    Downward,
    /// One of the two ends, always the same one at one place of the program: errors that belong
    /// together add up.
    BySite,
    /// One of the strategies above for each invocation.
    Mixed,
}

impl Strategy {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Random, Self::Extreme, Self::Upward, Self::Downward, Self::BySite, Self::Mixed];
}

/// Where an operation is carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Number of the site in the program.
    pub site: usize,
    /// A number that names the inputs of the invocation.
    pub invocation: u64,
}

/// The decisions about one operation.
pub(super) struct Choice {
    strategy: Strategy,
    stream: Stream,
    /// Equal for all operations of one kind at one place.
    site: u64,
}

impl Choice {
    pub(super) fn new(seed: u64, strategy: Strategy, place: Place, operation: u64, args: &[f64]) -> Self {
        let site = mix(mix(seed, place.site as u64), operation);
        let key = args.iter().fold(mix(site, place.invocation), |key, x| mix(key, x.to_bits()));
        let strategy = match strategy {
            Strategy::Mixed => {
                let simple = &Strategy::ALL[..Strategy::ALL.len() - 1];
                simple[Stream::new(mix(seed, place.invocation)).below(simple.len())]
            }
            simple => simple,
        };
        Self { strategy, stream: Stream::new(key), site }
    }

    /// Yes or no; at one place always the same where the strategy says so. `question` is below 64.
    pub(super) fn decide(&mut self, question: u32) -> bool {
        match self.strategy {
            Strategy::BySite => self.site >> question & 1 == 1,
            _ => self.stream.one_in(2),
        }
    }

    /// True for an error upward.
    pub(super) fn is_upward(&mut self) -> bool {
        match self.strategy {
            Strategy::Upward => true,
            Strategy::Downward => false,
            Strategy::Random | Strategy::Extreme | Strategy::BySite | Strategy::Mixed => self.decide(0),
        }
    }

    /// A binary32 number in an interval; the one nearest to `exact` when there is none inside.
    pub(super) fn within(&mut self, interval: Interval, exact: f64) -> f64 {
        let (lo, hi) = (grid::up(interval.lo), grid::down(interval.hi));
        if lo > hi {
            return grid::nearest(exact);
        }
        let up = self.is_upward();
        if self.strategy != Strategy::Random {
            return if up { hi } else { lo };
        }
        let finite = |x: f64| x.clamp(-grid::MAX_FINITE, grid::MAX_FINITE);
        // Infinity is as far as the largest number, and is one number among many.
        let end = if up { hi } else { lo };
        if end.is_infinite() && self.stream.one_in(4) {
            return end;
        }
        grid::nearest(self.stream.between(finite(lo), finite(hi))).clamp(lo, hi)
    }

    /// Anything, where nothing is promised.
    pub(super) fn wild(&mut self, exact: f64) -> f32 {
        let found = match self.stream.below(8) {
            0 => f32::NAN,
            1 if self.stream.one_in(2) => f32::INFINITY,
            1 => f32::NEG_INFINITY,
            2 => 0.0,
            3 | 4 => exact as f32,
            5 => (-2.0 * exact) as f32,
            _ => f32::from_bits(self.stream.bits() as u32),
        };
        // A NaN of chance could be the mark of what was never written.
        if found.is_nan() { f32::NAN } else { found }
    }
}
