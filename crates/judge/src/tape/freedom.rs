//! What is left to devices: the operations on the way to a value that two conforming devices may compute with other bits.
//!
//! A bound says how far a device may be from the real number. Two devices that round alike are equally far from it: a sum or
//! product that is rounded by itself gives every device the same bits as soon as its operands are the same, although its
//! error is not zero. What makes bits differ is a shorter list: terms in another order, a product and a sum in one operation,
//! functions that are promised within an error, subnormal numbers that become zero, numbers that are not finite, and
//! comparisons of what differs already.
//!
//! One assumption is made: sums and products are rounded to nearest, as every device that was measured does. Vulkan promises
//! it where an entry point asks for `RoundingModeRTE`; WGSL leaves the direction open.

use super::arena::{Id, Meta, NodeKind, Slots};
use super::kernels::lost_by_sum;
use super::{Column, Model, Tape};
use crate::profile::grid::{MAX_FINITE, MIN_NORMAL};
use crate::profile::{Entry, Op, Rule};
use program::interp::{Mask, SLOTS, Site};
use serde::{Deserialize, Serialize};

/// Whole numbers up to this size are exact in binary32, and so are sums of them in any order.
const WHOLE: f64 = (1 << 24) as f64;

/// Why two conforming devices may have other bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Freedom {
    /// A product and the sum that it goes into may be rounded once, as one operation. `precise` forbids it.
    Contraction,
    /// The terms of a sum or the factors of a product may be taken in another order. `precise` forbids it.
    Order,
    /// One function or operator of the source is several sums and products, in an order that nobody states: `dot`, `mix`, a
    /// matrix times a vector.
    Inside,
    /// A function, a quotient or a root is promised within an error, or not at all.
    Function(Op),
    /// A subnormal number may become zero.
    Subnormal,
    /// A number is infinite, none at all, or may be: nothing is promised of it.
    NotFinite,
    /// A comparison or a conversion of numbers that differ falls either way.
    Decision,
}

impl Freedom {
    /// True where `precise` takes it away.
    pub fn is_pinned_by_precise(self) -> bool {
        matches!(self, Self::Contraction | Self::Order)
    }
}

/// A freedom, where it stands, and in which slots a value depends on it.
#[derive(Clone, Copy, Debug)]
pub struct Freed {
    /// What may differ.
    pub freedom: Freedom,
    /// The expression; `None` for an input.
    pub site: Option<Site>,
    /// The slots.
    pub slots: Mask,
}

/// What of a column is left to devices.
#[derive(Clone, Debug)]
pub struct Freedoms {
    /// Each place once for each kind of freedom.
    pub each: Vec<Freed>,
    /// How far two conforming devices may be from each other in each slot, in the unit of the column; infinite where nothing
    /// bounds it.
    pub spread: Box<[f64; SLOTS]>,
}

/// The slots in which each node has the real number exactly.
#[derive(Clone, Debug)]
pub struct ExactSlots(Vec<Mask>);

/// A node that depends on no other.
const NOTHING: [(Id, Mask); 2] = [(0, Mask::NONE); 2];

/// A decision that may fall either way, with what it compares.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenDecision {
    site: Site,
    operands: [Id; 2],
    slots: Mask,
}

/// The walk from a value back to the inputs.
struct Walk {
    /// In which slots each node is needed.
    needed: Vec<Mask>,
    found: Vec<Freed>,
    /// In which slots each node has a freedom of its own.
    own: Vec<Mask>,
}

impl Walk {
    fn new(nodes: usize) -> Self {
        Self { needed: vec![Mask::NONE; nodes], found: Vec::new(), own: vec![Mask::NONE; nodes] }
    }

    fn need(&mut self, id: Id, slots: Mask) {
        let needed = &mut self.needed[id as usize];
        *needed = needed.or(slots);
    }

    fn add(&mut self, id: Id, freedom: Freedom, site: Option<Site>, slots: Mask) {
        if slots.is_empty() {
            return;
        }
        self.own[id as usize] = self.own[id as usize].or(slots);
        let index = |site: Option<Site>| site.map(Site::index);
        let same = |freed: &&mut Freed| freed.freedom == freedom && index(freed.site) == index(site);
        match self.found.iter_mut().find(same) {
            Some(freed) => freed.slots = freed.slots.or(slots),
            None => self.found.push(Freed { freedom, site, slots }),
        }
    }
}

impl Tape<'_> {
    /// A tape that remembers what open decisions compare, for [`Tape::freedoms`].
    #[must_use]
    pub fn with_decisions(mut self) -> Self {
        self.decisions = Some(Vec::new());
        self
    }

    /// Remembers an open decision, where that is asked for.
    pub(super) fn note_decision(&mut self, site: Site, operands: [Id; 2], slots: &[usize]) {
        if let Some(decisions) = self.decisions.as_mut().filter(|_| !slots.is_empty()) {
            let mut mask = Mask::NONE;
            slots.iter().for_each(|&slot| mask.insert(slot));
            decisions.push(OpenDecision { site, operands, slots: mask });
        }
    }

    /// What of a column is left to devices of the profile of this tape, in these slots.
    pub fn freedoms(&mut self, output: Column, slots: Mask, exact: &ExactSlots) -> Freedoms {
        let root = self.id(&output);
        let walk = self.walk(root, slots, exact);
        let freed = self.freed_within(&walk, root);
        let mut spread = Box::new([0.0; SLOTS]);
        let rearranged = self.model.is_rearranged();
        let mut shares: Vec<(Id, Slots)> = Vec::new();
        self.bounds_with(output, &mut |_| false, &mut |id, part| shares.push((id, *part)));
        for (id, part) in shares {
            let whole = rearranged && self.arena.nodes[id as usize].is_regrouped();
            let free = if whole { freed[id as usize] } else { walk.own[id as usize] };
            free.each(|slot| spread[slot] += 2.0 * part[slot]);
        }
        for freed in &walk.found {
            if freed.freedom == Freedom::NotFinite {
                freed.slots.each(|slot| spread[slot] = f64::INFINITY);
            }
        }
        Freedoms { each: walk.found, spread }
    }

    /// The decisions that may fall otherwise on another device, in these slots; and the slots in which one may fall otherwise
    /// than in real numbers, but alike on all devices, so that what a device does behind it is not known here.
    pub fn open_decisions(&self, slots: Mask, exact: &ExactSlots) -> (Vec<Freed>, Mask) {
        let (mut found, mut unknown): (Vec<Freed>, Mask) = (Vec::new(), Mask::NONE);
        let mut told = Mask::NONE;
        let decisions = self.decisions.as_deref().unwrap_or_default();
        let differs = if decisions.is_empty() { Vec::new() } else { self.differing(exact) };
        for OpenDecision { site, operands: [a, b], slots: open } in decisions {
            let open = open.and(slots);
            told = told.or(open);
            let free = differs[*a as usize].or(differs[*b as usize]).and(open);
            if !free.is_empty() {
                found.push(Freed { freedom: Freedom::Decision, site: Some(*site), slots: free });
            }
            unknown = unknown.or(open.minus(free));
        }
        // What was noted without operands, and what was given up, is open for other reasons.
        for slot in slots.slots() {
            match (self.given_up(slot), self.fork(slot)) {
                (Some(_), _) => unknown.insert(slot),
                (None, Some(site)) if !told.has(slot) => {
                    let slots = Mask::where_(|k| k == slot);
                    found.push(Freed { freedom: Freedom::Decision, site: Some(site), slots });
                }
                (None, _) => {}
            }
        }
        (found, unknown)
    }

    /// From a node back to the inputs.
    fn walk(&self, root: Id, slots: Mask, ExactSlots(exact): &ExactSlots) -> Walk {
        let mut walk = Walk::new(root as usize + 1);
        walk.need(root, slots);
        // Arguments have smaller numbers.
        for id in (0..=root).rev() {
            let slots = walk.needed[id as usize];
            if !slots.is_empty() {
                self.look_at(id, slots, exact, &mut walk).into_iter().for_each(|(to, slots)| walk.need(to, slots));
            }
        }
        walk
    }

    /// In which slots each node may have other bits on another device.
    fn differing(&self, ExactSlots(exact): &ExactSlots) -> Vec<Mask> {
        let mut walk = Walk::new(exact.len());
        let mut all: Vec<Mask> = Vec::with_capacity(exact.len());
        for id in 0..exact.len() as Id {
            let takes = self.look_at(id, Mask::ALL, exact, &mut walk);
            let taken = takes
                .into_iter()
                .filter(|(_, slots)| !slots.is_empty())
                .fold(Mask::NONE, |sum, (to, slots)| sum.or(all[to as usize].and(slots)));
            all.push(walk.own[id as usize].or(taken));
        }
        all
    }

    /// The freedoms of one node; gives the nodes that it depends on, with the slots in which it does.
    fn look_at(&self, id: Id, slots: Mask, exact: &[Mask], walk: &mut Walk) -> [(Id, Mask); 2] {
        let at = id as usize;
        let meta = self.arena.nodes[at];
        let (value, radius) = (self.arena.value.get(at), self.arena.radius.get(at));
        let local = self.arena.local.get(at);
        let finite = |id: Id, slot: usize| self.arena.value.get(id as usize)[slot].is_finite();
        let begins = |slot: usize| self.arguments(id, slot).all(|a| finite(a, slot));
        let lost =
            |slot: usize| !value[slot].is_finite() || value[slot].abs() + finite_or_zero(radius[slot]) > MAX_FINITE;
        let lost = slots.and(Mask::where_(|slot| slots.has(slot) && lost(slot) && begins(slot)));
        walk.add(id, Freedom::NotFinite, meta.site, lost);
        if meta.tiny && self.model.flushes() && !matches!(meta.kind, NodeKind::Select { .. }) {
            let small = |slot: usize| value[slot] != 0.0 && value[slot].abs() < MIN_NORMAL;
            walk.add(id, Freedom::Subnormal, meta.site, slots.and(Mask::where_(small)));
        }
        let off = slots.and(Mask::where_(|slot| local[slot] != 0.0));
        match meta.kind {
            NodeKind::Leaf => {
                if let Some(op) = meta.op.filter(|op| !self.is_fixed(*op)) {
                    walk.add(id, Freedom::Function(op), meta.site, off);
                }
                let unbounded = |slot: usize| radius[slot] == f64::INFINITY;
                walk.add(id, Freedom::NotFinite, meta.site, slots.and(Mask::where_(unbounded)));
                NOTHING
            }
            NodeKind::Select { mask, a, b } => {
                let mask = self.arena.masks[mask as usize];
                [(a, slots.and(mask)), (b, slots.minus(mask))]
            }
            NodeKind::Sum { a, signs: (_, 0.0), .. } => [(a, slots), NOTHING[1]],
            NodeKind::Sum { a, b, .. } => {
                self.look_at_terms((id, &meta), [a, b], slots, exact, walk);
                [(a, slots), (b, slots)]
            }
            NodeKind::Product { a, b } => {
                self.look_at_factors((id, &meta), [a, b], slots, exact, walk);
                // Nothing is left of a factor beside an exact zero.
                let zero = |id: Id| {
                    let (value, exact) = (self.arena.value.get(id as usize), exact[id as usize]);
                    Mask::where_(|slot| value[slot] == 0.0 && exact.has(slot))
                };
                [(a, slots.minus(zero(b))), (b, slots.minus(zero(a)))]
            }
            NodeKind::One { .. } | NodeKind::Two { .. } => {
                match meta.op {
                    Some(op) if !self.is_fixed(op) => walk.add(id, Freedom::Function(op), meta.site, off),
                    // Half-way cases that the implementation rounds in a direction of its own.
                    Some(op) if meta.site.is_some_and(Site::is_open_at_ties) => {
                        let tie = |slot: usize| self.argument_values(id, slot).iter().all(|x| (2.0 * x).fract() == 0.0);
                        walk.add(id, Freedom::Function(op), meta.site, off.and(Mask::where_(tie)));
                    }
                    Some(_) => {}
                    // What a definition allows beside its operations.
                    None => walk.add(id, Freedom::Inside, meta.site, off),
                }
                let mut takes = NOTHING;
                for (own, (to, (slope, bend))) in takes.iter_mut().zip(super::sweep::partials(&self.arena, id)) {
                    let moves = |slot: usize| slope[slot] != 0.0 || bend[slot] != 0.0 || local[slot] != 0.0;
                    *own = (to, slots.and(Mask::where_(moves)));
                }
                takes
            }
        }
    }

    /// What is free of a sum: products among its terms, and sums.
    fn look_at_terms(&self, (id, meta): (Id, &Meta), terms: [Id; 2], slots: Mask, exact: &[Mask], walk: &mut Walk) {
        let contracts = matches!(self.model, Model::Device { profile, .. } if profile.contraction);
        for (k, term) in terms.into_iter().enumerate() {
            for (inner, slots) in self.behind(term, slots) {
                let child = self.arena.nodes[inner as usize];
                let open = match child.kind {
                    NodeKind::Product { a, b } if contracts => {
                        let scaled = |slot: usize| [a, b].iter().any(|&x| self.is_power_of_two(x, slot, exact));
                        (Freedom::Contraction, slots.minus(exact[inner as usize]).minus(Mask::where_(scaled)))
                    }
                    NodeKind::Sum { a, b, .. } if self.model.is_rearranged() => {
                        let all = [a, b, terms[1 - k]];
                        (Freedom::Order, slots.and(Mask::where_(|slot| !self.are_whole(&all, slot, exact))))
                    }
                    _ => continue,
                };
                self.free((id, meta), &child, open, walk);
            }
        }
    }

    /// What is free of a product: products among its factors, and sums that it may be distributed over.
    fn look_at_factors(&self, (id, meta): (Id, &Meta), factors: [Id; 2], slots: Mask, exact: &[Mask], walk: &mut Walk) {
        if !self.model.is_rearranged() {
            return;
        }
        for (k, factor) in factors.into_iter().enumerate() {
            let scaled = Mask::where_(|slot| self.is_power_of_two(factors[1 - k], slot, exact));
            for (inner, slots) in self.behind(factor, slots.minus(scaled)) {
                let child = self.arena.nodes[inner as usize];
                let open = match child.kind {
                    NodeKind::Product { a, b } => {
                        let scaled = |slot: usize| [a, b].iter().any(|&x| self.is_power_of_two(x, slot, exact));
                        slots.minus(Mask::where_(scaled)).minus(exact[id as usize])
                    }
                    NodeKind::Sum { .. } => slots.minus(exact[id as usize]),
                    _ => continue,
                };
                self.free((id, meta), &child, (Freedom::Order, open), walk);
            }
        }
    }

    /// A freedom of two operations that belong together. Those of one expression are its own affair, which `precise` does not
    /// reach; others it keeps as they are written.
    fn free(&self, (id, meta): (Id, &Meta), child: &Meta, (freedom, slots): (Freedom, Mask), walk: &mut Walk) {
        let index = |meta: &Meta| meta.site.map(Site::index);
        if index(meta) == index(child) {
            walk.add(id, Freedom::Inside, meta.site, slots);
        } else if !meta.is_kept() && !child.is_kept() {
            walk.add(id, freedom, meta.site, slots);
        }
    }

    /// The operations that a node hands on, by slots: selections, signs and copies left out.
    fn behind(&self, id: Id, slots: Mask) -> Vec<(Id, Mask)> {
        let (mut open, mut found) = (vec![(id, slots)], Vec::new());
        while let Some((id, slots)) = open.pop() {
            if slots.is_empty() {
                continue;
            }
            match self.arena.nodes[id as usize].kind {
                NodeKind::Select { mask, a, b } => {
                    let mask = self.arena.masks[mask as usize];
                    open.extend([(a, slots.and(mask)), (b, slots.minus(mask))]);
                }
                NodeKind::Sum { a, signs: (_, 0.0), .. } => open.push((a, slots)),
                _ => found.push((id, slots)),
            }
        }
        found
    }

    /// True for an operation that gives every device the same bits for the same operands.
    fn is_fixed(&self, op: Op) -> bool {
        let Model::Device { profile, .. } = self.model else { return true };
        match profile.entry(op) {
            Entry::Promised(pieces) => {
                !pieces.is_empty() && pieces.iter().all(|piece| matches!(piece.rule, Rule::Exact | Rule::Rounded))
            }
            Entry::Measured(table) => table.rounds(),
        }
    }

    /// The slots in which each node of the last run has the real number exactly, on every device.
    pub fn exact(&self) -> ExactSlots {
        let mut all: Vec<Mask> = Vec::with_capacity(self.arena.nodes.len());
        for id in 0..self.arena.nodes.len() as Id {
            let at = id as usize;
            let (meta, value) = (self.arena.nodes[at], self.arena.value.get(at));
            let fits = || Mask::where_(|slot| f64::from(value[slot] as f32) == value[slot]);
            let of = |id: Id| all[id as usize];
            all.push(match meta.kind {
                NodeKind::Leaf => {
                    let radius = self.arena.radius.get(at);
                    fits().and(Mask::where_(|slot| radius[slot] == 0.0))
                }
                NodeKind::Sum { a, signs: (_, 0.0), .. } => of(a),
                NodeKind::Sum { a, b, signs } => {
                    let (x, y) = (self.arena.value.get(a as usize), self.arena.value.get(b as usize));
                    let lost = |slot: usize| lost_by_sum(signs.0 * x[slot], signs.1 * y[slot], value[slot]) == 0.0;
                    of(a).and(of(b)).and(fits()).and(Mask::where_(lost))
                }
                NodeKind::Product { a, b } => of(a).and(of(b)).and(fits()),
                NodeKind::Select { mask, a, b } => {
                    let mask = self.arena.masks[mask as usize];
                    of(a).and(mask).or(of(b).minus(mask))
                }
                NodeKind::One { a, .. } if meta.op.is_some_and(|op| self.is_fixed(op)) => of(a).and(fits()),
                NodeKind::Two { a, b, .. } if meta.op.is_some_and(|op| self.is_fixed(op)) => {
                    of(a).and(of(b)).and(fits())
                }
                NodeKind::One { .. } | NodeKind::Two { .. } => Mask::NONE,
            });
        }
        ExactSlots(all)
    }

    fn is_power_of_two(&self, id: Id, slot: usize, exact: &[Mask]) -> bool {
        const FRACTION: u64 = (1 << 52) - 1;
        let value = self.arena.value.get(id as usize)[slot];
        exact[id as usize].has(slot) && value.is_normal() && value.to_bits() & FRACTION == 0
    }

    /// True for whole numbers that have an exact sum in any order.
    fn are_whole(&self, terms: &[Id], slot: usize, exact: &[Mask]) -> bool {
        let value = |id: &Id| self.arena.value.get(*id as usize)[slot];
        let whole = |id: &Id| exact[*id as usize].has(slot) && value(id).fract() == 0.0;
        terms.iter().all(whole) && terms.iter().map(|id| value(id).abs()).sum::<f64>() <= WHOLE
    }

    /// In which slots each node, or a sum or product that is regrouped with it, is free.
    fn freed_within(&self, walk: &Walk, last: Id) -> Vec<Mask> {
        let mut all: Vec<Mask> = Vec::with_capacity(last as usize + 1);
        for id in 0..=last {
            let of = |id: Id| if self.arena.nodes[id as usize].is_regrouped() { all[id as usize] } else { Mask::NONE };
            let inside = match self.arena.nodes[id as usize].kind {
                NodeKind::Leaf | NodeKind::One { .. } | NodeKind::Two { .. } => Mask::NONE,
                NodeKind::Sum { a, signs: (_, 0.0), .. } => of(a),
                NodeKind::Sum { a, b, .. } | NodeKind::Product { a, b } => of(a).or(of(b)),
                NodeKind::Select { mask, a, b } => {
                    let mask = self.arena.masks[mask as usize];
                    of(a).and(mask).or(of(b).minus(mask))
                }
            };
            all.push(walk.own[id as usize].or(inside));
        }
        all
    }
}

/// A radius that is no number says nothing of the size of a value.
fn finite_or_zero(radius: f64) -> f64 {
    if radius.is_finite() { radius } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{THIRD, call, device};
    use super::super::{Model, Tape};
    use super::*;
    use program::interp::{FUEL, Machine, OutputColumn};

    /// The freedoms of a function of one case, and the spread in ULP of 1.
    fn freedoms(profile: &str, function: &str, arguments: &[f32]) -> (Vec<Freedom>, f64) {
        let (executable, batch) = call(function, arguments);
        let Model::Device { profile, stage, .. } = device(profile, false) else { panic!("a device") };
        let model = Model::Device { profile, stage, rearranged: profile.rearrangement };
        let mut machine = Machine::new(&executable, Tape::new(model).with_decisions(), FUEL);
        machine.run(&batch, 0);
        let OutputColumn::Real(&column) = machine.output(0, 0) else { panic!("a real number") };
        let one = Mask::first(1);
        let exact = machine.domain().exact();
        let (decisions, unknown) = machine.domain().open_decisions(one, &exact);
        let found = machine.domain().freedoms(column, one, &exact);
        let mut all: Vec<Freedom> = found.each.iter().chain(&decisions).map(|freed| freed.freedom).collect();
        all.sort();
        assert!(unknown.is_empty());
        (all, found.spread[0] / f64::from(f32::EPSILON))
    }

    #[test]
    fn one_rounding_is_the_same_everywhere() {
        for function in [
            "float f(float x, float y) { return x + y; }",
            "float f(float x, float y) { return max(x * y, 0.25); }",
            "float f(float x, float y) { return floor(x) - abs(y); }",
            // A product with a power of two is exact, whatever is added to it.
            "float f(float x, float y) { return 2.0 * x - y; }",
            "float f(float x, float y) { return x < 0.5 ? y : -y; }",
        ] {
            assert_eq!(freedoms("vulkan-1.4", function, &[THIRD, 0.7]), (Vec::new(), 0.0), "{function}");
        }
    }

    #[test]
    fn what_is_left_to_a_device_is_told_by_its_kind() {
        let of = |function: &str| freedoms("vulkan-1.4", function, &[THIRD, 0.7]).0;
        let f = |body: &str| of(&format!("float f(float x, float y) {{ return {body}; }}"));
        assert_eq!(f("x * y + 0.1"), [Freedom::Contraction]);
        assert_eq!(f("x + y + 0.1"), [Freedom::Order]);
        assert_eq!(f("x * y * 0.1"), [Freedom::Order]);
        assert_eq!(f("x * (y + 0.1)"), [Freedom::Order]);
        assert_eq!(f("x / y"), [Freedom::Function(Op::Div)]);
        assert_eq!(f("dot(vec2(x), vec2(y))"), [Freedom::Inside]);
        assert_eq!(f("x * 2e-38"), [Freedom::Subnormal]);
        assert_eq!(f("x * 3e38 * 30.0"), [Freedom::Order, Freedom::NotFinite]);
        assert_eq!(f("sin(x) < 0.3271946967961522 ? x : y"), [Freedom::Decision]);
    }

    #[test]
    fn precise_keeps_what_stands_apart_and_nothing_inside_of_a_function() {
        let of = |profile: &str, body: &str| {
            freedoms(
                profile,
                &format!("#extension GL_ARB_gpu_shader5 : enable\nfloat f(float x, float y) {{ {body} }}"),
                &[THIRD, 0.7],
            )
        };
        assert_eq!(of("vulkan-1.4", "precise float r = x * y + 0.1; return r;"), (Vec::new(), 0.0));
        assert_eq!(of("vulkan-1.4", "precise float r = x / y; return r;").0, [Freedom::Function(Op::Div)]);
        assert_eq!(of("vulkan-1.4", "precise float r = fma(x, y, 0.1); return r;").0, [Freedom::Inside]);
        // Strict binary32 leaves nothing open.
        assert_eq!(of("binary32", "return sqrt(x / y) + x * y;"), (Vec::new(), 0.0));
    }

    #[test]
    fn the_spread_is_that_of_what_is_free_alone() {
        let quotient = freedoms("vulkan-1.4", "float f(float x, float y) { return (x + y) / 3.0; }", &[1.0, 2.0]).1;
        // Twice 2.5 ULP of 1: the rounding of the sum is everyone's.
        assert!((5.0..5.01).contains(&quotient), "{quotient}");
    }
}
