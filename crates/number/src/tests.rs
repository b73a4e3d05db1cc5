//! Every function against numbers of 192 bits and more.

use astro_float::{BigFloat, Consts, RoundingMode};
use pulp::Arch;

use super::*;

const BITS: usize = 192;
const ROUND: RoundingMode = RoundingMode::ToEven;

/// Arithmetic with many bits.
struct Wide(Consts);

impl Wide {
    fn new() -> Self {
        Self(Consts::new().expect("there is memory for constants"))
    }

    fn of(x: f64) -> BigFloat {
        if x.is_normal() || x == 0.0 {
            return BigFloat::from_f64(x, BITS);
        }
        // The library takes subnormal numbers for others.
        let mut wide = BigFloat::from_f64(x * 2f64.powi(200), BITS);
        let exponent = wide.exponent().unwrap_or_default();
        wide.set_exponent(exponent - 200);
        wide
    }

    /// a^b. The library's own `pow` does not end where the result is exact.
    fn power(&mut self, a: f64, b: f64) -> BigFloat {
        let more = 2 * BITS;
        let log = Self::of(a).ln(more, ROUND, &mut self.0);
        log.mul(&Self::of(b), more, ROUND).exp(BITS, ROUND, &mut self.0)
    }

    /// The angle of the point (x, y), both not 0.
    fn angle(&mut self, y: f64, x: f64) -> BigFloat {
        let more = 2 * BITS;
        let angle = Self::of(y).div(&Self::of(x), more, ROUND).atan(more, ROUND, &mut self.0);
        let pi = self.0.pi(more, ROUND);
        match (x < 0.0, y < 0.0) {
            (false, _) => angle,
            (true, false) => angle.add(&pi, more, ROUND),
            (true, true) => angle.sub(&pi, more, ROUND),
        }
    }
}

/// A fraction in [½, 1) with its sign and an exponent; (0, 0) for zero.
fn fraction(x: &BigFloat) -> (f64, i32) {
    let (words, _, sign, exponent, _) = x.as_raw_parts().expect("the reference is a number");
    if x.is_zero() {
        return (0.0, 0);
    }
    let top = words[words.len() - 1] as f64 / 2f64.powi(64);
    (if sign.is_negative() { -top } else { top }, exponent)
}

/// How far `value` is from the reference, in ULP of binary64 at the reference.
fn error(value: f64, exact: &BigFloat) -> f64 {
    let (sign, exponent) = fraction(exact);
    if !value.is_finite() {
        let overflows = exponent > 1024 && value == sign.signum() * f64::INFINITY;
        return if overflows { 0.0 } else { f64::INFINITY };
    }
    let (difference, size) = fraction(&exact.sub(&Wide::of(value), BITS, ROUND));
    difference.abs() * 2f64.powi((size - (exponent - 53).max(-1074)).clamp(-1000, 1000))
}

/// Numbers of all binades from 2^`from` up, of both signs if `signed`.
fn binades(range: std::ops::Range<i32>, each: u64, signed: bool) -> Vec<f64> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut numbers = Vec::new();
    for exponent in range {
        for k in 0..each {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            // The significand of a power of two first, but for subnormal numbers: no zero.
            let significand = if k == 0 && exponent > -1023 { 0 } else { state >> 12 };
            let bits = ((exponent + 1023).max(0) as u64) << 52 | significand;
            let x = f64::from_bits(bits);
            numbers.push(x);
            if signed {
                numbers.push(-x);
            }
        }
    }
    numbers
}

/// Neighbours of a number, and itself.
fn around(x: f64) -> [f64; 3] {
    [x, x.next_up(), x.next_down()]
}

type Reference = fn(&BigFloat, &mut Wide) -> BigFloat;

/// The largest error of a function, and where.
fn worst(function: &Unary, x: &[f64], exact: Reference) -> (f64, f64) {
    let mut values = vec![0.0; x.len()];
    function.column(x, &mut values);
    let mut wide = Wide::new();
    let errors = x.iter().zip(&values).map(|(&x, &value)| (error(value, &exact(&Wide::of(x), &mut wide)), x));
    errors.fold((0.0, 0.0), |worst, next| if next.0 > worst.0 { next } else { worst })
}

/// Angles of all sizes, and those next to multiples of π/2.
fn angles() -> Vec<f64> {
    let mut x = binades(-40..24, 12, true);
    x.extend(binades(24..1024, 1, true));
    x.extend((1..400).chain([83_442, 83_443, 83_444, 1 << 20]).flat_map(|n| around(f64::from(n) * HALF_PI)));
    // The number of binary64 nearest to a multiple of π/2, and where the way to reduce changes.
    x.extend([6_381_956_970_095_103.0 * 2f64.powi(797), f64::MAX]);
    x.extend(around(reduction::LIMIT));
    x
}

const HALF_PI: f64 = std::f64::consts::FRAC_PI_2;

/// The largest error of a function of two numbers.
fn worst_of_two(function: &Binary, a: &[f64], b: &[f64], exact: impl Fn(f64, f64, &mut Wide) -> BigFloat) -> f64 {
    let mut values = vec![0.0; a.len()];
    function.column(a, b, &mut values);
    let mut wide = Wide::new();
    let errors = a.iter().zip(b).zip(&values).map(|((&a, &b), &value)| error(value, &exact(a, b, &mut wide)));
    errors.fold(0.0, f64::max)
}

/// 1 and its neighbourhood, at all distances.
fn near_one() -> Vec<f64> {
    binades(-52..-1, 6, true).into_iter().map(|x| 1.0 + x).collect()
}

/// Checks an error against the table of the documentation: it is not exceeded, and not by far more
/// than was found.
fn expect(name: &str, found: f64, documented: f64) {
    assert!(found <= documented, "{name} errs by {found} ULP, more than the {documented} of the documentation");
    assert!(found >= 0.7 * documented, "{name} errs by {found} ULP: the documentation says {documented}, too much");
}

#[test]
fn errors_are_those_of_the_documentation() {
    let signed = |range, each| binades(range, each, true);
    let positive = [binades(-1050..1024, 1, false), near_one(), binades(-3..3, 200, false)].concat();
    let inner = near_one().into_iter().filter(|x| *x < 1.0);
    let fractions: Vec<f64> = signed(-30..0, 30).into_iter().chain(inner.flat_map(|x| [x, -x])).collect();
    let exponents = |limit: f64| {
        let mut x = [signed(-60..0, 8), signed(0..9, 100)].concat();
        x.extend((0..4000).map(|k| limit * (f64::from(k) / 2000.0 - 1.0)));
        x
    };
    let slopes = [signed(-1050..-4, 1), signed(-4..4, 300), signed(4..80, 4)].concat();
    let cases: [(&str, Unary, Vec<f64>, Reference, f64); 10] = [
        ("sin", SIN, angles(), |x, w| x.sin(BITS, ROUND, &mut w.0), 0.75),
        ("cos", COS, angles(), |x, w| x.cos(BITS, ROUND, &mut w.0), 0.75),
        ("tan", TAN, angles(), |x, w| x.tan(BITS, ROUND, &mut w.0), 1.9),
        ("asin", ASIN, fractions.clone(), |x, w| x.asin(BITS, ROUND, &mut w.0), 0.6),
        ("acos", ACOS, fractions, |x, w| x.acos(BITS, ROUND, &mut w.0), 0.7),
        ("atan", ATAN, slopes, |x, w| x.atan(BITS, ROUND, &mut w.0), 1.4),
        ("exp", EXP, exponents(745.0), |x, w| x.exp(BITS, ROUND, &mut w.0), 0.85),
        ("exp2", EXP2, exponents(1074.0), |x, w| Wide::of(2.0).pow(x, BITS, ROUND, &mut w.0), 1.0),
        ("ln", LN, positive.clone(), |x, w| x.ln(BITS, ROUND, &mut w.0), 0.8),
        ("log2", LOG2, positive, |x, w| x.log2(BITS, ROUND, &mut w.0), 0.65),
    ];
    for (name, function, x, exact, documented) in cases {
        let (ulp, at) = worst(&function, &x, exact);
        expect(&format!("{name} at {at:e}"), ulp, documented);
    }
}

#[test]
fn errors_of_functions_of_two_numbers_are_those_of_the_documentation() {
    let (mut bases, mut exponents) = (Vec::new(), Vec::new());
    let spread = binades(-1050..1024, 1, false).into_iter().step_by(16);
    for a in spread.chain(binades(-2..2, 8, false)).chain(near_one().into_iter().step_by(8)).filter(|a| *a != 1.0) {
        let reach = (0..12).map(|k| (f64::from(k) * 180.0 - 1060.0) / a.log2());
        for b in [0.5, -1.0, 2.0, 1.0 / 3.0, -16.0, 1e-3].into_iter().chain(reach) {
            bases.push(a);
            exponents.push(b);
        }
    }
    let found = worst_of_two(&POW, &bases, &exponents, |a, b, wide| wide.power(a, b));
    let mut points = binades(-3..3, 6, true);
    points.extend(binades(-1074..1024, 1, true).into_iter().step_by(97));
    points.extend([f64::MAX, 5e-324, 15e-324, -25e-324]);
    let heights: Vec<f64> = points.iter().flat_map(|&y| points.iter().map(move |_| y)).collect();
    let widths: Vec<f64> = points.iter().flat_map(|_| points.iter().copied()).collect();
    let angles = worst_of_two(&ATAN2, &heights, &widths, |y, x, wide| wide.angle(y, x));
    expect("pow", found, 1.1);
    expect("atan2", angles, 1.4);
}

#[test]
fn an_error_of_one_number_in_the_last_place_shows() {
    let exact: Reference = |x, w| x.sin(BITS, ROUND, &mut w.0);
    let x = 0.7;
    let sine = SIN.value(x);
    let wide = exact(&Wide::of(x), &mut Wide::new());
    assert!(error(sine, &wide) < 1.0 && error(sine.next_up().next_up(), &wide) > 1.0);
    assert!(error(f64::NAN, &wide) == f64::INFINITY && error(f64::INFINITY, &wide) == f64::INFINITY);
    // A subnormal number is measured by its own distance to the next.
    assert_eq!(error(5e-324, &Wide::of(15e-324)), 2.0);
}

type Scalar = fn(f64) -> f64;

const ALL: [(Unary, Scalar); 10] = [
    (SIN, f64::sin),
    (COS, f64::cos),
    (TAN, f64::tan),
    (ASIN, f64::asin),
    (ACOS, f64::acos),
    (ATAN, f64::atan),
    (EXP, f64::exp),
    (EXP2, f64::exp2),
    (LN, f64::ln),
    (LOG2, f64::log2),
];

/// Numbers at which functions have values of their own.
const EDGES: [f64; 14] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
    5e-324,
    -5e-324,
    f64::MIN_POSITIVE,
    f64::MAX,
    f64::MIN,
    1.5,
    -1.5,
];

/// Bits, all NaN alike.
fn bits(x: f64) -> u64 {
    if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() }
}

/// True for the same bits, or for two roundings of a number that is neither 0 nor infinite.
fn agree(value: f64, due: f64) -> bool {
    bits(value) == bits(due) || (due != 0.0 && due.is_finite() && (value - due).abs() <= 4e-16 * due.abs())
}

#[test]
fn edges_are_those_of_the_standard_library() {
    for (k, (function, library)) in ALL.into_iter().enumerate() {
        for x in EDGES {
            assert!(agree(function.value(x), library(x)), "function {k} at {x:e}: {:e}", function.value(x));
        }
    }
    for (a, b) in EDGES.into_iter().flat_map(|a| EDGES.map(|b| (a, b))) {
        assert!(agree(ATAN2.value(a, b), a.atan2(b)), "{a:e}, {b:e}: {:e}", ATAN2.value(a, b));
        let power = if a < 0.0 { f64::NAN } else { a.powf(b) };
        assert!(agree(POW.value(a, b), power), "{a:e}^{b:e}: {:e}", POW.value(a, b));
    }
    assert!(!agree(0.0, -0.0) && !agree(1.0, f64::NAN) && !agree(f64::MAX, f64::INFINITY) && !agree(1.0, 1.0 + 1e-15));
}

#[test]
fn a_column_has_the_bits_of_its_numbers_in_vectors_of_every_width() {
    // Blocks with numbers of all sizes, and blocks of one binade.
    let mut x = [binades(-60..1024, 1, true), EDGES.to_vec(), binades(800..801, 300, true)].concat();
    x.extend((0..600).map(|k| f64::from(k).mul_add(0.37, -100.0)));
    let y: Vec<f64> = x.iter().rev().map(|y| y.clamp(-40.0, 40.0)).collect();
    let narrow = |function: &Unary, x: &[f64], out: &mut [f64]| {
        Arch::Scalar.dispatch(|| out.iter_mut().zip(x).for_each(|(out, x)| *out = function.value(*x)));
    };
    let (mut wide, mut single) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    let same = |a: &[f64], b: &[f64]| a.iter().map(|a| bits(*a)).eq(b.iter().map(|b| bits(*b)));
    for (k, (function, _)) in ALL.into_iter().enumerate() {
        function.column(&x, &mut wide);
        narrow(&function, &x, &mut single);
        assert!(same(&wide, &single), "function {k}");
        let number = single.iter().position(|x| !x.is_nan()).expect("not all are outside of the domain");
        single[number] = single[number].next_up();
        assert!(!same(&wide, &single), "a changed bit shows");
    }
    for function in [POW, ATAN2] {
        function.column(&x, &y, &mut wide);
        for ((single, x), y) in single.iter_mut().zip(&x).zip(&y) {
            *single = function.value(*x, *y);
        }
        assert!(same(&wide, &single));
    }
}

#[test]
#[should_panic(expected = "one result for each argument")]
fn columns_of_different_lengths_are_refused() {
    SIN.column(&[1.0, 2.0], &mut [0.0]);
}

#[test]
fn numbers_above_limits_are_counted() {
    let x = [0.5, f64::NAN, 3.0, -1.0, f64::INFINITY, 3.0_f64.next_up()];
    assert_eq!(count_above(&x, &[3.0, -1.0, f64::INFINITY]), [2, 4, 0]);
}

#[test]
fn constants_in_parts_have_the_bits_that_they_should() {
    const MORE: usize = 1400;
    let mut consts = Consts::new().expect("there is memory for constants");
    let two = BigFloat::from_f64(2.0, MORE);
    let half_pi = consts.pi(MORE, ROUND).div(&two, MORE, ROUND);
    let per_ln_2 = consts.ln_2(MORE, ROUND).reciprocal(MORE, ROUND);
    let sum = |parts: &[f64]| {
        parts.iter().fold(BigFloat::from_f64(0.0, MORE), |sum, p| sum.add(&BigFloat::from_f64(*p, MORE), MORE, ROUND))
    };
    let near = |parts: &[f64], exact: &BigFloat, bits: i32| {
        let (_, size) = fraction(&sum(parts).sub(exact, MORE, ROUND).div(exact, MORE, ROUND));
        assert!(size <= -bits, "{parts:?}: 2^{size}");
    };
    near(&reduction::QUARTER, &half_pi, 150);
    near(&[reduction::HALF_PI.0, reduction::HALF_PI.1], &half_pi, 105);
    near(&[logarithm::LN_2_PARTS.0, logarithm::LN_2_PARTS.1], &consts.ln_2(MORE, ROUND), 84);
    near(&[logarithm::PER_LN_2.0, logarithm::PER_LN_2.1], &per_ln_2, 74);
    near(&[power::TWO_PER_LN_2.0, power::TWO_PER_LN_2.1], &per_ln_2.mul(&two, MORE, ROUND), 105);
    near(&[power::THIRD.0, power::THIRD.1], &BigFloat::from_f64(3.0, MORE).reciprocal(MORE, ROUND), 105);
    let half = BigFloat::from_f64(0.5, MORE).atan(MORE, ROUND, &mut consts);
    near(&[inverse::ARCTAN_HALF.0, inverse::ARCTAN_HALF.1], &half, 105);
    // The words of 2/π, each with its weight, which binary64 does not reach to the end.
    let mut bits = BigFloat::from_f64(0.0, MORE);
    for word in reduction::TWO_OVER_PI.iter().rev() {
        bits = bits.add(&BigFloat::from_f64(f64::from(*word), MORE), MORE, ROUND);
        bits = bits.div(&BigFloat::from_f64(2f64.powi(32), MORE), MORE, ROUND);
    }
    let (_, size) = fraction(&bits.mul(&half_pi, MORE, ROUND).sub(&BigFloat::from_f64(1.0, MORE), MORE, ROUND));
    assert!(size <= -1214, "2^{size}");
}

#[test]
fn a_column_of_exp_m1_has_the_bits_of_its_numbers() {
    let mut column: Vec<f64> = (0..300).map(|k| 2f64.powf(f64::from(k) / 10.0 - 26.0)).collect();
    column.extend([0.0, -0.0, -1e-3, -0.5, 1e-310, f64::INFINITY, f64::NEG_INFINITY, f64::NAN]);
    let expected: Vec<u64> = column.iter().map(|&x| exp_m1(x).to_bits()).collect();
    exp_m1_all(&mut column);
    assert_eq!(column.iter().map(|x| x.to_bits()).collect::<Vec<_>>(), expected);
}
