//! A range of binary32 values: what is drawn from it, and which of its values are special.

/// A closed range of binary32 values. The ends are the binary32 values nearest to the stated ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    lo: f32,
    hi: f32,
    width: f64,
    /// Binary exponents of the magnitudes drawn log-uniformly, both included.
    exponents: (i32, i32),
}

/// Smallest exponent of log-uniform magnitudes: 2^-20 is small beside 1 and far from underflow.
const SMALLEST: i32 = -20;

/// Kinds of special values in [`Range::special`].
const KINDS: u64 = 12;

fn exponent(value: f32) -> i32 {
    (value.to_bits() >> 23 & 0xff) as i32 - 127
}

impl Range {
    /// The range `lo..=hi`. `lo` is not above `hi` and both are finite as binary32.
    pub fn new(lo: f64, hi: f64) -> Self {
        let (lo, hi) = (lo as f32, hi as f32);
        let top = exponent(lo.abs().max(hi.abs())).max(-100);
        let low = if top > SMALLEST { SMALLEST } else { top - 20 };
        Self { lo, hi, width: f64::from(hi) - f64::from(lo), exponents: (low, top) }
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
    #[inline]
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
    #[inline]
    pub fn ordinary(&self, bits: u64) -> f32 {
        if bits & 3 == 0 {
            let value = self.log_uniform(bits >> 2);
            if self.contains(value) {
                return value;
            }
            if self.contains(-value) {
                return -value;
            }
        }
        let unit = (bits >> 32) as f64 * 2f64.powi(-32);
        self.clamp((f64::from(self.lo) + self.width * unit) as f32)
    }

    #[inline]
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
    pub fn special(&self, bits: u64) -> f32 {
        let (kind, rest) = (((bits & 0xffff) * KINDS) >> 16, bits >> 16);
        let value = match kind {
            0 => self.lo,
            1 => self.hi,
            2 => 0.0,
            3 => -0.0,
            4 => 1.0,
            5 => -1.0,
            6 => 0.5,
            7 => self.clamp(self.lo.next_up()),
            8 => self.clamp(self.hi.next_down()),
            9 => self.power_of_two(rest),
            10 => self.power_of_two(rest).next_up(),
            _ => self.power_of_two(rest).next_down(),
        };
        let mirrored = -value;
        match (self.contains(value), self.contains(mirrored), rest & 1) {
            (true, ..) => value,
            // A negative zero in a range above zero would be turned into a positive one here.
            (false, true, _) => mirrored,
            (false, false, 0) => self.lo,
            (false, false, _) => self.hi,
        }
    }

    fn power_of_two(&self, bits: u64) -> f32 {
        let value = self.log_uniform(bits);
        f32::from_bits(value.to_bits() & 0xff80_0000)
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
