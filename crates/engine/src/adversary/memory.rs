//! Numbers of the adversary in memory that invocations share: binary32 numbers.

use program::interp::group::{InMemory, RealCombine};
use program::interp::{Binary32, Mask, SLOTS};
use property::mix;

use super::domain::{Adversary, Column};

impl InMemory for Adversary {
    type Cell = f32;
    type Sum = ();

    fn cell(bits: u32) -> f32 {
        f32::from_bits(bits)
    }

    fn bits(cell: f32) -> u32 {
        cell.to_bits()
    }

    fn kept(&self, column: &Column, slot: usize) -> f32 {
        column.values.values()[slot]
    }

    fn put(&mut self, mask: &Mask, cells: &[f32; SLOTS], to: &mut Column) {
        to.rounded();
        let values = to.values.values_mut();
        mask.each(|slot| {
            values[slot] = cells[slot];
            // Other numbers, other errors.
            self.invocations[slot] = mix(self.invocations[slot], u64::from(cells[slot].to_bits()));
        });
    }

    fn combined(&self, op: RealCombine, old: f32, value: f32, sum: &mut ()) -> f32 {
        Binary32::default().combined(op, old, value, sum)
    }
}
