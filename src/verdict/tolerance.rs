//! How far an output may be from the formula. Everything about a tolerance that a suite states is
//! in this file.
//!
//! A suite states a number of ULP. They are ULP *at the scale of the inputs*: of the largest
//! component of the output variable, plus the root of the sum over all inputs of (X · ∂y/∂x)², which is
//! how much of the inputs' own size passes through to the output: their roundings are independent. A sum that cancels keeps the scale of what
//! was summed, and a quotient by a small length gets the scale of what was divided.
//!
//! X is the size of the input: |x| for a number; for a component of a vector or matrix, the largest
//! component of all vectors, or all matrices, since they are added to each other: where the second
//! end of a bone is nearest, the first one drops out of the distance, and still gives its size to
//! the differences from which the distance is computed.

use crate::value::ulp_at;

/// A tolerance in ULP at the scale of the inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Number of ULP; positive.
    pub ulp: f64,
}

/// Beyond this relative size a tolerance says nothing: 2^-10, as for any ill-conditioned sample.
const USELESS: f64 = 1.0 / 1024.0;

impl Tolerance {
    /// The tolerance at a given scale. A result in the subnormal range may be flushed to zero.
    /// Infinite when the scale is no number: nothing can be said then.
    pub fn at(&self, scale: f64) -> f64 {
        if scale.is_finite() { self.ulp * ulp_at(scale) + f64::from(f32::MIN_POSITIVE) } else { f64::INFINITY }
    }

    /// True when a tolerance at `scale` is no test of an output of size `size` any more.
    pub fn is_useless(&self, scale: f64, size: f64) -> bool {
        self.at(scale) > USELESS * size.max(f64::from(f32::MIN_POSITIVE))
    }
}

/// Relative step by which an input is moved to see what it does: small against the curvature of
/// every formula at hand, large against the rounding of binary64.
const STEP: f64 = 1.0 / (1 << 20) as f64;

/// Inputs that share a size: see the head of this file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// An integer: exact, never moved.
    Exact,
    /// A number of its own.
    Single,
    /// A component of a vector.
    Vector,
    /// A component of a matrix.
    Matrix,
}

/// For each output, √Σ (X · ∂y/∂x)² over the inputs, by moving one input at a time. `eval` gives the
/// outputs of the inputs, always the same number of them. An output that jumps, or that loses its
/// value, counts as infinitely sensitive.
///
/// `enough` is shown the sums of squares after each input and may end the search: they only grow, so
/// a scale that suffices already suffices in the end.
pub fn sensitivity(
    inputs: &[f64],
    families: &[Family],
    base: &[f64],
    mut eval: impl FnMut(&[f64], &mut Vec<f64>),
    enough: &mut dyn FnMut(&[f64]) -> bool,
) -> Vec<f64> {
    let largest = |family| {
        let of = inputs.iter().zip(families).filter(|(_, f)| **f == family);
        of.fold(0.0_f64, |m, (x, _)| m.max(x.abs()))
    };
    let mut squares = vec![0.0; base.len()];
    let mut moved = inputs.to_vec();
    let mut outputs = Vec::with_capacity(base.len());
    // Matrices first: their components weigh most where there are any.
    'search: for family in [Family::Matrix, Family::Vector, Family::Single] {
        let shared = largest(family);
        for (k, &x) in inputs.iter().enumerate().filter(|(k, _)| families[*k] == family) {
            let size = if family == Family::Single { x.abs() } else { shared };
            if size == 0.0 {
                continue;
            }
            moved[k] = x + size * STEP;
            outputs.clear();
            eval(&moved, &mut outputs);
            moved[k] = x;
            if outputs.len() != base.len() {
                squares.fill(f64::INFINITY);
                break 'search;
            }
            for ((sum, &y), &y0) in squares.iter_mut().zip(&outputs).zip(base) {
                let change = (y - y0) / STEP;
                *sum += if change.is_nan() { f64::INFINITY } else { change * change };
            }
            if enough(&squares) {
                break 'search;
            }
        }
    }
    squares.iter_mut().for_each(|sum| *sum = sum.sqrt());
    squares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cancelling_difference_keeps_the_scale_of_its_terms() {
        let eval = |x: &[f64], out: &mut Vec<f64>| out.push(x[0] - x[1]);
        let sum = sensitivity(&[1000.0, 999.9], &[Family::Single; 2], &[0.1], eval, &mut |_| false);
        assert!((sum[0] - 1000.0_f64.hypot(999.9)).abs() < 1e-2, "{sum:?}");
    }

    #[test]
    fn vectors_share_their_size_and_numbers_do_not() {
        // y = x0; the second input does not matter, but for its size.
        let eval = |x: &[f64], out: &mut Vec<f64>| out.push(x[0]);
        let with = |family| sensitivity(&[0.0, 8.0], &[family; 2], &[0.0], eval, &mut |_| false)[0];
        assert!((with(Family::Vector) - 8.0).abs() < 1e-6);
        assert_eq!(with(Family::Single), 0.0);
    }

    #[test]
    fn the_search_ends_when_it_is_told_to() {
        let eval = |x: &[f64], out: &mut Vec<f64>| out.push(x.iter().sum());
        let mut inputs = 0;
        let mut two = |squares: &[f64]| {
            inputs += 1;
            squares[0] > 1.5
        };
        let sum = sensitivity(&[1.0; 9], &[Family::Single; 9], &[9.0], eval, &mut two);
        assert!((sum[0] - 2.0_f64.sqrt()).abs() < 1e-6, "{sum:?}");
        assert_eq!(inputs, 2);
    }

    #[test]
    fn integers_are_not_moved() {
        let eval = |x: &[f64], out: &mut Vec<f64>| out.push(x[0]);
        assert_eq!(sensitivity(&[7.0], &[Family::Exact], &[7.0], eval, &mut |_| false), [0.0]);
    }

    #[test]
    fn a_value_that_is_lost_is_infinitely_sensitive() {
        let eval = |x: &[f64], out: &mut Vec<f64>| out.push((1.0 - x[0]).sqrt());
        assert_eq!(sensitivity(&[1.0], &[Family::Single], &[0.0], eval, &mut |_| false), [f64::INFINITY]);
    }

    #[test]
    fn a_tolerance_of_the_size_of_the_output_is_useless() {
        let tolerance = Tolerance { ulp: 16.0 };
        assert!(!tolerance.is_useless(1.0, 1.0));
        assert!(tolerance.is_useless(1e6, 1e-3));
    }
}
