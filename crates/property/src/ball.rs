//! Numbers with a radius: an output of a lane and how far it may be off, carried through the
//! arithmetic of a relation.

use std::ops::{Add, Mul, Neg, Sub};

use crate::Observed;

/// A real number known to lie within `rad` of `mid`. An infinite radius says that nothing is known,
/// as of an output for which the formula has no value.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// The middle of the interval.
    pub mid: f64,
    /// Half of its width; infinite where nothing is known.
    pub rad: f64,
}

impl From<f64> for Ball {
    fn from(mid: f64) -> Self {
        Self { mid, rad: 0.0 }
    }
}

impl Add for Ball {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { mid: self.mid + other.mid, rad: self.rad + other.rad }
    }
}

impl Neg for Ball {
    type Output = Self;
    fn neg(self) -> Self {
        Self { mid: -self.mid, rad: self.rad }
    }
}

impl Sub for Ball {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Ball {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let rad = times(self.mid, other.rad) + times(other.mid, self.rad) + times(self.rad, other.rad);
        Self { mid: self.mid * other.mid, rad }
    }
}

impl Mul<f64> for Ball {
    type Output = Self;
    fn mul(self, exact: f64) -> Self {
        Self { mid: self.mid * exact, rad: times(exact, self.rad) }
    }
}

/// |a| b, where 0 times the unknown is 0.
fn times(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a.abs() * b }
}

impl Ball {
    /// Whether nothing is known of the number.
    pub fn is_unknown(self) -> bool {
        self.rad == f64::INFINITY
    }

    /// Whether the number may be 0. False for NaN, so that a NaN reaches the claim and fails it.
    pub fn may_be_zero(self) -> bool {
        self.is_unknown() || self.mid.abs() <= self.rad
    }

    /// The quotient; `None` when the divisor may be 0.
    pub fn over(self, divisor: Self) -> Option<Self> {
        if divisor.may_be_zero() {
            return None;
        }
        let mid = self.mid / divisor.mid;
        // |x/y - mid| = |(x - X) - mid (y - Y)| / |y|, with |y| at least |Y| less its radius.
        Some(Self { mid, rad: (self.rad + mid.abs() * divisor.rad) / (divisor.mid.abs() - divisor.rad) })
    }

    /// The greater one, that is, a number that neither exceeds by more than the radius.
    pub fn max(self, other: Self) -> Self {
        // f64::max would drop a NaN.
        let mid = if self.mid.is_nan() || self.mid > other.mid { self.mid } else { other.mid };
        Self { mid, rad: self.rad.max(other.rad) }
    }

    /// The lesser one.
    pub fn min(self, other: Self) -> Self {
        -((-self).max(-other))
    }
}

/// Numbers without a radius.
pub fn exact<const N: usize>(values: [f64; N]) -> [Ball; N] {
    values.map(Ball::from)
}

/// `N` output words from `at` on. A word that the lane did not give is NaN.
pub fn outputs<const N: usize>(observed: &Observed, at: usize) -> [Ball; N] {
    std::array::from_fn(|k| match (observed.words.get(at + k), observed.slack.get(at + k)) {
        (Some(&mid), Some(&rad)) => Ball { mid, rad: if rad.is_finite() { rad } else { f64::INFINITY } },
        _ => Ball { mid: f64::NAN, rad: 0.0 },
    })
}

/// One output word.
pub fn output(observed: &Observed, at: usize) -> Ball {
    let [ball] = outputs(observed, at);
    ball
}

/// Sum of two vectors, the second one scaled by an exact number.
pub fn plus<const N: usize>(a: [Ball; N], b: [Ball; N], scale: f64) -> [Ball; N] {
    std::array::from_fn(|k| a[k] + b[k] * scale)
}

/// Difference of two vectors.
pub fn minus<const N: usize>(a: [Ball; N], b: [Ball; N]) -> [Ball; N] {
    plus(a, b, -1.0)
}

/// Scalar product.
pub fn dot<const N: usize>(a: [Ball; N], b: [Ball; N]) -> Ball {
    a.into_iter().zip(b).fold(Ball::from(0.0), |sum, (a, b)| sum + a * b)
}

/// Length of a vector. Its radius is no more than the length of the vector of radii.
pub fn length<const N: usize>(a: [Ball; N]) -> Ball {
    let norm = |part: fn(Ball) -> f64| a.map(part).iter().map(|x| x * x).sum::<f64>().sqrt();
    Ball { mid: norm(|b| b.mid), rad: norm(|b| b.rad) }
}

/// Vector product.
pub fn cross(a: [Ball; 3], b: [Ball; 3]) -> [Ball; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i] * b[j] - a[j] * b[i]
    })
}

/// Unit vector of this direction; `None` when the vector may be zero.
pub fn direction(a: [Ball; 3]) -> Option<[Ball; 3]> {
    let length = length(a);
    if length.may_be_zero() {
        return None;
    }
    // |a/|a| - b/|b|| is at most 2 |a-b| / max(|a|, |b|).
    let rad = 2.0 * length.rad / length.mid;
    Some(a.map(|x| Ball { mid: x.mid / length.mid, rad }))
}

/// The first three components.
pub fn xyz(a: [Ball; 4]) -> [Ball; 3] {
    [a[0], a[1], a[2]]
}

/// The homogeneous divide; `None` when w may be 0.
pub fn real(a: [Ball; 4]) -> Option<[Ball; 3]> {
    Some([a[0].over(a[3])?, a[1].over(a[3])?, a[2].over(a[3])?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;

    /// A ball and a number in it, at the edge half of the time.
    fn ball(rng: &mut Stream) -> (Ball, f64) {
        let ball = Ball { mid: rng.between(-3.0, 3.0), rad: rng.unit() * 0.4 };
        let at = [rng.between(-1.0, 1.0), 1.0, -1.0][(rng.bits() % 3) as usize];
        (ball, ball.mid + at * ball.rad)
    }

    fn holds(ball: Ball, value: f64) -> bool {
        (ball.mid - value).abs() <= ball.rad * (1.0 + 1e-12) + 1e-12
    }

    #[test]
    fn results_hold_every_result_of_their_operands() {
        let mut rng = Stream::new(5);
        for _ in 0..5000 {
            let ((a, x), (b, y), (c, z)) = (ball(&mut rng), ball(&mut rng), ball(&mut rng));
            assert!(holds(a + b, x + y) && holds(a - b, x - y) && holds(a * b, x * y) && holds(a * -1.5, x * -1.5));
            assert!(holds(a.max(b), x.max(y)) && holds(a.min(b), x.min(y)));
            if let Some(quotient) = a.over(b) {
                assert!(holds(quotient, x / y), "{a:?} {b:?} {x} {y}");
            }
            let norm = (x * x + y * y + z * z).sqrt();
            assert!(holds(length([a, b, c]), norm));
            if let Some(unit) = direction([a, b, c]) {
                assert!(holds(unit[0], x / norm) && holds(unit[1], y / norm) && holds(unit[2], z / norm));
            }
        }
    }

    #[test]
    fn nan_goes_through_everything() {
        let nan = Ball { mid: f64::NAN, rad: 0.0 };
        let one = Ball::from(1.0);
        assert!(nan.max(one).mid.is_nan() && one.max(nan).mid.is_nan() && one.min(nan).mid.is_nan());
        assert!(one.over(nan).is_some_and(|b| b.mid.is_nan()));
        assert!(direction([nan, one, one]).is_some_and(|d| d[1].mid.is_nan()));
        let missing = Observed { vertices: 1, words: vec![1.0], slack: vec![0.0] };
        assert!(output(&missing, 1).mid.is_nan());
    }

    #[test]
    fn the_unknown_stays_unknown_but_for_a_factor_of_zero() {
        let observed = Observed { vertices: 1, words: vec![1.0, f64::NAN], slack: vec![f64::NAN, f64::INFINITY] };
        for unknown in outputs::<2>(&observed, 0) {
            let one = Ball { mid: 1.0, rad: 0.1 };
            assert!((unknown + one).is_unknown() && (one - unknown).is_unknown() && unknown.may_be_zero());
            assert_eq!((unknown * 0.0).rad, 0.0);
        }
        assert!((output(&observed, 0) * Ball { mid: 2.0, rad: 0.1 }).is_unknown());
    }

    #[test]
    fn a_divisor_around_zero_gives_no_quotient() {
        assert!(Ball::from(1.0).over(Ball { mid: 1e-3, rad: 1e-2 }).is_none());
        assert!(direction([Ball { mid: 1e-3, rad: 1e-2 }; 3]).is_none());
    }
}
