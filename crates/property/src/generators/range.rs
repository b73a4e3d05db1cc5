//! A range of binary32 values: what is drawn from it, and which of its values are special.

/// A closed range of binary32 values. The ends are the binary32 values nearest to the stated ones.
///
/// Drawing is written without branches on random bits: mispredicted ones took most of the time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    lo: f32,
    hi: f32,
    /// 2^-32 of the distance of the ends.
    width: f64,
    /// Binary exponents of the magnitudes drawn log-uniformly, both included.
    exponents: (i32, i32),
    /// Special values that do not depend on random bits, all inside.
    fixed: [f32; FIXED],
}

/// Number of fixed special values.
const FIXED: usize = 9;

/// Smallest exponent of log-uniform magnitudes: 2^-20 is small beside 1 and far from underflow.
const SMALLEST: i32 = -20;

/// Kinds of special values in [`Range::special`]: the fixed ones, and powers of two with their two
/// neighbours.
const KINDS: u64 = FIXED as u64 + 3;

/// `yes` or `no`, without a branch.
#[cfg_attr(not(debug_assertions), inline(always))]
fn select(condition: bool, yes: f32, no: f32) -> f32 {
    let mask = 0u32.wrapping_sub(u32::from(condition));
    f32::from_bits((yes.to_bits() & mask) | (no.to_bits() & !mask))
}

fn exponent(value: f32) -> i32 {
    (value.to_bits() >> 23 & 0xff) as i32 - 127
}

impl Range {
    /// The range `lo..=hi`. `lo` is not above `hi` and both are finite as binary32.
    pub fn new(lo: f64, hi: f64) -> Self {
        let (lo, hi) = (lo as f32, hi as f32);
        let top = exponent(lo.abs().max(hi.abs())).max(-100);
        let low = if top > SMALLEST { SMALLEST } else { top - 20 };
        let fixed = [lo, hi, 0.0, -0.0, 1.0, -1.0, 0.5, lo.next_up().min(hi), hi.next_down().max(lo)];
        let mut range =
            Self { lo, hi, width: (f64::from(hi) - f64::from(lo)) * 2f64.powi(-32), exponents: (low, top), fixed };
        for (i, value) in fixed.into_iter().enumerate() {
            range.fixed[i] = range.inside(value, i % 2 == 0);
        }
        range
    }

    /// Half the sum of the ends, and half their distance.
    pub fn middle(&self) -> (f64, f64) {
        let (lo, hi) = (f64::from(self.lo), f64::from(self.hi));
        ((lo + hi) / 2.0, (hi - lo) / 2.0)
    }

    /// The lower end.
    pub fn lo(&self) -> f32 {
        self.lo
    }

    /// The upper end.
    pub fn hi(&self) -> f32 {
        self.hi
    }

    /// True when the value lies inside, the ends included. False for NaN.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn contains(&self, value: f32) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// The value inside that is nearest.
    #[inline]
    pub fn clamp(&self, value: f32) -> f32 {
        value.max(self.lo).min(self.hi)
    }

    /// A value spread over the range: three times of four evenly, else with an evenly spread
    /// exponent, so that small magnitudes come too.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn ordinary(&self, bits: u64) -> f32 {
        // Through i64: processors convert signed integers in one instruction.
        let steps = (bits >> 32) as i64 as f64;
        let even = (f64::from(self.lo) + self.width * steps) as f32;
        let even = select(even > self.hi, self.hi, even);
        let scaled = self.log_uniform(bits >> 2);
        let scaled = select(self.contains(scaled), scaled, -scaled);
        select((bits & 3 == 0) & self.contains(scaled), scaled, even)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn log_uniform(&self, bits: u64) -> f32 {
        let (low, top) = self.exponents;
        let exponent = low + (((bits & 0xffff) * (top - low + 1) as u64) >> 16) as i32;
        let sign = (bits >> 16 & 1) as u32;
        let fraction = (bits >> 39) as u32 & 0x007f_ffff;
        f32::from_bits(sign << 31 | ((exponent + 127) as u32) << 23 | fraction)
    }

    /// A value where arithmetic has its edges: the ends and their inner neighbours, 0 with both
    /// signs, 1, -1, one half, powers of two and their two neighbours. One that does not lie in the
    /// range is replaced by an end.
    #[inline]
    pub fn special(&self, bits: u64) -> f32 {
        let (kind, rest) = ((((bits & 0xffff) * KINDS) >> 16) as usize, bits >> 16);
        // The kinds behind the fixed ones are 0, 1 and -1 units in the last place of a power of two.
        let step = [0, 1, u32::MAX][kind.saturating_sub(FIXED)];
        let power = self.log_uniform(rest).to_bits() & 0xff80_0000;
        let beside = self.inside(f32::from_bits(power.wrapping_add(step)), rest & 1 == 0);
        select(kind < FIXED, self.fixed[kind.min(FIXED - 1)], beside)
    }

    /// The value, else its negative, else an end: the first that lies inside.
    #[inline]
    fn inside(&self, value: f32, lower: bool) -> f32 {
        let mirrored = select(self.contains(value), value, -value);
        select(self.contains(mirrored), mirrored, select(lower, self.lo, self.hi))
    }

    /// A multiple of 1/64 of the largest power of two in the range, inside the range where one
    /// exists: sums of eighths of such values are exact.
    pub fn on_grid(&self, bits: u64) -> f32 {
        let step = 2f64.powi(self.exponents.1 - 6);
        let (first, last) = ((f64::from(self.lo) / step).ceil(), (f64::from(self.hi) / step).floor());
        if first > last {
            return self.ordinary(bits);
        }
        let count = (last - first) as u64 + 1;
        ((first + (((bits >> 32) * count) >> 32) as f64) * step) as f32
    }

    /// -1, 0 or 1, moved into the range.
    pub fn lattice(&self, bits: u64) -> f32 {
        self.clamp((((bits >> 32) * 3) >> 32) as f32 - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::stream::Stream;
    use super::*;

    fn draw(range: Range, n: usize, f: fn(&Range, u64) -> f32) -> Vec<f32> {
        let mut stream = Stream::new(5);
        (0..n).map(|_| f(&range, stream.bits())).collect()
    }

    #[test]
    fn nothing_falls_outside() {
        for (lo, hi) in [(0.0, 1.0), (-2.0, 2.0), (5.0, 6.0), (0.0, 0.0), (-3.0, -1.0), (0.0, 1e-9), (-1e30, 1e30)] {
            let range = Range::new(lo, hi);
            for f in [Range::ordinary, Range::special, Range::on_grid, Range::lattice] {
                for value in draw(range, 4096, f) {
                    assert!(range.contains(value), "{value} in {lo}..={hi}");
                }
            }
        }
    }

    #[test]
    fn ordinary_values_are_even_and_reach_small_magnitudes() {
        let values = draw(Range::new(-2.0, 2.0), 1 << 14, Range::ordinary);
        for quarter in 0..4 {
            let lo = -2.0 + quarter as f32;
            let count = values.iter().filter(|&&v| lo <= v && v < lo + 1.0).count();
            assert!((3000..5400).contains(&count), "{lo}: {count}");
        }
        assert!(values.iter().filter(|v| v.abs() < 1e-4).count() > 500);
    }

    #[test]
    fn special_values_reach_every_kind() {
        let range = Range::new(-2.5, 2.5);
        let values = draw(range, 1 << 14, Range::special);
        let count = |f: &dyn Fn(f32) -> bool| values.iter().filter(|&&v| f(v)).count();
        let power = |v: f32| v != 0.0 && v.to_bits() & 0x007f_ffff == 0;
        let kinds: [(&str, &dyn Fn(f32) -> bool); 10] = [
            ("lower end", &|v| v == -2.5),
            ("upper end", &|v| v == 2.5),
            ("zero", &|v| v.to_bits() == 0),
            ("negative zero", &|v| v.to_bits() == 1 << 31),
            ("one", &|v| v == 1.0),
            ("minus one", &|v| v == -1.0),
            ("inside the ends", &|v| v == (-2.5f32).next_up() || v == 2.5f32.next_down()),
            ("power of two", &|v| power(v) && v.abs() != 1.0),
            ("above a power", &|v| power(v.next_down()) && v > 0.0),
            ("below a power", &|v| power(v.next_up()) && v > 0.0),
        ];
        for (name, kind) in kinds {
            assert!(count(kind) > 300, "{name}: {}", count(kind));
        }
    }

    #[test]
    fn grid_values_add_up_exactly() {
        let values = draw(Range::new(-2.0, 2.0), 1000, Range::on_grid);
        for pair in values.windows(2) {
            let sum = f64::from(pair[0]) + 0.125 * f64::from(pair[1]);
            assert_eq!(f64::from(sum as f32), sum);
        }
    }
}
