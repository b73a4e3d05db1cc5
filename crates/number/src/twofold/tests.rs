//! Pairs against numbers of 400 bits.

use super::big::{BITS, Big, ROUND};
use super::pair::Pair;
use super::tables::{INVERSE_FACTORIALS, LN_2, PI, SINES};
use super::*;

/// How far a pair is from a number, in parts of the number.
fn off(pair: Pair, exact: Big) -> f64 {
    let difference = (Big::of(pair.high) + Big::of(pair.low)) - exact;
    if difference.is_zero() { 0.0 } else { (difference / exact).size() }
}

#[test]
fn constants_are_right() {
    assert!(off(PI, Big::pi()) < 1e-31);
    assert!(off(LN_2, Big::of(2.0).with(|x, c| x.ln(BITS, ROUND, c))) < 1e-31);
    for (k, &sine) in SINES.iter().enumerate() {
        let exact = Big::of(k as f64 / 256.0).sin_cos_pi().0;
        if exact.is_zero() {
            assert_eq!((sine.high, sine.low), (0.0, 0.0), "{k}");
        } else {
            assert!(off(sine, exact) < 1e-31, "{k}");
        }
    }
    let mut factorial = Big::of(1.0);
    for (n, &inverse) in INVERSE_FACTORIALS.iter().enumerate() {
        factorial = factorial * Big::of(n.max(1) as f64);
        assert!(off(inverse, Big::of(1.0) / factorial) < 1e-31, "{n}");
    }
}

fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    let fraction = 1.0 + (*state >> 12) as f64 / 2f64.powi(52);
    let exponent = (*state >> 5) as i32 % 20;
    fraction * 2f64.powi(exponent) * if *state & 1 == 0 { 1.0 } else { -1.0 }
}

fn pair(state: &mut u64) -> Pair {
    Pair::of(random(state)).add::<true>(Pair::of(random(state) * 2f64.powi(-70)))
}

fn big(pair: Pair) -> Big {
    Big::of(pair.high) + Big::of(pair.low)
}

#[test]
fn operations_have_a_hundred_bits() {
    let mut state = 7;
    let mut worst = [0.0_f64; 5];
    for _ in 0..2000 {
        Big::forget();
        let (a, b) = (pair(&mut state), pair(&mut state));
        let positive = if a.high < 0.0 { a.neg() } else { a };
        let errors = [
            off(a.add::<true>(b), big(a) + big(b)),
            off(a.mul::<true>(b), big(a) * big(b)),
            off(a.div::<true>(b), big(a) / big(b)),
            off(positive.sqrt::<true>(), big(positive).sqrt()),
            off(a.times::<true>(b.high), big(a) * Big::of(b.high)),
        ];
        worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
    }
    assert!(worst.iter().all(|&error| error < 2f64.powi(-100)), "{worst:?}");
    // The bound can be reached: half as many bits are not more than there are.
    assert!(worst.iter().any(|&error| error > 2f64.powi(-110)), "{worst:?}");
}

#[test]
fn numbers_without_a_second_part_are_added_as_pairs_are() {
    let mut state = 23;
    for round in 0..20_000 {
        let (a, near) = (pair(&mut state), random(&mut state));
        // Of every kind: apart, close to each other, and what leaves the second part alone.
        let b = [near, -a.high, -a.high.next_up(), near * 2f64.powi(-60), near * 2f64.powi(60), 0.0][round % 6];
        assert_eq!(a.add_number::<false>(b), a.add::<false>(Pair::of(b)), "{a:?} {b}");
        assert_eq!(a.add_number::<true>(b), a.add::<true>(Pair::of(b)), "{a:?} {b}");
        let difference = Pair::of(a.high).sub::<true>(Pair::of(b));
        assert_eq!(Pair::difference::<false>(a.high, b), difference, "{a:?} {b}");
        assert_eq!(Pair::difference::<true>(a.high, b), difference, "{a:?} {b}");
    }
    assert!(Pair::difference::<true>(f64::INFINITY, 1.0).low == 0.0);
}

#[test]
fn functions_have_more_bits_than_binary64() {
    let mut state = 11;
    for _ in 0..300 {
        Big::forget();
        let x = f64::from((random(&mut state) / 1e5) as f32);
        let (sin, cos) = Pair::sin_cos_pi(2.0 * x);
        let (exact_sin, exact_cos) = Big::of(2.0 * x).sin_cos_pi();
        assert!(off(sin, exact_sin) < 2f64.powi(-96) && off(cos, exact_cos) < 2f64.powi(-96), "{x}");
        let (base, exponent) = (1.0 + x.abs(), Pair::of(f64::from((random(&mut state) / 3e4) as f32)));
        let power = Pair::of(base).pow(exponent);
        assert!(off(power, Big::of(base).pow(big(exponent))) < 2f64.powi(-80), "{base} {exponent:?}");
    }
}

#[test]
fn near_turns_are_within_their_bound_and_not_much_better() {
    let (mut state, mut worst) = (17, 0.0_f64);
    for round in 0..6000 {
        Big::forget();
        // Of all sizes, and next to the numbers of the table and between them.
        let x = match round % 3 {
            0 => f64::from((random(&mut state) / 2f64.powi(round % 40)) as f32),
            1 => f64::from(((round % 512) as f64 / 256.0 + 1e-3 * random(&mut state) / 2f64.powi(20)) as f32),
            _ => f64::from(((round % 512) as f32 + 0.5) / 256.0) * if round % 2 == 0 { 2.0 } else { -1.0 },
        };
        let [sin, cos] = sin_cos_pi_near(x);
        let (exact_sin, exact_cos) = Big::of(x).sin_cos_pi();
        for ((high, low), exact) in [(sin, exact_sin), (cos, exact_cos)] {
            let apart = ((Big::of(high) + Big::of(low)) - exact).size().abs();
            assert!(apart < TURN_OFF, "{x}: {:e}", apart / TURN_OFF);
            assert!(high == high + low);
            worst = worst.max(apart);
        }
    }
    assert!(worst > TURN_OFF / 256.0, "{:e}", worst / TURN_OFF);
}

#[test]
fn turns_are_exact_where_they_can_be() {
    for (x, sin, cos) in [(0.0, 0.0, 1.0), (0.5, 1.0, 0.0), (1.0, 0.0, -1.0), (-0.5, -1.0, 0.0), (16777216.0, 0.0, 1.0)]
    {
        let (s, c) = Pair::sin_cos_pi(x);
        assert_eq!((s.high, s.low, c.high, c.low), (sin, 0.0, cos, 0.0), "{x}");
    }
    let (s, c) = Pair::sin_cos_pi(0.25);
    assert_eq!(s, c, "one number has one value");
    assert!(Pair::sin_cos_pi(f64::INFINITY).0.high.is_nan() && Pair::sin_cos_pi(f64::NAN).1.high.is_nan());
}

#[test]
fn infinities_stay_what_they_are() {
    let infinite = Pair::of(f64::INFINITY);
    assert_eq!(infinite.add::<true>(Pair::of(1.0)).high, f64::INFINITY);
    assert_eq!(infinite.mul::<true>(Pair::of(-2.0)).high, f64::NEG_INFINITY);
    assert_eq!(
        (Pair::of(1.0).div::<true>(infinite).high, Pair::of(1.0).div::<true>(Pair::of(0.0)).high),
        (0.0, f64::INFINITY)
    );
    assert_eq!((infinite.sqrt::<true>().high, Pair::of(0.0).sqrt::<true>().high), (f64::INFINITY, 0.0));
    assert!(infinite.sub::<true>(infinite).high.is_nan() && Pair::of(0.0).div::<true>(Pair::of(0.0)).high.is_nan());
    assert_eq!(Pair::of(2.0).pow(Pair::of(-2000.0)).high, 0.0);
}

#[test]
fn a_number_between_two_binary32_is_rounded_once() {
    // Half a gap above 1, and a little more or less than binary64 can hold.
    let half = 1.0 + 2f64.powi(-24);
    let of = |low: f64| {
        let mut out = [0; WIDTH];
        Twofold::<true> { high: [half; WIDTH], low: [low; WIDTH] }.rounded_32(&mut out);
        f32::from_bits(out[0])
    };
    assert_eq!((of(0.0), of(2f64.powi(-80)), of(-2f64.powi(-80))), (1.0, 1.0_f32.next_up(), 1.0));
    let negative = |low: f64| {
        let mut out = [0; WIDTH];
        Twofold::<true> { high: [-half; WIDTH], low: [low; WIDTH] }.rounded_32(&mut out);
        f32::from_bits(out[0])
    };
    assert_eq!((negative(-2f64.powi(-80)), negative(2f64.powi(-80))), (-1.0_f32.next_up(), -1.0));
}

#[test]
fn small_powers_less_one_are_right() {
    for x in [1e-300_f64, -1e-20, 1e-9, 0.007, -0.0078, 0.0079, 0.3, -2.0, 40.0, 700.5, -745.0] {
        let exact = x.exp_m1();
        assert!((crate::exp_m1(x) - exact).abs() <= 4.0 * f64::EPSILON * exact.abs(), "{x}");
    }
    assert!(crate::exp_m1(f64::NAN).is_nan() && crate::exp_m1(f64::INFINITY) == f64::INFINITY);
}
