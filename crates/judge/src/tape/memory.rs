//! Numbers of the tape in memory that invocations share: a value, and how far a device may be from it.
//!
//! What lies in memory has no history: who loads it begins anew, with the radius as an error of its own. Errors that would
//! cancel do not, so that the radius of what comes of them is larger than a bound by one sweep over all invocations would be,
//! and it never is smaller.

use program::interp::group::{InMemory, RealCombine};
use program::interp::{Mask, SLOTS, Site};

use super::{Column, Tape};

/// A number in memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Its exact value.
    pub value: f64,
    /// How far a device's may be from it.
    pub radius: f64,
}

impl InMemory for Tape<'_> {
    type Cell = Cell;

    fn cell(bits: u32) -> Cell {
        Cell { value: f64::from(f32::from_bits(bits)), radius: 0.0 }
    }

    fn bits(cell: Cell) -> u32 {
        (cell.value as f32).to_bits()
    }

    fn kept(&self, column: &Column, slot: usize) -> Cell {
        let at = self.id(column) as usize;
        Cell { value: self.arena.value.get(at)[slot], radius: self.arena.radius.get(at)[slot] }
    }

    fn put(&mut self, mask: &Mask, cells: &[Cell; SLOTS], to: &mut Column) {
        let before = self.id(to) as usize;
        let (mut values, mut radii) = (*self.arena.value.get(before), *self.arena.radius.get(before));
        mask.each(|slot| (values[slot], radii[slot]) = (cells[slot].value, cells[slot].radius));
        let id = self.leaf(|value| *value = values);
        if radii.iter().any(|&radius| radius != 0.0) {
            let at = id as usize;
            self.arena.exact[at] = false;
            self.arena.nodes[at].exact = false;
            *self.arena.radius.get_mut(at) = radii;
            *self.arena.local.get_mut(at) = radii;
            // A size is one with its radius.
            self.group(id);
        }
        self.hold(to, id);
    }

    /// Sums by atomic functions come in any order, and nothing is known of what that does to them.
    fn combined(op: RealCombine, old: Cell, value: Cell) -> Cell {
        let (a, b) = (old.value, value.value);
        let most = old.radius.max(value.radius);
        match op {
            RealCombine::Add => Cell { value: a + b, radius: f64::INFINITY },
            RealCombine::Subtract => Cell { value: a - b, radius: f64::INFINITY },
            RealCombine::Min => Cell { value: a.min(b), radius: most },
            RealCombine::Max => Cell { value: a.max(b), radius: most },
            RealCombine::Exchange => value,
        }
    }

    fn doubted(&self, slot: usize) -> Option<Site> {
        self.forks[slot]
    }

    fn first_doubt(&self) -> Option<Site> {
        self.forks.iter().flatten().next().copied()
    }
}
