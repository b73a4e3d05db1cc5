//! Operations as nodes: values, radii, local errors and derivatives.

use super::Tape;
use super::arena::{Id, Meta, NodeKind, Slots};
use super::columns::{images_of_one, images_of_two};
use super::definitions::Definitions;
use super::functions::{is_not_negative, is_not_negative_of};
use super::inherited::{at_zero, function, logarithm_of, power, power_at_zero};
use super::kernels::{self, KernelNode, Once, Out1, Out2, or_infinite};
use super::model::Arg;
use super::paths::PathStep;
use super::rounded::either_side;
use crate::profile::grid::MIN_NORMAL;
use crate::profile::{Op, Unlisted};

use program::interp::{Mask, SLOTS, Site, Unary};

impl Tape<'_> {
    /// An operation on one number.
    pub(super) fn apply1(&mut self, site: Site, op: Unary, active: &Mask, a: Id) -> Id {
        let a = self.operand(site, a);
        match Op::of_unary(op) {
            Ok(Op::Neg) => self.sum(Some(site), Op::Neg, a, a, (-1.0, 0.0)),
            Ok(op) => self.function1(site, op, active, a),
            Err(Unlisted::NormalScale) => self.normal_scale(site, active, a),
            Err(Unlisted::Determinant) => self.mark(site, Op::Determinant, a),
            Err(Unlisted::Inverse) => self.mark(site, Op::Inverse, a),
            Err(Unlisted::Narrow) => self.narrow(site, a),
            Err(Unlisted::Half) => self.half(site, a),
            Err(Unlisted::FrexpFraction) => self.frexp_fraction(site, a),
        }
    }

    /// An operation on two numbers.
    pub(super) fn apply2(&mut self, site: Site, op: Op, active: &Mask, a: Id, b: Id) -> Id {
        let (a, b) = (self.operand(site, a), self.operand(site, b));
        match op {
            Op::Add => self.sum(Some(site), op, a, b, (1.0, 1.0)),
            Op::Sub => self.sum(Some(site), op, a, b, (1.0, -1.0)),
            Op::Mul => self.product(site, op, a, b),
            _ => self.function2(site, op, active, a, b),
        }
    }

    /// How far the ends of what a profile accepts of a node are moved outward.
    pub(super) fn step_outward(&self, id: Id) -> Slots {
        let (value, radius) = (self.arena.value.get(id as usize), self.arena.radius.get(id as usize));
        std::array::from_fn(|slot| self.model.outward(value[slot].abs() + radius[slot]))
    }

    /// The same value once more, with an error of its own: what is added is not regrouped.
    pub(super) fn identity(&mut self, site: Option<Site>, op: Option<Op>, a: Id, error: &Slots) -> Id {
        let partial = self.arena.partial();
        self.arena.partials.get_mut(2 * partial as usize).fill(1.0);
        self.arena.partials.get_mut(2 * partial as usize + 1).fill(0.0);
        let Meta { tiny, not_negative, .. } = self.arena.nodes[a as usize];
        let kind = NodeKind::One { a, partial };
        let id = self.node(Meta { kind, op, site, exact: false, tiny, not_negative });
        let at = id as usize;
        let (before, value) = self.arena.value.split(at);
        *value = *before.get(a as usize);
        let (before, radius) = self.arena.radius.split(at);
        for (slot, radius) in radius.iter_mut().enumerate() {
            *radius = before.get(a as usize)[slot] + error[slot];
        }
        *self.arena.local.get_mut(at) = *error;
        self.settle(id);
        id
    }

    /// Marks the result of an operation that is made of others, of which nothing may be promised.
    fn mark(&mut self, site: Site, op: Op, a: Id) -> Id {
        let at = a as usize;
        let mut local = [0.0; SLOTS];
        let args = [Arg { value: self.arena.value.get(at), radius: self.arena.radius.get(at) }];
        if matches!(self.model, super::Model::Device { .. }) && self.model.definition(op).is_none() {
            self.model.local(op, &args, args[0].value, args[0].radius, &mut local);
        }
        self.identity(Some(site), Some(op), a, &local)
    }

    /// ±a ± b.
    pub(super) fn sum(&mut self, site: Option<Site>, op: Op, a: Id, b: Id, signs: (f64, f64)) -> Id {
        let nodes = &self.arena.nodes;
        let (left, right) = (nodes[a as usize], nodes[b as usize]);
        let single = signs.1 == 0.0;
        let not_negative = signs == (1.0, 1.0) && left.not_negative && right.not_negative;
        let kind = NodeKind::Sum { a, b, signs };
        let id = self.node(Meta { kind, op: Some(op), site, exact: single, tiny: false, not_negative });
        let at = id as usize;
        if !single && self.moved_once(id, [a, b], op, Once::Sum(signs)) {
            return id;
        }
        let (before, value) = self.arena.value.split(at);
        let (radii, carried) = self.arena.radius.split(at);
        let (x, y) = (before.get(a as usize), before.get(b as usize));
        let (ex, ey) = (radii.get(a as usize), radii.get(b as usize));
        if single {
            number::wide(|| (0..SLOTS).for_each(|slot| value[slot] = signs.0 * x[slot]));
            *carried = *ex;
            if self.arena.radius.is_zero(a as usize) {
                self.arena.radius.set_zero(at);
            }
            self.arena.local.set_zero(at);
            self.arena.nodes[at].tiny = left.tiny;
            if left.tiny && self.model.flushes() {
                self.arena.nodes[at].exact = false;
                self.flush(id, &[(a, None)]);
                let (radius, local) = (self.arena.radius.get_mut(at), self.arena.local.get(at));
                radius.iter_mut().zip(local).for_each(|(e, b)| *e += b);
            }
            self.settle(id);
            return id;
        }
        if let Some(closing) = self.model.closing(op, [left.tiny, right.tiny], self.arena.nodes[at].is_kept()) {
            let node = KernelNode { value, radius: carried, local: self.arena.local.get_mut(at) };
            let seen = number::wide(|| kernels::rounded_sum((x, ex), (y, ey), signs, closing, node));
            self.arena.nodes[at].tiny = seen.tiny;
            self.settle(id);
            return id;
        }
        number::wide(|| {
            for slot in 0..SLOTS {
                value[slot] = signs.0 * x[slot] + signs.1 * y[slot];
                carried[slot] = ex[slot] + ey[slot];
            }
        });
        let args = [Arg { value: x, radius: ex }, Arg { value: y, radius: ey }];
        let op = if op == Op::Neg { Op::Sub } else { op };
        self.model.local(op, &args, value, carried, self.arena.local.get_mut(at));
        self.flush(id, &[(a, None), (b, None)]);
        self.close(id);
        id
    }

    /// a·b.
    pub(super) fn product(&mut self, site: Site, op: Op, a: Id, b: Id) -> Id {
        let nodes = &self.arena.nodes;
        let tiny = [nodes[a as usize].tiny, nodes[b as usize].tiny];
        let not_negative = a == b || (nodes[a as usize].not_negative && nodes[b as usize].not_negative);
        let kind = NodeKind::Product { a, b };
        let meta = Meta { kind, op: Some(op), site: Some(site), exact: false, tiny: false, not_negative };
        let id = self.node(meta);
        let at = id as usize;
        if self.moved_once(id, [a, b], op, Once::Product) {
            return id;
        }
        let (before, value) = self.arena.value.split(at);
        let (radii, carried) = self.arena.radius.split(at);
        let (x, y) = (before.get(a as usize), before.get(b as usize));
        let (ex, ey) = (radii.get(a as usize), radii.get(b as usize));
        if let Some(closing) = self.model.closing(op, tiny, self.arena.nodes[at].is_kept()) {
            let node = KernelNode { value, radius: carried, local: self.arena.local.get_mut(at) };
            let seen = number::wide(|| kernels::rounded_product((x, ex), (y, ey), closing, node));
            self.arena.nodes[at].tiny = seen.tiny;
            self.settle(id);
            return id;
        }
        number::wide(|| {
            for slot in 0..SLOTS {
                value[slot] = x[slot] * y[slot];
                carried[slot] = or_infinite(kernels::carried_by_product(x[slot], ex[slot], y[slot], ey[slot]));
            }
        });
        let args = [Arg { value: x, radius: ex }, Arg { value: y, radius: ey }];
        self.model.local(op, &args, value, carried, self.arena.local.get_mut(at));
        self.flush(id, &[(a, Some(b)), (b, Some(a))]);
        self.close(id);
        id
    }

    /// `a` in the slots of a mask, `b` in the others.
    pub(super) fn select(&mut self, mask: &Mask, a: Id, b: Id) -> Id {
        if a == b {
            return a;
        }
        let nodes = &self.arena.nodes;
        let (left, right) = (nodes[a as usize], nodes[b as usize]);
        let number = self.arena.mask(*mask);
        let id = self.node(Meta {
            kind: NodeKind::Select { mask: number, a, b },
            op: None,
            site: None,
            exact: true,
            tiny: left.tiny || right.tiny,
            not_negative: left.not_negative && right.not_negative,
        });
        let at = id as usize;
        for pool in [&mut self.arena.value, &mut self.arena.radius] {
            if pool.is_zero(a as usize) && pool.is_zero(b as usize) {
                pool.set_zero(at);
                continue;
            }
            let (before, to) = pool.split(at);
            *to = *before.get(b as usize);
            number::wide(|| mask.merge(before.get(a as usize), to));
        }
        self.arena.local.set_zero(at);
        self.settle(id);
        id
    }

    /// A function of one number as a node of its own.
    pub(super) fn one(&mut self, site: Site, op: Op, active: &Mask, a: Id) -> Id {
        let flushes = self.model.flushes() && self.arena.nodes[a as usize].tiny;
        let open = self.is_open_at_ties(site);
        let steps = self.steps((site, op), active, a, flushes);
        let partial = self.arena.partial();
        let not_negative = self.arena.nodes[a as usize].not_negative;
        let keeps = is_not_negative(op);
        let kind = NodeKind::One { a, partial };
        let meta = Meta { kind, op: Some(op), site: Some(site), exact: false, tiny: false, not_negative: keeps };
        let id = self.node(meta);
        let at = id as usize;
        let (before, value) = self.arena.value.split(at);
        let (radii, carried) = self.arena.radius.split(at);
        let (x, ex) = (before.get(a as usize), radii.get(a as usize));
        let halves;
        let ex = if open {
            halves = either_side(x, ex);
            &halves
        } else {
            ex
        };
        let (slope, bend) = self.arena.partials.pair_mut(2 * partial as usize);
        let mut out = Out1 { value, moves: carried, slope, bend };
        images_of_one(op, active, (x, ex), flushes, not_negative, &mut out);
        let (slope, bend) = self.arena.partials.pair_mut(2 * partial as usize);
        for PathStep { slot, value: side, moves, slope: steep } in steps {
            (value[slot], carried[slot], slope[slot], bend[slot]) = (side, moves, steep, 0.0);
        }
        let local = self.arena.local.get_mut(at);
        function(&self.model, op, Arg { value: x, radius: ex }, value, carried, local);
        self.flush(id, &[(a, None)]);
        self.cut(id, &[partial]);
        self.close(id);
        id
    }

    /// A function of two numbers as a node of its own.
    pub(super) fn two(&mut self, site: Site, op: Op, active: &Mask, a: Id, b: Id) -> Id {
        let flushes = [a, b].map(|id| self.arena.nodes[id as usize].tiny && self.model.flushes());
        let steps = self.edge(op, active, [a, b], flushes);
        let partials = [self.arena.partial(), self.arena.partial()];
        let (left, right) = (self.arena.nodes[a as usize], self.arena.nodes[b as usize]);
        let not_negative = is_not_negative_of(op, [left.not_negative, right.not_negative]);
        let kind = NodeKind::Two { a, b, partials };
        let meta = Meta { kind, op: Some(op), site: Some(site), exact: false, tiny: false, not_negative };
        let id = self.node(meta);
        let at = id as usize;
        let (before, value) = self.arena.value.split(at);
        let (radii, carried) = self.arena.radius.split(at);
        let (x, y) = (before.get(a as usize), before.get(b as usize));
        let (ex, ey) = (radii.get(a as usize), radii.get(b as usize));
        let [sx, bx, sy, by] = self.arena.partials.quad_mut(2 * partials[0] as usize);
        let mut out = Out2 { value, moves: carried, slopes: [sx, sy], bends: [bx, by] };
        images_of_two(op, active, (x, ex), (y, ey), (flushes, self.model.flushes()), &mut out);
        let args = [Arg { value: x, radius: ex }, Arg { value: y, radius: ey }];
        let local = self.arena.local.get_mut(at);
        let [sx, bx, sy, by] = self.arena.partials.quad_mut(2 * partials[0] as usize);
        for PathStep { slot, value: side, moves, slope } in steps {
            (value[slot], carried[slot]) = (side, moves);
            (sx[slot], sy[slot], bx[slot], by[slot]) = (slope, slope, 0.0, 0.0);
        }
        let mut out = Out2 { value, moves: carried, slopes: [sx, sy], bends: [bx, by] };
        if op == Op::Pow && left.not_negative && at_zero(args, active, &mut out) {
            power_at_zero(&self.model, args, out, local);
        } else if op == Op::Pow {
            power(&self.model, args, &logarithm_of(x), (value, carried), number::exp_m1_all, local);
        } else {
            self.model.local(op, &args, value, carried, local);
        }
        self.flush(id, &[(a, None), (b, None)]);
        self.cut(id, &partials);
        self.close(id);
        id
    }

    /// Adds what a flushed argument may do. `None` for the other factor stands for the node's own
    /// partials.
    fn flush(&mut self, id: Id, args: &[(Id, Option<Id>)]) {
        if !self.model.flushes() || args.iter().all(|(a, _)| !self.arena.nodes[*a as usize].tiny) {
            return;
        }
        let at = id as usize;
        let mut more = [0.0; SLOTS];
        for (k, &(a, other)) in args.iter().enumerate() {
            let a = a as usize;
            if !self.arena.nodes[a].tiny {
                continue;
            }
            let (x, e) = (self.arena.value.get(a), self.arena.radius.get(a));
            let (slope, bend) = match (other, self.arena.nodes[at].kind) {
                (Some(other), _) => (self.arena.value.get(other as usize), self.arena.radius.get(other as usize)),
                (None, NodeKind::One { partial, .. }) => self.arena.partial_at(partial),
                (None, NodeKind::Two { partials, .. }) => self.arena.partial_at(partials[k]),
                (None, _) => (&[1.0; SLOTS], &[0.0; SLOTS]),
            };
            number::wide(|| {
                for slot in 0..SLOTS {
                    let (size, e) = (x[slot].abs(), e[slot]);
                    let reach = size + e;
                    let slope = slope[slot].abs() + bend[slot];
                    // Written so that a number that is none counts. Without a finite slope the movement counts as a whole, the
                    // flush included.
                    let touched = !((reach == 0.0) | (size - e >= MIN_NORMAL)) & (slope < f64::INFINITY);
                    let moved = slope * reach.min(MIN_NORMAL);
                    more[slot] += if touched { moved } else { 0.0 };
                }
            });
        }
        self.arena.local.get_mut(at).iter_mut().zip(&more).for_each(|(b, more)| *b += more);
    }

    /// Where a derivative is not finite, the node's movement becomes its own error.
    fn cut(&mut self, id: Id, partials: &[u32]) {
        let at = id as usize;
        let finite = |slot: usize| {
            let of = |&p: &u32| self.arena.partial_at(p);
            partials.iter().map(of).all(|(slope, bend)| slope[slot].is_finite() && bend[slot].is_finite())
        };
        let lost = partials.iter().any(|&p| {
            let (slope, bend) = self.arena.partial_at(p);
            // 0 times what is not finite is NaN.
            number::wide(|| {
                slope.iter().zip(bend).fold(0_u64, |lost, (s, b)| lost | u64::from((s * 0.0 + b * 0.0) != 0.0))
            }) != 0
        });
        if !lost {
            return;
        }
        let slots: Vec<usize> = (0..SLOTS).filter(|&slot| !finite(slot)).collect();
        self.note_steps(id, &slots);
        for slot in slots {
            for &p in partials {
                self.arena.partials.get_mut(2 * p as usize)[slot] = 0.0;
                self.arena.partials.get_mut(2 * p as usize + 1)[slot] = 0.0;
            }
            let carried = self.arena.radius.get(at)[slot];
            self.arena.local.get_mut(at)[slot] += carried;
            self.arena.radius.get_mut(at)[slot] = 0.0;
        }
    }

    /// An argument that may be infinite, or no number, may give anything, whatever the function's values
    /// elsewhere are: a device's `sin` of infinity is NaN, and so is 0 times infinity. Derivatives do not
    /// say so.
    fn lose(&mut self, id: Id) {
        let at = id as usize;
        let args = match self.arena.nodes[at].kind {
            NodeKind::One { a, .. } => [a, a],
            NodeKind::Two { a, b, .. } | NodeKind::Product { a, b } => [a, b],
            NodeKind::Leaf | NodeKind::Sum { .. } | NodeKind::Select { .. } => return,
        };
        let local = self.arena.local.get_mut(at);
        for arg in args {
            let radius = self.arena.radius.get(arg as usize);
            number::wide(|| {
                for slot in 0..SLOTS {
                    local[slot] = if radius[slot] < f64::INFINITY { local[slot] } else { f64::INFINITY };
                }
            });
        }
    }

    /// Completes a node: its local error and with it its radius.
    fn close(&mut self, id: Id) {
        if self.closed_moving(id) {
            return;
        }
        let at = id as usize;
        let (value, local) = (self.arena.value.get(at), self.arena.local.get_mut(at));
        let carried = self.arena.radius.get_mut(at);
        self.arena.nodes[at].tiny = self.model.finish(value, carried, local);
        self.lose(id);
        let (local, carried) = (self.arena.local.get(at), self.arena.radius.get_mut(at));
        let regrouped = self.model.is_rearranged() && self.arena.nodes[at].is_regrouped();
        if !regrouped {
            number::wide(|| carried.iter_mut().zip(local.iter()).for_each(|(e, b)| *e += b));
        }
        self.settle(id);
    }
}
