//! The first terms of the power series at 0 of a term with one leaf.
//!
//! Coefficients come from an interpolation at a dozen points beside 0 in numbers of many bits, so that no rule for
//! derivatives is needed. What is cut off is no part of the equality: a series is used below a threshold alone.

use crate::graph::{Points, values};
use crate::real::{Computer, Real, exact, is_finite, near};
use crate::term::{Binary, Node, Term};

/// Points on either side of 0.
const SIDE: i32 = 8;

/// The distance between them.
const STEP: f32 = 1.0 / 256.0;

/// Terms that a series has.
const LENGTHS: [usize; 5] = [2, 3, 4, 6, 8];

/// A coefficient that is this part of the largest one is 0.
const NOTHING: f64 = 1e-9;

/// Exponents of the first term.
const EXPONENTS: std::ops::RangeInclusive<i32> = -3..=5;

/// Series of some lengths; none where the function has none at 0, or more than one leaf.
pub fn of(term: &Term, leaf: u32, width: usize) -> Vec<Term> {
    coefficients(term, leaf, width).map_or_else(Vec::new, |(exponent, all)| {
        let largest = all.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        let kept: Vec<(i32, f64)> = all
            .iter()
            .enumerate()
            .filter(|(_, c)| c.abs() > NOTHING * largest)
            .map(|(k, c)| (exponent + k as i32, plain(*c)))
            .collect();
        LENGTHS.iter().filter(|n| kept.len() >= **n).filter_map(|n| sum(&kept[..*n], leaf)).collect()
    })
}

fn at(term: &Term, leaf: u32, width: usize, xs: &[f32]) -> Option<Vec<Real>> {
    let points: Vec<Vec<f32>> =
        xs.iter().map(|x| (0..width).map(|k| if k == leaf as usize { *x } else { 1.0 }).collect()).collect();
    let all = values(term, &Points::new(&points)).ok()?;
    let root = all.last()?;
    root.reals.iter().all(is_finite).then(|| root.reals.to_vec())
}

/// The exponent of the first term, and coefficients from there.
fn coefficients(term: &Term, leaf: u32, width: usize) -> Option<(i32, Vec<f64>)> {
    let tiny = at(term, leaf, width, &[STEP * STEP, 0.5 * STEP * STEP])?;
    let ratio = (near(&tiny[0]) / near(&tiny[1])).abs().log2();
    let exponent = ratio.round() as i32;
    if !((ratio - ratio.round()).abs() < 0.01 && EXPONENTS.contains(&exponent)) {
        return None;
    }
    let xs: Vec<f32> = (1..=SIDE).flat_map(|k| [STEP * k as f32, -STEP * k as f32]).collect();
    let mut computer = Computer::new().ok()?;
    let mut op = |of: Binary, a: &Real, b: &Real| {
        let node = Node::Binary(of, [0.into(), 0.into()]);
        computer.node(&node, &[a, b])
    };
    let places: Vec<Real> = xs.iter().map(|x| exact(f64::from(*x))).collect();
    // Newton's divided differences of f(x) ÷ x^exponent.
    let mut table = at(term, leaf, width, &xs)?;
    for (value, x) in table.iter_mut().zip(&places) {
        for _ in 0..exponent.unsigned_abs() {
            *value = op(if exponent > 0 { Binary::Div } else { Binary::Mul }, value, x);
        }
    }
    let count = places.len();
    for order in 1..count {
        for k in (order..count).rev() {
            let rise = op(Binary::Sub, &table[k], &table[k - 1]);
            let run = op(Binary::Sub, &places[k], &places[k - order]);
            table[k] = op(Binary::Div, &rise, &run);
        }
    }
    // From Newton's form to powers.
    let mut powers: Vec<Real> = vec![table[count - 1].clone()];
    for k in (0..count - 1).rev() {
        let mut next = vec![exact(0.0); powers.len() + 1];
        for (n, c) in powers.iter().enumerate() {
            next[n + 1] = op(Binary::Add, &next[n + 1], c);
            let moved = op(Binary::Mul, c, &places[k]);
            next[n] = op(Binary::Sub, &next[n], &moved);
        }
        next[0] = op(Binary::Add, &next[0], &table[k]);
        powers = next;
    }
    // The last ones carry what was cut off.
    let all: Vec<f64> = powers.iter().take(count * 2 / 3).map(near).collect();
    all.iter().all(|c| c.is_finite()).then_some((exponent, all))
}

/// A coefficient without the error of the interpolation, where a short fraction is near.
fn plain(c: f64) -> f64 {
    let found = (1..=20_160).map(f64::from).find(|q| {
        let p = (c * q).round();
        p != 0.0 && (c * q - p).abs() < 1e-9 * p.abs().max(1.0)
    });
    found.map_or(c, |q| (c * q).round() / q)
}

/// Σ c·x^k, by Horner's scheme.
fn sum(terms: &[(i32, f64)], leaf: u32) -> Option<Term> {
    let mut nodes = Term::default();
    let x = nodes.add(Node::Leaf(leaf));
    let (first, last) = (terms.first()?, terms.last()?);
    let power = |nodes: &mut Term, n: i32| {
        let mut all = x;
        for _ in 1..n {
            all = nodes.add(Node::Binary(Binary::Mul, [all, x]));
        }
        all
    };
    let mut sum = nodes.add(Node::number(last.1));
    for pair in terms.windows(2).rev() {
        let x = power(&mut nodes, pair[1].0 - pair[0].0);
        let product = nodes.add(Node::Binary(Binary::Mul, [x, sum]));
        let c = nodes.add(Node::number(pair[0].1));
        sum = nodes.add(Node::Binary(Binary::Add, [c, product]));
    }
    match first.0 {
        0 => {}
        n if n > 0 => {
            let x = power(&mut nodes, n);
            nodes.add(Node::Binary(Binary::Mul, [x, sum]));
        }
        n => {
            let x = power(&mut nodes, -n);
            nodes.add(Node::Binary(Binary::Div, [sum, x]));
        }
    }
    Some(nodes)
}
