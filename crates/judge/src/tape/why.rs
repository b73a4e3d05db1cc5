//! Answers about single slots, for reports: what a bound is made of, and why there is none.

use super::arena::{Id, NodeKind};
use super::functions::{image1, image2};
use super::{Column, Model, Tape};
use crate::profile::grid::MAX_FINITE;
use crate::profile::{Allowed, Op};
use program::interp::{Number, Site};

/// Why a value or a bound is not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Why {
    /// The operation has no value for these arguments.
    Domain,
    /// The arguments are so uncertain that they reach a place where the operation has no value.
    Singular,
    /// The API promises nothing for the operation, or for these arguments.
    NoPromise,
    /// The value is, or may be, too large for binary32.
    Overflow,
}

/// The operation that is to blame for a value or a bound that is not finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    /// The reason why there is no finite number.
    pub why: Why,
    /// The operation; `None` for what is not one, an input that is NaN for example.
    pub op: Option<Op>,
    /// Where it stands.
    pub site: Option<Site>,
    /// Its arguments, exactly.
    pub args: Vec<f64>,
    /// Its value, exactly.
    pub value: f64,
}

/// The part of a bound that one operation has.
#[derive(Clone, Debug, PartialEq)]
pub struct Share {
    /// The operation; `None` for a literal.
    pub op: Option<Op>,
    /// Where it stands.
    pub site: Option<Site>,
    /// Its arguments, exactly.
    pub args: Vec<f64>,
    /// Its value, exactly.
    pub value: f64,
    /// Its part of the bound, in the unit of the output.
    pub share: f64,
}

/// The operations that outputs depend on, in one slot.
#[derive(Clone, Debug)]
pub struct Feeds {
    needed: Vec<bool>,
    slot: usize,
}

impl Feeds {
    /// True for a column whose operation is one of them.
    pub fn has(&self, tape: &Tape<'_>, column: Column) -> bool {
        self.needed[tape.operation(column, self.slot) as usize]
    }
}

impl From<Share> for Cause {
    /// The operation of a share as a cause; its value is a number.
    fn from(Share { op, site, args, value, share: _ }: Share) -> Self {
        Self { why: Why::Singular, op, site, args, value }
    }
}

impl Tape<'_> {
    /// A comparison as a cause.
    pub fn decision(&self, site: Site) -> Cause {
        Cause { why: Why::Singular, op: None, site: Some(site), args: Vec::new(), value: f64::NAN }
    }

    /// Why a value is no finite number in a slot, or why nothing bounds its error.
    pub fn cause(&self, output: Column, slot: usize) -> Option<Cause> {
        let loose = |id: &Id| !self.arena.radius.get(*id as usize)[slot].is_finite();
        let lost = |id: &Id| !self.arena.value.get(*id as usize)[slot].is_finite();
        let mut id = self.id(&output);
        if !lost(&id) && !loose(&id) {
            return None;
        }
        // Arguments have smaller numbers: this ends. A lost value is followed first.
        loop {
            let arguments = || self.arguments(id, slot);
            let before = arguments().find(|a| lost(a)).or_else(|| arguments().find(|a| loose(a)));
            match before {
                Some(before) => id = before,
                None => return Some(self.cause_at(id, slot)),
            }
        }
    }

    /// The largest parts of a bound in a slot, largest first.
    pub fn shares(&mut self, output: Column, slot: usize, most: usize) -> Vec<Share> {
        let mut parts: Vec<(Id, f64)> = Vec::new();
        self.bounds_with(output, &mut |_| false, &mut |id, part| {
            if part[slot] > 0.0 {
                parts.push((id, part[slot]));
            }
        });
        parts.sort_by(|a, b| b.1.total_cmp(&a.1));
        parts.truncate(most);
        let share = |(id, share): (Id, f64)| Share {
            op: self.arena.nodes[id as usize].op,
            site: self.arena.nodes[id as usize].site,
            args: self.argument_values(id, slot),
            value: self.arena.value.get(id as usize)[slot],
            share,
        };
        parts.into_iter().map(share).collect()
    }

    /// The operation at which a value goes wrong in a slot: the first on the way to it that has no finite
    /// value, is too large for binary32, or has an error of more than `limit` of its size; of errors
    /// nothing is asked where `limit` is infinite. With its relative condition number. `None` where the
    /// value itself is fine.
    pub fn culprit(&self, output: Column, slot: usize, limit: f64) -> Option<(Cause, f64)> {
        let value = |id: Id| self.arena.value.get(id as usize)[slot];
        let lost = |id: &Id| !value(*id).is_finite();
        let large = |id: &Id| value(*id).abs() > MAX_FINITE;
        // Written so that a radius that is no number counts.
        let loose =
            |id: &Id| limit.is_finite() && !(self.arena.radius.get(*id as usize)[slot] <= limit * value(*id).abs());
        let mut id = self.id(&output);
        if !lost(&id) && !large(&id) && !loose(&id) {
            return None;
        }
        // Arguments have smaller numbers: this ends.
        loop {
            let arguments = || self.arguments(id, slot);
            let before = arguments().find(|a| lost(a)).or_else(|| arguments().find(|a| large(a)));
            let before = before.or_else(|| arguments().find(|a| loose(a)));
            match before {
                Some(before) => id = before,
                None => return Some((self.cause_at(id, slot), self.condition(Column(id), slot))),
            }
        }
    }

    /// What some columns depend on in a slot.
    pub fn feeds(&self, outputs: &[Column], slot: usize) -> Feeds {
        let mut needed = vec![false; self.arena.nodes.len()];
        let mut open: Vec<Id> = outputs.iter().map(|column| self.id(column)).collect();
        while let Some(id) = open.pop() {
            if !std::mem::replace(&mut needed[id as usize], true) {
                open.extend(self.arguments(id, slot));
            }
        }
        Feeds { needed, slot }
    }

    /// The operation behind a column in a slot, selections left out.
    fn operation(&self, column: Column, slot: usize) -> Id {
        let mut id = self.id(&column);
        while let NodeKind::Select { .. } = self.arena.nodes[id as usize].kind {
            let Some(before) = self.arguments(id, slot).next() else { break };
            id = before;
        }
        id
    }

    /// Where the operation stands that gives a column its value in a slot; `None` for an input.
    pub fn site_of(&self, column: Column, slot: usize) -> Option<Site> {
        self.arena.nodes[self.operation(column, slot) as usize].site
    }

    /// The exact arguments of the operation that gives a column its value in a slot.
    pub fn arguments_of(&self, column: Column, slot: usize) -> Vec<f64> {
        self.argument_values(self.operation(column, slot), slot)
    }

    /// The relative condition number of that operation: Σ |∂y/∂a · a| / |y| over its arguments; NaN for
    /// what is no operation.
    pub fn condition(&self, column: Column, slot: usize) -> f64 {
        let id = self.operation(column, slot);
        let value = |id: Id| self.arena.value.get(id as usize)[slot];
        let slope = |partial: u32| self.arena.partial_at(partial).0[slot];
        let moved = match self.arena.nodes[id as usize].kind {
            NodeKind::Leaf | NodeKind::Select { .. } => f64::NAN,
            NodeKind::Sum { a, b, signs } => (signs.0 * value(a)).abs() + (signs.1 * value(b)).abs(),
            NodeKind::Product { .. } => 2.0 * value(id).abs(),
            NodeKind::One { a, partial } => (slope(partial) * value(a)).abs(),
            NodeKind::Two { a, b, partials: [p, q] } => (slope(p) * value(a)).abs() + (slope(q) * value(b)).abs(),
        };
        moved / value(id).abs()
    }

    pub(super) fn arguments(&self, id: Id, slot: usize) -> impl Iterator<Item = Id> + use<> {
        let both = match self.arena.nodes[id as usize].kind {
            NodeKind::Leaf => [None, None],
            NodeKind::Sum { a, signs: (_, 0.0), .. } | NodeKind::One { a, .. } => [Some(a), None],
            NodeKind::Sum { a, b, .. } | NodeKind::Product { a, b } | NodeKind::Two { a, b, .. } => [Some(a), Some(b)],
            NodeKind::Select { mask, a, b } => {
                [Some(if self.arena.masks[mask as usize].has(slot) { a } else { b }), None]
            }
        };
        both.into_iter().flatten()
    }

    pub(super) fn argument_values(&self, id: Id, slot: usize) -> Vec<f64> {
        self.arguments(id, slot).map(|a| self.arena.value.get(a as usize)[slot]).collect()
    }

    /// True when an operation has a value wherever its arguments may be, and nothing is promised for
    /// some of these.
    fn reaches_out(&self, id: Id, slot: usize) -> bool {
        let meta = self.arena.nodes[id as usize];
        let at = |a: Id| (self.arena.value.get(a as usize)[slot], self.arena.radius.get(a as usize)[slot]);
        let moves = match (meta.kind, meta.op) {
            (NodeKind::One { a, .. }, Some(op)) => {
                let (x, e) = at(a);
                image1(op, x, e, self.arena.nodes[a as usize].not_negative).moves
            }
            (NodeKind::Two { a, b, .. }, Some(op)) => image2(op, at(a), at(b)).moves,
            _ => return false,
        };
        moves.is_finite()
    }

    fn cause_at(&self, id: Id, slot: usize) -> Cause {
        let at = id as usize;
        let meta = self.arena.nodes[at];
        let (value, args) = (self.arena.value.get(at)[slot], self.argument_values(id, slot));
        let reach = value.abs() + self.arena.radius.get(at)[slot];
        let promise = match (self.model, meta.op) {
            (Model::Device { profile, stage, .. }, Some(op)) => Some(profile.allowed(op, &args, value, stage)),
            _ => None,
        };
        let why = if value.is_nan() && !value.is_poison() {
            Why::Domain
        } else if matches!(promise, Some(Allowed::NoPromise | Allowed::OutsideDomain)) || self.reaches_out(id, slot) {
            Why::NoPromise
        } else if value.abs() > MAX_FINITE || (value.is_finite() && reach.is_finite() && reach > MAX_FINITE) {
            Why::Overflow
        } else {
            Why::Singular
        };
        Cause { why, op: meta.op, site: meta.site, args, value }
    }
}
