//! What is remembered of the results of an operation: errors by binade, and how they relate to a
//! promise.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use judge::profile::{BINS, CLASSES, Interval, Op, Profile, Sieve, accept, bin_of, grid, may_promise};
use judge::single::Arguments;
use judge::single::kernel::SWEEP;
use lanes::Stage;

/// Samples that one thread takes at a time.
const CHUNK: usize = 1 << 15;

/// Samples of a sweep whose exact values are computed at once; a multiple of [`SWEEP`].
const COLUMN: usize = 256;

/// In the place of an error: no value is defined.
const UNDEFINED: f64 = -3.0;
/// In the place of an error: an infinity for a value beyond the range.
const BEYOND: f64 = -2.0;
/// In the place of an error: the sample is tallied by itself.
const LONG_WAY: f64 = -1.0;
/// What errors and the marks above are counted by.
const LIMITS: [f64; CLASSES.len() + 3] = {
    let mut limits = [0.0; CLASSES.len() + 3];
    (limits[0], limits[1], limits[2]) = (UNDEFINED, BEYOND, LONG_WAY);
    let mut k = 0;
    while k < CLASSES.len() {
        limits[k + 3] = CLASSES[k];
        k += 1;
    }
    limits
};

/// Exponent field of a binary64 at the smallest normal binary32 number.
const LEAST_EXPONENT: u64 = 1023 - 126;

/// A largest value, and where it was found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Worst {
    /// The value, as bits of a binary64: text keeps them.
    bits: u64,
    /// Arguments of the operation with which the value came about.
    pub at: Arguments,
    /// Result of the device.
    pub result: u32,
}

impl Worst {
    /// The largest value so far; 0 before any.
    pub fn value(&self) -> f64 {
        f64::from_bits(self.bits)
    }

    /// Takes a value that is greater; NaN is greater than all. Of equal values the one with the smallest
    /// arguments stays, so that it does not matter in which order parts of a measurement are joined.
    fn take(&mut self, value: f64, at: Arguments, result: u32) {
        let old = self.value();
        let equal = value == old && old > 0.0 || value.is_nan() && old.is_nan();
        if value > old || (value.is_nan() && !old.is_nan()) || (equal && at < self.at) {
            *self = Self { bits: value.to_bits(), at, result };
        }
    }

    pub(super) fn merge(&mut self, other: &Self) {
        self.take(other.value(), other.at, other.result);
    }
}

/// Errors in one binade of the key.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Bin {
    /// Samples with an error.
    pub samples: u64,
    /// Largest error in ULP.
    pub ulp: Worst,
    /// Largest absolute error.
    pub abs: Worst,
    /// Samples by class of error.
    pub histogram: [u64; CLASSES.len() + 1],
    /// Samples with an infinity or NaN in place of a number.
    pub wild: u64,
    /// One of them, with an infinite value.
    #[serde(default)]
    pub wild_at: Worst,
}

/// Results of one operation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Samples, of whatever kind.
    pub samples: u64,
    /// Samples for which no value is defined.
    pub undefined: u64,
    /// Samples whose exact value is beyond the range of binary32.
    pub beyond: u64,
    /// Samples where a subnormal argument or result was flushed to zero.
    pub flushed: u64,
    /// Errors by bin of the key.
    pub bins: Vec<Bin>,
    /// Largest error in ULP where the specification promises one.
    pub promised_ulp: Worst,
    /// Largest absolute error where the specification promises one.
    pub promised_abs: Worst,
    /// Largest error as a part of what the text of the specification allows; infinite for a result
    /// that is no finite number, or an error where none is allowed.
    pub ratio: Worst,
    /// Samples outside of the text of the specification.
    pub outside_text: u64,
    /// Those of them that the conformance suite does not accept either.
    pub outside_suite: u64,
    /// The worst of these, by its part of what the text allows.
    pub suite_ratio: Worst,
}

impl Default for Tally {
    fn default() -> Self {
        Self {
            samples: 0,
            undefined: 0,
            beyond: 0,
            flushed: 0,
            bins: vec![Bin::default(); BINS],
            promised_ulp: Worst::default(),
            promised_abs: Worst::default(),
            ratio: Worst::default(),
            outside_text: 0,
            outside_suite: 0,
            suite_ratio: Worst::default(),
        }
    }
}

/// What results are held against.
pub struct Judge<'a> {
    op: Op,
    text: &'a Profile,
    suite: &'a Profile,
    stage: Stage,
    /// Errors that are promised wherever anything is.
    sieve: Sieve,
}

impl<'a> Judge<'a> {
    /// A judge by the text of a specification and the rule of its conformance suite.
    pub fn new(op: Op, text: &'a Profile, suite: &'a Profile, stage: Stage) -> Self {
        Self { op, text, suite, stage, sieve: Sieve::new(text, op, None) }
    }

    /// Tallies `count` samples in all threads. `sample` gives arguments and result.
    pub fn tally(&self, count: usize, sample: impl Fn(usize) -> (Arguments, u32) + Sync) -> Tally {
        let chunk = |c: usize| {
            let mut tally = Tally::default();
            for k in c * CHUNK..count.min((c + 1) * CHUNK) {
                let (arguments, result) = sample(k);
                self.one(&mut tally, arguments, result);
            }
            tally
        };
        (0..count.div_ceil(CHUNK)).into_par_iter().map(chunk).reduce(Tally::default, |mut a, b| {
            a.merge(&b);
            a
        })
    }

    /// Tallies the results for words of one bin: the same as [`Judge::tally`] for a function of one argument,
    /// without what most samples do not need. `firsts` are in ascending order; for each of them there are the
    /// results for it and the [`SWEEP`] − 1 words behind it.
    pub fn tally_neighbours(&self, firsts: &[u32], results: &[u32], function: fn(&[f64], &mut [f64])) -> Tally {
        let mut tally = Tally::default();
        let (Some(&first), Some(&last)) = (firsts.first(), firsts.last()) else { return tally };
        let range = Interval::hull([first, last + SWEEP as u32 - 1].map(|w| f64::from(f32::from_bits(w))));
        let bin = (first >> 23) as usize;
        let promises = range.is_some_and(|range| may_promise(self.text, self.op, range));
        let everything = Sieve { ulp: f64::INFINITY, abs: f64::INFINITY };
        let sieve = if promises { Sieve::new(self.text, self.op, range) } else { everything };
        let normal = !bin.is_multiple_of(BINS / 2);
        let least_size = if normal { grid::MIN_NORMAL } else { f64::INFINITY };
        let mut plain = [0_u64; CLASSES.len() + 1];
        let (mut arguments, mut exact, mut errors) = ([0.0; COLUMN], [0.0; COLUMN], [0.0; COLUMN]);
        for (firsts, results) in firsts.chunks(COLUMN / SWEEP).zip(results.chunks(COLUMN)) {
            for (first, group) in firsts.iter().zip(arguments.chunks_exact_mut(SWEEP)) {
                for (word, x) in (*first..).zip(group) {
                    *x = f64::from(f32::from_bits(word));
                }
            }
            let count = results.len();
            let (exact, errors) = (&mut exact[..count], &mut errors[..count]);
            function(&arguments[..count], exact);
            // Errors up to these limits set no record.
            let (mut ulp_limit, mut abs_limit) = (tally.bins[bin].ulp.value(), tally.bins[bin].abs.value());
            if promises {
                ulp_limit = ulp_limit.min(tally.promised_ulp.value());
                abs_limit = abs_limit.min(tally.promised_abs.value());
            }
            // The error in ULP of a sample that sets no record and is inside of the promise.
            number::map_pairs(exact, results, errors, |exact, result| {
                let error = (f64::from(f32::from_bits(result)) - exact).abs();
                // The reciprocal of the gap from the exponent, as `grid::ulp` without its cases.
                let bits = exact.to_bits();
                let field = bits >> 52 & 0x7ff;
                let field = if field < LEAST_EXPONENT { LEAST_EXPONENT } else { field };
                let field = if field > 0x7fe { 0x7fe } else { field };
                let power_of_two = (bits << 12 == 0) & (exact.abs() > grid::MIN_NORMAL);
                let ulp = error * f64::from_bits((2046 + 23 - field + u64::from(power_of_two)) << 52);
                // A subnormal number may be flushed: that is no error, and takes the long way.
                let usual = (ulp <= 0.5) | (exact.abs() >= least_size);
                let within = exact.abs() <= grid::MAX_FINITE;
                let no_record = (ulp <= ulp_limit) & (error <= abs_limit);
                let value = if usual & within & no_record & sieve.passes(ulp, error) { ulp } else { LONG_WAY };
                let infinite = f64::from(f32::from_bits(result)) == f64::INFINITY.copysign(exact);
                let value = if !within & infinite { BEYOND } else { value };
                if exact.is_nan() { UNDEFINED } else { value }
            });
            let above = number::count_above(errors, &LIMITS);
            let mut rest = count as u64;
            let parts = above.map(|above| std::mem::replace(&mut rest, above) - above);
            let [undefined, beyond, long, classes @ ..] = parts;
            tally.undefined += undefined;
            tally.beyond += beyond;
            tally.samples += undefined + beyond;
            plain.iter_mut().zip(classes.into_iter().chain([rest])).for_each(|(sum, class)| *sum += class);
            if long > 0 {
                for (k, &result) in results.iter().enumerate().filter(|(k, _)| errors[*k] == LONG_WAY) {
                    let word = firsts[k / SWEEP] + (k % SWEEP) as u32;
                    self.one_with(&mut tally, [word, 0, 0], result, exact[k], promises.then_some(sieve));
                }
            }
        }
        let count: u64 = plain.iter().sum();
        tally.samples += count;
        tally.bins[bin].samples += count;
        tally.bins[bin].histogram.iter_mut().zip(plain).for_each(|(a, b)| *a += b);
        tally
    }

    fn one(&self, tally: &mut Tally, arguments: Arguments, result: u32) {
        let args = arguments.map(|w| f64::from(f32::from_bits(w)));
        let exact = self.op.exact(&args[..self.op.arity().unwrap_or(0)]);
        self.one_with(tally, arguments, result, exact, Some(self.sieve));
    }

    /// Tallies a sample whose exact value is known. What passes the sieve is promised; without one,
    /// nothing is.
    fn one_with(&self, tally: &mut Tally, arguments: Arguments, result: u32, exact: f64, sieve: Option<Sieve>) {
        let args = arguments.map(|w| f64::from(f32::from_bits(w)));
        let args = &args[..self.op.arity().unwrap_or(0)];
        let found = f64::from(f32::from_bits(result));
        tally.samples += 1;
        if exact.is_nan() {
            tally.undefined += 1;
            return;
        }
        if exact.abs() > grid::MAX_FINITE {
            tally.beyond += 1;
            let accepted = found.abs() >= grid::MAX_FINITE && (found > 0.0) == (exact > 0.0);
            if !accepted {
                self.against_promise(tally, arguments, args, result, exact);
            }
            return;
        }
        let error = (found - exact).abs();
        let ulp = error / grid::ulp(exact);
        // An error of less is a rounding, whatever the arguments.
        if ulp > 0.5 && self.is_flush(args, found, exact) {
            tally.flushed += 1;
            return;
        }
        if let Some(bin) = self.bin(arguments, args).and_then(|b| tally.bins.get_mut(b)) {
            bin.samples += 1;
            if error.is_finite() {
                bin.ulp.take(ulp, arguments, result);
                bin.abs.take(error, arguments, result);
                let class = CLASSES.iter().position(|end| ulp <= *end).unwrap_or(CLASSES.len());
                bin.histogram[class] += 1;
            } else {
                bin.wild += 1;
                bin.wild_at.take(f64::INFINITY, arguments, result);
            }
        }
        let record = ulp > tally.promised_ulp.value() || error > tally.promised_abs.value();
        // A NaN does not pass.
        if sieve.is_some_and(|sieve| record || !sieve.passes(ulp, error)) {
            self.against_promise(tally, arguments, args, result, exact);
        }
    }

    /// The bin of the key; a word of the only argument says it without arithmetic.
    fn bin(&self, arguments: Arguments, args: &[f64]) -> Option<usize> {
        if self.op.arity() == Some(1) { Some((arguments[0] >> 23) as usize) } else { bin_of(self.op.key(args)) }
    }

    /// True for a zero where a subnormal result is due, and for the result that zeros in the place
    /// of subnormal arguments give.
    fn is_flush(&self, args: &[f64], found: f64, exact: f64) -> bool {
        if found == 0.0 && exact.abs() < grid::MIN_NORMAL {
            return true;
        }
        let subnormal = |x: f64| x != 0.0 && x.abs() < grid::MIN_NORMAL;
        if !args.iter().any(|x| subnormal(*x)) {
            return false;
        }
        let mut zeroed = [0.0; 3];
        for (to, x) in zeroed.iter_mut().zip(args) {
            *to = if subnormal(*x) { 0.0_f64.copysign(*x) } else { *x };
        }
        let value = self.op.exact(&zeroed[..args.len()]);
        grid::down(value) <= found && found <= grid::up(value)
    }

    #[cold]
    fn against_promise(&self, tally: &mut Tally, arguments: Arguments, args: &[f64], result: u32, exact: f64) {
        let Ok(accepted) = accept(self.text, self.op, args, self.stage) else { return };
        let found = f64::from(f32::from_bits(result));
        let error = (found - exact).abs();
        let inside = accepted.contains(found);
        let room = if found < exact { exact - accepted.lo } else { accepted.hi - exact };
        let ratio = match (error, inside) {
            (0.0, _) => 0.0,
            // A result that is accepted beside the interval's own width, such as a flushed one.
            (_, true) => (error / room).min(1.0),
            (e, false) if e.is_finite() => (e / room).max(1.0),
            (_, false) => f64::INFINITY,
        };
        tally.ratio.take(ratio, arguments, result);
        if error.is_finite() {
            tally.promised_ulp.take(error / grid::ulp(exact), arguments, result);
            tally.promised_abs.take(error, arguments, result);
        }
        if inside {
            return;
        }
        tally.outside_text += 1;
        let by_suite = accept(self.suite, self.op, args, self.stage);
        if by_suite.is_ok_and(|interval| !interval.contains(found)) {
            tally.outside_suite += 1;
            tally.suite_ratio.take(ratio, arguments, result);
        }
    }
}

impl Tally {
    /// Adds another tally of the same operation.
    pub fn merge(&mut self, other: &Self) {
        self.samples += other.samples;
        self.undefined += other.undefined;
        self.beyond += other.beyond;
        self.flushed += other.flushed;
        for (a, b) in self.bins.iter_mut().zip(&other.bins).filter(|(_, b)| b.samples > 0) {
            a.samples += b.samples;
            a.wild += b.wild;
            a.wild_at.merge(&b.wild_at);
            a.ulp.merge(&b.ulp);
            a.abs.merge(&b.abs);
            for (a, b) in a.histogram.iter_mut().zip(b.histogram) {
                *a += b;
            }
        }
        self.promised_ulp.merge(&other.promised_ulp);
        self.promised_abs.merge(&other.promised_abs);
        self.ratio.merge(&other.ratio);
        self.outside_text += other.outside_text;
        self.outside_suite += other.outside_suite;
        self.suite_ratio.merge(&other.suite_ratio);
    }

    /// The largest error in ULP of all samples, and where.
    pub fn worst_ulp(&self) -> Worst {
        self.worst(|b| &b.ulp)
    }

    /// The largest absolute error of all samples, and where.
    pub fn worst_abs(&self) -> Worst {
        self.worst(|b| &b.abs)
    }

    fn worst(&self, of: impl Fn(&Bin) -> &Worst) -> Worst {
        let mut worst = Worst::default();
        self.bins.iter().for_each(|bin| worst.merge(of(bin)));
        worst
    }
}
