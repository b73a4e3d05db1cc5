//! The quick phase against the accurate one.

use super::*;
use crate::exact::Words;
use number::twofold::Twofold;

/// Words of the list of inputs of skinning.
const LENGTH: usize = 229;

/// Inputs, of which so many are the samples' own.
struct Columns<'a>(&'a Given, usize);

impl Words<Twofold<false>> for Columns<'_> {
    fn word(&self, index: usize) -> Twofold<false> {
        if index < self.1 { Twofold::of(self.0.own[index]) } else { Twofold::of([self.0.case[index]; WIDTH]) }
    }
}

fn bits(state: &mut u64) -> u64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    *state >> 32
}

/// A binary32 number in [-2, 2).
fn ordinary(state: &mut u64) -> f64 {
    f64::from((bits(state) as f64 / 2f64.powi(30) - 2.0) as f32)
}

/// -1, 0 or 1.
fn lattice(state: &mut u64) -> f64 {
    (bits(state) % 3) as f64 - 1.0
}

/// Inputs of one case with so many bones, each word from `word`.
fn given(count: usize, state: &mut u64, word: fn(&mut u64) -> f64) -> Given {
    let mut given = Given { own: vec![[0.0; WIDTH]; LENGTH], case: vec![0.0; LENGTH] };
    given.own[..4].iter_mut().flatten().for_each(|x| *x = word(state));
    given.own[3] = [1.0; WIDTH];
    given.case[4..].iter_mut().for_each(|x| *x = word(state));
    given.case[36] = count as f64;
    for point in given.case[37..101].chunks_mut(4) {
        point[3] = 1.0;
    }
    given
}

/// A case of one bone, whose matrices are the identity.
fn plain(state: &mut u64, root: [f64; 3], tip: [f64; 3]) -> Given {
    let mut plain = given(1, state, ordinary);
    for at in [4, 20, 101] {
        plain.case[at..at + 16].iter_mut().enumerate().for_each(|(k, x)| *x = f64::from(u8::from(k % 5 == 0)));
    }
    plain.case[37..40].copy_from_slice(&root);
    plain.case[69..72].copy_from_slice(&tip);
    plain
}

/// The largest error of what is sure, in parts of its bound.
fn worst(both: &Both) -> f64 {
    let Both { near, exact, .. } = both;
    let mut worst = 0.0_f64;
    for (word, exact) in exact.iter().enumerate() {
        for k in (0..WIDTH).filter(|&k| near.sure[k] != 0) {
            let [high, low] = exact.parts(k);
            let apart = (near.high[word][k] - high) + (near.low[word][k] - low);
            worst = worst.max(apart.abs() / near.off[k]);
        }
    }
    worst
}

struct Both {
    near: Near,
    values: [[f64; WIDTH]; WORDS],
    nearest: [[u32; WIDTH]; WORDS],
    exact: [Twofold<false>; WORDS],
    marks: [[u64; WIDTH]; 2],
}

fn both(given: &Given) -> Both {
    of(Quick::Skinning, Exact::Skinning, given)
}

fn sphere(given: &Given) -> Both {
    of(Quick::Sphere, Exact::Sphere, given)
}

fn of(quick: Quick, formula: Exact, given: &Given) -> Both {
    let (mut near, mut values, mut nearest) = (Near::default(), [[0.0; WIDTH]; WORDS], [[0; WIDTH]; WORDS]);
    quick.evaluate(given, &mut near, &mut values, &mut nearest);
    let mut exact = [Twofold::of([0.0; WIDTH]); WORDS];
    let marks = formula.evaluate(&Columns(given, if quick == Quick::Sphere { 2 } else { 4 }), &mut exact);
    Both { near, values, nearest, exact, marks: [marks.segment_end, marks.degenerate] }
}

/// Compares what is sure; gives how many samples are.
fn compare(both: &Both) -> usize {
    let Both { near, values, nearest, exact, marks } = both;
    let mut sure = 0;
    for k in (0..WIDTH).filter(|&k| near.sure[k] != 0) {
        sure += 1;
        assert_eq!([near.segment_end[k], near.degenerate[k]], [marks[0][k], marks[1][k]]);
        for word in 0..WORDS {
            let mut rounded = [0; WIDTH];
            exact[word].rounded_32(&mut rounded);
            assert_eq!(values[word][k].to_bits(), exact[word].rounded()[k].to_bits());
            assert_eq!(nearest[word][k], rounded[k]);
        }
    }
    sure
}

#[test]
fn what_is_sure_is_what_the_accurate_phase_gives() {
    let (mut state, mut sure) = (3, 0);
    for round in 0..4000 {
        sure += compare(&both(&given(1 + round % 8, &mut state, ordinary)));
    }
    assert!(sure * 100 > 4000 * WIDTH * 97, "{sure}");
}

#[test]
fn the_bound_holds_and_is_not_much_too_wide() {
    let (mut state, mut most) = (5, 0.0_f64);
    for round in 0..2000 {
        most = most.max(worst(&both(&given(1 + round % 8, &mut state, ordinary))));
    }
    assert!((1e-12..1.0).contains(&most), "{most:e}");
}

#[test]
fn points_on_a_bone_but_for_the_last_bits_are_within_the_bound_or_not_sure() {
    let (mut state, mut sure) = (13, 0);
    for distance in 5..60 {
        let mut given = plain(&mut state, [-3.0; 3], [3.0; 3]);
        // What is beside the bone is moved by the matrix: it is too small for a position.
        given.case[18] = 2f64.powi(-distance);
        for k in 0..WIDTH {
            let along = ordinary(&mut state);
            (0..3).for_each(|c| given.own[c][k] = along);
        }
        let found = both(&given);
        sure += compare(&found);
        assert!(worst(&found) < 1.0, "2^-{distance}: {}", worst(&found));
        assert!(distance < 25 || found.near.sure == [0; WIDTH], "2^-{distance}");
    }
    assert!(sure > 5 * WIDTH / 2, "{sure}");
}

/// Inputs of the sphere.
fn turned(state: &mut u64, parameter: fn(&mut u64) -> f64) -> Given {
    let mut given = Given { own: vec![[0.0; WIDTH]; 18], case: vec![0.0; 18] };
    given.own[..2].iter_mut().flatten().for_each(|x| *x = parameter(state));
    given.case[2..].iter_mut().for_each(|x| *x = ordinary(state));
    given
}

#[test]
fn the_sphere_is_what_the_accurate_phase_gives() {
    let (mut state, mut sure, mut most) = (19, 0, 0.0_f64);
    for _ in 0..4000 {
        let found = sphere(&turned(&mut state, ordinary));
        sure += compare(&found);
        most = most.max(worst(&found));
    }
    assert!(sure * 100 > 4000 * WIDTH * 97, "{sure}");
    assert!((1e-4..1.0).contains(&most), "{most:e}");

    // Twelfths and quarters of a turn, where roots of 1/2 and zeros meet; and what is beyond all turns.
    let edge = |state: &mut u64| [0.25, 0.5, 0.75, 1.0, 1.5, 0.125, 2f64.powi(-30), 0.0][bits(state) as usize % 8];
    for _ in 0..500 {
        let mut given = turned(&mut state, edge);
        given.own[0][3] = 2f64.powi(25);
        given.own[1][4] = f64::INFINITY;
        given.own[1][5] = f64::NAN;
        let found = sphere(&given);
        compare(&found);
        assert_eq!([found.near.sure[3], found.near.sure[4], found.near.sure[5]], [0; 3]);
    }
    let mut given = turned(&mut state, ordinary);
    given.case[7] = f64::NAN;
    assert_eq!(compare(&sphere(&given)), 0);
}

#[test]
fn edges_are_left_to_the_accurate_phase() {
    let mut state = 7;
    // Points on bones, before both ends and beside them, bones of no length: decisions of which none is near.
    let mut sure = 0;
    for round in 0..4000 {
        sure += compare(&both(&given(1 + round % 8, &mut state, lattice)));
    }
    assert!((1..4000 * WIDTH / 2).contains(&sure), "{sure}");

    // A point in the plane through an end, one part in 2^23 before it and behind it.
    let mut edge = plain(&mut state, [0.0; 3], [0.0, 1.0, 0.0]);
    // Results that are small beside others are left to the accurate phase.
    edge.case[101..117].iter_mut().for_each(|x| *x = ordinary(&mut state));
    let step = 2f64.powi(-23);
    let own = [[0.5; 8], [0.0, step, -step, 1.0, 1.0 + step, 1.0 - step, 0.5, 2.0], [0.25; 8]];
    for (to, from) in edge.own.iter_mut().zip(own) {
        to[..8].copy_from_slice(&from);
    }
    let found = both(&edge);
    compare(&found);
    assert_eq!(
        found.near.sure[..8].iter().map(|&s| s != 0).collect::<Vec<_>>()[..6],
        [false, true, true, false, true, true]
    );
    assert_eq!(
        found.marks[0][..8].iter().map(|&s| s != 0).collect::<Vec<_>>(),
        [true, false, true, true, true, false, false, true]
    );
}

#[test]
fn numbers_beyond_the_bound_are_not_sure() {
    let mut state = 9;
    for (index, value) in [(36, 0.0), (36, 9.0), (4, 2f64.powi(40)), (4, f64::NAN), (20, f64::INFINITY)] {
        let mut given = given(3, &mut state, ordinary);
        given.case[index] = value;
        assert_eq!(compare(&both(&given)), 0, "{index} {value}");
    }
    // In one sample alone.
    let mut given = given(3, &mut state, ordinary);
    given.own[1][5] = f64::INFINITY;
    let found = both(&given);
    assert!(found.near.sure[5] == 0 && compare(&found) > WIDTH / 2);
}

#[test]
fn a_formula_has_a_quick_phase_for_inputs_of_its_sides_alone() {
    assert!(Quick::of(Exact::Skinning, (0..LENGTH).map(|index| index >= 4)).is_some());
    assert!(Quick::of(Exact::Skinning, (0..LENGTH).map(|index| index >= 5)).is_none());
    assert!(Quick::of(Exact::Skinning, (0..LENGTH).map(|index| index >= 3)).is_none());
    assert!(Quick::of(Exact::Sphere, (0..18).map(|index| index >= 2)).is_some());
    assert!(Quick::of(Exact::Sphere, (0..18).map(|_| false)).is_none());
    assert!(Quick::of(Exact::Morph, (0..25).map(|index| index >= 2)).is_none());
}
