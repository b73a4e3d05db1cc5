//! Outputs that fade out: small because an exponential or a power is, whose natural scale is its value 1 at its start.

use super::arena::{Id, NodeKind};
use super::{Column, Tape};
use crate::profile::Op;

/// An exponential below this part of 1 has faded out: the error of a colour of 16 bits is larger.
pub const FADED: f64 = 1.0 / (1 << 20) as f64;

/// Nodes that are looked at on the way.
const MOST: usize = 256;

impl Tape<'_> {
    /// True when an output is small in a lane because of a factor or terms that are exponentials or powers near 0, and
    /// would be of the size of their other factors without them.
    pub fn has_faded(&self, output: Column, lane: usize) -> bool {
        let mut left = MOST;
        self.fades(self.id(&output), lane, &mut left)
    }

    fn fades(&self, id: Id, lane: usize, left: &mut usize) -> bool {
        if *left == 0 {
            return false;
        }
        *left -= 1;
        let value = |id: Id| self.arena.value.get(id as usize)[lane];
        let meta = self.arena.nodes[id as usize];
        if matches!(meta.op, Some(Op::Exp | Op::Exp2 | Op::Pow)) {
            return value(id).abs() <= FADED;
        }
        match meta.kind {
            NodeKind::Leaf => false,
            // A term that is 0 leaves the others.
            NodeKind::Sum { a, b, signs } => {
                let terms = [(a, signs.0), (b, signs.1)].map(|(id, sign)| (id, sign != 0.0 && value(id) != 0.0));
                let mut terms = terms.into_iter().filter(|(_, counts)| *counts).peekable();
                terms.peek().is_some() && terms.all(|(id, _)| self.fades(id, lane, left))
            }
            NodeKind::Product { a, b } => {
                // Without the factor that fades, the rest is of an ordinary size.
                let factor = |one: Id, other: Id, left: &mut usize| {
                    value(other).abs() >= FADED && self.fades(one, lane, left)
                        || self.fades(one, lane, left) && self.fades(other, lane, left)
                };
                factor(a, b, left) || factor(b, a, left)
            }
            NodeKind::Select { mask, a, b } => {
                let taken = if self.arena.masks[mask as usize].has(lane) { a } else { b };
                self.fades(taken, lane, left)
            }
            NodeKind::Two { a, b, .. } => match meta.op {
                Some(Op::Div) => self.fades(a, lane, left),
                Some(Op::Min | Op::Max) => self.fades(if value(id) == value(a) { a } else { b }, lane, left),
                _ => false,
            },
            // The same value once more.
            NodeKind::One { a, .. } => value(a) == value(id) && self.fades(a, lane, left),
        }
    }
}
