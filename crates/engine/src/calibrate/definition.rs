//! Whether a device computes an operation by its definition.
//!
//! A table by binades says little about operations whose error depends on more than one number: the
//! error of `pow(x, y)` grows with y where x is near 1, whatever x^y is, and a sum that cancels has
//! any error in ULP. If the errors of the parts of the definition bound every error that is seen,
//! they are the better bound.

use super::device::DISPATCH;
use super::{CalibrateError, Inputs};
use base::value::Batch;
use judge::profile::{Allowed, Definition, Entry, Op, Profile, grid};
use judge::single::kernel::pointwise;
use lanes::{Lane, Stage};

/// Operations with their definition and the parts of it.
const DEFINED: [(Op, Definition, &[Op]); 4] = [
    (Op::Tan, Definition::SinOverCos, &[Op::Sin, Op::Cos, Op::Div]),
    (Op::Pow, Definition::PowByExp2, &[Op::Log2, Op::Mul, Op::Exp2]),
    (Op::Mod, Definition::ModByFloor, &[Op::Div, Op::Floor, Op::Mul, Op::Sub]),
    (Op::Fma, Definition::MultiplyAdd, &[Op::Mul, Op::Add]),
];

/// Dispatches of samples of one operation.
const ROUNDS: u64 = 4;
/// Samples that have to bear witness.
const WITNESSES: usize = 1000;

/// The operations that `lane` computes by their definitions, as far as samples show: no error is
/// larger than the errors of the parts that `profile`, which was measured on it, bounds. Operations
/// that are correctly rounded anyway, or whose parts were not measured, are left out.
///
/// # Errors
/// [`CalibrateError`] when the lane fails.
pub fn confirmed(lane: &dyn Lane, profile: &Profile) -> Result<Vec<(Op, Definition)>, CalibrateError> {
    let measured = |op: &Op| matches!(profile.entry(*op), Entry::Measured(_));
    let mut found = Vec::new();
    for (op, definition, parts) in DEFINED {
        let rounded = matches!(profile.entry(op), Entry::Measured(table) if table.max_ulp() <= 0.5);
        if measured(&op) && !rounded && parts.iter().all(measured) && confirms(lane, profile, op)? {
            found.push((op, definition));
        }
    }
    Ok(found)
}

/// True when no sample contradicts, and enough are of use.
fn confirms(lane: &dyn Lane, profile: &Profile, op: Op) -> Result<bool, CalibrateError> {
    let kernel = pointwise(op)?;
    let inputs = Inputs::new(op);
    let arity = op.arity().unwrap_or(1);
    let mut runner = lane.prepare(&kernel, DISPATCH)?;
    let step = runner.capacity().clamp(1, DISPATCH) as u64;
    let mut witnesses = 0;
    for round in 0..ROUNDS {
        let mut batch = Batch::with_capacity(kernel.invocation.clone(), kernel.case.clone(), 1, step as usize);
        let samples = round * step..(round + 1) * step;
        batch.invocations.extend(samples.flat_map(|k| inputs.at(k).into_iter().take(arity)));
        let actual = runner.run(&batch)?;
        for k in 0..batch.invocation_count() {
            let mut args = [0.0; 3];
            for (to, word) in args.iter_mut().zip(batch.invocation(k)) {
                *to = f64::from(f32::from_bits(*word));
            }
            let args = &args[..arity];
            let (exact, result) = (op.exact(args), f64::from(f32::from_bits(actual.vertex(k, 0)[0])));
            let Some(limit) = by_parts(profile, op, args, exact) else { continue };
            // A NaN is no witness for the formula.
            if (result - exact).abs() <= limit {
                witnesses += 1;
            } else {
                return Ok(false);
            }
        }
    }
    Ok(witnesses >= WITNESSES)
}

/// How far the definition may lead away from the exact value; `None` where a part is not bounded,
/// where a subnormal number or an overflow comes in between, or where the bound says little.
pub(super) fn by_parts(profile: &Profile, op: Op, args: &[f64], exact: f64) -> Option<f64> {
    let normal = |x: f64| (grid::MIN_NORMAL..=grid::MAX_FINITE).contains(&x.abs());
    if !normal(exact) || args.iter().any(|x| *x != 0.0 && !normal(*x)) {
        return None;
    }
    // The value of a part, and its error when its result lies up to `off` further away than exact.
    let part = |op: Op, args: &[f64], off: f64| {
        let value = op.exact(args);
        match profile.allowed(op, args, value.abs() + off, Stage::Compute) {
            Allowed::Bound(error) if error.is_finite() && normal(value) => Some((value, error)),
            _ => None,
        }
    };
    let at = |k: usize| args.get(k).copied();
    let limit = match op {
        Op::Tan => {
            let ((s, s_error), (c, c_error)) = (part(Op::Sin, args, 0.0)?, part(Op::Cos, args, 0.0)?);
            if c_error > c.abs() / 16.0 {
                return None;
            }
            let passed = (s_error + exact.abs() * c_error) / (c.abs() - c_error);
            passed + part(Op::Div, &[s, c], passed)?.1
        }
        Op::Pow => {
            let y = at(1)?;
            let (log, log_error) = part(Op::Log2, &args[..1], 0.0)?;
            let passed = y.abs() * log_error;
            let (exponent, error) = part(Op::Mul, &[y, log], passed)?;
            let growth = (passed + error).exp2();
            let moved = exact * (growth - 1.0);
            moved + part(Op::Exp2, &[exponent], moved)?.1 * growth
        }
        Op::Mod => {
            let (x, y) = (at(0)?, at(1)?);
            let (quotient, error) = part(Op::Div, &[x, y], 0.0)?;
            let whole = quotient.floor();
            if (quotient - error).floor() != (quotient + error).floor() || whole == 0.0 {
                return None;
            }
            let (product, passed) = part(Op::Mul, &[y, whole], 0.0)?;
            passed + part(Op::Sub, &[x, product], passed)?.1
        }
        Op::Fma => {
            let (product, passed) = part(Op::Mul, &args[..2], 0.0)?;
            passed + part(Op::Add, &[product, at(2)?], passed)?.1
        }
        _ => return None,
    };
    // With room for what is of second order.
    Some(limit * (1.0 + 1e-3)).filter(|limit| *limit < exact.abs() / 16.0 || op == Op::Fma || op == Op::Mod)
}

#[cfg(test)]
mod tests {
    use super::super::tests::Soft;
    use super::*;
    use judge::profile::by_name;

    /// A device whose parts were measured; the host is more accurate.
    fn strict() -> &'static Profile {
        by_name("llvmpipe-22.3.6").unwrap()
    }

    #[test]
    fn operations_by_their_definition_are_confirmed() {
        let pow: fn(&[f32]) -> f32 = |a| (f64::from(a[1]) * f64::from(a[0]).log2()).exp2() as f32;
        assert!(confirms(&Soft::new(pow), strict(), Op::Pow).unwrap());
        assert!(confirms(&Soft::new(|a| a[0] * a[1] + a[2]), strict(), Op::Fma).unwrap());
        assert!(confirms(&Soft::new(|a| a[0].mul_add(a[1], a[2])), strict(), Op::Fma).unwrap(), "it is better");
        assert!(confirms(&Soft::new(|a| a[0] - a[1] * (a[0] / a[1]).floor()), strict(), Op::Mod).unwrap());
        assert!(confirms(&Soft::new(|a| a[0].sin() / a[0].cos()), strict(), Op::Tan).unwrap());
    }

    #[test]
    fn operations_that_are_further_off_are_not() {
        // A logarithm of 16 bits, a product that lost its last bits, a remainder with a wrong bit.
        let pow: fn(&[f32]) -> f32 = |a| (a[1] * f32::from_bits(a[0].log2().to_bits() & !0xff)).exp2();
        assert!(!confirms(&Soft::new(pow), strict(), Op::Pow).unwrap());
        let fma: fn(&[f32]) -> f32 = |a| f32::from_bits((a[0] * a[1]).to_bits() & !7) + a[2];
        assert!(!confirms(&Soft::new(fma), strict(), Op::Fma).unwrap());
        let modulo: fn(&[f32]) -> f32 = |a| f32::from_bits((a[0] - a[1] * (a[0] / a[1]).floor()).to_bits() ^ 0x10);
        assert!(!confirms(&Soft::new(modulo), strict(), Op::Mod).unwrap());
        assert!(!confirms(&Soft::new(|a| a[0].tan() + 1e-5), strict(), Op::Tan).unwrap());
        assert!(!confirms(&Soft::new(|_| f32::NAN), strict(), Op::Tan).unwrap());
    }

    #[test]
    fn what_was_not_measured_is_not_asked() {
        let promise = by_name("vulkan-1.4").unwrap();
        assert_eq!(confirmed(&Soft::new(|_| f32::NAN), promise).unwrap(), []);
    }
}
