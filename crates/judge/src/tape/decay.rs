//! Outputs that fade out: small because an exponential or a power is, whose natural scale is its value 1 at its start.
//!
//! Near 0 a power or an exponential has no correct digits on a device, but its error is small beside 1, the value
//! from which it falls.

use super::arena::{Id, NodeKind};
use super::{Column, Tape};
use crate::profile::Op;

/// An exponential below this part of 1 has faded out: the error of a colour of 16 bits is larger.
pub const FADED: f64 = 1.0 / (1 << 20) as f64;

/// Nodes that are looked at on the way.
const MOST: usize = 256;

impl Tape<'_> {
    /// True when an output is small in a slot because of a factor or terms that are exponentials or powers near 0, and
    /// would be of the size of their other factors without them.
    pub fn has_faded(&self, output: Column, slot: usize) -> bool {
        let mut left = MOST;
        self.fades(self.id(&output), slot, &mut left)
    }

    fn fades(&self, id: Id, slot: usize, left: &mut usize) -> bool {
        if *left == 0 {
            return false;
        }
        *left -= 1;
        let value = |id: Id| self.arena.value.get(id as usize)[slot];
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
                terms.peek().is_some() && terms.all(|(id, _)| self.fades(id, slot, left))
            }
            NodeKind::Product { a, b } => {
                // Without the factor that fades, the rest is of an ordinary size.
                let factor = |one: Id, other: Id, left: &mut usize| {
                    value(other).abs() >= FADED && self.fades(one, slot, left)
                        || self.fades(one, slot, left) && self.fades(other, slot, left)
                };
                factor(a, b, left) || factor(b, a, left)
            }
            NodeKind::Select { mask, a, b } => {
                let taken = if self.arena.masks[mask as usize].has(slot) { a } else { b };
                self.fades(taken, slot, left)
            }
            NodeKind::Two { a, b, .. } => match meta.op {
                Some(Op::Div) => self.fades(a, slot, left),
                Some(Op::Min | Op::Max) => self.fades(if value(id) == value(a) { a } else { b }, slot, left),
                _ => false,
            },
            // The same value once more.
            NodeKind::One { a, .. } => value(a) == value(id) && self.fades(a, slot, left),
        }
    }
}
