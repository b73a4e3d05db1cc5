//! Vertex blending, (76) and (79) to (81).
//!
//! The square of the distance to a segment is |v2|² less what lies along it: (v1·v2)²/|v1|² between the ends, and
//! 2 v1·v2 − |v1|² beyond the second one. What cancels there is seen, and left to the accurate phase.
//!
//! With u = 2^-53: squares and products of vectors in two parts are within 2^-101 of the sum of their terms, and the
//! square of the distance within 2^-98 of |v2|². It is used where it is 2^-20 of |v2|² or more: the distance d is
//! within 2^-79 of itself then, and (d + 1)^-16 within 2^-75. The point p is within 2^-104 of the sum of its terms,
//! which is 2^16 at most, and moves d by 2^-87. All else is below: u is within 2^-74 of the sum of its terms.

use super::{Given, LEAST, Near, matrix, power, square};
use number::twofold::{WIDTH, all_bits, product, sum, times, two_product, two_sum};

/// Words of the list of inputs that each sample has for itself: its position.
pub(super) const OWN: usize = 4;

/// Most bones of the skinning shader.
const MAXBONES: f64 = 8.0;

// Places in the list of inputs: position, modelViewMatrix, projectionMatrix, numberOfBones, p0, p1, blendMatrix.
const MODEL_VIEW: usize = 4;
const PROJECTION: usize = 20;
const COUNT: usize = 36;
const ROOTS: usize = 37;
const TIPS: usize = 69;
const BLEND: usize = 101;

/// Bound of the error in parts of what the terms of a result can be at most: twice what is found above, and four
/// terms in each row.
const PART: f64 = power(-71);
/// The smallest part of |v2|² that a square of the distance may be.
const CANCELLED: f64 = power(-20);
/// Squares of numbers whose sign is certain, in parts of the squares of their terms.
const DECIDED: f64 = power(-120);

/// Columns of a vector in two parts.
struct MatrixColumns {
    high: [[f64; WIDTH]; 4],
    low: [[f64; WIDTH]; 4],
}

impl MatrixColumns {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn zero() -> Self {
        Self { high: [[0.0; WIDTH]; 4], low: [[0.0; WIDTH]; 4] }
    }
}

/// What samples share of a bone.
struct Bone {
    root: [f64; 4],
    /// From root to tip, exact.
    v1: [(f64, f64); 4],
    /// |v1|²
    squared: (f64, f64),
    /// Its inverse; 0 for a bone of length 0.
    inverse: (f64, f64),
    /// Root and tip are one point.
    point: bool,
    /// Rows of the blend matrix.
    rows: [[f64; 4]; 4],
    /// Its largest entry.
    largest: f64,
}

impl Bone {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new(case: &[f64], bone: usize) -> Self {
        let (mut root, mut v1, mut terms) = ([0.0; 4], [(0.0, 0.0); 4], [(0.0, 0.0); 4]);
        for c in 0..4 {
            root[c] = case[ROOTS + 4 * bone + c];
            v1[c] = two_sum(case[TIPS + 4 * bone + c], -root[c]);
            terms[c] = square(v1[c]);
        }
        let (high, rest) = sum(terms);
        let squared = two_sum(high, rest);
        let point = squared.0 == 0.0;
        let first = if point { 0.0 } else { 1.0 / squared.0 };
        let left = (-first).mul_add(squared.1, (-first).mul_add(squared.0, 1.0));
        let inverse = if point { (0.0, 0.0) } else { (first, first * left) };
        let (rows, largest) = matrix(case, BLEND + 16 * bone);
        Self { root, v1, squared, inverse, point, rows, largest }
    }
}

/// position, modelViewMatrix, projectionMatrix, numberOfBones, p0, p1, blendMatrix
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn skinning(given: &Given, near: &mut Near) {
    let case = given.case.as_slice();
    let count = case[COUNT];
    // NaN is in no range.
    if !(1.0..=MAXBONES).contains(&count) {
        near.give_up();
        return;
    }
    let (mut p, mut size) = (MatrixColumns::zero(), [0.0; WIDTH]);
    transform(&matrix(case, MODEL_VIEW).0, &given.own, &mut p, &mut size);
    let (mut u, mut weights) = (MatrixColumns::zero(), [0.0; WIDTH]);
    for bone in 0..count as usize {
        let bone = Bone::new(case, bone);
        // The square of the length is not lost to underflow, or there is none.
        if !(bone.point || (power(-200)..power(200)).contains(&bone.squared.0)) {
            near.give_up();
            return;
        }
        blend(&bone, &p, &mut u, &mut weights, near);
    }
    let (rows, largest) = matrix(case, PROJECTION);
    for k in 0..WIDTH {
        let mut parts = [(0.0, 0.0); 4];
        for c in 0..4 {
            parts[c] = two_sum(u.high[c][k], u.low[c][k]);
        }
        for r in 0..4 {
            let mut terms = [(0.0, 0.0); 4];
            for c in 0..4 {
                terms[c] = times(rows[r][c], parts[c]);
            }
            let (high, rest) = sum(terms);
            (near.high[r][k], near.low[r][k]) = two_sum(high, rest);
        }
        near.off[k] = PART * largest * weights[k] * size[k] + LEAST;
        near.sure[k] &= all_bits(size[k] <= power(16));
    }
}

/// A matrix times positions, and the sum of the magnitudes of all terms.
#[cfg_attr(not(debug_assertions), inline(always))]
fn transform(rows: &[[f64; 4]; 4], position: &[[f64; WIDTH]], p: &mut MatrixColumns, size: &mut [f64; WIDTH]) {
    for r in 0..4 {
        for k in 0..WIDTH {
            let mut terms = [(0.0, 0.0); 4];
            for c in 0..4 {
                // Of two binary32 numbers: exact.
                terms[c].0 = rows[r][c] * position[c][k];
                size[k] += terms[c].0.abs();
            }
            let (high, rest) = sum(terms);
            (p.high[r][k], p.low[r][k]) = two_sum(high, rest);
        }
    }
}

/// Adds what a bone does to points: its weight times its matrix times the point.
#[cfg_attr(not(debug_assertions), inline(always))]
fn blend(bone: &Bone, p: &MatrixColumns, u: &mut MatrixColumns, weights: &mut [f64; WIDTH], near: &mut Near) {
    let (squared, small) = (bone.squared, DECIDED * bone.squared.0);
    for k in 0..WIDTH {
        let (mut of_square, mut of_along) = ([(0.0, 0.0); 4], [(0.0, 0.0); 4]);
        for c in 0..4 {
            let (high, carried) = two_sum(p.high[c][k], -bone.root[c]);
            // Where the first parts cancel, they do so exactly, and what is left is more than all second parts.
            let low = carried + p.low[c][k];
            let v2 = (high + low, low - ((high + low) - high));
            of_square[c] = square(v2);
            of_along[c] = product(bone.v1[c], v2);
        }
        let (n, n_low) = sum(of_square);
        let along = sum(of_along);

        let before = along.0 + along.1;
        let beyond = (along.0 - squared.0) + (along.1 - squared.1);
        let at_start = bone.point | (before < 0.0);
        let at_end = !at_start & (beyond > 0.0);
        let limit = small * n;
        let decided = bone.point | ((before * before > limit) & (beyond * beyond > limit + small * squared.0));

        let between = product(square(along), bone.inverse);
        let (end, carried) = two_sum(along.0 + along.0, -squared.0);
        let end_low = carried + ((along.1 + along.1) - squared.1);
        let c = if at_end { end } else { between.0 };
        let c_low = if at_end { end_low } else { between.1 };
        let (c, c_low) = if at_start { (0.0, 0.0) } else { (c, c_low) };
        let (left, carried) = two_sum(n, -c);
        let rest = carried + (n_low - c_low);
        let q = left + rest;
        let q_low = rest - (q - left);
        let usable = (q >= CANCELLED * n) & (n >= power(-40)) & (n <= power(100));

        let root = q.sqrt();
        let root_low = ((-root).mul_add(root, q) + q_low) / (root + root);
        let (s, carried) = two_sum(root, 1.0);
        let s_low = carried + root_low;
        let inverse = 1.0 / s;
        let left = (-inverse).mul_add(s_low, (-inverse).mul_add(s, 1.0));
        let mut w = (inverse, inverse * left);
        for _ in 0..4 {
            w = square(w);
        }

        weights[k] += w.0 * bone.largest;
        let mut weighted = [(0.0, 0.0); 4];
        for c in 0..4 {
            weighted[c] = product(w, (p.high[c][k], p.low[c][k]));
        }
        for r in 0..4 {
            let (mut high, mut rest) = (u.high[r][k], u.low[r][k]);
            for c in 0..4 {
                let (first, second) = two_product(bone.rows[r][c], weighted[c].0);
                let (next, carried) = two_sum(high, first);
                high = next;
                rest = bone.rows[r][c].mul_add(weighted[c].1, rest) + (carried + second);
            }
            (u.high[r][k], u.low[r][k]) = (high, rest);
        }
        near.sure[k] &= all_bits(decided & usable & (w.0 >= power(-400)));
        near.segment_end[k] |= all_bits(at_start | at_end);
        near.degenerate[k] |= all_bits(bone.point);
    }
}
