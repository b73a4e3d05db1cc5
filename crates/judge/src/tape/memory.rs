//! Numbers of the tape in memory that invocations share: a value, and how far a device may be from it.
//!
//! What lies in memory has no history: who loads it begins anew, with the radius as an error of its own. Errors that would
//! cancel do not, so that the radius of what comes of them is larger than a bound by one sweep over all invocations would be,
//! and it never is smaller.

use program::interp::group::{InMemory, RealCombine};
use program::interp::{Mask, SLOTS, Site};

use super::model::{BINARY64, Model};
use super::{Column, Tape};
use crate::profile::grid::{MAX_FINITE, MIN_NORMAL};

/// A number in memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Its exact value.
    pub value: f64,
    /// How far a device's may be from it.
    pub radius: f64,
    /// Binary32 numbers between which it lies on a device; infinite where they are not known.
    pub ends: [f32; 2],
}

/// Ends of which nothing is known.
pub(super) const UNKNOWN: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];

/// What atomic functions added to a word, in any order: no partial sum is larger than all sizes together, and each rounds
/// once.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    /// Numbers that were added.
    terms: u32,
    /// Sizes of the first value and of all terms, with their radii.
    size: f64,
    /// Radii of these.
    off: f64,
}

impl Sum {
    /// Adds a term to what lies in memory. Gives how far the sum of any order may be from the exact one: n·u/(1 − n·u) of
    /// all sizes for n roundings by u, and what is flushed of each argument and result (Higham, Accuracy and Stability of
    /// Numerical Algorithms, chapter 4).
    fn radius(&mut self, model: &Model<'_>, old: Cell, value: Cell) -> f64 {
        if self.terms == 0 {
            (self.size, self.off) = (old.value.abs() + old.radius, old.radius);
        }
        self.terms = self.terms.saturating_add(1);
        self.size += value.value.abs() + value.radius;
        self.off += value.radius;
        let terms = f64::from(self.terms);
        // Binary64 adds the exact sum.
        let relative = terms * (model.unit() + BINARY64);
        let flushed = if model.flushes() { 2.0 * (terms + 1.0) * MIN_NORMAL } else { 0.0 };
        let own = relative / (1.0 - relative).max(0.5) * self.size + flushed;
        // A partial sum may be too large, whatever the whole is.
        if self.size + own > MAX_FINITE || relative > 0.5 { f64::INFINITY } else { self.off + own }
    }
}

impl InMemory for Tape<'_> {
    type Cell = Cell;
    type Sum = Sum;

    fn cell(bits: u32) -> Cell {
        let value = f32::from_bits(bits);
        Cell { value: f64::from(value), radius: 0.0, ends: [value; 2] }
    }

    fn bits(cell: Cell) -> u32 {
        (cell.value as f32).to_bits()
    }

    fn kept(&self, column: &Column, slot: usize) -> Cell {
        let id = self.id(column);
        let at = id as usize;
        let (value, radius) = (self.arena.value.get(at)[slot], self.arena.radius.get(at)[slot]);
        Cell { value, radius, ends: self.ends(id, slot) }
    }

    fn put(&mut self, mask: &Mask, cells: &[Cell; SLOTS], to: &mut Column) {
        let old = self.id(to);
        let before = old as usize;
        let (mut values, mut radii) = (*self.arena.value.get(before), *self.arena.radius.get(before));
        mask.each(|slot| (values[slot], radii[slot]) = (cells[slot].value, cells[slot].radius));
        let id = self.leaf(|value| *value = values);
        if radii.iter().any(|&radius| radius != 0.0) {
            let at = id as usize;
            self.arena.nodes[at].exact = false;
            *self.arena.radius.get_mut(at) = radii;
            *self.arena.local.get_mut(at) = radii;
            // A size is one with its radius.
            self.group(id);
            self.bracket(id);
            if self.brackets.is_some() {
                let ends = [0, 1].map(|end| std::array::from_fn(|slot| f64::from(cells[slot].ends[end])));
                self.bracket_by(id, old, mask, &ends);
            }
        }
        self.hold(to, id);
    }

    fn combined(&self, op: RealCombine, old: Cell, value: Cell, sum: &mut Sum) -> Cell {
        let (a, b) = (old.value, value.value);
        let most = old.radius.max(value.radius);
        match op {
            RealCombine::Add => Cell { value: a + b, radius: sum.radius(&self.model, old, value), ends: UNKNOWN },
            RealCombine::Subtract => Cell { value: a - b, radius: sum.radius(&self.model, old, value), ends: UNKNOWN },
            RealCombine::Min => Cell { value: a.min(b), radius: most, ends: UNKNOWN },
            RealCombine::Max => Cell { value: a.max(b), radius: most, ends: UNKNOWN },
            RealCombine::Exchange => value,
        }
    }

    fn passing(cell: Cell) -> Cell {
        Cell { radius: f64::INFINITY, ends: UNKNOWN, ..cell }
    }

    fn doubted(&self, slot: usize) -> Option<Site> {
        self.forks[slot]
    }

    fn first_doubt(&self) -> Option<Site> {
        self.forks.iter().flatten().next().copied()
    }
}
