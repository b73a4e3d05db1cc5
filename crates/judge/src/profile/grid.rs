//! The grid of binary32 numbers under the real line, and intervals on it.

/// The smallest normal binary32 number, 2^-126.
pub const MIN_NORMAL: f64 = f32::MIN_POSITIVE as f64;
/// The largest finite binary32 number.
pub const MAX_FINITE: f64 = f32::MAX as f64;

/// ulp(x) of the Vulkan specification: the smallest distance between two finite binary32 numbers
/// a ≤ x ≤ b. At a power of two that is the gap below it. NaN for NaN and infinities.
pub fn ulp(x: f64) -> f64 {
    let gap = base::value::ulp_at(x);
    // All bits of the significand are zero.
    let power_of_two = x.to_bits() << 12 == 0;
    if power_of_two && x.abs() > MIN_NORMAL && x.abs() <= MAX_FINITE { gap / 2.0 } else { gap }
}

/// The binary32 number nearest to `x`; ties to even, overflow to infinity.
pub fn nearest(x: f64) -> f64 {
    f64::from(x as f32)
}

/// The largest binary32 number that is not above `x`; −∞ below the range.
pub fn down(x: f64) -> f64 {
    let near = x as f32;
    if f64::from(near) > x { f64::from(near.next_down()) } else { f64::from(near) }
}

/// The smallest binary32 number that is not below `x`; +∞ above the range.
pub fn up(x: f64) -> f64 {
    -down(-x)
}

/// A closed interval of real numbers; its ends may be infinite, and are never NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

impl Interval {
    /// The interval of one number.
    pub fn point(x: f64) -> Self {
        Self { lo: x, hi: x }
    }

    /// The smallest interval with these numbers; `None` when one of them is NaN, or there is none.
    pub fn hull(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        values
            .into_iter()
            .try_fold(None, |hull: Option<Self>, x| {
                if x.is_nan() {
                    return Err(());
                }
                Ok(Some(hull.map_or(Self::point(x), |h| Self { lo: h.lo.min(x), hi: h.hi.max(x) })))
            })
            .unwrap_or(None)
    }

    /// The smallest interval that holds both.
    pub fn join(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// True when `x` lies inside; never for NaN.
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// The largest magnitude inside.
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The smallest magnitude inside.
    pub fn least_magnitude(self) -> f64 {
        if self.contains(0.0) { 0.0 } else { self.lo.abs().min(self.hi.abs()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_a_power_of_two_the_smaller_gap_counts() {
        assert_eq!(ulp(1.0), 2f64.powi(-24));
        assert_eq!(ulp(1.0 + 1e-12), 2f64.powi(-23));
        assert_eq!(ulp(1.0 - 1e-12), 2f64.powi(-24));
        assert_eq!((ulp(0.0), ulp(MIN_NORMAL), ulp(1e-300)), (2f64.powi(-149), 2f64.powi(-149), 2f64.powi(-149)));
        assert_eq!(ulp(-4.0), ulp(4.0));
    }

    #[test]
    fn neighbours_enclose_and_grid_points_are_their_own_neighbours() {
        for x in [0.1, -0.1, 1e-40, 3e38, -1e-50, 1.0, 0.0, 2f64.powi(-149)] {
            assert!(down(x) <= x && x <= up(x), "{x}");
            let on_grid = f64::from(x as f32) == x;
            assert_eq!(on_grid, down(x) == up(x), "{x}");
        }
        assert_eq!(up(1e39), f64::INFINITY);
        assert_eq!(down(1e39), MAX_FINITE);
    }

    #[test]
    fn hulls_refuse_values_that_are_no_numbers() {
        assert_eq!(Interval::hull([1.0, -2.0]), Some(Interval { lo: -2.0, hi: 1.0 }));
        assert_eq!(Interval::hull([1.0, f64::NAN]), None);
        assert!(!Interval::point(1.0).contains(f64::NAN));
        assert_eq!(Interval { lo: -2.0, hi: 1.0 }.least_magnitude(), 0.0);
    }
}
