//! Random bits that depend on a seed and a place alone, never on what was drawn before elsewhere.

/// Odd constant of full period: spreads consecutive counters over all 64 bits.
const STRIDE: u64 = 0xd134_2543_de82_ef95;

/// Step of SplitMix64: 2^64 divided by the golden ratio.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// SplitMix64's output function.
///
/// `rand_xoshiro` has the same generator, and a test compares the two; but there seeding is a call
/// across crates that is not inlined, and two of these for each sample cost more than all the rest.
#[cfg_attr(not(debug_assertions), inline(always))]
fn finish(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A hash of two numbers. `mix(mix(seed, case), invocation)` names the stream of one sample.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn mix(key: u64, counter: u64) -> u64 {
    finish((key ^ counter.wrapping_mul(STRIDE)).wrapping_add(STEP))
}

/// A hash of a key and a text, to give every group of inputs its own streams.
pub fn mix_text(key: u64, text: &str) -> u64 {
    text.bytes().fold(mix(key, text.len() as u64), |key, byte| mix(key, u64::from(byte)))
}

/// A short sequence of random bits for one sample.
#[derive(Clone, Copy, Debug)]
pub struct Stream(u64);

impl Stream {
    /// The sequence of this seed. Equal seeds give equal sequences, on every machine.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(STEP);
        finish(self.0)
    }

    /// The next `draws` draws as a sequence of their own; this one goes on behind them.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn part(&mut self, draws: u64) -> Self {
        let part = *self;
        self.0 = self.0.wrapping_add(STEP.wrapping_mul(draws));
        part
    }

    /// A number in `0..n`; 0 when `n` is 0. The bias is below 2^-32.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn below(&mut self, n: usize) -> usize {
        (((self.bits() >> 32) * n as u64) >> 32) as usize
    }

    /// True once in `n` draws on average.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    /// A number in `[0, 1)` with 53 bits.
    #[inline]
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * 2f64.powi(-53)
    }

    /// A number in `[lo, hi)`.
    #[inline]
    pub fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use rand_core::{Rng, SeedableRng};
    use rand_xoshiro::SplitMix64;

    use super::*;

    #[test]
    fn the_bits_are_those_of_splitmix64() {
        for seed in [0, 1, u64::MAX, 1477776061723855037] {
            let (mut ours, mut theirs) = (Stream::new(seed), SplitMix64::seed_from_u64(seed));
            assert!((0..1000).all(|_| ours.bits() == theirs.next_u64()));
        }
    }

    #[test]
    fn parts_are_what_would_have_been_drawn() {
        let (mut whole, mut rest) = (Stream::new(9), Stream::new(9));
        let mut part = rest.part(3);
        assert!((0..3).all(|_| whole.bits() == part.bits()) && whole.bits() == rest.bits());
    }

    #[test]
    fn neighbouring_counters_share_nothing() {
        let seeds: HashSet<u64> = (0..1 << 16).map(|i| mix(7, i)).collect();
        assert_eq!(seeds.len(), 1 << 16);
        // Each output bit flips for about half of the neighbours.
        for bit in 0..64 {
            let flips = (0..4096).filter(|&i| (mix(7, i) ^ mix(7, i + 1)) >> bit & 1 == 1).count();
            assert!((1800..2300).contains(&flips), "bit {bit}: {flips}");
        }
    }

    #[test]
    fn below_reaches_every_number_evenly() {
        let mut stream = Stream::new(1);
        let mut counts = [0; 5];
        for _ in 0..5000 {
            counts[stream.below(5)] += 1;
        }
        assert!(counts.iter().all(|&c| (850..1150).contains(&c)), "{counts:?}");
        assert_eq!(stream.below(0), 0);
    }

    #[test]
    fn texts_give_different_keys() {
        assert_ne!(mix_text(1, "p0"), mix_text(1, "p1"));
        assert_ne!(mix_text(1, ""), mix_text(2, ""));
    }
}
