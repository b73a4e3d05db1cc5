//! Several terms, each on its side of a threshold of one input.

use crate::graph::Points;
use crate::single::Losses;

/// Bits that a threshold has to gain in the mean of all points.
const GAIN: f64 = 0.35;

/// Points that each side has at least.
const LEAST: usize = 8;

/// Thresholds inside of one another.
const DEPTH: usize = 2;

/// Which term is used where, by its index.
#[derive(Clone, Debug, PartialEq)]
pub enum Split {
    /// This one.
    Term(usize),
    /// One below, one from there on.
    At {
        /// The input that decides.
        leaf: u32,
        /// Its size decides, whatever its sign.
        absolute: bool,
        /// The threshold.
        threshold: f32,
        /// What is used below it.
        below: Box<Split>,
        /// What is used from there on.
        above: Box<Split>,
    },
}

impl Split {
    /// How many thresholds there are.
    pub fn thresholds(&self) -> usize {
        match self {
            Self::Term(_) => 0,
            Self::At { below, above, .. } => 1 + below.thresholds() + above.thresholds(),
        }
    }

    /// The terms that are used.
    pub fn terms(&self) -> Vec<usize> {
        match self {
            Self::Term(k) => vec![*k],
            Self::At { below, above, .. } => [below.terms(), above.terms()].concat(),
        }
    }

    /// The term that is used at a point.
    pub fn chosen(&self, points: &Points, at: usize) -> usize {
        match self {
            Self::Term(k) => *k,
            Self::At { leaf, absolute, threshold, below, above } => {
                let x = key(points, *leaf, *absolute, at);
                if x < *threshold { below } else { above }.chosen(points, at)
            }
        }
    }
}

fn key(points: &Points, leaf: u32, absolute: bool, at: usize) -> f32 {
    let x = points.leaf(leaf)[at];
    if absolute { x.abs() } else { x }
}

/// The choice of terms that loses least; `losses` are those of each term.
pub fn best(points: &Points, losses: &[Losses]) -> Split {
    let all: Vec<usize> = (0..points.len()).collect();
    within(points, losses, &all, DEPTH)
}

fn total(losses: &Losses, which: &[usize]) -> f64 {
    which.iter().map(|&k| losses.0[k]).sum()
}

fn within(points: &Points, losses: &[Losses], which: &[usize], depth: usize) -> Split {
    let totals: Vec<f64> = losses.iter().map(|losses| total(losses, which)).collect();
    let alone = (0..totals.len()).min_by(|a, b| totals[*a].total_cmp(&totals[*b])).unwrap_or(0);
    if depth == 0 || which.len() < 2 * LEAST {
        return Split::Term(alone);
    }
    let needed = GAIN * points.len() as f64;
    let mut found: Option<(f64, u32, bool, Vec<usize>, usize)> = None;
    for leaf in 0..points.width() as u32 {
        for absolute in [false, true] {
            let mut order = which.to_vec();
            order.sort_by(|a, b| key(points, leaf, absolute, *a).total_cmp(&key(points, leaf, absolute, *b)));
            let (at, least) = threshold(points, losses, &order, &totals, leaf, absolute);
            let better = found.as_ref().is_none_or(|found| least < found.0);
            if better && totals[alone] - least > needed {
                found = Some((least, leaf, absolute, order, at));
            }
        }
    }
    let Some((_, leaf, absolute, order, at)) = found else { return Split::Term(alone) };
    let edge = between(key(points, leaf, absolute, order[at - 1]), key(points, leaf, absolute, order[at]));
    let below = within(points, losses, &order[..at], depth - 1);
    let above = within(points, losses, &order[at..], depth - 1);
    if below == above {
        below
    } else {
        Split::At { leaf, absolute, threshold: edge, below: below.into(), above: above.into() }
    }
}

/// The place in the order with the least sum of the best below and the best above.
fn threshold(
    points: &Points,
    losses: &[Losses],
    order: &[usize],
    totals: &[f64],
    leaf: u32,
    absolute: bool,
) -> (usize, f64) {
    let mut below = vec![0.0; losses.len()];
    let mut best = (0, f64::INFINITY);
    for at in 1..=order.len().saturating_sub(LEAST) {
        losses.iter().zip(&mut below).for_each(|(losses, sum)| *sum += losses.0[order[at - 1]]);
        let apart = key(points, leaf, absolute, order[at - 1]) < key(points, leaf, absolute, order[at]);
        if at < LEAST || !apart {
            continue;
        }
        let left = below.iter().copied().fold(f64::INFINITY, f64::min);
        let right = totals.iter().zip(&below).map(|(all, below)| all - below).fold(f64::INFINITY, f64::min);
        if left + right < best.1 {
            best = (at, left + right);
        }
    }
    best
}

/// A number between two, with few digits; the higher one where there is no shorter.
#[expect(clippy::cast_possible_truncation, reason = "checked to lie between")]
fn between(low: f32, high: f32) -> f32 {
    if low < 0.0 && high > 0.0 {
        return 0.0;
    }
    let (a, b) = (f64::from(low), f64::from(high));
    let middle = if a * b > 0.0 { a.signum() * (a * b).sqrt() } else { 0.5 * (a + b) };
    for digits in 0..7_usize {
        let short: f64 = format!("{middle:.digits$e}").parse().unwrap_or(middle);
        if a < short && short as f32 <= high && low < short as f32 {
            return short as f32;
        }
    }
    high
}
