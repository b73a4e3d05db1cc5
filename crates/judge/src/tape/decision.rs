//! Whether a comparison could have gone the other way on a conforming device.

use crate::profile::grid::MIN_NORMAL;
use program::interp::Comparison;

/// A number, and how far a device's may be from it.
type About = (f64, f64);

/// True when two numbers are nearer to each other than their errors. A radius that is no number says nothing
/// about the decision.
pub(super) fn is_near((x, ex): About, (y, ey): About) -> bool {
    let reach = ex + ey;
    reach != 0.0 && !((x - y).abs() > reach)
}

/// True when an operand may be subnormal and the answer is another one with zero in its place. Each operand is
/// flushed or kept for itself: specifications ask for no agreement, not even between two uses of one value.
pub(super) fn flush_decides(op: Comparison, x: About, y: About) -> bool {
    let zero = (0.0, 0.0);
    let answer = op.holds(x.0, y.0);
    let other = |x: About, y: About| op.holds(x.0, y.0) != answer || is_near(x, y);
    let (flushes_x, flushes_y) = (is_subnormal(x), is_subnormal(y));
    (flushes_x && other(zero, y)) || (flushes_y && other(x, zero)) || (flushes_x && flushes_y && other(zero, zero))
}

/// True when some number within the radius is subnormal.
fn is_subnormal((x, e): About) -> bool {
    x.abs() - e < MIN_NORMAL && x.abs() + e > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flush_decides_where_the_answer_changes_and_nowhere_else() {
        const TINY: About = (1e-40, 0.0);
        const MINUS: About = (-1e-40, 0.0);
        const ZERO: About = (0.0, 0.0);
        const ONE: About = (1.0, 0.0);
        use Comparison::{Equal, Greater, GreaterEqual, Less, LessEqual, NotEqual};
        for (op, x, y, expected) in [
            (Equal, TINY, ZERO, true),
            (NotEqual, TINY, ZERO, true),
            (Greater, TINY, ZERO, true),
            (LessEqual, TINY, ZERO, true),
            // Zero and a positive number answer alike.
            (Less, TINY, ZERO, false),
            (GreaterEqual, TINY, ZERO, false),
            (Less, MINUS, ZERO, true),
            (Greater, MINUS, ZERO, false),
            (Less, TINY, ONE, false),
            (Equal, TINY, ONE, false),
            (Equal, TINY, MINUS, true),
            (Less, MINUS, TINY, true),
            (Equal, TINY, TINY, true),
            (Equal, (1.2e-38, 0.0), ZERO, false),
            (Equal, ZERO, ZERO, false),
            // The other operand may be zero within its error.
            (Less, TINY, (1e-3, 2e-3), true),
        ] {
            assert_eq!(flush_decides(op, x, y), expected, "{op:?} {x:?} {y:?}");
        }
    }
}
