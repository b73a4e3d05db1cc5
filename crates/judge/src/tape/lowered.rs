//! Operations of `mediump` and `lowp`: what GLSL ES and Vulkan promise of them at the least, beside what they are off by
//! in binary32.
//!
//! GLSL ES 3.00, 4.5.1: `mediump` has a relative precision of 2^-10 within 2^14 and down to 2^-14, `lowp` an absolute one of
//! 2^-8. Vulkan (table of half precision): sin and cos are off by 2^-7, log by 2^-7 or 3 ULP, exp by 1 + 2|x| ULP. The sizes
//! of binary16 alone are not promised, so that a device with more range is within these bounds as well.

use super::Tape;
use super::arena::{Id, NodeKind};
use crate::profile::Op;
use program::Grade;
use program::interp::{SLOTS, Site};

/// One step of `mediump`, as part of a number.
pub const STEP: f64 = 1.0 / 1024.0;
/// Larger numbers may be infinite.
pub const LARGEST: f64 = 16384.0;
/// Smaller numbers may be 0.
pub const SMALLEST: f64 = 1.0 / 16384.0;
/// One step of `lowp`.
pub const LOWP: f64 = 1.0 / 256.0;

pub(super) fn is_lower(site: Option<Site>) -> bool {
    site.is_some_and(|site| site.grade() != Grade::Full)
}

/// How far the result of an operation may be off, at the least precision that its grade allows: where its argument is as
/// large as `argument`, and its result in binary32 between `near` and `size` from 0. Infinite where it may be infinite.
pub fn error(grade: Grade, op: Option<Op>, argument: f64, [near, size]: [f64; 2]) -> f64 {
    let function = match op {
        Some(Op::Exp | Op::Exp2) => 2.0 * argument * STEP * size,
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
        Grade::Medium => size * STEP,
        Grade::Low => (size * STEP).max(LOWP),
    };
    let flushed = if near - own < SMALLEST { size } else { 0.0 };
    if size + own > LARGEST { f64::INFINITY } else { own.max(flushed) }
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
        let argument: Option<[f64; SLOTS]> = match (op, self.arena.nodes[at].kind) {
            (Some(Op::Exp | Op::Exp2), NodeKind::One { a, .. }) => {
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
            own[slot] = error(site.grade(), op, argument.map_or(0.0, |x| x[slot]), range);
            radius[slot] += own[slot];
        }
        let local = self.arena.local.get_mut(at);
        local.iter_mut().zip(own).for_each(|(local, own)| *local += own);
        self.arena.nodes[at].exact = false;
        self.arena.exact[at] = false;
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
