//! Inputs arranged for a picture: a random cloud of points shows little, a shape that bends shows what a
//! shader does. These are ordinary inputs in the stated ranges, and no samples of a run: nothing is
//! drawn from them but pictures.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::Range;

/// Where in a picture an invocation stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Place in the parameter square, each 0 to 1.
    pub at: [f64; 2],
    /// Time of the picture, 0 to 1.
    pub frame: f64,
    /// Number of the first shape of a group among all of the invocation.
    pub shape: usize,
    /// The strand, of so many, and the primitive in it.
    pub strand: (usize, usize),
    /// The primitive in its strand.
    pub primitive: usize,
}

/// What a group of inputs is in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// It stays as a sample has it.
    Still,
    /// Numbers that span the parameter square.
    Axis,
    /// Points of a shape.
    Shape,
    /// Coordinates that span the square where nothing else does.
    Place,
    /// Nodes of strands.
    Strand,
    /// It follows the place in the parameter square.
    Follows,
    /// As a uniform it changes with time, as an input of an invocation it stays.
    Moves,
}

/// A point of the shape number `shape` at a place of the parameter square: along the x axis, and around it.
pub fn shape(range: &Range, shape: usize, [u, v]: [f64; 2]) -> DVec3 {
    let (center, half) = range.middle();
    let around = TAU * v;
    let (x, radius, lift) = match shape % 5 {
        0 => (2.0 * u - 1.0, 0.24, 0.0),
        1 => (-(PI * u).cos() * 0.85, (PI * u).sin() * 0.85, 0.0),
        2 => (2.0 * u - 1.0, 0.32 + 0.2 * (TAU * u).sin(), 0.0),
        3 => (2.0 * u - 1.0, 0.2, 0.6 * (2.0 * u - 1.0).powi(2) - 0.3),
        _ => (2.0 * u - 1.0, 0.36 * (1.0 + 0.3 * (5.0 * around).cos()), 0.0),
    };
    let point = DVec3::new(0.92 * x, lift + radius * around.cos(), radius * around.sin());
    DVec3::splat(center) + point * half
}

/// The `k`-th of `n` numbers at a time: one after the other rises and falls, inside of the range.
pub fn wave(range: &Range, k: usize, n: usize, frame: f64) -> f64 {
    let (lo, hi) = (f64::from(range.lo()), f64::from(range.hi()));
    if n == 1 {
        return lo + (hi - lo) * frame;
    }
    let height = (1.0 - (frame * n as f64 - (k + 1) as f64).abs()).max(0.0);
    let (rest, peak) = (0.0_f64.clamp(lo, hi), if (lo..=hi).contains(&1.0) { 1.0 } else { hi });
    rest + (peak - rest) * height
}

/// Parts of one shape at a place along it: each takes over from the one before. They add up to 1 exactly.
pub fn shares(n: usize, u: f64) -> Vec<f64> {
    const STEPS: f64 = 4096.0;
    let at = u * (n - 1) as f64;
    let mut all: Vec<f64> = (0..n).map(|k| ((1.0 - (at - k as f64).abs()).max(0.0) * STEPS).floor() / STEPS).collect();
    let rest = 1.0 - all.iter().sum::<f64>();
    all[at.round() as usize] += rest;
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_stay_in_the_range() {
        for range in [Range::new(-2.0, 2.0), Range::new(0.5, 4.0)] {
            let inside = |p: DVec3| p.to_array().iter().all(|&c| range.contains(c as f32));
            let place = |k: usize| f64::from(k as u8) / 24.0;
            for (u, v) in (0..25).flat_map(|u| (0..25).map(move |v| (u, v))) {
                assert!((0..5).all(|s| inside(shape(&range, s, [place(u), place(v)]))));
            }
        }
    }

    #[test]
    fn shares_add_up_to_one_and_hand_over() {
        for n in 2..6 {
            for k in 0..=32 {
                assert_eq!(shares(n, f64::from(k as u8) / 32.0).iter().sum::<f64>(), 1.0);
            }
            assert_eq!((shares(n, 0.0)[0], shares(n, 1.0)[n - 1]), (1.0, 1.0));
        }
    }
}
