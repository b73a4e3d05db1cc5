//! The formulas against `formula`, which was written apart from them.

use super::*;
use crate::formula;
use judge::formula::{Args, Emission, Formula, Kind, Param, Rule};
use number::twofold::{Twofold, WIDTH};

struct Single<'a>(&'a [f64]);

impl<const SAFE: bool> Words<Twofold<SAFE>> for Single<'_> {
    fn word(&self, index: usize) -> Twofold<SAFE> {
        Twofold::of([self.0[index]; WIDTH])
    }
}

fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    f64::from(((*state >> 40) as f64 / 2f64.powi(24)) as f32)
}

/// Inputs of a formula in its usual range: numbers in [0, 1), whole ones from 1 to 3.
fn inputs(formula: &Formula, state: &mut u64) -> Vec<f64> {
    let mut words = Vec::new();
    for param in formula.inputs {
        for _ in 0..param.words() {
            words.push(match param.kind {
                Kind::Int => (1.0 + 3.0 * random(state)).floor(),
                _ => random(state),
            });
        }
    }
    words
}

fn exact(formula: Exact, inputs: &[f64]) -> (Vec<f64>, Marks<Twofold>) {
    computed::<true>(formula, inputs)
}

fn computed<const SAFE: bool>(formula: Exact, inputs: &[f64]) -> (Vec<f64>, Marks<Twofold<SAFE>>) {
    let mut out = vec![Twofold::of([0.0; WIDTH]); formula.outputs()];
    let marks = formula.evaluate(&Single(inputs), &mut out);
    (out.iter().map(|column| column.rounded()[WIDTH - 1]).collect(), marks)
}

fn plain(formula: &Formula, inputs: &[f64]) -> Vec<f64> {
    let args = Args::new(formula.inputs, inputs);
    match formula.rule {
        Rule::Pointwise(rule) => {
            let mut out = vec![0.0; formula.outputs.iter().map(Param::words).sum()];
            rule(&args, &mut out);
            out
        }
        Rule::Emission(rule) => {
            let mut out = Emission::default();
            rule(&args, &mut out);
            out.words
        }
    }
}

fn near(a: &[f64], b: &[f64]) -> bool {
    let scale = b.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a.is_nan() && b.is_nan()) || (a - b).abs() <= 1e-13 * scale)
}

#[test]
fn every_formula_is_here_in_its_order() {
    let names: Vec<&str> = formula::all().iter().map(|f| f.name).collect();
    assert_eq!(names, Exact::ALL.map(Exact::name));
    for formula in formula::all() {
        assert_eq!(Exact::by_name(formula.name).unwrap().name(), formula.name);
    }
    assert_eq!(Exact::by_name("Sphere"), None);
}

#[test]
fn two_ways_to_a_formula_agree() {
    let mut state = 5;
    for formula in formula::all() {
        let own = Exact::by_name(formula.name).unwrap();
        for _ in 0..100 {
            let inputs = inputs(formula, &mut state);
            let (ours, theirs) = (exact(own, &inputs).0, plain(formula, &inputs));
            assert!(near(&ours, &theirs), "{}: {ours:?} against {theirs:?} for {inputs:?}", formula.name);
            // The comparison is one: a part in 10^12 is seen.
            let off: Vec<f64> = ours.iter().map(|x| x * (1.0 + 1e-12) + 1e-12).collect();
            assert!(!near(&off, &theirs), "{}", formula.name);
        }
    }
}

#[test]
fn places_without_a_value_are_nan_in_both() {
    let cases: [(&str, Vec<f64>); 3] = [
        ("bone_weight", vec![-0.5, 16.0]),
        ("joints", [vec![1.0, 0.0, 0.0, 1.0, 4.0], vec![1.0; 80]].concat()),
        ("skinning", [vec![0.5; 36], vec![9.0], vec![0.5; 192]].concat()),
    ];
    for (name, inputs) in cases {
        let (ours, _) = exact(Exact::by_name(name).unwrap(), &inputs);
        assert!(ours.iter().all(|x| x.is_nan()), "{name}: {ours:?}");
        assert!(near(&ours, &plain(formula::by_name(name).unwrap(), &inputs)), "{name}");
    }
}

#[test]
fn ends_and_degenerate_segments_are_marked() {
    let of = |p: f64, to: f64| {
        let (out, marks) = exact(Exact::SegmentDistance, &[p, 2.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, to, 0.0, 0.0, 1.0]);
        (out[0], marks.segment_end[0] != 0, marks.degenerate[0] != 0)
    };
    assert_eq!(of(1.0, 4.0), (2.0, false, false));
    assert_eq!(of(-1.5, 4.0), (2.5, true, false));
    assert_eq!(of(5.5, 4.0), (2.5, true, false));
    assert_eq!(of(1.5, 0.0), (2.5, true, true));
}

#[test]
fn a_point_on_a_line_has_distance_zero() {
    // The direction (1, 3, 7) has no length that is a binary number.
    let inputs = [0.5, 1.5, 3.5, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 3.0, 7.0, 1.0];
    assert_eq!(exact(Exact::SegmentDistance, &inputs).0, [0.0]);
}

/// Numbers from the ends of binary32, and others.
fn wild(state: &mut u64) -> f64 {
    let ends = [0.0, -0.0, f32::MAX, f32::MIN, f32::MIN_POSITIVE, 1e-45, -1e-45, 1.0, -1.0, f32::EPSILON];
    let (choice, x) = (random(state), random(state) as f32);
    let scale = 2f32.powi((random(state) * 250.0) as i32 - 125);
    f64::from(if choice < 0.3 { ends[(x * ends.len() as f32) as usize] } else { (2.0 * x - 1.0) * scale })
}

#[test]
fn fast_arithmetic_gives_the_same_bits_for_finite_numbers() {
    let mut state = 5;
    for exact in Exact::ALL {
        let formula = formula::by_name(exact.name()).expect("each is a formula of the list");
        let mut finite = 0;
        for round in 0..400 {
            let mut words = inputs(formula, &mut state);
            if round % 2 == 0 {
                // Whole numbers count something, and have a range.
                words.iter_mut().filter(|x| x.fract() != 0.0).for_each(|x| *x = wild(&mut state));
            }
            let (safe, marks) = computed::<true>(exact, &words);
            let (fast, fast_marks) = computed::<false>(exact, &words);
            let same_marks = (marks.segment_end, marks.degenerate) == (fast_marks.segment_end, fast_marks.degenerate);
            assert!(same_marks, "{}: {words:?}", exact.name());
            if fast.iter().all(|x| x.is_finite()) {
                finite += 1;
                let bits = |words: &[f64]| words.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&safe), bits(&fast), "{}: {words:?}", exact.name());
            }
        }
        assert!(finite > 200, "{}: {finite}", exact.name());
    }
}
