//! The tape: a domain of numbers that remembers how every value came about, and from that how far a
//! conforming device may be off at each output.
//!
//! Every operation becomes a node with its exact value, what the operation itself may add to the error
//! (by a [`Model`]), and its derivatives. The bound of an output y is Σ |∂y/∂v_k|·b_k over the nodes k,
//! by one reverse sweep. To hold beyond the first order, derivatives are not taken at the exact values
//! alone: a forward pass keeps for each node a radius, within which a device's value lies, and each
//! derivative is accompanied by how far it moves within these radii. By the mean value theorem the sum
//! with the derivatives at their largest is a bound.
//!
//! Where there is no derivative (the root at 0, a jump of `floor`) the whole movement of the value
//! within its radius counts as an error of that operation, and nothing before it counts.

mod arena;
mod brackets;
mod columns;
mod decay;
mod decision;
mod definitions;
mod folded;
mod freedom;
mod functions;
mod glance;
mod held;
mod inherited;
#[cfg(test)]
mod inside;
mod integral;
mod kernels;
pub mod lowered;
mod memory;
mod model;
mod operations;
mod paths;
mod regroup;
mod rounded;
mod sweep;
mod tangent;
#[cfg(test)]
mod tests;
mod why;

use crate::profile::{Op, grid};
use base::value::Scalar;
use program::interp::{
    Binary, Class, Comparison, Domain, FromWords, Guarded, Mask, Number, SLOTS, Site, ToWords, Unary, WordSource, Words,
};

use arena::{Arena, Id, MOST, Meta, NodeKind, Slots};
pub use decay::FADED;
pub use folded::Fold;
pub use freedom::{ExactSlots, Freed, Freedom, Freedoms};
pub use glance::Glance;
pub use memory::Cell;
pub use model::Model;
pub(crate) use model::gap;
pub use paths::Path;
pub use sweep::Bounds;
pub use why::{Cause, Feeds, Share, Why};

/// A value on the tape. The default marks a place and is no value.
#[derive(Clone, Copy, Debug, Default)]
pub struct Column(Id);

/// What stands in the place of a literal of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Literal {
    /// The real number that the author wrote.
    pub value: f64,
    /// How far that may be from what was meant, by rounding alone; 0 when it is written exactly.
    pub slack: f64,
}

/// The domain.
pub struct Tape<'p> {
    model: Model<'p>,
    literals: &'p [Option<Literal>],
    /// Whether `precise` keeps nothing as it is written.
    loses_precise: bool,
    arena: Arena,
    /// Slots in which a decision could have gone the other way, with the first place where.
    forks: [Option<Site>; SLOTS],
    /// Slots in which that decision is the one between two texels.
    edges: [bool; SLOTS],
    /// Slots that were given up in a loop, for the tape was full, with the place of the loop.
    given_up: [Option<Site>; SLOTS],
    /// Slots in which a function with steps may come out on either side of one.
    stepping: Mask,
    /// The sides that decisions take, where they are followed.
    paths: Option<paths::Paths>,
    /// A pair of operations that is left out, where one is.
    folding: Option<folded::Folding>,
    /// For each node, whether it holds whole numbers that the program made.
    whole: Vec<bool>,
    sweep: sweep::Scratch,
    /// Displacements, where they are wanted.
    tangents: Option<tangent::Tangents>,
    /// Binary32 numbers between which values lie, where they are wanted and known.
    brackets: Option<brackets::Brackets>,
    /// Decisions that may fall either way, where somebody asks what they compare.
    decisions: Option<Vec<freedom::OpenDecision>>,
}

impl<'p> Tape<'p> {
    /// A tape for devices that follow a model.
    pub fn new(model: Model<'p>) -> Self {
        Self {
            model,
            literals: &[],
            loses_precise: false,
            arena: Arena::default(),
            forks: [None; SLOTS],
            edges: [false; SLOTS],
            given_up: [None; SLOTS],
            stepping: Mask::NONE,
            paths: None,
            folding: None,
            whole: Vec::new(),
            sweep: sweep::Scratch::default(),
            tangents: None,
            brackets: None,
            decisions: None,
        }
    }

    /// A tape on which `precise` keeps nothing as it is written: what a device may do to which nobody told it.
    #[must_use]
    pub fn without_precise(mut self) -> Self {
        self.loses_precise = true;
        self
    }

    /// A tape on which literals have the values that their author wrote: by the number of their site,
    /// where that is another number than the module's binary32.
    #[must_use]
    pub fn with_literals(mut self, literals: &'p [Option<Literal>]) -> Self {
        self.literals = literals;
        self
    }

    /// What operations are promised to be off by, for the profile and stage of this tape.
    pub fn model(&self) -> &Model<'p> {
        &self.model
    }

    /// The exact values of a column.
    pub fn values(&self, column: Column) -> &[f64; SLOTS] {
        self.arena.value.get(column.0 as usize)
    }

    /// Where a decision in this slot could have gone the other way on a conforming device: a
    /// comparison of numbers that are nearer to each other than their errors.
    pub fn fork(&self, slot: usize) -> Option<Site> {
        self.forks[slot]
    }

    /// True when that decision is the one between two texels.
    pub fn is_texel_edge(&self, slot: usize) -> bool {
        self.edges[slot]
    }

    /// The loop in which this slot was given up: it has more rounds than there is room for on a tape. Nothing is known of
    /// the values of such a slot, and every bound is infinite.
    pub fn given_up(&self, slot: usize) -> Option<Site> {
        self.given_up[slot]
    }

    /// True when some slot was given up.
    pub fn has_given_up(&self) -> bool {
        self.given_up.iter().any(Option::is_some)
    }

    /// Gives back the room that very long loops took.
    pub fn release(&mut self) {
        self.arena.clear();
        self.sweep.release();
    }

    fn leaf(&mut self, value: impl FnOnce(&mut Slots)) -> Id {
        let meta = Meta { kind: NodeKind::Leaf, op: None, site: None, exact: true, tiny: false, not_negative: false };
        let id = self.node(meta);
        let at = id as usize;
        value(self.arena.value.get_mut(at));
        let values = self.arena.value.get(at);
        let (tiny, negative) = number::wide(|| {
            let (mut tiny, mut negative) = (0_u64, 0_u64);
            for v in values {
                tiny |= u64::from((v.abs() < grid::MIN_NORMAL) & (*v != 0.0));
                negative |= u64::from(!(*v >= 0.0));
            }
            (tiny, negative)
        });
        let meta = &mut self.arena.nodes[at];
        (meta.tiny, meta.not_negative) = (tiny != 0, negative == 0);
        self.settle(id);
        id
    }

    /// A register may still hold a value of the chunk before; in the slots where it is read it was
    /// written since, so any value will do.
    fn id(&self, column: &Column) -> Id {
        if (column.0 as usize) < self.arena.nodes.len() { column.0 } else { 0 }
    }

    /// What else is remembered of a node, once its value, radius and local error are known.
    fn settle(&mut self, id: Id) {
        self.keep_whole(id);
        self.lower(id);
        self.group(id);
        self.move_on(id);
        self.bracket(id);
    }

    /// True when some slot of a column may be subnormal, and a device may take it for zero.
    fn flushed(&self, at: usize) -> bool {
        self.arena.nodes[at].tiny && self.model.flushes()
    }

    fn note_fork(&mut self, site: Site, slots: impl Iterator<Item = usize>) {
        for slot in slots {
            self.forks[slot].get_or_insert(site);
        }
    }
}

impl Domain for Tape<'_> {
    type Column = Column;
    type Word = f64;

    fn begin(&mut self) {
        match &mut self.tangents {
            None => self.arena.clear(),
            Some(tangents) => tangents.begin(),
        }
        self.forks = [None; SLOTS];
        self.edges = [false; SLOTS];
        self.given_up = [None; SLOTS];
        self.stepping = Mask::NONE;
        if let Some(paths) = &mut self.paths {
            paths.begin();
        }
        if let Some(folding) = &mut self.folding {
            folding.begin();
        }
        if let Some(decisions) = &mut self.decisions {
            decisions.clear();
        }
        // Node 0 holds zeros: what a column holds that nobody wrote.
        if self.arena.nodes.is_empty() {
            self.leaf(|value| value.fill(0.0));
        }
    }

    fn column(&mut self) -> Column {
        Column(0)
    }

    fn constant(&mut self, site: Option<Site>, value: f32, out: &mut Column) {
        let literal = site.and_then(|site| self.literals.get(site.index()).copied().flatten());
        let literal = literal.unwrap_or(Literal { value: f64::from(value), slack: 0.0 });
        let id = self.leaf(|v| v.fill(literal.value));
        let at = id as usize;
        self.arena.nodes[at].site = site;
        if literal.slack == 0.0 && literal.value.fract() == 0.0 {
            self.note_whole(id);
        }
        if literal.slack > 0.0 {
            self.arena.nodes[at].exact = false;
            self.arena.local.get_mut(at).fill(literal.slack);
            self.arena.radius.get_mut(at).fill(literal.slack);
            self.bracket(id);
        }
        self.hold(out, id);
    }

    fn input(&mut self, _: WordSource, words: &Words, out: &mut Column) {
        let id = self.leaf(|value| {
            for (v, &word) in value.iter_mut().zip(words) {
                *v = f64::from(f32::from_bits(word));
            }
        });
        self.open_special(None, words, id);
        self.hold(out, id);
    }

    fn unary(&mut self, site: Site, op: Unary, active: &Mask, a: &Column, out: &mut Column) {
        let a = self.id(a);
        let id = self.apply1(site, op, active, a);
        self.hold(out, id);
    }

    fn binary(&mut self, site: Site, op: Binary, active: &Mask, a: &Column, b: &Column, out: &mut Column) {
        let (a, b) = (self.id(a), self.id(b));
        let id = self.apply2(site, Op::of_binary(op), active, a, b);
        self.hold(out, id);
    }

    fn scale(&mut self, site: Site, a: &Column, exponent: &Words, out: &mut Column) {
        let a = self.id(a);
        // ldexp is the product with a power of two, rounded once.
        let factor = self.leaf(|value| {
            for (v, &word) in value.iter_mut().zip(exponent) {
                *v = 2f64.powi(word.cast_signed().clamp(-1000, 1000));
            }
        });
        let id = self.product(site, Op::Ldexp, a, factor);
        self.hold(out, id);
    }

    fn compare(&mut self, site: Site, op: Comparison, active: &Mask, a: &Column, b: &Column, out: &mut Words) {
        let (a, b) = (self.id(a) as usize, self.id(b) as usize);
        let (x, y) = (self.arena.value.get(a), self.arena.value.get(b));
        let (ex, ey) = (self.arena.radius.get(a), self.arena.radius.get(b));
        let flushes = self.flushed(a) || self.flushed(b);
        // Literals are compared as numbers of the precision of the comparison.
        let reach = |x: f64, e: f64| e + lowered::slack(site.grade(), x.abs() - e, x.abs() + e);
        let device = matches!(self.model, Model::Device { .. });
        let open = |slot: usize| {
            let (ex, ey) = match device {
                true => (reach(x[slot], ex[slot]), reach(y[slot], ey[slot])),
                false => (ex[slot], ey[slot]),
            };
            let (x, y) = ((x[slot], ex), (y[slot], ey));
            (a != b && decision::is_near(x, y)) || (flushes && decision::flush_decides(op, x, y))
        };
        let forks: Vec<usize> = active.slots().filter(|&slot| open(slot)).collect();
        program::interp::compare(op, x, y, out);
        self.note_decision(site, [a as Id, b as Id], &forks);
        self.decide(site, &forks, &mut |slot| out[slot] ^= 1);
    }

    fn classify(&mut self, site: Site, class: Class, active: &Mask, a: &Column, out: &mut Words) {
        let a = self.id(a) as usize;
        let (x, e) = (self.arena.value.get(a), self.arena.radius.get(a));
        program::interp::classify(class, x, out);
        let forks: Vec<usize> = active.slots().filter(|&slot| !e[slot].is_finite()).collect();
        self.note_decision(site, [a as Id; 2], &forks);
        self.note_fork(site, forks.into_iter());
    }

    fn words_of(&mut self, site: Site, op: ToWords, active: &Mask, a: &Column, out: &mut Words) -> Mask {
        let a = self.id(a) as usize;
        let (x, e) = (self.arena.value.get(a), self.arena.radius.get(a));
        let outside = program::interp::to_words(op, x, out);
        let (mut low, mut high) = ([0; SLOTS], [0; SLOTS]);
        let texel = matches!(op, ToWords::Texel { .. });
        let (relative, absolute) = if texel { self.model.texel_slack() } else { (0.0, 0.0) };
        let flushes = self.flushed(a);
        let reach = |slot: usize| kernels::reach(x[slot], e[slot], flushes) + relative * x[slot].abs() + absolute;
        // In real numbers the bits of an input are those that were given, the sign of a zero among them. The sign of a
        // computed zero is promised by nobody.
        let given = matches!(self.model, Model::Binary64) && matches!(self.arena.nodes[a].kind, NodeKind::Leaf);
        let end = |slot: usize, sign: f64| if given { x[slot] } else { x[slot] + sign * reach(slot) };
        let ends = |sign: f64| -> Slots { std::array::from_fn(|slot| end(slot, sign)) };
        let (least, most) = (ends(-1.0), ends(1.0));
        program::interp::to_words(op, &least, &mut low);
        program::interp::to_words(op, &most, &mut high);
        if op == ToWords::HalfBits && self.model.rounds_halves_either_way() {
            rounded::half_outward(&least, &mut low, -1.0);
            rounded::half_outward(&most, &mut high, 1.0);
        }
        // Nobody promises the sign of a zero that is computed.
        let sign = paths::sign_of(op);
        if sign != 0 && !matches!(self.arena.nodes[a].kind, NodeKind::Leaf) {
            for slot in active.slots().filter(|&slot| x[slot] == 0.0 && e[slot] == 0.0) {
                (low[slot], high[slot]) = (0, sign);
            }
        }
        // A device turns coordinates into fixed point numbers of 32 bits, 8 of them within a texel.
        let far = |x: f64| !x.is_finite() || (absolute > 0.0 && x.abs() >= 8_388_608.0);
        let subnormal = |slot: usize| {
            op == ToWords::HalfBits && rounded::may_flush(&self.model, x[slot], reach(slot), low[slot] | high[slot])
        };
        let lost = |slot: usize| !e[slot].is_finite() || subnormal(slot) || (texel && far(x[slot]));
        // Between the exponents on both sides of zero lie all others, and that of zero itself.
        let around = |slot: usize| op == ToWords::FrexpExponent && e[slot] > 0.0 && x[slot].abs() <= e[slot];
        let lost: Vec<bool> = (0..SLOTS).map(|slot| lost(slot) || around(slot)).collect();
        for slot in active.slots().filter(|&slot| low[slot] != high[slot] || lost[slot]) {
            let ends = [low[slot], high[slot]];
            let word = if lost[slot] { None } else { self.word_on_path(op, slot, out[slot], ends) };
            if let Some(word) = word {
                out[slot] = word;
                continue;
            }
            self.edges[slot] |= texel && self.forks[slot].is_none();
            self.note_decision(site, [a as Id; 2], &[slot]);
            self.note_fork(site, [slot].into_iter());
        }
        self.note_words(site, op, a as Id, out);
        outside
    }

    fn reals_of(&mut self, site: Site, op: FromWords, a: &Words, out: &mut Column) {
        let id = self.leaf(|value| program::interp::from_words(op, a, value));
        let at = id as usize;
        if matches!(op, FromWords::Signed | FromWords::Unsigned) {
            let args = [model::Arg { value: self.arena.value.get(at), radius: self.arena.radius.get(at) }];
            let mut local = [0.0; SLOTS];
            self.model.local(Op::Convert, &args, args[0].value, &[0.0; SLOTS], &mut local);
            // Integers of up to 24 bits are kept whatever the rounding, and all of them in binary64.
            let all = matches!(self.model, Model::Binary64);
            for (b, v) in local.iter_mut().zip(args[0].value) {
                *b = if all || f64::from(*v as f32) == *v { 0.0 } else { *b };
            }
            let exact = local.iter().all(|b| *b == 0.0);
            *self.arena.radius.get_mut(at) = local;
            *self.arena.local.get_mut(at) = local;
            let meta = &mut self.arena.nodes[at];
            (meta.exact, meta.op, meta.site) = (exact, Some(Op::Convert), Some(site));
            self.note_whole(id);
            self.lower(id);
            self.bracket(id);
        }
        if op == FromWords::HalfBits && matches!(self.model, Model::Device { .. }) {
            self.halves(site, id);
        }
        if op == FromWords::Bits {
            self.flush_bits(site, id);
            self.open_special(Some(site), a, id);
        }
        let id = self.unrounded(site, op, a, id);
        self.hold(out, id);
    }

    fn doubt(&mut self, site: Site, slots: &Mask) {
        self.note_fork(site, slots.slots());
    }

    fn shown(&self, column: &Column, slot: usize) -> f64 {
        self.values(Column(self.id(column)))[slot]
    }

    fn outside(&self, what: Guarded, active: &Mask, x: &Column, y: &Column) -> Mask {
        // Who wants no displacements looks at bounds alone, but on a path that no other machine goes.
        if self.tangents.is_none() && self.paths.is_none() {
            return Mask::NONE;
        }
        program::interp::outside(what, active, self.values(Column(self.id(x))), self.values(Column(self.id(y))))
    }

    fn is_full(&self) -> bool {
        self.tangents.as_ref().map_or_else(|| self.arena.is_full(MOST), tangent::Tangents::is_full)
    }

    fn give_up(&mut self, site: Site, slots: &Mask) {
        self.note_fork(site, slots.slots());
        slots.slots().for_each(|slot| self.given_up[slot] = Some(site));
    }

    fn copy(&mut self, from: &Column, to: &mut Column) {
        let id = self.id(from);
        self.hold(to, id);
    }

    fn merge(&mut self, mask: &Mask, from: &Column, to: &mut Column) {
        let (a, b) = (self.id(from), self.id(to));
        let id = self.select(mask, a, b);
        self.hold(to, id);
    }

    fn poison(&mut self, mask: &Mask, to: &mut Column) {
        let mark = self.leaf(|value| value.fill(f64::poison()));
        let id = if mask.is_full() { mark } else { self.select(mask, mark, self.id(to)) };
        self.hold(to, id);
    }

    fn word(&self, column: &Column, slot: usize) -> Option<f64> {
        let value = self.values(*column)[slot];
        (!value.is_poison()).then_some(value)
    }

    fn exact(word: u32, scalar: Scalar) -> f64 {
        <f64 as Number>::exact(word, scalar)
    }
}
