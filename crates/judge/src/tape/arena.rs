//! What the tape remembers: one node for each operation on a chunk of slots, its columns side by side.
//!
//! A tape has a limit. Endless shaders are found by counting rounds in binary64 and never reach a tape; a loop with
//! more rounds than a tape has room for is undetermined (`long_loop`), the same on every machine.

use crate::profile::Op;
use program::Grade;
use program::interp::{Mask, SLOTS, Site};

/// One binary64 number for each slot.
pub(super) type Slots = [f64; SLOTS];

/// Number of a node within its chunk.
pub(super) type Id = u32;

/// How a node comes from others. A partial is the derivative at the exact arguments, with the
/// distance to the derivative anywhere between these and what a device may have instead.
#[derive(Clone, Copy, Debug)]
pub(super) enum NodeKind {
    /// An input, a constant, or a value that was never written.
    Leaf,
    /// The sum with signs ±1 (0 leaves an argument out).
    Sum { a: Id, b: Id, signs: (f64, f64) },
    /// The product of two nodes; they are each other's partials.
    Product { a: Id, b: Id },
    /// A function of one node, with the number of its partial.
    One { a: Id, partial: u32 },
    /// A function of two nodes, with the numbers of the partials.
    Two { a: Id, b: Id, partials: [u32; 2] },
    /// `a` in the slots of a mask, `b` in the others.
    Select { mask: u32, a: Id, b: Id },
}

impl NodeKind {
    /// True for sums, products and selections, which rearrangement may regroup.
    pub(super) fn is_polynomial(self) -> bool {
        match self {
            Self::Sum { .. } | Self::Product { .. } | Self::Select { .. } => true,
            Self::Leaf | Self::One { .. } | Self::Two { .. } => false,
        }
    }
}

/// What is known of a node in all slots together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meta {
    pub kind: NodeKind,
    /// The operation as profiles call it; `None` for leaves and selections.
    pub op: Option<Op>,
    pub site: Option<Site>,
    /// True when the local error is zero in every slot.
    pub exact: bool,
    /// True when some slot may hold a subnormal number.
    pub tiny: bool,
    /// True when no rounding makes the value negative: squares and sums of them.
    pub not_negative: bool,
}

impl Meta {
    /// True for what stays as it is written on every device: it is `precise`.
    pub(super) fn is_kept(&self) -> bool {
        self.site.is_some_and(Site::is_precise)
    }

    /// True for sums, products and selections that rearrangement may regroup.
    pub(super) fn is_regrouped(&self) -> bool {
        self.kind.is_polynomial() && !self.is_kept()
    }
}

/// A column of zeros.
pub(super) static ZEROS: Slots = [0.0; SLOTS];

/// A pool of columns that are used again for each chunk.
#[derive(Default)]
pub(super) struct Pool {
    #[expect(clippy::vec_box, reason = "one more column must not move the others")]
    columns: Vec<Box<Slots>>,
    /// Columns that hold zeros, whatever is left in their place: one column for all of them stays in the cache.
    zero: Vec<bool>,
    used: usize,
}

/// Columns of a chunk, of all pools together, at which the tape is full: an eighth of a GiB. Each round of a loop adds some for
/// each of its operations; shaders without very long loops have a few thousand.
pub(super) const MOST: usize = 1 << 17;

/// Columns of a pool that are kept between chunks.
const KEPT: usize = 1 << 12;

impl Pool {
    pub(super) fn clear(&mut self) {
        self.used = 0;
        self.columns.truncate(KEPT);
        self.zero.truncate(KEPT);
    }

    /// Makes room up to a column; what it holds is left from before.
    pub(super) fn reach(&mut self, at: usize) {
        self.used = self.used.max(at + 1);
        while self.columns.len() <= at {
            self.columns.push(Box::new([0.0; SLOTS]));
            self.zero.push(false);
        }
    }

    /// Lets a column hold zeros.
    pub(super) fn set_zero(&mut self, at: usize) {
        self.zero[at] = true;
    }

    /// True when a column is known to hold zeros.
    pub(super) fn is_zero(&self, at: usize) -> bool {
        self.zero[at]
    }

    /// Lets a column hold what is left from before: all of it is written next.
    pub(super) fn renew(&mut self, at: usize) {
        self.zero[at] = false;
    }

    #[inline]
    pub(super) fn get(&self, at: usize) -> &Slots {
        if self.zero[at] { &ZEROS } else { &self.columns[at] }
    }

    pub(super) fn get_mut(&mut self, at: usize) -> &mut Slots {
        if std::mem::replace(&mut self.zero[at], false) {
            self.columns[at].fill(0.0);
        }
        &mut self.columns[at]
    }

    /// The column at `at` and the one after it.
    pub(super) fn pair_mut(&mut self, at: usize) -> (&mut Slots, &mut Slots) {
        let (first, second) = self.columns[at..].split_at_mut(1);
        (&mut first[0], &mut second[0])
    }

    /// The columns of two partials with their distances; they stand one after the other.
    pub(super) fn quad_mut(&mut self, at: usize) -> [&mut Slots; 4] {
        let [a, b, c, d] = self.columns[at..].first_chunk_mut().expect("two partials are made together");
        [a, b, c, d]
    }

    /// The column at `at`, all of which is written next, and the others to read.
    pub(super) fn split(&mut self, at: usize) -> (Others<'_>, &mut Slots) {
        self.renew(at);
        let (before, rest) = self.columns.split_at_mut(at);
        let (one, after) = rest.split_first_mut().expect("a column that was made");
        (Others { before, after, zero: &self.zero }, one)
    }
}

/// All columns of a pool but one.
#[derive(Clone, Copy)]
pub(super) struct Others<'a> {
    before: &'a [Box<Slots>],
    after: &'a [Box<Slots>],
    zero: &'a [bool],
}

impl<'a> Others<'a> {
    /// True when a column is known to hold zeros.
    pub(super) fn is_zero(&self, at: usize) -> bool {
        self.zero[at]
    }

    /// A column other than the one that was split off.
    #[inline]
    pub(super) fn get(&self, at: usize) -> &'a Slots {
        match at.checked_sub(self.before.len() + 1) {
            _ if self.zero[at] => &ZEROS,
            Some(after) => &self.after[after],
            None => &self.before[at],
        }
    }
}

/// The nodes of one chunk.
#[derive(Default)]
pub(super) struct Arena {
    pub nodes: Vec<Meta>,
    /// Exact values: what the program means.
    pub value: Pool,
    /// How far a device's value may be from the exact one, over everything before it.
    pub radius: Pool,
    /// What the operation itself may add to that.
    pub local: Pool,
    /// Partials and their distances, in turn.
    pub partials: Pool,
    /// Number of partials.
    slopes: usize,
    pub masks: Vec<Mask>,
    /// For rearrangement: the value with all terms positive, and the number of roundings.
    pub size: Pool,
    pub roundings: Pool,
    /// For rearrangement: the lowest precision of what is regrouped together.
    pub grades: Vec<Grade>,
    /// For rearrangement: the largest value on any way to this one.
    pub peak: Pool,
    /// For rearrangement: the smallest product of some of its factors.
    pub least: Pool,
    /// For rearrangement: the same where its factors are distributed over sums.
    pub part: Pool,
    /// For rearrangement on a tape of radii: what the terms of a sum or product are off by, without what any order of them
    /// rounds to.
    pub terms: Pool,
}

impl Arena {
    pub(super) fn clear(&mut self) {
        let Self {
            nodes,
            value,
            radius,
            local,
            partials,
            slopes,
            masks,
            size,
            roundings,
            grades,
            peak,
            least,
            part,
            terms,
        } = self;
        nodes.clear();
        *slopes = 0;
        masks.clear();
        grades.clear();
        for pool in [value, radius, local, partials, size, roundings, peak, least, part, terms] {
            pool.clear();
        }
    }

    /// True when a chunk has as many columns as it may have.
    pub(super) fn is_full(&self, most: usize) -> bool {
        let Self { value, radius, local, partials, size, roundings, peak, least, .. } = self;
        let pools = [value, radius, local, partials, size, roundings, peak, least];
        pools.iter().map(|pool| pool.used).sum::<usize>() >= most
    }

    /// A node in a new place. Its columns hold what is left from before.
    pub(super) fn push(&mut self, meta: Meta) -> Id {
        let at = self.nodes.len();
        self.nodes.push(meta);
        for pool in [&mut self.value, &mut self.radius, &mut self.local] {
            pool.reach(at);
        }
        self.put(at as Id, meta);
        at as Id
    }

    /// A node in the place of one that nobody needs any more. Its columns hold what is left from before, but for those of a
    /// leaf, which is exact until something else is said.
    pub(super) fn put(&mut self, id: Id, meta: Meta) {
        let at = id as usize;
        self.nodes[at] = meta;
        for pool in [&mut self.radius, &mut self.local] {
            match meta.kind {
                NodeKind::Leaf => pool.set_zero(at),
                _ => pool.renew(at),
            }
        }
    }

    /// One more partial with its distance.
    pub(super) fn partial(&mut self) -> u32 {
        let at = self.slopes;
        self.partials.reach(2 * at + 1);
        self.slopes += 1;
        at as u32
    }

    /// Forgets how nodes came about: their values stay.
    pub(super) fn forget_ways(&mut self) {
        self.slopes = 0;
        self.masks.clear();
    }

    /// A partial and its distance.
    pub(super) fn partial_at(&self, at: u32) -> (&Slots, &Slots) {
        (self.partials.get(2 * at as usize), self.partials.get(2 * at as usize + 1))
    }

    pub(super) fn mask(&mut self, mask: Mask) -> u32 {
        self.masks.push(mask);
        (self.masks.len() - 1) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_of_zeros_is_read_as_one_whatever_is_left_in_its_place() {
        let mut pool = Pool::default();
        pool.reach(2);
        for at in 0..3 {
            pool.get_mut(at).fill(7.0);
        }
        pool.set_zero(0);
        pool.set_zero(2);
        assert_eq!((pool.get(0), pool.get(1)[5], pool.is_zero(2)), (&ZEROS, 7.0, true));
        let (others, one) = pool.split(1);
        assert_eq!((others.get(0), others.get(2), others.is_zero(0)), (&ZEROS, &ZEROS, true));
        one[3] = 1.0;
        // Who writes to some slots finds zeros in the others.
        pool.get_mut(0)[4] = 2.0;
        assert_eq!((pool.get(0)[3], pool.get(0)[4], pool.get(1)[3], pool.is_zero(0)), (0.0, 2.0, 1.0, false));
    }
}
