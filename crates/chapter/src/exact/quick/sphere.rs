//! The sphere (section 9.1).

use super::{Given, LEAST, Near, matrix, power};
use number::twofold::{TURN_OFF, WIDTH, all_bits, product, sin_cos_pi_near, sum, times, two_sum};

/// Words of the list of inputs that each sample has for itself: its parameters.
pub(super) const OWN: usize = 2;

/// Place of the matrix in the list of inputs.
const MATRIX: usize = OWN;

/// Bound of the error in parts of the largest entry of the matrix: each component of the point is a product of two
/// numbers of 1 at most, or one of them, and three count in a row; all else is far below.
const PART: f64 = 8.0 * TURN_OFF;

/// parameter, mc
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn sphere(given: &Given, near: &mut Near) {
    let (rows, largest) = matrix(&given.case, MATRIX);
    let [turn, half] = [&given.own[0], &given.own[1]];
    for k in 0..WIDTH {
        let [sin_th, cos_th] = sin_cos_pi_near(turn[k] + turn[k]);
        let [sin_ph, cos_ph] = sin_cos_pi_near(half[k]);
        let (x, z) = (product(sin_ph, cos_th), product(sin_ph, sin_th));
        for r in 0..4 {
            let row = &rows[r];
            let terms = [times(row[0], x), times(row[1], cos_ph), times(row[2], z), (row[3], 0.0)];
            let (high, rest) = sum(terms);
            (near.high[r][k], near.low[r][k]) = two_sum(high, rest);
        }
        near.off[k] = PART * largest + LEAST;
        let small = (turn[k].abs() <= power(19)) & (half[k].abs() <= power(20));
        near.sure[k] &= all_bits(small & (largest <= power(100)));
    }
}
