//! Functions: their images over one radius for all slots, and what they err by at exact arguments.

use super::super::columns::{self, images_of_one, images_of_two};
use super::super::definitions::Definitions;
use super::super::functions::{is_not_negative, is_not_negative_of};
use super::super::inherited::{function, logarithm_of, power};
use super::super::kernels::{Out1, Out2, farther};
use super::super::model::{Arg, BINARY64, Model};
use super::super::rounded::either_side;
use super::{Glance, Id, Mask, Node, SLOTS, Slots, ZEROS, largest};
use crate::profile::Op;
use crate::profile::grid::{MAX_FINITE, MIN_NORMAL};
use program::interp::Site;
use std::f64::consts::LN_2;

/// Radii of which the largest is so many times their mean are kept slot by slot.
const UNEVEN: f64 = 8.0;

/// What a function does in all slots, beside its values.
struct Images {
    /// How far it moves within the radius.
    moves: Slots,
    /// Derivative by each argument, and how far that moves.
    slopes: [Slots; 2],
    bends: [Slots; 2],
    /// What the operation errs by within the radius, and at exact arguments.
    local: Slots,
    own: Slots,
}

impl Images {
    fn new() -> Self {
        let [moves, local, own] = [[0.0; SLOTS]; 3];
        Self { moves, slopes: [[0.0; SLOTS]; 2], bends: [[0.0; SLOTS]; 2], local, own }
    }
}

impl Definitions for Glance<'_> {
    fn promised(&self) -> &Model<'_> {
        &self.model
    }

    fn one(&mut self, site: Site, op: Op, active: &Mask, a: Id) -> Id {
        let arg = self.nodes[a as usize];
        let id = self.node(Node::new(is_not_negative(op), arg.open));
        let mut ex = self.radii_of(a);
        let (before, value) = self.value.split(id as usize);
        let x = before.get(a as usize);
        if site.is_open_at_ties() {
            ex = either_side(x, &ex);
        }
        let mut images = Images::new();
        let Images { moves, slopes: [slope, _], bends: [bend, _], local, own } = &mut images;
        let mut out = Out1 { value: &mut *value, moves, slope, bend };
        images_of_one(op, active, (x, &ex), self.model.flushes(), arg.not_negative, &mut out);
        for (radius, carried, error) in [(&ex, &*moves, local), (&ZEROS, &ZEROS, own)] {
            function(&self.model, op, Arg { value: x, radius }, value, carried, error);
        }
        self.complete(id, op, active, &[a], &mut images);
        id
    }

    fn two(&mut self, _: Site, op: Op, active: &Mask, a: Id, b: Id) -> Id {
        let (left, right) = (self.nodes[a as usize], self.nodes[b as usize]);
        let not_negative = is_not_negative_of(op, [left.not_negative, right.not_negative]);
        let id = self.node(Node::new(not_negative, left.open.or(right.open)));
        let flushes = self.model.flushes();
        let [ex, ey] = [a, b].map(|id| self.radii_of(id));
        let (before, value) = self.value.split(id as usize);
        let (x, y) = (before.get(a as usize), before.get(b as usize));
        let mut images = Images::new();
        let Images { moves, slopes: [sx, sy], bends: [bx, by], local, own } = &mut images;
        let mut out = Out2 { value: &mut *value, moves, slopes: [sx, sy], bends: [bx, by] };
        let logarithm = if op == Op::Pow { logarithm_of(x) } else { ZEROS };
        match op {
            Op::Pow => {
                let mut ln = ZEROS;
                number::map(&logarithm, &mut ln, |log| log * LN_2);
                columns::power((x, &ex), (y, &ey), &ln, [flushes; 2], |t| grown(t), &mut out);
            }
            _ => images_of_two(op, active, (x, &ex), (y, &ey), ([flushes; 2], flushes), &mut out),
        }
        // At exact arguments nothing may be more than it is.
        let [within, exactly]: [fn(&mut [f64]); 2] = [grown, surely_grown];
        for ([ex, ey], carried, grow, error) in
            [([&ex, &ey], &*moves, within, local), ([&ZEROS; 2], &ZEROS, exactly, own)]
        {
            let args = [Arg { value: x, radius: ex }, Arg { value: y, radius: ey }];
            match op {
                Op::Pow => power(&self.model, args, &logarithm, (value, carried), grow, error),
                _ => self.model.local(op, &args, value, carried, error),
            }
        }
        self.complete(id, op, active, &[a, b], &mut images);
        id
    }

    fn sum(&mut self, _: Option<Site>, _: Op, a: Id, b: Id, signs: (f64, f64)) -> Id {
        self.sum_of(a, b, signs)
    }

    fn product(&mut self, _: Site, _: Op, a: Id, b: Id) -> Id {
        self.product_of(a, b)
    }

    fn number(&mut self, value: f64) -> Id {
        self.leaf(|v| v.fill(value)).0
    }

    fn allow(&mut self, id: Id, error: f64) -> Id {
        if error > 0.0 { self.widened(id, error) } else { id }
    }

    fn outward(&mut self, _: Site, _: Op, id: Id) -> Id {
        let Node { most, radius, .. } = self.nodes[id as usize];
        let error = self.model.outward(most + radius);
        if error > 0.0 { self.widened(id, error) } else { id }
    }
}

impl Glance<'_> {
    /// The same value once more, off by `error` more.
    pub(super) fn widened(&mut self, a: Id, error: f64) -> Id {
        let node = self.nodes[a as usize];
        let id = self.node(Node { radius: node.radius + error, constant: None, ..node });
        if self.spreads(a) {
            *self.radii.get_mut(id as usize) = self.radii_of(a).map(|radius| radius + error);
        }
        self.sources[id as usize] = self.sources[a as usize];
        for pool in [&mut self.value, &mut self.moved, &mut self.farthest] {
            if pool.is_zero(a as usize) {
                pool.set_zero(id as usize);
                continue;
            }
            let (before, out) = pool.split(id as usize);
            *out = *before.get(a as usize);
        }
        id
    }

    /// Marks the result of an operation that is made of others, of which nothing may be promised.
    pub(super) fn mark(&mut self, op: Op, a: Id) -> Id {
        let (mut local, x) = ([0.0; SLOTS], self.value.get(a as usize));
        if self.model.definition(op).is_none() {
            self.model.local(op, &[Arg { value: x, radius: &ZEROS }], x, &ZEROS, &mut local);
        }
        let finite = Mask::where_(|slot| x[slot].is_finite());
        let error = local.into_iter().fold(0.0, f64::max);
        let id = self.widened(a, if error < f64::INFINITY { error } else { 0.0 });
        if error == f64::INFINITY {
            let node = &mut self.nodes[id as usize];
            node.open = node.open.or(finite);
            self.lost = self.lost.or(Mask::ALL.minus(finite));
        }
        id
    }

    /// Completes a function whose values are there.
    fn complete(&mut self, id: Id, op: Op, active: &Mask, args: &[Id], images: &mut Images) {
        let at = id as usize;
        let arg = |k: usize| args.get(k).map_or(&ZEROS, |id| self.value.get(*id as usize));
        let (x, y, value) = (arg(0), arg(1), self.value.get(at));
        let Images { moves, slopes: [sx, sy], bends: [bx, by], local, own } = images;
        let mut radii = [0.0; SLOTS];
        number::wide(|| {
            for slot in 0..SLOTS {
                let steep = sx[slot].abs() + bx[slot] + sy[slot].abs() + by[slot];
                let size = value[slot].abs();
                // Arguments and result may be flushed, and the reference is computed in binary64.
                let off = moves[slot] + local[slot] + (steep + 1.0) * (2.0 * MIN_NORMAL) + size * BINARY64;
                let known = (x[slot].abs() < f64::INFINITY) & (y[slot].abs() < f64::INFINITY);
                radii[slot] = if known & (size + off < MAX_FINITE / 2.0) { off } else { f64::INFINITY };
            }
        });
        let mut known = active.minus(self.lost).minus(self.nodes[at].open);
        if number::wide(|| radii.iter().fold(0_u64, |some, r| some | u64::from(!(*r < f64::INFINITY)))) != 0 {
            let endless = Mask::where_(|slot| radii[slot] == f64::INFINITY).and(known);
            let whole = self.model.definition(op).is_some();
            let unpromised = |slot: usize| {
                let finite = x[slot].is_finite() && y[slot].is_finite() && value[slot].is_finite();
                !whole && finite && own[slot] == f64::INFINITY
            };
            let open = Mask::where_(unpromised).and(endless);
            self.nodes[at].open = self.nodes[at].open.or(open);
            self.lost = self.lost.or(endless.minus(open));
            known = known.minus(endless);
        }
        let (mut most, mut radius) = (0.0_f64, 0.0_f64);
        if known.is_full() {
            (most, radius) = number::wide(|| (largest(|slot| value[slot].abs()), largest(|slot| radii[slot])));
        } else {
            known.each(|slot| (most, radius) = (most.max(value[slot].abs()), radius.max(radii[slot])));
        }
        (self.nodes[at].most, self.nodes[at].radius) = (most, radius);
        let sum = known.slots().map(|slot| radii[slot]).sum::<f64>();
        if radius * known.count() as f64 > UNEVEN * sum {
            *self.radii.get_mut(at) = radii;
        }
        self.displace(id, args, images);
    }

    /// Writes the displacement of a function.
    fn displace(&mut self, id: Id, args: &[Id], Images { slopes, own, .. }: &Images) {
        let at = id as usize;
        let errs = own.iter().any(|own| *own != 0.0);
        if !errs && args.iter().all(|&a| !self.moves(a)) {
            self.hold_still(id);
            return;
        }
        // Node 0 does not move.
        let ids = [args.first(), args.get(1)].map(|id| id.copied().unwrap_or(0));
        let apart = self.gather_sources(id, ids, errs);
        let (before, moved) = self.moved.split(at);
        let (far, farthest) = self.farthest.split(at);
        let [dx, dy] = ids.map(|id| before.get(id as usize));
        let [fx, fy] = ids.map(|id| far.get(id as usize));
        let [sx, sy] = slopes;
        number::wide(|| {
            for slot in 0..SLOTS {
                let along = sx[slot] * dx[slot] + sy[slot] * dy[slot];
                let most = sx[slot].abs() * fx[slot] + sy[slot].abs() * fy[slot];
                moved[slot] = farther(along, own[slot]);
                farthest[slot] = if apart { most } else { along.abs() } + own[slot];
            }
        });
    }
}

/// At least e^t − 1 for t ≥ 0: t + t²/2 + t³/4 + … against t + t²/2 + t³/6 + …, and a power of two where t is large.
#[inline(always)]
fn at_least_growth(t: f64) -> f64 {
    const WHOLE: f64 = (1_u64 << 52) as f64;
    // The lowest bits of a sum with 2^52 are those of its integral part.
    let exponent = (1.5 * t + 1.0 + WHOLE).to_bits() & 0xfff;
    let power = f64::from_bits((exponent + 1023) << 52);
    let near = t / (1.0 - 0.5 * t);
    let far = if t <= 64.0 { power } else { f64::INFINITY };
    if t <= 1.0 { near } else { far }
}

/// [`at_least_growth`] of all numbers of a column.
fn grown(column: &mut [f64]) {
    number::wide(|| column.iter_mut().for_each(|t| *t = at_least_growth(*t)));
}

/// At most e^t − 1 for t ≥ 0, by the first terms of its series.
fn surely_grown(column: &mut [f64]) {
    number::wide(|| column.iter_mut().for_each(|t| *t += 0.5 * *t * *t));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_is_an_upper_bound_at_every_size() {
        for k in 0..4000 {
            let t = 2f64.powf(f64::from(k) / 100.0 - 32.0);
            let (exact, found) = (t.exp_m1(), at_least_growth(t));
            assert!(found >= exact * (1.0 - 1e-15), "{t}: {found} against {exact}");
            assert!(found <= 8.0 * exact * (1.0 + t) || t > 64.0, "{t}: {found} against {exact}");
        }
        assert_eq!(at_least_growth(0.0), 0.0);
        for k in 0..4000 {
            let mut column = [2f64.powf(f64::from(k) / 100.0 - 32.0)];
            let exact = column[0].exp_m1();
            surely_grown(&mut column);
            assert!(column[0] <= exact * (1.0 + 1e-15), "{} against {exact}", column[0]);
        }
        assert!(at_least_growth(f64::NAN) == f64::INFINITY && at_least_growth(f64::INFINITY) == f64::INFINITY);
    }
}
