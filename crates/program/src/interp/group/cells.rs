//! Domains whose numbers can lie in memory that invocations share.

use super::super::domain::{Domain, Site};
use super::super::plain::{Column, Number, Plain};
use super::super::slots::{Mask, SLOTS};
use super::access::Combine;

/// A domain whose numbers can lie in memory.
pub trait InMemory: Domain {
    /// A number in memory.
    type Cell: Copy + Send + Sync + std::fmt::Debug;

    /// The number with these bits.
    fn cell(bits: u32) -> Self::Cell;

    /// Bits of the nearest binary32.
    fn bits(cell: Self::Cell) -> u32;

    /// What memory takes of a slot.
    fn kept(&self, column: &Self::Column, slot: usize) -> Self::Cell;

    /// Puts numbers from memory into the slots of `mask`, and leaves the others.
    fn put(&mut self, mask: &Mask, cells: &[Self::Cell; SLOTS], to: &mut Self::Column);

    /// What is remembered of the numbers that atomic functions added to a word since it was last stored.
    type Sum: Copy + Default + Send + Sync + std::fmt::Debug;

    /// What an atomic function on real numbers leaves in memory, in whatever order its invocations come.
    fn combined(&self, op: RealCombine, old: Self::Cell, value: Self::Cell, sum: &mut Self::Sum) -> Self::Cell;

    /// What an invocation sees of a word while others may still add to it.
    fn passing(cell: Self::Cell) -> Self::Cell {
        cell
    }

    /// The first decision of a slot since it began that could have gone the other way; none for a domain that does not look.
    fn doubted(&self, slot: usize) -> Option<Site> {
        let _ = slot;
        None
    }

    /// The same of any slot.
    fn first_doubt(&self) -> Option<Site> {
        None
    }
}

/// What an atomic function on real numbers makes of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RealCombine {
    /// a + b.
    Add,
    /// a − b.
    Subtract,
    /// The lesser.
    Min,
    /// The greater.
    Max,
    /// The second.
    Exchange,
}

impl Combine {
    /// The function on real numbers; `None` for one that works on bits.
    pub(super) fn of_reals(self) -> Option<RealCombine> {
        match self {
            Self::Add => Some(RealCombine::Add),
            Self::Subtract => Some(RealCombine::Subtract),
            Self::Min => Some(RealCombine::Min),
            Self::Max => Some(RealCombine::Max),
            Self::Exchange => Some(RealCombine::Exchange),
            Self::And | Self::Or | Self::Xor => None,
        }
    }
}

impl<N: Number> InMemory for Plain<N>
where
    Self: Domain<Column = Column<N>>,
{
    type Cell = N;
    type Sum = ();

    #[inline]
    fn cell(bits: u32) -> N {
        N::nearest(f64::from(f32::from_bits(bits)))
    }

    #[inline]
    fn bits(cell: N) -> u32 {
        (cell.widen() as f32).to_bits()
    }

    #[inline]
    fn kept(&self, column: &Column<N>, slot: usize) -> N {
        column.values()[slot]
    }

    #[inline]
    fn put(&mut self, mask: &Mask, cells: &[N; SLOTS], to: &mut Column<N>) {
        let values = to.values_mut();
        mask.each(|slot| values[slot] = cells[slot]);
    }

    fn combined(&self, op: RealCombine, old: N, value: N, (): &mut ()) -> N {
        let (a, b) = (old.widen(), value.widen());
        N::nearest(match op {
            RealCombine::Add => a + b,
            RealCombine::Subtract => a - b,
            RealCombine::Min => a.min(b),
            RealCombine::Max => a.max(b),
            RealCombine::Exchange => b,
        })
    }
}
