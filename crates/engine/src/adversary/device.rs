//! Single operations, with errors up to the legal maximum.

use judge::profile::{Allowed, Definition, Entry, Flush, Free, Interval, Op, Profile, Rule, accept, accept_near, grid};
use lanes::Stage;

use judge::tape::lowered::{self, SMALLEST, largest};
use program::Grade;
use program::interp::halved;

use super::choice::{Choice, Place, Strategy};

/// A fault that is planted: an operation that errs by more than it may.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// The operation. `normalize` is the only one of those on vectors that can be named: the others
    /// are made of scalar ones.
    pub op: Op,
    /// Multiple of the largest legal error; a result that may have no error has none.
    pub factor: f64,
}

/// A device by a profile.
#[derive(Clone, Debug)]
pub struct Device {
    profile: Profile,
    /// The same without flushes, which are decided here one by one.
    keeping: Profile,
    stage: Stage,
    strategy: Strategy,
    seed: u64,
    fault: Option<Fault>,
}

/// How `normalize` is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Normalize {
    /// x·inversesqrt(dot(x, x)).
    ByInverseSqrt,
    /// x/sqrt(dot(x, x)).
    ByLength,
    /// Nothing is promised.
    Free,
}

impl Device {
    /// A device that behaves as the profile allows it in a stage.
    pub fn new(profile: &Profile, stage: Stage, strategy: Strategy, seed: u64) -> Self {
        let mut keeping = profile.clone();
        (keeping.compute, keeping.vertex) = (Flush::Never, Flush::Never);
        Self { profile: profile.clone(), keeping, stage, strategy, seed, fault: None }
    }

    /// The same with a planted fault.
    #[must_use]
    pub fn with_fault(self, fault: Fault) -> Self {
        Self { fault: Some(fault), ..self }
    }

    /// What the device promises, and how it errs within that.
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// The result of a scalar operation on binary32 numbers: a binary32 number.
    pub fn apply(&self, op: Op, args: &[f64], place: Place) -> f32 {
        self.result(op, Some(op), args, &|args| op.exact(args), place)
    }

    /// The same as a part of another operation: a fault of that other one is made here.
    pub(super) fn apply_in(&self, op: Op, whole: Option<Op>, args: &[f64], place: Place) -> f32 {
        self.result(op, whole, args, &|args| op.exact(args), place)
    }

    /// The result of an operation whose exact value [`Op::exact`] does not know.
    pub fn apply_to(&self, op: Op, args: &[f64], exact: &dyn Fn(&[f64]) -> f64, place: Place) -> f32 {
        self.result(op, Some(op), args, exact, place)
    }

    fn result(&self, op: Op, whole: Option<Op>, args: &[f64], exact: &dyn Fn(&[f64]) -> f64, place: Place) -> f32 {
        let mut choice = Choice::new(self.seed, self.strategy, place, op as u64, args);
        let mut given = [f64::NAN; 3];
        let count = args.len().min(3);
        for (k, (given, &arg)) in given.iter_mut().zip(args).enumerate() {
            *given = self.flushed(arg, arg, &mut choice, 1 + 2 * k as u32);
        }
        let args = &given[..count];
        // The definition of a root by its inverse has no value at 0. It counts in its limit, here and
        // for the judge: every device has this root.
        if op == Op::Sqrt && args == [0.0] {
            return 0.0;
        }
        // So does 0 to a positive power, by exp2 of the logarithm's limit or of any large negative number.
        if op == Op::Pow && args[0] == 0.0 && args[1] > 0.0 {
            return 0.0;
        }
        let exact = exact(args);
        let Ok(interval) = self.interval(op, args, exact) else { return choice.wild(exact) };
        if let Some(fault) = self.fault.filter(|fault| Some(fault.op) == whole)
            && let Some(wrong) = beyond(interval, exact, fault.factor, choice.is_upward())
        {
            return wrong as f32;
        }
        let found = choice.within(interval, exact);
        self.flushed(found, exact, &mut choice, 7) as f32
    }

    /// What the profile accepts for arguments that are not flushed any more.
    fn interval(&self, op: Op, args: &[f64], exact: f64) -> Result<Interval, Free> {
        match self.keeping.entry(op) {
            Entry::Promised(_) if op.arity().is_some() => accept(&self.keeping, op, args, self.stage),
            Entry::Promised(_) => accept_near(&self.keeping, op, args, exact, self.stage),
            Entry::Measured(_) => match self.keeping.allowed(op, args, exact, self.stage) {
                Allowed::Bound(bound) => Ok(Interval { lo: exact - bound, hi: exact + bound }),
                Allowed::NoPromise => Err(Free::NoPromise),
                Allowed::Inherited { .. } | Allowed::OutsideDomain => Err(Free::OutsideDomain),
            },
        }
    }

    /// A number, or a zero of any sign when it stands for a subnormal number that may or must be
    /// flushed. `question` and the number behind it name the two decisions.
    fn flushed(&self, x: f64, exact: f64, choice: &mut Choice, question: u32) -> f64 {
        let subnormal = |x: f64| x != 0.0 && x.abs() < grid::MIN_NORMAL;
        if !subnormal(x) && !subnormal(exact) {
            return x;
        }
        let flushes = match self.profile.flush(self.stage) {
            Flush::Must => true,
            Flush::May => choice.decide(question),
            Flush::Never => false,
        };
        match flushes {
            false => x,
            true if choice.decide(question + 1) => 0.0,
            true => -0.0,
        }
    }

    /// A number as an operation of lower precision gives it, or takes it where `op` is none: within what GLSL ES and Vulkan
    /// allow of the binary32 number that it stands for.
    pub(crate) fn lowered(&self, grade: Grade, op: Option<Op>, argument: f64, x: f32, place: Place) -> f32 {
        let exact = f64::from(x);
        let given = op.is_none_or(|op| grade == Grade::Half && lowered::rounds_once(op));
        if grade == Grade::Full || !x.is_finite() || (given && halved(x) == x && within_range(grade, exact)) {
            return x;
        }
        if grade == Grade::Half && op.is_some_and(lowered::keeps) {
            return x;
        }
        // Of a power, the argument is what is lost on the way to it: the least of that.
        let argument = if op == Some(Op::Pow) { 0.0 } else { argument };
        let limit = largest(grade);
        let mut choice = Choice::new(self.seed, self.strategy, place, 3 + Op::ALL.len() as u64, &[exact]);
        if exact.abs() > limit && choice.decide(5) {
            return f32::INFINITY.copysign(x);
        }
        // What is flushed may be off by all of itself, and what is not is as it was: an operand is taken as it was given.
        if exact.abs() < SMALLEST {
            return if choice.decide(6) { 0.0 } else { halved(x) };
        }
        // Half of the range: there, what is allowed has an end, and nothing is flushed.
        let size = exact.abs().min(limit / 2.0);
        let reach = lowered::error(grade, op, argument, [2.0 * size.max(1.0), size]);
        let interval = Interval { lo: exact - reach, hi: exact + reach };
        if let Some(fault) = self.fault.filter(|fault| Some(fault.op) == op)
            && let Some(wrong) = beyond(interval, exact, fault.factor, choice.is_upward())
        {
            return wrong as f32;
        }
        let found = halved(choice.within(interval, exact) as f32);
        // Half a step of binary16 is always allowed.
        if interval.contains(f64::from(found)) { found } else { halved(x) }
    }

    /// A comparison sees these numbers.
    pub(super) fn compared(&self, [a, b]: [f64; 2], place: Place) -> [f64; 2] {
        // No operation has this number.
        let mut choice = Choice::new(self.seed, self.strategy, place, Op::ALL.len() as u64, &[a, b]);
        [self.flushed(a, a, &mut choice, 1), self.flushed(b, b, &mut choice, 3)]
    }

    /// A conversion to a word sees this number.
    pub(super) fn converted(&self, x: f64, place: Place) -> f64 {
        let mut choice = Choice::new(self.seed, self.strategy, place, 2 + Op::ALL.len() as u64, &[x]);
        self.flushed(x, x, &mut choice, 1)
    }

    /// Whether a sum takes the product before its rounding.
    pub(super) fn fuses(&self, args: [f64; 2], place: Place) -> bool {
        // A fault of one of the operations must not vanish in another.
        let planted = self.fault.is_some_and(|fault| matches!(fault.op, Op::Add | Op::Sub | Op::Mul));
        let mut choice = Choice::new(self.seed, self.strategy, place, 1 + Op::ALL.len() as u64, &args);
        self.profile.contraction && !planted && choice.decide(0)
    }

    pub(super) fn normalize(&self) -> Normalize {
        let Entry::Promised(pieces) = self.profile.entry(Op::Normalize) else { return Normalize::Free };
        match pieces.first().map(|piece| piece.rule) {
            Some(Rule::Inherited { definition: Definition::NormalizeByLength, .. }) => Normalize::ByLength,
            None | Some(Rule::NoPromise) => Normalize::Free,
            Some(_) => Normalize::ByInverseSqrt,
        }
    }

    /// True when nothing is promised for an operation.
    pub(super) fn is_free(&self, op: Op) -> bool {
        match self.profile.entry(op) {
            Entry::Promised(pieces) => pieces.iter().all(|piece| piece.rule == Rule::NoPromise),
            Entry::Measured(_) => false,
        }
    }

    /// Anything.
    pub(super) fn wild(&self, op: Op, x: f64, place: Place) -> f32 {
        Choice::new(self.seed, self.strategy, place, op as u64, &[x]).wild(x)
    }
}

fn within_range(grade: Grade, x: f64) -> bool {
    x == 0.0 || (SMALLEST..=largest(grade)).contains(&x.abs())
}

/// The first binary32 number that is at least `factor` times as far from the exact value as the end
/// of the interval; `None` where there is no error to multiply.
fn beyond(interval: Interval, exact: f64, factor: f64, upward: bool) -> Option<f64> {
    let (above, below) = (interval.hi - exact, exact - interval.lo);
    let up = if upward { above > 0.0 } else { below <= 0.0 };
    let reach = factor * if up { above } else { below };
    if !reach.is_finite() || reach <= 0.0 {
        return None;
    }
    // The rounding of the sums must not lead back to the end.
    let past = factor > 1.0;
    Some(match (up, past) {
        (true, true) => grid::up((exact + reach).max(interval.hi.next_up())),
        (true, false) => grid::up(exact + reach),
        (false, true) => grid::down((exact - reach).min(interval.lo.next_down())),
        (false, false) => grid::down(exact - reach),
    })
}
