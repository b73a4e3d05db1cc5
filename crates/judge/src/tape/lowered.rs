//! Operations of `mediump`, `lowp` and `f16`: what GLSL ES, Vulkan and WGSL promise of them at the least, beside what they
//! are off by in binary32.
//!
//! GLSL ES 3.00, 4.5.1: `mediump` has a relative precision of 2^-10 within 2^14 and down to 2^-14, `lowp` an absolute one of
//! 2^-8. Vulkan (table of half precision): sin and cos are off by 2^-7, log by 2^-7 or 3 ULP, exp by 1 + 2|x| ULP. The sizes
//! of binary16 alone are not promised, so that a device with more range is within these bounds as well.
//!
//! Numbers of `f16` are those of binary16, to either neighbour of the exact result, and subnormal ones may be flushed (WGSL,
//! 15.7; the table of half precision of Vulkan has the same numbers): a quotient is off by 2.5 ULP, 1/√x by 2. What is
//! exact in binary16 stays exact.

use super::Tape;
use super::arena::{Id, NodeKind};
use crate::profile::Op;
use program::Grade;
use program::interp::{SLOTS, Site, halved};

/// One step of `mediump`, as part of a number.
pub const STEP: f64 = 1.0 / 1024.0;
/// Smaller numbers may be 0: the smallest normal one of binary16.
pub const SMALLEST: f64 = 1.0 / 16384.0;

/// Larger numbers may be infinite.
pub fn largest(grade: Grade) -> f64 {
    match grade {
        Grade::Full => f64::from(f32::MAX),
        Grade::Half => 65504.0,
        Grade::Medium | Grade::Low => 16384.0,
    }
}

/// True for an operation whose result is one of its operands, its negative or a whole number: what its operands have,
/// it has.
pub fn keeps(op: Op) -> bool {
    matches!(
        op,
        Op::Neg | Op::Abs | Op::Sign | Op::Floor | Op::Ceil | Op::RoundEven | Op::Trunc | Op::Min | Op::Max | Op::Step
    )
}

/// True for an operation that is rounded once, in binary16 as well: exact where the result is a number of it.
pub fn rounds_once(op: Op) -> bool {
    matches!(op, Op::Add | Op::Sub | Op::Mul | Op::Fract | Op::Convert)
}
/// One step of `lowp`.
pub const LOWP: f64 = 1.0 / 256.0;

pub(super) fn is_lower(site: Option<Site>) -> bool {
    site.is_some_and(|site| site.grade() != Grade::Full)
}

/// How far the result of an operation may be off, at the least precision that its grade allows: where its argument is as
/// large as `argument` (of a power, what is lost on the way to it, as a part of it), and its result in binary32 between `near` and `size` from 0. Infinite where it may be infinite.
pub fn error(grade: Grade, op: Option<Op>, argument: f64, [near, size]: [f64; 2]) -> f64 {
    let half = grade == Grade::Half;
    let function = match op {
        Some(Op::Exp | Op::Exp2) => 2.0 * argument * STEP * size,
        Some(Op::Div) if half => 1.5 * STEP * size,
        Some(Op::InverseSqrt) if half => STEP * size,
        // By 1/inversesqrt(x).
        Some(Op::Sqrt) if half => 3.5 * STEP * size,
        // By exp(x) and exp(-x).
        Some(Op::Sinh | Op::Cosh | Op::Tanh) if half => 4.0 * (1.0 + 2.0 * argument) * STEP * size,
        Some(Op::Asinh | Op::Acosh | Op::Atanh) if half => f64::INFINITY,
        Some(Op::Pow) if half => argument * size,
        Some(Op::Sin | Op::Cos | Op::Log | Op::Log2 | Op::Tan | Op::Asin | Op::Acos | Op::Atan | Op::Atan2) => {
            8.0 * STEP * size.max(1.0)
        }
        _ => 0.0,
    };
    function + slack(grade, near - function, size + function)
}

/// How far a number may be off from one that is not rounded yet, where that lies between `near` and `size` from 0.
pub(super) fn slack(grade: Grade, near: f64, size: f64) -> f64 {
    let own = match grade {
        Grade::Full => return 0.0,
        Grade::Medium | Grade::Half => size * STEP,
        Grade::Low => (size * STEP).max(LOWP),
    };
    let flushed = if near - own < SMALLEST { size } else { 0.0 };
    if size + own > largest(grade) { f64::INFINITY } else { own.max(flushed) }
}

impl Tape<'_> {
    /// Adds what the precision of its site takes from a node; none for meaning in real numbers.
    pub(super) fn lower(&mut self, id: Id) {
        let at = id as usize;
        let (site, op) = (self.arena.nodes[at].site, self.arena.nodes[at].op);
        let super::Model::Device { .. } = self.model else { return };
        let Some(site) = site.filter(|site| is_lower(Some(*site))) else { return };
        if matches!(self.arena.nodes[at].kind, NodeKind::Leaf | NodeKind::Select { .. }) && op.is_none() {
            return;
        }
        let half = site.grade() == Grade::Half;
        if half && op.is_some_and(keeps) {
            return;
        }
        let argument: Option<[f64; SLOTS]> = match (op, self.arena.nodes[at].kind) {
            (Some(Op::Pow), NodeKind::Two { a, b, .. }) if half => Some(self.power_by_halves(a, b)),
            (Some(Op::Exp | Op::Exp2 | Op::Sinh | Op::Cosh | Op::Tanh), NodeKind::One { a, .. }) => {
                let (x, e) = (self.arena.value.get(a as usize), self.arena.radius.get(a as usize));
                Some(std::array::from_fn(|slot| x[slot].abs() + e[slot]))
            }
            _ => None,
        };
        let value = *self.arena.value.get(at);
        let mut own = [0.0; SLOTS];
        let radius = self.arena.radius.get_mut(at);
        for slot in 0..SLOTS {
            let range = [value[slot].abs() - radius[slot], value[slot].abs() + radius[slot]];
            let is_number = radius[slot] == 0.0 && f64::from(halved(value[slot] as f32)) == value[slot];
            if half && is_number && op.is_some_and(rounds_once) {
                continue;
            }
            own[slot] = error(site.grade(), op, argument.map_or(0.0, |x| x[slot]), range);
            radius[slot] += own[slot];
        }
        let local = self.arena.local.get_mut(at);
        local.iter_mut().zip(own).for_each(|(local, own)| *local += own);
        if own.iter().all(|own| *own == 0.0) {
            return;
        }
        self.arena.nodes[at].exact = false;
    }

    /// How far x^y may be off by exp2(y·log2(x)) in binary16, as a part of it.
    fn power_by_halves(&self, a: Id, b: Id) -> [f64; SLOTS] {
        let (x, ex) = (self.arena.value.get(a as usize), self.arena.radius.get(a as usize));
        let (y, ey) = (self.arena.value.get(b as usize), self.arena.radius.get(b as usize));
        std::array::from_fn(|slot| {
            let ends = [x[slot] - ex[slot], x[slot] + ex[slot]].map(|x| x.log2().abs());
            let (log, y) = (ends[0].max(ends[1]), y[slot].abs() + ey[slot]);
            let exponent = y * (8.0 * STEP).max(4.0 * STEP * log) + STEP * y * log;
            let off = (std::f64::consts::LN_2 * exponent).exp_m1() + STEP * (1.0 + 2.0 * y * log);
            if off.is_nan() { f64::INFINITY } else { off }
        })
    }

    /// The same value as a number of the precision of a site.
    pub(super) fn narrow(&mut self, site: Site, a: Id) -> Id {
        match is_lower(Some(site)) {
            true => self.identity(Some(site), Some(Op::Convert), a, &[0.0; SLOTS]),
            false => a,
        }
    }

    /// An operand of an operation: a literal takes the precision of what uses it.
    pub(super) fn operand(&mut self, site: Site, a: Id) -> Id {
        let literal = matches!(self.arena.nodes[a as usize].kind, NodeKind::Leaf);
        if literal && is_lower(Some(site)) { self.narrow(site, a) } else { a }
    }
}
