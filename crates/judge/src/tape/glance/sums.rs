//! Sums and products: what most operations of a shader are.

use super::super::kernels::farther;
use super::super::model::{BINARY64, gap};
use super::{Glance, Id, Mask, Node, SLOTS, Slots};
use crate::profile::grid::{MAX_FINITE, MIN_NORMAL};

/// Larger factors are lost before a whole chunk is.
const LARGE: f64 = (1_u64 << 60) as f64;

/// The largest gap behind a number, as a part of it.
const ULP: f64 = 1.0 / (1 << 23) as f64;

/// Bits of a binary64 that no binary32 has.
const BELOW_BINARY32: u64 = (1 << 29) - 1;

/// An argument in a slot: its value, its displacement and the largest size of one.
type Moving = (f64, f64, f64);

/// The columns of an argument.
type MovingColumns<'a> = [&'a Slots; 3];

/// A sum or product with the columns that it writes.
struct Rounded<'a, F> {
    /// Part of a gap that its rounding is.
    part: f64,
    /// Whether its arguments share no operation that errs.
    apart: bool,
    args: [MovingColumns<'a>; 2],
    value: &'a mut Slots,
    moved: &'a mut Slots,
    farthest: &'a mut Slots,
    /// The three of a result before it is rounded, for arguments that are apart.
    of: F,
}

impl<F: Fn(Moving, Moving) -> Moving> number::Wide for Rounded<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { part, apart, args, value, moved, farthest, of } = self;
        match apart {
            true => rounded(part, args, value, moved, farthest, of),
            false => rounded(part, args, value, moved, farthest, |x, y| {
                let (value, along, _) = of(x, y);
                (value, along, along.abs())
            }),
        }
    }
}

/// The loop. The columns that are written are arguments of their own: those of a function are known not to overlap, without
/// which there are no vectors.
#[inline(always)]
fn rounded(
    part: f64,
    [[x, dx, fx], [y, dy, fy]]: [MovingColumns<'_>; 2],
    value: &mut Slots,
    moved: &mut Slots,
    farthest: &mut Slots,
    of: impl Fn(Moving, Moving) -> Moving,
) {
    for slot in 0..SLOTS {
        let (v, along, far) = of((x[slot], dx[slot], fx[slot]), (y[slot], dy[slot], fy[slot]));
        // A number of binary32 may be exact.
        let kept = v.to_bits() & BELOW_BINARY32 == 0;
        let own = if kept { 0.0 } else { part * gap(v.abs()) };
        value[slot] = v;
        moved[slot] = farther(along, own);
        farthest[slot] = far + own;
    }
}

impl Glance<'_> {
    /// ±a ± b; a sign of 0 leaves its number out.
    pub(super) fn sum_of(&mut self, a: Id, b: Id, signs: (f64, f64)) -> Id {
        let (left, right) = (self.nodes[a as usize], self.nodes[b as usize]);
        if signs.1 == 0.0 {
            // An argument may be flushed.
            let id = self.widened(a, 2.0 * MIN_NORMAL);
            self.nodes[id as usize].not_negative = false;
            for pool in [&mut self.value, &mut self.moved] {
                if !pool.is_zero(id as usize) {
                    let column = pool.get_mut(id as usize);
                    number::wide(|| column.iter_mut().for_each(|x| *x *= signs.0));
                }
            }
            return id;
        }
        let not_negative = signs == (1.0, 1.0) && left.not_negative && right.not_negative;
        let id = self.node(Node::new(not_negative, left.open.or(right.open)));
        self.round(id, [a, b], |(x, dx, fx), (y, dy, fy)| {
            (signs.0 * x + signs.1 * y, signs.0 * dx + signs.1 * dy, fx + fy)
        });
        self.close(id, [a, b], |a, b| Sizes {
            most: a.most + b.most,
            carried: a.radius + b.radius,
            flushed: 4.0 * MIN_NORMAL,
        });
        self.spread(id, [a, b], |(_, ex), (_, ey)| ex + ey);
        id
    }

    /// a·b.
    pub(super) fn product_of(&mut self, a: Id, b: Id) -> Id {
        let (left, right) = (self.nodes[a as usize], self.nodes[b as usize]);
        let not_negative = a == b || (left.not_negative && right.not_negative);
        let id = self.node(Node::new(not_negative, left.open.or(right.open)));
        self.round(id, [a, b], |(x, dx, fx), (y, dy, fy)| (x * y, y * dx + x * dy, y.abs() * fx + x.abs() * fy));
        self.close(id, [a, b], |a, b| {
            let (x, y) = (a.most + a.radius, b.most + b.radius);
            Sizes {
                most: a.most * b.most,
                carried: a.most * b.radius + y * a.radius,
                flushed: (2.0 + x + y) * MIN_NORMAL,
            }
        });
        id
    }

    /// Writes the columns of a new node.
    fn round(&mut self, id: Id, ids: [Id; 2], of: impl Fn(Moving, Moving) -> Moving) {
        let (at, apart) = (id as usize, self.gather_sources(id, ids, true));
        let (values, value) = self.value.split(at);
        let (before, moved) = self.moved.split(at);
        let (far, farthest) = self.farthest.split(at);
        let args = ids.map(|id| id as usize).map(|id| [values.get(id), before.get(id), far.get(id)]);
        number::run_wide(Rounded { part: self.part, apart, args, value, moved, farthest, of });
    }

    /// Completes a node by what its arguments are at the most.
    fn close(&mut self, id: Id, [a, b]: [Id; 2], sizes: impl Fn(Node, Node) -> Sizes) {
        let at = id as usize;
        let found = sizes(self.nodes[a as usize], self.nodes[b as usize]).closed();
        let (most, radius) = found.unwrap_or_else(|| self.close_large([a, b], sizes));
        (self.nodes[at].most, self.nodes[at].radius) = (most, radius);
    }

    /// Writes the radii of a new node where its arguments have very different ones. `carried` gives what the slot of a sum
    /// or product moves by with its arguments: their values and radii.
    fn spread(&mut self, id: Id, [a, b]: [Id; 2], carried: impl Fn((f64, f64), (f64, f64)) -> f64) {
        if !self.spreads(a) && !self.spreads(b) {
            return;
        }
        let at = id as usize;
        let Node { most, radius, .. } = self.nodes[at];
        let flushed = 4.0 * MIN_NORMAL * (1.0 + most + radius);
        let [ex, ey] = [a, b].map(|id| self.radii_of(id));
        let (x, y) = (self.value.get(a as usize), self.value.get(b as usize));
        let radii = self.radii.get_mut(at);
        number::wide(|| {
            for slot in 0..SLOTS {
                let carried = carried((x[slot], ex[slot]), (y[slot], ey[slot])) * (1.0 + BINARY64);
                // A gap is no larger than this part of a number.
                radii[slot] = carried + (most + carried) * (ULP + BINARY64) + flushed;
            }
        });
    }

    /// The same where that is too much: by the values themselves, without those that are large.
    #[cold]
    fn close_large(&mut self, args: [Id; 2], sizes: impl Fn(Node, Node) -> Sizes) -> (f64, f64) {
        for limit in [f64::INFINITY, LARGE] {
            for at in args.into_iter().map(|id| id as usize) {
                // A constant outlives its chunk.
                if self.nodes[at].constant.is_some() {
                    continue;
                }
                let values = self.value.get(at);
                let (open, lost) = (self.nodes[at].open, self.lost);
                let large = Mask::where_(|slot| values[slot].abs() > limit).minus(open);
                self.lost = lost.or(large);
                let known = Mask::ALL.minus(self.lost.or(open));
                let sizes = known.slots().map(|slot| values[slot].abs());
                // What nobody looks at may be no number.
                self.nodes[at].most =
                    sizes.filter(|size| size.is_finite()).fold(0.0, f64::max).min(self.nodes[at].most);
            }
            let [a, b] = args.map(|id| self.nodes[id as usize]);
            if let Some(found) = sizes(a, b).closed() {
                return found;
            }
        }
        self.lost = Mask::ALL;
        (0.0, 0.0)
    }
}

/// What is known of a node before it is rounded.
struct Sizes {
    /// At least the size of its values.
    most: f64,
    /// At least how far the exact result moves with its arguments.
    carried: f64,
    /// At least what flushing arguments and result adds.
    flushed: f64,
}

impl Sizes {
    /// Size and radius; `None` where a number may be too large for binary32.
    fn closed(self) -> Option<(f64, f64)> {
        let Self { most, carried, flushed } = self;
        let radius = carried + gap(most + carried) + most * BINARY64 + flushed;
        // A little more for the rounding of these numbers themselves.
        let radius = radius * (1.0 + BINARY64);
        (most + radius < MAX_FINITE / 2.0).then_some((most, radius))
    }
}
