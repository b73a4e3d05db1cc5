//! Arguments for a measurement by samples: every binade of every argument, and special values.

use crate::profile::Op;

/// Arguments of one application; those past the arity are 0.
pub type Arguments = [u32; 3];

/// Exponents in which shaders live; half of the samples and more go there.
const CENTRE: std::ops::RangeInclusive<u32> = 127 - 24..=127 + 16;
/// Times that a binade of the centre comes for each of the others.
const WEIGHT: usize = 6;
/// An odd number near 2^23/φ: its multiples visit all significands, evenly from the start.
const STRIDE: u64 = 5_184_509;

/// A source of arguments: the same for the same operation, whatever the device.
pub struct Inputs {
    op: Op,
    specials: Vec<Arguments>,
    /// Sign and exponent bits, in the order of visits.
    strata: Vec<u32>,
}

impl Inputs {
    /// The arguments for an operation.
    pub fn new(op: Op) -> Self {
        let mut strata: Vec<u32> = (0..255).flat_map(|e| [e << 23, (e + 256) << 23]).collect();
        for _ in 0..WEIGHT {
            strata.extend(CENTRE.flat_map(|e| [e << 23, (e + 256) << 23]));
        }
        Self { op, specials: specials(op), strata }
    }

    /// Number of special arguments; they come first.
    pub fn special_count(&self) -> usize {
        self.specials.len()
    }

    /// The `k`-th arguments.
    pub fn at(&self, k: u64) -> Arguments {
        if let Some(special) = self.specials.get(k as usize) {
            return *special;
        }
        let k = k - self.specials.len() as u64;
        let x = self.stratified(k);
        match self.op.arity() {
            Some(2 | 3) => {
                // Independent strata for each argument: the order of the first is no order of the others.
                let [second, third] = [1, 2].map(|salt| self.stratified(mixed(k, salt)));
                if self.op == Op::Pow { power(x, second, k) } else { [x, second, third] }
            }
            _ => [x, 0, 0],
        }
    }

    fn stratified(&self, k: u64) -> u32 {
        let strata = self.strata.len() as u64;
        let significand = (k / strata).wrapping_mul(STRIDE) & 0x007f_ffff;
        self.strata[(k % strata) as usize] | significand as u32
    }
}

/// Arguments of `pow`: a positive base, and mostly an exponent for which the result is in range.
fn power(x: u32, y: u32, k: u64) -> Arguments {
    let x = x & 0x7fff_ffff;
    let log = f64::from(f32::from_bits(x)).log2();
    if k.is_multiple_of(4) || log == 0.0 || !log.is_finite() {
        return [x, y, 0];
    }
    let spread = (mixed(k, 3) >> 11) as f64 / (1_u64 << 53) as f64;
    let exponent = (spread * 254.0 - 126.0) / log;
    [x, (exponent as f32).to_bits(), 0]
}

/// A number without visible relation to `k` (the finalizer of SplitMix64).
fn mixed(k: u64, salt: u64) -> u64 {
    let mut z = k.wrapping_add((salt + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

fn specials(op: Op) -> Vec<Arguments> {
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, LN_2, PI, TAU};
    let mut values = vec![0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 10.0, PI, FRAC_PI_2, FRAC_PI_4, TAU, LN_2, 100.0, 88.72, 126.0];
    values.extend([f32::MIN_POSITIVE, f32::from_bits(1), f32::from_bits(0x007f_ffff), f32::MAX, 8_388_608.0]);
    let around = |x: f32| [x, x.next_up(), x.next_down()].into_iter().flat_map(|x| [x, -x]);
    let finite = |x: &f32| x.is_finite();
    let near: Vec<u32> = values.into_iter().flat_map(around).filter(finite).map(f32::to_bits).collect();
    match op.arity() {
        Some(1) => {
            // Ends of all binades, where errors in units of the last place jump.
            let powers = (1..255_u32).map(|e| f32::from_bits(e << 23)).flat_map(around).filter(finite);
            near.into_iter().chain(powers.map(f32::to_bits)).map(|x| [x, 0, 0]).collect()
        }
        Some(_) => {
            let third = f32::to_bits(-1.0);
            near.iter().flat_map(|&x| near.iter().map(move |&y| [x, y, third])).collect()
        }
        None => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn samples_reach_every_binade_and_no_argument_is_infinite() {
        for op in [Op::Sin, Op::Atan2, Op::Fma] {
            let inputs = Inputs::new(op);
            let count = inputs.special_count() as u64 + 4 * inputs.strata.len() as u64;
            let mut bins = [BTreeSet::new(), BTreeSet::new(), BTreeSet::new()];
            for k in 0..count {
                for (bins, x) in bins.iter_mut().zip(inputs.at(k)) {
                    assert!(f32::from_bits(x).is_finite());
                    bins.insert(x >> 23);
                }
            }
            // The first argument visits all in turn, the others at random.
            assert_eq!(bins[0].len(), 510);
            assert!(op.arity().unwrap() < 2 || bins[1].len() > 450, "{op:?}: {}", bins[1].len());
        }
    }

    #[test]
    fn samples_of_a_binade_do_not_repeat() {
        let inputs = Inputs::new(Op::Exp2);
        let first = inputs.special_count() as u64;
        let visits = (0..5000).map(|k| inputs.at(first + k * inputs.strata.len() as u64)[0]);
        assert_eq!(visits.collect::<BTreeSet<_>>().len(), 5000);
    }

    #[test]
    fn specials_hold_zeros_of_both_signs_and_the_ends_of_the_range() {
        let inputs = Inputs::new(Op::Sqrt);
        let specials: Vec<u32> = (0..inputs.special_count() as u64).map(|k| inputs.at(k)[0]).collect();
        for x in [0.0, -0.0, f32::MAX, f32::MIN, f32::MIN_POSITIVE, 1.0_f32.next_down()] {
            assert!(specials.contains(&x.to_bits()), "{x:e}");
        }
    }

    #[test]
    fn most_powers_are_in_range() {
        let inputs = Inputs::new(Op::Pow);
        let first = inputs.special_count() as u64;
        let in_range = (first..first + 4000).filter(|&k| {
            let [x, y, _] = inputs.at(k).map(|w| f64::from(f32::from_bits(w)));
            let power = Op::Pow.exact(&[x, y]);
            power.abs() < 3.5e38 && power.abs() > 1e-39
        });
        assert!(in_range.count() > 2500);
    }
}
