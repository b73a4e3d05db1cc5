//! A glance at a chunk: values, how far they move when operations err, and no radii.
//!
//! For any choice of operations and signs |Σ ±∂y/∂v_k·b_k| is at most the bound of y, also with each b_k at its smallest:
//! that of exact arguments, since no rule of a profile promises less for arguments that may be off. One choice of signs serves
//! all nodes, and gives displacements that are added with their signs. Where two arguments share no operation that errs,
//! there is a choice for this node alone in which the two do not cancel: their sizes are added. What is left to know is
//! that the bound is finite. For that, one number a node stands for the radii of all slots: as large as the largest, by the
//! rules of [`Tape`](super::Tape), at the largest value of the chunk. Slots in which that is not enough (an argument near
//! the end of a domain, a jump within reach, a number too large) are lost, and left to a tape.
//!
//! Values are those of a tape, bit for bit.

mod domain;
mod functions;
mod sums;
#[cfg(test)]
mod tests;

use super::arena::{Id, MOST, Pool, Slots, ZEROS};
use super::held::HeldNodes;
use super::model::Model;
use super::tangent::ROUNDING;
use super::{Column, Literal};
use crate::profile::Op;
use program::interp::{Mask, SLOTS, Words};

/// The domain.
pub struct Glance<'p> {
    model: Model<'p>,
    literals: &'p [Option<Literal>],
    /// Part of a gap that one rounding is at most.
    part: f64,
    value: Pool,
    /// Displacements, by one choice of signs; those of nodes that do not move are zeros.
    moved: Pool,
    /// The largest size that is known of a displacement, by any choice; at least that of the one above.
    farthest: Pool,
    /// Operations that err on the way to each node.
    sources: Vec<Sources>,
    /// Operations of the chunk that err.
    erring: usize,
    /// Chunks so far.
    chunk: u64,
    /// Radii of nodes whose slots have very different ones; zeros stand for that of the node.
    radii: Pool,
    nodes: Vec<Node>,
    held: HeldNodes,
    /// Slots of which nothing is known.
    lost: Mask,
    /// Whether a loop has more rounds than a glance takes, or an operation is one that it does not know.
    given_up: bool,
}

/// What is known of a node in all slots that are not lost.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// At least the size of its values.
    most: f64,
    /// At least how far a device may be from them.
    radius: f64,
    /// No rounding makes the value negative.
    not_negative: bool,
    /// Slots in which nothing is promised for an operation on the way to it; the two numbers above say nothing of these.
    open: Mask,
    /// The number that it holds in all slots, where it is a constant.
    constant: Option<f64>,
    /// The chunk that it was made in.
    chunk: u64,
}

impl Node {
    /// A node of which the sizes are not known yet.
    fn new(not_negative: bool, open: Mask) -> Self {
        Self { most: 0.0, radius: 0.0, not_negative, open, constant: None, chunk: 0 }
    }
}

impl<'p> Glance<'p> {
    /// A glance for devices that follow a model, with something in the place of literals. `None` for a model that regroups, or
    /// that does not round sums and products once.
    pub fn new(model: Model<'p>, literals: &'p [Option<Literal>]) -> Option<Self> {
        if model.is_rearranged() {
            return None;
        }
        let closings = [Op::Add, Op::Sub, Op::Mul].map(|op| model.closing(op, [false; 2], false));
        let part = closings.into_iter().try_fold(1.0_f64, |part, closing| Some(part.min(closing?.part)))?;
        Some(Self {
            model,
            literals,
            part,
            value: Pool::default(),
            moved: Pool::default(),
            farthest: Pool::default(),
            sources: Vec::new(),
            erring: 0,
            chunk: 0,
            radii: Pool::default(),
            nodes: Vec::new(),
            held: HeldNodes::default(),
            lost: Mask::NONE,
            given_up: false,
        })
    }

    /// The exact values of a column.
    pub fn values(&self, column: Column) -> &Slots {
        self.value.get(self.id(&column) as usize)
    }

    /// At most the bound of an output in each slot; NaN in slots of which that is not known.
    pub fn allowance(&self, output: Column) -> Slots {
        let id = self.id(&output) as usize;
        let farthest = self.farthest.get(id);
        let mut out = [0.0; SLOTS];
        number::wide(|| (0..SLOTS).for_each(|slot| out[slot] = farthest[slot] * (1.0 - ROUNDING)));
        self.nodes[id].open.or(self.lost).each(|slot| out[slot] = f64::NAN);
        out
    }

    /// Slots in which nothing bounds an output because nothing is promised for an operation on the way to it, at its exact
    /// arguments.
    pub fn unpromised(&self, output: Column) -> Mask {
        let id = self.id(&output) as usize;
        let open = self.nodes[id].open.minus(self.lost);
        if open.is_empty() {
            return open;
        }
        let value = self.value.get(id);
        open.and(Mask::where_(|slot| value[slot].is_finite()))
    }

    /// True when a loop was left before its end, or an operation was left out: nothing is known of this chunk.
    pub fn has_given_up(&self) -> bool {
        self.given_up
    }

    /// The node in a register. One of a chunk before is none any more, but for constants: in the slots where the register is
    /// read it was written since.
    fn id(&self, column: &Column) -> Id {
        let fresh = self.nodes.get(column.0 as usize).is_some_and(|of| of.chunk == self.chunk || of.constant.is_some());
        if fresh { column.0 } else { 0 }
    }

    /// A node whose columns hold what is left from before.
    fn node(&mut self, node: Node) -> Id {
        let id = self.held.reuse().unwrap_or(self.nodes.len() as Id);
        let at = id as usize;
        if at == self.nodes.len() {
            self.nodes.push(node);
            self.value.reach(at);
            self.moved.reach(at);
            self.farthest.reach(at);
            self.sources.push(Sources::default());
            self.radii.reach(at);
        }
        self.radii.set_zero(at);
        self.nodes[at] = Node { chunk: self.chunk, ..node };
        self.held.make(id);
        id
    }

    /// A node that does not move and has no radius, and whether it holds numbers alone.
    fn leaf(&mut self, value: impl FnOnce(&mut Slots)) -> (Id, bool) {
        let id = self.node(Node::new(false, Mask::NONE));
        let at = id as usize;
        self.value.renew(at);
        self.hold_still(id);
        let values = self.value.get_mut(at);
        value(values);
        let (most, negative, special) = number::wide(|| {
            let (mut negative, mut special) = (0_u64, 0_u64);
            for v in values.iter() {
                negative |= u64::from(!(*v >= 0.0));
                special |= u64::from(!(v.abs() < f64::INFINITY));
            }
            let size = |slot: usize| if values[slot].abs() < f64::INFINITY { values[slot].abs() } else { 0.0 };
            (largest(size), negative != 0, special != 0)
        });
        (self.nodes[at].most, self.nodes[at].not_negative) = (most, !negative);
        (id, !special)
    }

    /// The same for words of binary32, which are compared as whole numbers: there are more inputs than operations in some
    /// programs.
    fn leaf_of_words(&mut self, words: &Words) -> Id {
        const SIGN: u32 = 1 << 31;
        let (most, negative) = number::wide(|| {
            let (mut most, mut negative) = (0, 0);
            for &word in words {
                most = most.max(word & !SIGN);
                // Beyond −0.
                negative |= u32::from(word > SIGN);
            }
            (f32::from_bits(most), negative)
        });
        if !most.is_finite() {
            return self.leaf_of_numbers(|value| number::map(words, value, |word| f64::from(f32::from_bits(word))));
        }
        let id = self.node(Node { most: f64::from(most), ..Node::new(negative == 0, Mask::NONE) });
        self.value.renew(id as usize);
        self.hold_still(id);
        number::map(words, self.value.get_mut(id as usize), |word| f64::from(f32::from_bits(word)));
        id
    }

    /// The same for a column from outside, of which slots without a number are lost.
    fn leaf_of_numbers(&mut self, value: impl FnOnce(&mut Slots)) -> Id {
        let (id, numbers) = self.leaf(value);
        if !numbers {
            let values = self.value.get(id as usize);
            self.lost = self.lost.or(Mask::where_(|slot| !values[slot].is_finite()));
        }
        id
    }

    /// Puts the result of an operation into a register.
    fn hold(&mut self, out: &mut Column, id: Id) {
        self.held.swap(out.0, id);
        out.0 = id;
    }

    /// `a` in the slots of a mask, `b` in the others.
    fn select(&mut self, mask: &Mask, a: Id, b: Id) -> Id {
        if a == b {
            return a;
        }
        let (left, right) = (self.nodes[a as usize], self.nodes[b as usize]);
        let id = self.node(Node {
            most: left.most.max(right.most),
            radius: left.radius.max(right.radius),
            ..Node::new(left.not_negative && right.not_negative, left.open.and(*mask).or(right.open.minus(*mask)))
        });
        self.sources[id as usize] = self.sources[a as usize].or(&self.sources[b as usize]);
        for pool in [&mut self.value, &mut self.moved, &mut self.farthest] {
            if pool.is_zero(a as usize) && pool.is_zero(b as usize) {
                pool.set_zero(id as usize);
                continue;
            }
            let (before, to) = pool.split(id as usize);
            *to = *before.get(b as usize);
            mask.merge(before.get(a as usize), to);
        }
        if self.spreads(a) || self.spreads(b) {
            let [of_a, mut radii] = [a, b].map(|id| self.radii_of(id));
            mask.merge(&of_a, &mut radii);
            *self.radii.get_mut(id as usize) = radii;
        }
        id
    }

    /// Whether the slots of a node have radii of their own.
    fn spreads(&self, id: Id) -> bool {
        !self.radii.is_zero(id as usize)
    }

    /// The radii of a node.
    fn radii_of(&self, id: Id) -> Slots {
        if self.spreads(id) { *self.radii.get(id as usize) } else { [self.nodes[id as usize].radius; SLOTS] }
    }

    /// A node that does not move.
    fn hold_still(&mut self, id: Id) {
        self.moved.set_zero(id as usize);
        self.farthest.set_zero(id as usize);
        self.sources[id as usize] = Sources::default();
    }

    /// The sources of a new node, with its own error where it has one; and whether those of its arguments are apart.
    fn gather_sources(&mut self, id: Id, args: [Id; 2], errs: bool) -> bool {
        let (mut sources, mut apart) = (Sources::default(), true);
        match args.map(|id| self.moves(id)) {
            [true, true] => {
                let [a, b] = args.map(|id| &self.sources[id as usize]);
                apart = !a.meets(b);
                sources = a.or(b);
            }
            [true, false] => sources = self.sources[args[0] as usize],
            [false, true] => sources = self.sources[args[1] as usize],
            [false, false] => {}
        }
        if errs {
            sources.insert(self.erring);
            self.erring += 1;
        }
        self.sources[id as usize] = sources;
        apart
    }

    /// Whether a node moves.
    fn moves(&self, id: Id) -> bool {
        !self.moved.is_zero(id as usize)
    }
}

/// A set of operations, by their numbers in the chunk. Those of a long program share bits: two sets may seem to meet that do
/// not, and never the other way round.
#[derive(Clone, Copy, Default)]
struct Sources([u64; 16]);

impl Sources {
    fn insert(&mut self, number: usize) {
        let bit = number % (64 * self.0.len());
        self.0[bit / 64] |= 1 << (bit % 64);
    }

    fn or(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] | other.0[k]))
    }

    fn meets(&self, other: &Self) -> bool {
        self.0.iter().zip(&other.0).fold(0, |both, (a, b)| both | a & b) != 0
    }
}

/// The largest of some numbers that are not negative; what is no number is left out. In parts, so that they are compared side
/// by side.
#[inline(always)]
fn largest(of: impl Fn(usize) -> f64) -> f64 {
    const PARTS: usize = 16;
    let mut most = [0.0_f64; PARTS];
    for base in (0..SLOTS).step_by(PARTS) {
        for (part, most) in most.iter_mut().enumerate() {
            let one = of(base + part);
            *most = if one > *most { one } else { *most };
        }
    }
    most.into_iter().fold(0.0, f64::max)
}
