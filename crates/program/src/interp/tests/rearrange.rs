//! Rearranged programs: the same in real numbers, and not in binary32.

use super::super::{Binary32, Binary64, Domain, Executable, FUEL, Laws};
use super::support::{batch, compile, glsl, wgsl};

/// Functions of six numbers, and the same with every term positive: the size of their terms.
const ROWS: [(&str, &str); 7] = [
    ("a + b + c + d + e + g", "a + b + c + d + e + g"),
    ("a - (b - (c - (d - (e - g))))", "a + (b + (c + (d + (e + g))))"),
    ("-(a * b) * -c * (d * e) * g", "a * b * c * (d * e) * g"),
    ("a * b + c * d - e * g", "a * b + c * d + e * g"),
    ("(a + b) * (c - d) * (e + g)", "(a + b) * (c + d) * (e + g)"),
    ("((a * e + b) * e + c) * e - d * (g - -a) + b", "((a * e + b) * e + c) * e + d * (g + a) + b"),
    ("a * b - a * c + a * d - e * a * g", "a * b + a * c + a * d + e * a * g"),
];

const LAWS: [Laws; 2] = [Laws::Order, Laws::Distribution];

fn function(expression: &str) -> Executable {
    let text = format!("fn f(a: f32, b: f32, c: f32, d: f32, e: f32, g: f32) -> f32 {{ return {expression}; }}");
    compile(&wgsl(&text)).unwrap()
}

/// Numbers below `n`, without end.
fn random(seed: u64) -> impl FnMut(usize) -> usize {
    let mut state = seed;
    move |n| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % n as u64) as usize
    }
}

fn rows(seed: u64, absolute: bool) -> Vec<Vec<u32>> {
    let mut next = random(seed);
    let mut number = || {
        let size = (next(1 << 24) as f32 / 8_388_608.0 - 1.0) * 2f32.powi(next(12) as i32 - 6);
        if absolute { size.abs() } else { size }.to_bits()
    };
    (0..500).map(|_| (0..6).map(|_| number()).collect()).collect()
}

fn results<D: Domain + Default>(executable: &Executable, rows: &[Vec<u32>]) -> Vec<D::Word> {
    let meaning = executable.run::<D>(&batch(rows), FUEL).unwrap();
    (0..rows.len()).map(|k| meaning.vertex(k, 0)[0]).collect()
}

/// The largest difference of two functions, in units of the size of their terms.
fn difference(a: &Executable, b: &Executable, sizes: &Executable, seed: u64) -> f64 {
    let [a, b] = [a, b].map(|executable| results::<Binary64>(executable, &rows(seed, false)));
    let sizes = results::<Binary64>(sizes, &rows(seed, true));
    a.iter().zip(&b).zip(&sizes).map(|((a, b), size)| (a - b).abs() / size).fold(0.0, f64::max)
}

#[test]
fn the_value_stays_in_real_numbers_and_moves_in_binary32() {
    for (expression, sizes) in ROWS {
        let (original, sizes) = (function(expression), function(sizes));
        for laws in LAWS {
            let mut moved = 0;
            for seed in 0..20 {
                let rearranged = original.rearranged(laws, &mut random(seed));
                let apart = difference(&original, &rearranged, &sizes, seed);
                assert!(apart <= 1e-12, "{expression}, {laws:?}, {seed}: {apart:e}");
                let inputs = rows(seed, false);
                let [strict, other] = [&original, &rearranged].map(|e| results::<Binary32>(e, &inputs));
                moved += strict.iter().zip(&other).filter(|(a, b)| a != b).count();
            }
            // Of 10 000 results.
            assert!(moved > 1000, "{expression}, {laws:?}: {moved}");
        }
    }
}

#[test]
fn a_wrong_sign_or_a_lost_factor_would_show() {
    let sizes = function(ROWS[3].1);
    for wrong in ["a * b + c * d + e * g", "a * b + c * d - e", "a * b + c * d"] {
        assert!(difference(&function(ROWS[3].0), &function(wrong), &sizes, 3) > 1e-3, "{wrong}");
    }
}

#[test]
fn distribution_changes_the_operations_and_order_does_not() {
    let count = |executable: &Executable| executable.draft.body.iter().map(operations).sum::<usize>();
    let original = function("a * (b + c + d)");
    let counts = |laws| (0..20).map(move |seed| (laws, seed));
    let changed = |(laws, seed)| count(&original.rearranged(laws, &mut random(seed))) != count(&original);
    assert!(!counts(Laws::Order).any(changed));
    assert!(counts(Laws::Distribution).any(changed));
    // And back: a·b + a·c becomes a·(b + c).
    let spread = function("a * b + a * c");
    let fewer = (0..20).any(|seed| count(&spread.rearranged(Laws::Distribution, &mut random(seed))) < count(&spread));
    assert!(fewer);
}

fn operations(inst: &super::super::code::Inst) -> usize {
    use super::super::code::Inst;
    match inst {
        Inst::Real2 { .. } => 1,
        Inst::Call { body } => body.iter().map(operations).sum(),
        _ => 0,
    }
}

#[test]
fn what_is_stored_on_the_way_is_not_moved_across_the_store() {
    // `x` changes between its two readings, and `a * x` must keep the first.
    let text = "void f(float a, float b, float c, float d, float e, float g, out float r) {
        float x = b;
        float t = a * x + c;
        x = d;
        for (int i = 0; i < 3; ++i) { float before = x; x = x * 0.5 + g; t = t + before * e - x; }
        r = t + x * a - (x - c);
    }";
    let original = super::support::compile_with(&glsl(text), false).unwrap();
    let inputs = rows(5, false);
    let expected: Vec<f64> = inputs
        .iter()
        .map(|row| {
            let [a, b, c, d, e, g] = std::array::from_fn(|k| f64::from(f32::from_bits(row[k])));
            let (mut x, mut t) = (d, a * b + c);
            for _ in 0..3 {
                let before = x;
                x = x * 0.5 + g;
                t = t + before * e - x;
            }
            t + x * a - (x - c)
        })
        .collect();
    for seed in 0..30 {
        let found = results::<Binary64>(&original.rearranged(Laws::Distribution, &mut random(seed)), &inputs);
        for (found, expected) in found.iter().zip(&expected) {
            // Inputs and their products are below 2^12.
            assert!((found - expected).abs() < 1e-9, "{seed}: {found} {expected}");
        }
    }
}

#[test]
fn equal_choices_give_equal_programs() {
    let original = function(ROWS[4].0);
    let twice = [9, 9].map(|seed| original.rearranged(Laws::Distribution, &mut random(seed)));
    let other = original.rearranged(Laws::Distribution, &mut random(10));
    let results = |executable: &Executable| results::<Binary32>(executable, &rows(1, false));
    assert_eq!(results(&twice[0]), results(&twice[1]));
    assert_ne!(results(&twice[0]), results(&other));
}
