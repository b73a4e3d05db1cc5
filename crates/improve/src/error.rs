//! How far a node is off in binary32, of how far its operands are: a first-order estimate with the roundings of the node.

use crate::term::{Binary, Node, Unary};

/// Smallest normal number of binary32.
pub const SMALLEST: f64 = f32::MIN_POSITIVE as f64;
const LARGEST: f64 = f32::MAX as f64;

/// The distance of neighbours of binary32 at a number.
pub fn ulp(x: f64) -> f64 {
    let size = x.abs().max(SMALLEST);
    let exponent = (size.to_bits() >> 52) as i32 - 1023;
    2f64.powi(exponent - 23)
}

/// Bits that an error takes away: 0 where it is the rounding of one operation.
pub fn bits(error: f64, value: f64) -> f64 {
    if !error.is_finite() || !value.is_finite() { WORST } else { (1.0 + error / ulp(value)).log2().min(WORST) }
}

/// Bits that are lost where nothing is right.
pub const WORST: f64 = 32.0;

/// Half a unit in the last place of a result; infinite where it overflows.
fn rounding(value: f64) -> f64 {
    if value.is_nan() || value.abs() > LARGEST {
        f64::INFINITY
    } else if value.abs() < SMALLEST {
        // Flushed, as a device may do.
        value.abs()
    } else {
        0.5 * ulp(value)
    }
}

/// The error of a node at a point: `value` is its value there, `of` the values of the operands with their errors.
pub fn of(node: &Node, value: f64, of: &[(f64, f64)]) -> f64 {
    let carried = match (node, of) {
        (Node::Number(_) | Node::Leaf(_) | Node::Pi, _) => return constant(node, value),
        (Node::Unary(f, _), [(x, e)]) => unary(*f, value, *x, *e),
        (Node::Binary(f, _), [a, b]) => binary(*f, value, *a, *b),
        _ => f64::INFINITY,
    };
    let exact = matches!(node, Node::Unary(Unary::Neg | Unary::Abs, _) | Node::Binary(Binary::Min | Binary::Max, _))
        || scales(node, of)
        || cancels(node, of);
    let total = if exact { carried } else { carried + rounding(value) };
    if total.is_nan() { f64::INFINITY } else { total }
}

/// What a constant is off once it is one of binary32.
#[expect(clippy::cast_possible_truncation, reason = "a literal of binary32")]
fn constant(node: &Node, value: f64) -> f64 {
    if matches!(node, Node::Leaf(_)) { 0.0 } else { (f64::from(value as f32) - value).abs() }
}

/// A product or quotient with a power of two is exact.
fn scales(node: &Node, of: &[(f64, f64)]) -> bool {
    let power = |k: usize| of.get(k).is_some_and(|(x, e)| *e == 0.0 && x.to_bits() << 12 == 0 && *x != 0.0);
    match node {
        Node::Binary(Binary::Mul, _) => power(0) || power(1),
        Node::Binary(Binary::Div, _) => power(1),
        _ => false,
    }
}

/// A difference of numbers within a factor of two is exact.
fn cancels(node: &Node, of: &[(f64, f64)]) -> bool {
    let [(a, _), (b, _)] = of else { return false };
    let b = match node {
        Node::Binary(Binary::Sub, _) => *b,
        Node::Binary(Binary::Add, _) => -b,
        _ => return false,
    };
    a * b > 0.0 && a.abs() <= 2.0 * b.abs() && b.abs() <= 2.0 * a.abs()
}

fn unary(f: Unary, value: f64, x: f64, e: f64) -> f64 {
    let whole = f64::INFINITY;
    match f {
        Unary::Neg | Unary::Abs => e,
        Unary::Sqrt if e > x.abs() => whole,
        Unary::Sqrt | Unary::SafeSqrt => e.sqrt().min(0.5 * e / value.abs()),
        Unary::InverseSqrt => {
            if e >= x.abs() {
                whole
            } else {
                0.5 * value.abs() * e / (x.abs() - e)
            }
        }
        Unary::Sin => (x.cos().abs() * e + 0.5 * e * e).min(2.0),
        Unary::Cos => (x.sin().abs() * e + 0.5 * e * e).min(2.0),
        Unary::Tan => (1.0 + value * value) * e * (1.0 + value.abs() * e),
        Unary::Asin | Unary::Acos if x.abs() + e > 1.0 && e > 0.0 => whole,
        Unary::Asin | Unary::Acos | Unary::SafeAsin | Unary::SafeAcos => {
            (e / (1.0 - x * x).max(0.0).sqrt()).min((2.0 * e).sqrt())
        }
        Unary::Atan => e / (1.0 + x * x),
        Unary::Sinh => x.cosh() * e,
        Unary::Cosh => x.sinh().abs() * e + 0.5 * e * e,
        Unary::Tanh => (1.0 - value * value).max(0.0) * e,
        Unary::Asinh => e / x.hypot(1.0),
        Unary::Acosh => {
            if x - e < 1.0 && e > 0.0 {
                whole
            } else {
                e / (x * x - 1.0).sqrt()
            }
        }
        Unary::Atanh => {
            if x.abs() + e >= 1.0 {
                whole
            } else {
                e / (1.0 - x * x)
            }
        }
        Unary::Exp => value.abs() * e.exp_m1(),
        Unary::Exp2 => value.abs() * (e * std::f64::consts::LN_2).exp_m1(),
        Unary::Log => {
            if e >= x.abs() {
                whole
            } else {
                -(-e / x.abs()).ln_1p()
            }
        }
        Unary::Log2 => {
            if e >= x.abs() {
                whole
            } else {
                -(-e / x.abs()).ln_1p() / std::f64::consts::LN_2
            }
        }
    }
}

fn binary(f: Binary, value: f64, (a, ea): (f64, f64), (b, eb): (f64, f64)) -> f64 {
    match f {
        Binary::Add | Binary::Sub => ea + eb,
        Binary::Mul => times(b, ea) + times(a, eb) + times(ea, eb),
        Binary::Div if eb >= b.abs() => f64::INFINITY,
        Binary::Div => (ea + times(value, eb)) / (b.abs() - eb),
        Binary::Pow if ea >= a.abs() => f64::INFINITY,
        Binary::Pow => value.abs() * (times(b, ea) / (a.abs() - ea) + times(a.abs().ln(), eb)).exp_m1(),
        Binary::Atan2 => (times(b, ea) + times(a, eb)) / (a * a + b * b).max(f64::MIN_POSITIVE),
        Binary::Min | Binary::Max => ea.max(eb),
    }
}

/// |x|·e, where no error is none of anything.
fn times(x: f64, e: f64) -> f64 {
    if e == 0.0 || x == 0.0 { 0.0 } else { (x * e).abs() }
}
