//! Scalar functions with their derivatives over an interval of arguments.
//!
//! For an exact argument x and what a device may have instead, anything within a radius of it, an image
//! holds the exact value, how far the function moves within the radius, the derivative at x, and how
//! far the derivative moves. Infinite where the interval reaches a place without value.

use crate::profile::Op;

/// A function of one argument over x ± radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Image1 {
    pub value: f64,
    /// Bound on |f(x') − f(x)|.
    pub moves: f64,
    /// f'(x).
    pub slope: f64,
    /// Bound on |f'(x') − f'(x)|.
    pub bends: f64,
}

/// A function of two arguments over x ± radius and y ± radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Image2 {
    pub value: f64,
    pub moves: f64,
    pub slopes: [f64; 2],
    pub bends: [f64; 2],
}

/// True for a function whose results are not negative.
pub(super) fn is_not_negative(op: Op) -> bool {
    matches!(op, Op::Abs | Op::Sqrt | Op::InverseSqrt | Op::Exp | Op::Exp2 | Op::Cosh | Op::Fract)
}

/// The same for a function of two numbers, of which each may be known not to be negative.
pub(super) fn is_not_negative_of(op: Op, [left, right]: [bool; 2]) -> bool {
    match op {
        Op::Pow => true,
        Op::Div | Op::Min => left && right,
        // `max(x, 0.0)` has no sign, whatever that of x is.
        Op::Max => left || right,
        _ => false,
    }
}

/// Beside a jump there is no derivative: the whole movement counts as an error of the operation.
const JUMP: f64 = f64::INFINITY;

/// Derivatives are taken at the ends of the interval. Where they are not monotone between them they
/// still move by less than this factor more, since the intervals are short.
const SLACK: f64 = 2.0;

const LN_2: f64 = std::f64::consts::LN_2;

/// A function that is constant between jumps.
fn stairs(f: impl Fn(f64) -> f64, x: f64, e: f64) -> Image1 {
    let (value, lo, hi) = (f(x), f(x - e), f(x + e));
    if lo == hi {
        Image1 { value, moves: 0.0, slope: 0.0, bends: 0.0 }
    } else {
        Image1 { value, moves: (value - lo).abs().max((hi - value).abs()), slope: 0.0, bends: JUMP }
    }
}

/// A monotone function with a derivative; both are NaN outside of the domain. The derivative grows on one side of 0 and falls on
/// the other, as those of all functions here do that are even.
fn smooth(f: impl Fn(f64) -> f64, df: impl Fn(f64) -> f64, x: f64, e: f64) -> Image1 {
    let (value, slope) = (f(x), df(x));
    if e == 0.0 {
        return Image1 { value, moves: 0.0, slope, bends: 0.0 };
    }
    let ends = |at: f64, g: &dyn Fn(f64) -> f64| (g(x - e) - at).abs().max((g(x + e) - at).abs());
    // `max` drops a NaN: an end outside of the domain has to be seen.
    let outside = f(x - e).is_nan() || f(x + e).is_nan();
    let moves = if outside { f64::INFINITY } else { ends(value, &f) };
    // Rounding of binary64 may hide a small movement; the derivative does not.
    let moves = moves.max(slope.abs() * e);
    let middle = if (x - e) * (x + e) < 0.0 { (df(0.0) - slope).abs() } else { 0.0 };
    let outside = outside || df(x - e).is_nan() || df(x + e).is_nan();
    let bends = if outside { JUMP } else { SLACK * ends(slope, &df).max(middle) };
    Image1 { value, moves, slope, bends }
}

/// The image of a function of one argument. `not_negative`: rounding leaves the argument's sign.
#[inline(always)]
pub(super) fn image1(op: Op, x: f64, e: f64, not_negative: bool) -> Image1 {
    match op {
        Op::Abs => {
            let straddles = x.abs() <= e && e > 0.0;
            let slope = if x < 0.0 { -1.0 } else { 1.0 };
            Image1 { value: x.abs(), moves: e, slope, bends: if straddles { 2.0 } else { 0.0 } }
        }
        Op::Sign => stairs(|x| if x == 0.0 { 0.0 } else { x.signum() }, x, e),
        Op::Floor => stairs(f64::floor, x, e),
        Op::Ceil => stairs(f64::ceil, x, e),
        Op::Trunc => stairs(f64::trunc, x, e),
        Op::RoundEven => stairs(f64::round_ties_even, x, e),
        Op::Fract => {
            if (x - e).floor() == (x + e).floor() {
                Image1 { value: x - x.floor(), moves: e, slope: 1.0, bends: 0.0 }
            } else {
                Image1 { value: x - x.floor(), moves: 1.0, slope: 0.0, bends: JUMP }
            }
        }
        Op::Sqrt => root(x, e, not_negative),
        Op::InverseSqrt => inverse_root(x, e),
        Op::Radians => linear(std::f64::consts::PI / 180.0, x, e),
        Op::Degrees => linear(180.0 / std::f64::consts::PI, x, e),
        Op::Sin => {
            let (value, slope) = (number::SIN.value(x), number::COS.value(x));
            Image1 { value, moves: e.min(2.0), slope, bends: e.min(2.0) }
        }
        Op::Cos => {
            let (sin, value) = (number::SIN.value(x), number::COS.value(x));
            Image1 { value, moves: e.min(2.0), slope: -sin, bends: e.min(2.0) }
        }
        Op::Tan => {
            // A pole between the ends.
            let turn = std::f64::consts::PI;
            let branch = |x: f64| (x / turn + 0.5).floor();
            if branch(x - e) != branch(x + e) {
                return Image1 { value: number::TAN.value(x), moves: f64::INFINITY, slope: 0.0, bends: JUMP };
            }
            let tan = |x: f64| number::TAN.value(x);
            let image = smooth(tan, |x| 1.0 + tan(x) * tan(x), x, e);
            // Where the branch crosses 0 the slope is 1.
            let crosses = tan(x - e) * tan(x + e) < 0.0;
            let bends = if crosses { image.bends.max(SLACK * (1.0 - image.slope).abs()) } else { image.bends };
            Image1 { bends, ..image }
        }
        Op::Asin => smooth(|x| number::ASIN.value(x), |x| 1.0 / (1.0 - x * x).sqrt(), x, e),
        Op::Acos => smooth(|x| number::ACOS.value(x), |x| -1.0 / (1.0 - x * x).sqrt(), x, e),
        Op::Atan => smooth(|x| number::ATAN.value(x), |x| 1.0 / (1.0 + x * x), x, e),
        Op::Sinh => smooth(f64::sinh, f64::cosh, x, e),
        Op::Cosh => {
            let image = smooth(f64::cosh, f64::sinh, x, e);
            // Not monotone across 0, but never farther off than by the slope at the larger end.
            Image1 { moves: image.moves.max(e * (x.abs() + e).sinh()), ..image }
        }
        Op::Tanh => smooth(f64::tanh, |x| 1.0 - x.tanh() * x.tanh(), x, e),
        Op::Asinh => smooth(|x| Op::Asinh.exact(&[x]), |x| 1.0 / (x * x + 1.0).sqrt(), x, e),
        Op::Acosh => smooth(|x| Op::Acosh.exact(&[x]), |x| 1.0 / (x * x - 1.0).sqrt(), x, e),
        Op::Atanh => smooth(|x| Op::Atanh.exact(&[x]), |x| 1.0 / (1.0 - x * x), x, e),
        Op::Exp => power(number::EXP.value(x), 1.0, e),
        Op::Exp2 => power(number::EXP2.value(x), LN_2, e),
        Op::Log => logarithm(number::LN.value(x), 1.0, x, e),
        Op::Log2 => logarithm(number::LOG2.value(x), LN_2, x, e),
        // Not functions of one argument.
        _ => Image1 { value: f64::NAN, moves: f64::INFINITY, slope: 0.0, bends: JUMP },
    }
}

fn linear(factor: f64, x: f64, e: f64) -> Image1 {
    Image1 { value: x * factor, moves: e * factor, slope: factor, bends: 0.0 }
}

/// b^x with the natural logarithm of b, b > 1.
fn power(value: f64, ln: f64, e: f64) -> Image1 {
    let moves = if e == 0.0 { 0.0 } else { value * number::exp_m1(ln * e) };
    Image1 { value, moves, slope: ln * value, bends: ln * moves }
}

/// ln x divided by `ln`.
fn logarithm(value: f64, ln: f64, x: f64, e: f64) -> Image1 {
    if x <= e || x <= 0.0 {
        let value = if x < 0.0 { f64::NAN } else { value };
        return Image1 { value, moves: f64::INFINITY, slope: 0.0, bends: JUMP };
    }
    let (slope, most) = (1.0 / (x * ln), 1.0 / ((x - e) * ln));
    Image1 { value, moves: e * most, slope, bends: e * most / x }
}

/// 1/√x.
#[inline(always)]
fn inverse_root(x: f64, e: f64) -> Image1 {
    let (value, least) = (1.0 / x.sqrt(), x - e);
    let slope = -0.5 * value / x;
    let most = 1.0 / least.sqrt();
    // f(x − e) − f(x), free of cancellation.
    let moves = e * most * value / (x.sqrt() + least.sqrt());
    // 1.5 e times the second derivative at its largest.
    let bends = 0.75 * e * most / (least * least);
    let nowhere = (x <= e) | (x <= 0.0);
    let or = |other: f64, here: f64| if nowhere { other } else { here };
    // At −0 the value is that at 0.
    let value = if x == 0.0 { f64::INFINITY } else { value };
    Image1 { value, moves: or(f64::INFINITY, moves), slope: or(0.0, slope), bends: or(JUMP, bends) }
}

/// √x. At 0 there is no derivative, but a value: the movement is bounded all the same.
#[inline(always)]
fn root(x: f64, e: f64, not_negative: bool) -> Image1 {
    let (value, least) = (x.sqrt(), (x - e).sqrt());
    // 1/(2√(x−e)) − 1/(2√x) = e / (2 √x √(x−e) (√x + √(x−e)))
    let bends = e / (2.0 * value * least * (value + least));
    let (moves, slope) = (e / (value + least), 0.5 / value);
    let smooth = x > e;
    // A device whose argument is below 0 gives no number.
    let whole = value.max((x + e).sqrt() - value);
    let whole = if not_negative & (x >= 0.0) { whole } else { f64::INFINITY };
    let zero = (x == 0.0) & (e == 0.0);
    let or = |zeros: f64, other: f64, here: f64| {
        let other = if zero { zeros } else { other };
        if smooth { here } else { other }
    };
    let value = if zero { 0.0 } else { value };
    Image1 { value, moves: or(0.0, whole, moves), slope: or(0.0, 0.0, slope), bends: or(0.0, JUMP, bends) }
}

/// x/y.
#[inline(always)]
fn quotient(x: f64, ex: f64, y: f64, ey: f64) -> Image2 {
    let (value, size) = (x / y, y.abs());
    let least = size - ey;
    let nowhere = (size <= ey) | (size == 0.0);
    let or = |other: f64, here: f64| if nowhere { other } else { here };
    // |x'/y'² − x/y²|, by the movement of x and then of y.
    let bend = ex / (least * least) + x.abs() * ey * (size + least) / (size * size * least * least);
    Image2 {
        value,
        moves: or(f64::INFINITY, (x.abs() / size * ey + ex) / least),
        slopes: [or(0.0, 1.0 / y), or(0.0, -value / y)],
        bends: [or(JUMP, ey / (size * least)), or(JUMP, bend)],
    }
}

/// The image of a function of two arguments.
#[inline(always)]
pub(super) fn image2(op: Op, (x, ex): (f64, f64), (y, ey): (f64, f64)) -> Image2 {
    let nowhere = |value: f64| Image2 { value, moves: f64::INFINITY, slopes: [0.0, 0.0], bends: [JUMP, JUMP] };
    match op {
        Op::Div => quotient(x, ex, y, ey),
        Op::Min | Op::Max => {
            let takes_y = if op == Op::Min { y < x } else { x < y };
            // A radius that is no number says nothing about which of the two is taken.
            let lost = (ex + ey).is_nan();
            let straddles = ((x - y).abs() <= ex + ey && ex + ey > 0.0) || lost;
            let bend = if straddles { 1.0 } else { 0.0 };
            let moves = if lost {
                f64::INFINITY
            } else if straddles {
                ex.max(ey)
            } else if takes_y {
                ey
            } else {
                ex
            };
            Image2 {
                value: if takes_y { y } else { x },
                moves,
                slopes: if takes_y { [0.0, 1.0] } else { [1.0, 0.0] },
                bends: [bend, bend],
            }
        }
        Op::Step => {
            let value = if y < x { 0.0 } else { 1.0 };
            if (x - y).abs() <= ex + ey && ex + ey > 0.0 {
                return Image2 { moves: 1.0, ..nowhere(value) };
            }
            Image2 { value, moves: 0.0, slopes: [0.0, 0.0], bends: [0.0, 0.0] }
        }
        Op::Rem => {
            let value = x % y;
            let (quotient, size) = (x / y, y.abs());
            let reach = (x.abs() / size * ey + ex) / (size - ey);
            if size <= ey || (quotient - reach).trunc() != (quotient + reach).trunc() {
                // From one multiple to the next, and on both sides of 0 where the dividend may have either sign.
                let across = if x.abs() <= ex { value.abs() } else { 0.0 };
                return if size > ey { Image2 { moves: size + ey + across, ..nowhere(value) } } else { nowhere(value) };
            }
            let whole = quotient.trunc();
            Image2 { value, moves: ex + whole.abs() * ey, slopes: [1.0, -whole], bends: [0.0, 0.0] }
        }
        Op::Pow => {
            let value = if x < 0.0 { f64::NAN } else { number::POW.value(x, y) };
            if x <= ex || x <= 0.0 {
                return nowhere(value);
            }
            // x^y = exp(y ln x): how far the exponent moves.
            let ln = number::LN.value(x);
            let along = ex / (x - ex);
            let moved = y.abs() * along + ey * (ln.abs() + along);
            let moves = if moved == 0.0 { 0.0 } else { value * number::exp_m1(moved) };
            let most = value + moves;
            Image2 {
                value,
                moves,
                slopes: [y * value / x, ln * value],
                bends: [
                    (y.abs() * moves + ey * most) / (x - ex) + y.abs() * value * along / x,
                    ln.abs() * moves + along * most,
                ],
            }
        }
        Op::Atan2 => {
            // x is the ordinate, as in atan(y, x) of GLSL.
            let value = number::ATAN2.value(x, y);
            let (size, reach) = ((x * x + y * y).sqrt(), (ex * ex + ey * ey).sqrt());
            let cut = y - ey < 0.0 && x.abs() <= ex && ex > 0.0;
            if size <= reach || size == 0.0 {
                return nowhere(value);
            }
            if cut {
                return Image2 { moves: std::f64::consts::TAU, ..nowhere(value) };
            }
            let least = size - reach;
            let bend = reach * (size + least) / (least * least * size);
            Image2 {
                value,
                moves: reach / least,
                slopes: [y / (size * size), -x / (size * size)],
                bends: [SLACK * bend, SLACK * bend],
            }
        }
        _ => nowhere(f64::NAN),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points spread over x ± e, the ends included.
    fn around(x: f64, e: f64) -> impl Iterator<Item = f64> {
        (-8..=8).map(move |k| x + e * f64::from(k) / 8.0)
    }

    const ONES: [Op; 28] = [
        Op::Abs,
        Op::Sign,
        Op::Floor,
        Op::Ceil,
        Op::Trunc,
        Op::RoundEven,
        Op::Fract,
        Op::Sqrt,
        Op::InverseSqrt,
        Op::Radians,
        Op::Degrees,
        Op::Sin,
        Op::Cos,
        Op::Tan,
        Op::Asin,
        Op::Acos,
        Op::Atan,
        Op::Sinh,
        Op::Cosh,
        Op::Tanh,
        Op::Asinh,
        Op::Acosh,
        Op::Atanh,
        Op::Exp,
        Op::Exp2,
        Op::Log,
        Op::Log2,
        Op::Abs,
    ];
    const TWOS: [Op; 7] = [Op::Div, Op::Min, Op::Max, Op::Step, Op::Rem, Op::Pow, Op::Atan2];

    /// The largest step of a numeric derivative is this part of the value.
    const STEP: f64 = 1e-6;

    #[test]
    fn no_value_within_the_radius_is_farther_than_the_image_says() {
        for op in ONES {
            for x in [-2.5, -1.0, -0.7, -0.01, 0.0, 1e-9, 0.3, 0.9999, 1.0, 1.5, 1.6, 3.0, 88.0] {
                for e in [0.0, 1e-9, 1e-4, 0.05, 1.5, 8.0] {
                    let image = image1(op, x, e, false);
                    if image.value.is_nan() || image.moves == f64::INFINITY {
                        continue;
                    }
                    for near in around(x, e) {
                        let moved = (image1(op, near, 0.0, false).value - image.value).abs();
                        let allowed = image.moves * (1.0 + 1e-9) + 4e-16 + 1e-14 * image.value.abs();
                        assert!(moved <= allowed, "{op:?}({x} ± {e}) at {near}: {moved} > {}", image.moves);
                    }
                }
            }
        }
    }

    #[test]
    fn slopes_are_derivatives_and_bend_no_more_than_the_image_says() {
        for op in ONES {
            for x in [-2.5, -0.7, 0.3, 0.8, 1.3, 2.7] {
                for e in [1e-6, 1e-3, 0.02, 0.7, 5.0] {
                    let image = image1(op, x, e, false);
                    if !image.bends.is_finite() || image.value.is_nan() {
                        continue;
                    }
                    for near in around(x, e) {
                        let f = |x: f64| image1(op, x, 0.0, false).value;
                        let slope = (f(near + STEP) - f(near - STEP)) / (2.0 * STEP);
                        let off = (slope - image.slope).abs();
                        // What the numeric derivative itself is worth.
                        let noise = 1e-6 * (1.0 + slope.abs());
                        assert!(off <= image.bends + noise, "{op:?}({x} ± {e}) at {near}: {off} > {}", image.bends);
                    }
                }
            }
        }
    }

    #[test]
    fn functions_of_two_arguments_stay_within_their_image() {
        for op in TWOS {
            for x in [-2.0, -0.3, 0.0, 0.7, 1.0, 5.3] {
                for y in [-3.0, -1.0, 0.2, 1.0, 4.0] {
                    for (ex, ey) in [
                        (0.0, 0.0),
                        (1e-6, 0.0),
                        (0.0, 1e-6),
                        (1e-3, 1e-2),
                        (0.05, 0.05),
                        (1.5, 0.1),
                        (0.1, 0.9),
                        (4.0, 4.0),
                    ] {
                        let image = image2(op, (x, ex), (y, ey));
                        if image.value.is_nan() || image.moves == f64::INFINITY {
                            continue;
                        }
                        let f = |x, y| image2(op, (x, 0.0), (y, 0.0)).value;
                        for (near_x, near_y) in around(x, ex).flat_map(|a| around(y, ey).map(move |b| (a, b))) {
                            let moved = (f(near_x, near_y) - image.value).abs();
                            let allowed = image.moves * (1.0 + 1e-9) + 1e-13 * image.value.abs();
                            assert!(moved <= allowed, "{op:?}({x} ± {ex}, {y} ± {ey}): {moved} > {}", image.moves);
                            if !image.bends.iter().all(|b| b.is_finite()) {
                                continue;
                            }
                            let slopes = [
                                (f(near_x + STEP, near_y) - f(near_x - STEP, near_y)) / (2.0 * STEP),
                                (f(near_x, near_y + STEP) - f(near_x, near_y - STEP)) / (2.0 * STEP),
                            ];
                            for k in 0..2 {
                                let off = (slopes[k] - image.slopes[k]).abs();
                                let noise = 1e-5 * (1.0 + slopes[k].abs());
                                // A kink between the steps has no derivative.
                                let kink =
                                    matches!(op, Op::Min | Op::Max | Op::Step) && (near_x - near_y).abs() <= 2.0 * STEP;
                                let quotient = near_x / near_y;
                                let kink = kink
                                    || op == Op::Rem && (quotient - quotient.round()).abs() < 1e-4
                                    || op == Op::Atan2 && near_x.abs() <= 2.0 * STEP && near_y < 0.0;
                                let ok = kink || off <= image.bends[k] + noise;
                                assert!(ok, "{op:?} slope {k} at ({near_x}, {near_y}): {off} > {}", image.bends[k]);
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn a_root_at_zero_has_a_movement_and_no_slope() {
        let image = image1(Op::Sqrt, 0.0, 1e-14, true);
        assert!((image.moves - 1e-7).abs() < 1e-15 && !image.bends.is_finite());
        assert_eq!(image1(Op::Sqrt, 0.0, 1e-14, false).moves, f64::INFINITY, "the device may have −1e-14");
        assert_eq!(image1(Op::Sqrt, 0.0, 0.0, false).moves, 0.0);
    }

    #[test]
    fn nothing_is_said_across_a_pole_or_outside_of_a_domain() {
        for (op, x, e) in [
            (Op::InverseSqrt, 1e-3, 1e-3),
            (Op::Log2, 1e-3, 2e-3),
            (Op::Acos, 1.0, 1e-7),
            (Op::Asin, -1.0, 1e-7),
            (Op::Tan, std::f64::consts::FRAC_PI_2, 1e-7),
            (Op::Acosh, 1.0, 1e-7),
            (Op::Atanh, 1.0 - 1e-9, 1e-7),
        ] {
            assert_eq!(image1(op, x, e, false).moves, f64::INFINITY, "{op:?}");
        }
        assert_eq!(image2(Op::Div, (1.0, 0.0), (1e-7, 1e-7)).moves, f64::INFINITY);
        assert_eq!(image2(Op::Atan2, (1e-8, 1e-7), (-1.0, 0.0)).moves, std::f64::consts::TAU, "across the cut");
    }
}
