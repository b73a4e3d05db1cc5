//! The results of one operation that a profile accepts, as an interval around the exact value.
//!
//! Operations that are defined by a formula are expanded, and every operation of the formula may err
//! by what the profile allows it. The intervals are evaluated in binary64; its rounding, at most
//! 2^-28 ULP of binary32 an operation, is not accounted for.

use super::grid::{self, Interval};
use super::{Acceptance, Definition, Entry, Flush, Op, Piece, Profile, Rounding, Rule};
use program::lane::Stage;

/// Why any result is accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Free {
    /// Nothing is promised for the operation, or for one that defines it.
    NoPromise,
    /// Nothing is promised for these arguments, or the exact value is undefined there.
    OutsideDomain,
}

/// The accepted results of a scalar operation with these arguments, by a promise; a measured entry
/// promises nothing.
///
/// # Errors
/// [`Free`] when any result is accepted.
pub fn accept(profile: &Profile, op: Op, args: &[f64], stage: Stage) -> Result<Interval, Free> {
    let points: [Interval; 3] = std::array::from_fn(|k| Interval::point(args.get(k).copied().unwrap_or(f64::NAN)));
    let scope = AcceptedScope { profile, stage };
    let count = args.len().min(3);
    let mut accepted = scope.apply(op, &points[..count])?;
    // An argument that may be flushed may also be zero, and a zero that of the other sign; all combinations count.
    let least = |x: f64| if x == 0.0 { grid::MIN_NORMAL / 2.0 } else { x };
    let flushed = |k: usize| profile.argument_flush(least(args[k]), stage) > 0.0;
    if (0..count).any(flushed) {
        // The sign of such a zero is not promised, and `atan2` tells the two apart.
        for (combination, zero) in (1_u32..1 << count).flat_map(|c| [(c, 0.0), (c, -0.0)]) {
            if (0..count).any(|k| combination >> k & 1 == 1 && !flushed(k)) {
                continue;
            }
            let mut points = points;
            for (k, point) in points.iter_mut().enumerate() {
                if combination >> k & 1 == 1 {
                    *point = Interval::point(zero);
                }
            }
            accepted = accepted.join(scope.apply(op, &points[..count])?);
        }
    }
    Ok(accepted)
}

/// The accepted results around an exact value that the caller knows, for operations on what is no
/// real number: `ldexp` and conversions of integers. `args` are the arguments as numbers; flushed
/// ones are not accounted for.
///
/// # Errors
/// [`Free`] when any result is accepted.
pub fn accept_near(profile: &Profile, op: Op, args: &[f64], exact: f64, stage: Stage) -> Result<Interval, Free> {
    let points: [Interval; 3] = std::array::from_fn(|k| Interval::point(args.get(k).copied().unwrap_or(f64::NAN)));
    let points = &points[..args.len().min(3)];
    let Entry::Promised(pieces) = profile.entry(op) else { return Err(Free::NoPromise) };
    if exact.is_nan() {
        return Err(Free::OutsideDomain);
    }
    AcceptedScope { profile, stage }.open(pieces, Interval::point(exact), points)
}

/// An error that a profile accepts wherever it promises anything: a quick sieve before [`accept`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sieve {
    /// Errors up to this many ULP at the exact value are accepted.
    pub ulp: f64,
    /// Absolute errors up to this are accepted.
    pub abs: f64,
}

impl Sieve {
    /// A sieve that lets nothing pass.
    pub const NONE: Self = Self { ulp: 0.0, abs: 0.0 };

    /// For all arguments, or for the arguments of a function of one argument that lie in a range.
    pub fn new(profile: &Profile, op: Op, range: Option<Interval>) -> Self {
        let Entry::Promised(pieces) = profile.entry(op) else { return Self::NONE };
        let mut sieve = Self { ulp: f64::INFINITY, abs: f64::INFINITY };
        for piece in pieces.iter().filter(|piece| range.is_none_or(|range| piece.touches(&[range]))) {
            let part = Self::of_rule(&piece.rule, profile.rounding);
            sieve = Self { ulp: sieve.ulp.min(part.ulp), abs: sieve.abs.min(part.abs) };
            // The first piece that covers a point counts.
            if range.is_some_and(|range| piece.covers(&[range])) {
                break;
            }
        }
        sieve
    }

    fn of_rule(rule: &Rule, rounding: Rounding) -> Self {
        let ulp = |ulp| Self { ulp, abs: 0.0 };
        match *rule {
            Rule::Exact => Self::NONE,
            // Less than one gap away and on the grid is one of the two neighbours.
            Rule::Rounded => match rounding {
                Rounding::Either => ulp(1.0 - 1e-6),
                Rounding::NearestEven => ulp(0.5 - 1e-6),
            },
            Rule::Ulp { constant, .. } => ulp(constant),
            // The ends of the interval are rounded.
            Rule::Absolute(error) => Self { ulp: 0.0, abs: error * (1.0 - 1e-6) },
            Rule::Inherited { definition, .. } => match definition {
                Definition::SqrtByInverseSqrt | Definition::SinOverCos | Definition::SinhOverCosh => ulp(2.5),
                Definition::AsinByAtan2 | Definition::AcosByAtan2 => ulp(4096.0),
                Definition::PowByExp2 => ulp(3.0),
                _ => Self::NONE,
            },
            Rule::NoPromise => Self { ulp: f64::INFINITY, abs: f64::INFINITY },
        }
    }

    /// True when an error is accepted for certain; never for NaN.
    #[inline]
    pub fn passes(self, ulp: f64, abs: f64) -> bool {
        // Not a short circuit: loops with this are to vectorise.
        (ulp <= self.ulp) | (abs <= self.abs)
    }
}

/// False when a profile promises nothing for any argument in a range, for a function of one argument.
pub fn may_promise(profile: &Profile, op: Op, range: Interval) -> bool {
    let Entry::Promised(pieces) = profile.entry(op) else { return false };
    pieces.iter().any(|piece| {
        let by_rule = match piece.rule {
            Rule::NoPromise => false,
            Rule::Inherited { definition: Definition::SinOverCos, .. } => {
                may_promise(profile, Op::Sin, range) && may_promise(profile, Op::Cos, range)
            }
            Rule::Exact | Rule::Rounded | Rule::Ulp { .. } | Rule::Absolute(_) | Rule::Inherited { .. } => true,
        };
        by_rule && piece.touches(&[range])
    })
}

struct AcceptedScope<'a> {
    profile: &'a Profile,
    stage: Stage,
}

impl AcceptedScope<'_> {
    /// What an operation may give for arguments somewhere in a box.
    fn apply(&self, op: Op, args: &[Interval]) -> Result<Interval, Free> {
        let Entry::Promised(pieces) = self.profile.entry(op) else { return Err(Free::NoPromise) };
        // The domain first: the value costs more.
        if !pieces.iter().any(|p| p.touches(args)) {
            return Err(Free::OutsideDomain);
        }
        self.open(pieces, exact_range(op, args).ok_or(Free::OutsideDomain)?, args)
    }

    /// What the rules of an operation open around its exact values.
    fn open(&self, pieces: &[Piece], range: Interval, args: &[Interval]) -> Result<Interval, Free> {
        let mut accepted: Option<Interval> = None;
        // The first piece that covers a point counts: later ones count for what earlier ones leave.
        let mut covered = false;
        for piece in pieces.iter().filter(|p| p.touches(args)) {
            let part = self.around(&piece.rule, range, args)?;
            // An infinite error at an infinite value leaves no end.
            if part.lo.is_nan() || part.hi.is_nan() {
                return Err(Free::OutsideDomain);
            }
            accepted = Some(accepted.map_or(part, |a| a.join(part)));
            covered = piece.covers(args);
            if covered {
                break;
            }
        }
        let mut accepted = accepted.filter(|_| covered).ok_or(Free::OutsideDomain)?;
        let tiny = Interval { lo: -grid::MIN_NORMAL, hi: grid::MIN_NORMAL };
        let touches_tiny = accepted.lo < tiny.hi && tiny.lo < accepted.hi;
        if touches_tiny && self.profile.flush(self.stage) != Flush::Never {
            accepted = accepted.join(Interval::point(0.0));
        }
        // "any value of magnitude larger than that of the largest representable finite number":
        // infinity and the largest number are accepted as well.
        if accepted.hi > grid::MAX_FINITE {
            accepted = accepted.join(Interval { lo: grid::MAX_FINITE, hi: f64::INFINITY });
        }
        if accepted.lo < -grid::MAX_FINITE {
            accepted = accepted.join(Interval { lo: f64::NEG_INFINITY, hi: -grid::MAX_FINITE });
        }
        Ok(accepted)
    }

    /// The interval that a rule opens around exact values.
    fn around(&self, rule: &Rule, range: Interval, args: &[Interval]) -> Result<Interval, Free> {
        let widened = |lo: f64, hi: f64| {
            let wide = Interval { lo: range.lo - lo, hi: range.hi + hi };
            match self.profile.acceptance {
                Acceptance::Text => wide,
                Acceptance::Outward => Interval { lo: grid::down(wide.lo), hi: grid::up(wide.hi) },
            }
        };
        Ok(match *rule {
            Rule::Exact => range,
            Rule::Rounded => match self.profile.rounding {
                Rounding::Either => Interval { lo: grid::down(range.lo), hi: grid::up(range.hi) },
                Rounding::NearestEven => Interval { lo: grid::nearest(range.lo), hi: grid::nearest(range.hi) },
            },
            Rule::Ulp { constant, slope } => {
                let size = constant + slope * args.first().map_or(0.0, |x| x.magnitude());
                // An end beyond the range has no ULP; the largest number's is the one meant.
                let ulp = |x: f64| grid::ulp(x.clamp(-grid::MAX_FINITE, grid::MAX_FINITE));
                widened(size * ulp(range.lo), size * ulp(range.hi))
            }
            Rule::Absolute(error) => widened(error, error),
            Rule::Inherited { definition, or } => {
                let formula = self.expand(definition, args)?;
                let error = (range.hi - formula.lo).max(formula.hi - range.lo).max(or);
                if error.is_nan() {
                    return Err(Free::OutsideDomain);
                }
                // The formula's own results, which the sums above may have missed by their rounding.
                widened(error, error).join(formula)
            }
            Rule::NoPromise => return Err(Free::NoPromise),
        })
    }

    /// What a formula may give.
    fn expand(&self, definition: Definition, args: &[Interval]) -> Result<Interval, Free> {
        let at = |k: usize| args.get(k).copied().ok_or(Free::NoPromise);
        let one = Interval::point(1.0);
        let half = Interval::point(0.5);
        let unary = |op, x| self.apply(op, &[x]);
        let binary = |op, x, y| self.apply(op, &[x, y]);
        let x = at(0)?;
        let negative = Interval { lo: -x.hi, hi: -x.lo };
        match definition {
            Definition::SqrtByInverseSqrt => binary(Op::Div, one, unary(Op::InverseSqrt, x)?),
            Definition::SinOverCos => binary(Op::Div, unary(Op::Sin, x)?, unary(Op::Cos, x)?),
            Definition::AsinByAtan2 => binary(Op::Atan2, x, self.cathetus(x)?),
            Definition::AcosByAtan2 => binary(Op::Atan2, self.cathetus(x)?, x),
            Definition::SinhByExp => {
                binary(Op::Mul, binary(Op::Sub, unary(Op::Exp, x)?, unary(Op::Exp, negative)?)?, half)
            }
            Definition::CoshByExp => {
                binary(Op::Mul, binary(Op::Add, unary(Op::Exp, x)?, unary(Op::Exp, negative)?)?, half)
            }
            Definition::SinhOverCosh => binary(Op::Div, unary(Op::Sinh, x)?, unary(Op::Cosh, x)?),
            Definition::AsinhByLog | Definition::AcoshByLog => {
                let shift = if definition == Definition::AsinhByLog { Op::Add } else { Op::Sub };
                let root = unary(Op::Sqrt, binary(shift, binary(Op::Mul, x, x)?, one)?)?;
                unary(Op::Log, binary(Op::Add, x, root)?)
            }
            Definition::AtanhByLog => {
                let quotient = binary(Op::Div, binary(Op::Add, one, x)?, binary(Op::Sub, one, x)?)?;
                binary(Op::Mul, unary(Op::Log, quotient)?, half)
            }
            Definition::PowByExp2 => unary(Op::Exp2, binary(Op::Mul, at(1)?, unary(Op::Log2, x)?)?),
            Definition::FractByFloor => binary(Op::Sub, x, unary(Op::Floor, x)?),
            Definition::ModByFloor | Definition::RemByTrunc => {
                let whole = if definition == Definition::ModByFloor { Op::Floor } else { Op::Trunc };
                let y = at(1)?;
                binary(Op::Sub, x, binary(Op::Mul, y, unary(whole, binary(Op::Div, x, y)?)?)?)
            }
            Definition::MultiplyAdd => binary(Op::Add, binary(Op::Mul, x, at(1)?)?, at(2)?),
            Definition::RadiansByProduct => {
                binary(Op::Mul, x, Interval::point(grid::nearest(std::f64::consts::PI / 180.0)))
            }
            Definition::DegreesByProduct => {
                binary(Op::Mul, x, Interval::point(grid::nearest(180.0 / std::f64::consts::PI)))
            }
            Definition::MixByWeights
            | Definition::SmoothStepByCubic
            | Definition::SumOfProducts
            | Definition::LengthByDot
            | Definition::DistanceByLength
            | Definition::NormalizeByInverseSqrt
            | Definition::NormalizeByLength
            | Definition::DifferenceOfProducts
            | Definition::ReflectByDot
            | Definition::RefractByDot
            | Definition::FaceForwardByDot
            | Definition::MatrixBySums => Err(Free::NoPromise),
        }
    }

    /// √(1 − x·x).
    fn cathetus(&self, x: Interval) -> Result<Interval, Free> {
        let square = self.apply(Op::Mul, &[x, x])?;
        self.apply(Op::Sqrt, &[self.apply(Op::Sub, &[Interval::point(1.0), square])?])
    }
}

/// The exact values of an operation over a box of arguments; `None` where it is undefined somewhere.
fn exact_range(op: Op, args: &[Interval]) -> Option<Interval> {
    let corners = |count: usize| {
        let corner = |bits: usize| {
            let mut point = [f64::NAN; 3];
            for (k, (at, arg)) in point.iter_mut().zip(args).enumerate() {
                *at = if bits >> k & 1 == 0 { arg.lo } else { arg.hi };
            }
            op.exact(&point[..count])
        };
        Interval::hull((0..1 << count).map(corner))
    };
    let arity = op.arity()?;
    if args.len() < arity {
        return None;
    }
    if args[..arity].iter().all(|a| a.lo == a.hi) {
        let point: [f64; 3] = std::array::from_fn(|k| args.get(k).map_or(f64::NAN, |a| a.lo));
        let value = op.exact(&point[..arity]);
        return (!value.is_nan()).then_some(Interval::point(value));
    }
    match op {
        _ if op.is_monotone() => corners(arity),
        Op::Div => {
            if args[1].contains(0.0) {
                None
            } else {
                corners(2)
            }
        }
        // Monotone in each argument where the first keeps its sign, or the second is positive.
        Op::Atan2 => (!args[0].contains(0.0) || args[1].lo > 0.0 || args[0].lo >= 0.0).then(|| corners(2)).flatten(),
        Op::Abs => Some(Interval { lo: args[0].least_magnitude(), hi: args[0].magnitude() }),
        Op::Cosh => Some(Interval { lo: args[0].least_magnitude().cosh(), hi: args[0].magnitude().cosh() }),
        Op::Sin | Op::Cos => Some(Interval { lo: -1.0, hi: 1.0 }),
        Op::Fract => Some(Interval { lo: 0.0, hi: 1.0 }),
        // Not needed by any definition.
        _ => None,
    }
}
