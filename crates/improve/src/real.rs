//! What a node is in real numbers: with 320 bits, so that the difference of two nearly equal numbers of binary32 still has
//! more digits than binary64.

use astro_float::{BigFloat, Consts, RoundingMode, WORD_BIT_SIZE};

use crate::term::{Binary, Node, Unary};

/// Bits of a number.
const BITS: usize = 320;
const ROUND: RoundingMode = RoundingMode::ToEven;

/// A power of two beyond which exponentials are infinite or zero.
const HUGE: i32 = 40;

/// Beyond 2 to this power an angle has no digits left.
const WIDE: i32 = 160;

/// Numbers that differ by no more than this part of their size are the same.
const SAME: i32 = 70;

/// A real number; NaN where an expression has no value.
pub type Real = BigFloat;

/// Computes nodes.
#[derive(Debug)]
pub struct Computer {
    constants: Consts,
}

impl Computer {
    /// # Errors
    /// When there is no memory for constants.
    pub fn new() -> Result<Self, String> {
        Consts::new().map(|constants| Self { constants }).map_err(|error| error.to_string())
    }

    /// The value of a node, of those of its operands.
    pub fn node(&mut self, node: &Node, operands: &[&Real]) -> Real {
        match (node, operands) {
            (Node::Number(c), _) => exact(c.value()),
            (Node::Pi, _) => self.pi(),
            (Node::Unary(of, _), [x]) => self.unary(*of, x),
            (Node::Binary(of, _), [a, b]) => self.binary(*of, a, b),
            // The value of a leaf is that of a point.
            _ => BigFloat::nan(None),
        }
    }

    fn pi(&mut self) -> Real {
        self.constants.pi(BITS, ROUND)
    }

    fn unary(&mut self, of: Unary, x: &Real) -> Real {
        let c = &mut self.constants;
        let one = || exact(1.0);
        if x.is_nan() {
            return BigFloat::nan(None);
        }
        let size = x.exponent().unwrap_or(0);
        let angle = matches!(of, Unary::Sin | Unary::Cos | Unary::Tan);
        let grows = matches!(of, Unary::Exp | Unary::Exp2 | Unary::Sinh | Unary::Cosh);
        if (angle && (size > WIDE || x.is_inf())) || (grows && size > HUGE) {
            return BigFloat::nan(None);
        }
        match of {
            Unary::Neg => x.neg(),
            Unary::Abs => {
                if x.is_negative() {
                    x.neg()
                } else {
                    x.clone()
                }
            }
            Unary::Sqrt => x.sqrt(BITS, ROUND),
            Unary::InverseSqrt => one().div(&x.sqrt(BITS, ROUND), BITS, ROUND),
            Unary::Sin => x.sin(BITS, ROUND, c),
            Unary::Cos => x.cos(BITS, ROUND, c),
            Unary::Tan => x.tan(BITS, ROUND, c),
            Unary::Asin => x.asin(BITS, ROUND, c),
            Unary::Acos => x.acos(BITS, ROUND, c),
            Unary::Atan => x.atan(BITS, ROUND, c),
            Unary::Sinh => x.sinh(BITS, ROUND, c),
            Unary::Cosh => x.cosh(BITS, ROUND, c),
            Unary::Tanh => x.tanh(BITS, ROUND, c),
            Unary::Asinh => x.asinh(BITS, ROUND, c),
            Unary::Acosh => x.acosh(BITS, ROUND, c),
            Unary::Atanh => x.atanh(BITS, ROUND, c),
            Unary::Exp => x.exp(BITS, ROUND, c),
            Unary::Log => x.ln(BITS, ROUND, c),
            Unary::Exp2 => exact(2.0).pow(x, BITS, ROUND, c),
            Unary::Log2 => x.log2(BITS, ROUND, c),
            Unary::SafeSqrt => exact(0.0).max(x).sqrt(BITS, ROUND),
            Unary::SafeAsin => x.max(&exact(-1.0)).min(&one()).asin(BITS, ROUND, c),
            Unary::SafeAcos => x.max(&exact(-1.0)).min(&one()).acos(BITS, ROUND, c),
        }
    }

    fn binary(&mut self, of: Binary, a: &Real, b: &Real) -> Real {
        if a.is_nan() || b.is_nan() {
            return BigFloat::nan(None);
        }
        match of {
            Binary::Add => a.add(b, BITS, ROUND),
            Binary::Sub => a.sub(b, BITS, ROUND),
            Binary::Mul => a.mul(b, BITS, ROUND),
            Binary::Div => a.div(b, BITS, ROUND),
            Binary::Min => a.min(b),
            Binary::Max => a.max(b),
            Binary::Pow => {
                let log = if a.is_zero() || a.is_positive() {
                    a.ln(BITS, ROUND, &mut self.constants)
                } else {
                    BigFloat::nan(None)
                };
                let exponent = log.mul(b, BITS, ROUND);
                self.unary(Unary::Exp, &exponent)
            }
            Binary::Atan2 => {
                if b.is_zero() && a.is_zero() {
                    return BigFloat::nan(None);
                }
                let turned = |computer: &mut Self, by: f64| computer.pi().mul(&exact(by), BITS, ROUND);
                if b.is_zero() {
                    return turned(self, if a.is_negative() { -0.5 } else { 0.5 });
                }
                let angle = a.div(b, BITS, ROUND).atan(BITS, ROUND, &mut self.constants);
                if b.is_positive() {
                    return angle;
                }
                let half = turned(self, if a.is_negative() { -1.0 } else { 1.0 });
                angle.add(&half, BITS, ROUND)
            }
        }
    }
}

/// A number of binary64 that is not subnormal.
pub fn exact(x: f64) -> Real {
    BigFloat::from_f64(x, BITS)
}

/// The nearest number of binary64, towards zero; infinite and NaN as they are.
pub fn near(x: &Real) -> f64 {
    if x.is_zero() {
        return 0.0;
    }
    let Some((words, _, _, exponent, _)) = x.as_raw_parts() else {
        return if x.is_inf_pos() {
            f64::INFINITY
        } else if x.is_inf_neg() {
            f64::NEG_INFINITY
        } else {
            f64::NAN
        };
    };
    // A word has as many bits as the machine: 32 in a browser.
    let upper =
        words.iter().rev().take(64 / WORD_BIT_SIZE).fold(0_u128, |top, &w| top << WORD_BIT_SIZE | u128::from(w));
    let top = upper as f64 / 2f64.powi(64);
    let exponent = exponent.clamp(-1000, 1000);
    let size = top * 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2);
    if x.is_negative() { -size } else { size }
}

/// True for a number.
pub fn is_finite(x: &Real) -> bool {
    !x.is_nan() && !x.is_inf()
}

/// True for numbers that are the same but for the rounding of 320 bits.
pub fn same(a: &Real, b: &Real) -> bool {
    if a.is_zero() && b.is_zero() {
        return true;
    }
    let far = a.sub(b, BITS, ROUND);
    let size = a.exponent().unwrap_or(i32::MIN).max(b.exponent().unwrap_or(i32::MIN));
    far.is_zero() || far.exponent().is_some_and(|exponent| exponent <= size - SAME)
}
