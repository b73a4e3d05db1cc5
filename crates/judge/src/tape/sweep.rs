//! The reverse sweep: how much each node's error is worth at an output.

use super::arena::{Arena, Id, NodeKind, Slots};
use super::{Column, Tape};

use program::interp::SLOTS;

const NONE: u32 = u32::MAX;

/// Derivatives of the output by a node: at the exact values, and how far they move from there.
struct Adjoint(Slots, Slots);

impl Default for Adjoint {
    fn default() -> Self {
        Self([0.0; SLOTS], [0.0; SLOTS])
    }
}

/// Room for sweeps, used again and again.
#[derive(Default)]
pub(super) struct Scratch {
    /// For each node, the number of its adjoint.
    places: Vec<u32>,
    #[expect(clippy::vec_box, reason = "one adjoint goes out of its place while others are written")]
    adjoints: Vec<Box<Adjoint>>,
    free: Vec<u32>,
    spare: Option<Box<Adjoint>>,
    /// What one node adds to a bound or to an adjoint, where somebody looks at it.
    part: Box<Adjoint>,
}

impl Scratch {
    fn begin(&mut self, nodes: usize) {
        self.places.clear();
        self.places.resize(nodes, NONE);
        self.free.clear();
        self.free.extend(0..self.adjoints.len() as u32);
    }

    /// Gives back what very many nodes took.
    pub(super) fn release(&mut self) {
        self.places = Vec::new();
        self.adjoints.truncate(1 << 10);
        self.free = Vec::new();
    }

    fn take(&mut self, node: Id) -> Option<u32> {
        let place = std::mem::replace(&mut self.places[node as usize], NONE);
        (place != NONE).then_some(place)
    }

    /// The adjoint of a node. True when it is new: what it holds is left from before.
    fn of(&mut self, node: Id) -> (&mut Adjoint, bool) {
        let place = &mut self.places[node as usize];
        let new = *place == NONE;
        if new {
            *place = self.free.pop().unwrap_or_else(|| {
                self.adjoints.push(Box::default());
                (self.adjoints.len() - 1) as u32
            });
        }
        (&mut self.adjoints[*place as usize], new)
    }
}

/// What a sweep found.
#[derive(Clone, Debug)]
pub struct Bounds {
    /// How far a conforming device may be from the exact value, for each slot. A sweep that was ended
    /// early gives less. Infinite where nothing can be said.
    pub bound: Box<[f64; SLOTS]>,
}

/// Nodes between two looks at whether the sweep may end.
const STRIDE: u32 = 8;

impl Tape<'_> {
    /// Bounds for one output in all slots. The sweep may end once `enough` says so of the bounds that
    /// it has: they only grow.
    pub fn bounds(&mut self, output: Column, enough: &mut dyn FnMut(&[f64; SLOTS]) -> bool) -> Bounds {
        self.bounds_with(output, enough, &mut |_, _| {})
    }

    /// The same; `see` gets each node's part of the bound, node after node.
    pub(super) fn bounds_with(
        &mut self,
        output: Column,
        enough: &mut dyn FnMut(&[f64; SLOTS]) -> bool,
        see: &mut dyn FnMut(Id, &Slots),
    ) -> Bounds {
        let root = self.id(&output);
        let rearranged = self.model.is_rearranged();
        let Self { arena, sweep, .. } = self;
        let reach = *arena.radius.get(root as usize);
        let mut bounds = Bounds { bound: Box::new([0.0; SLOTS]) };
        sweep.begin(root as usize + 1);
        *sweep.of(root).0 = Adjoint([1.0; SLOTS], [0.0; SLOTS]);
        for id in (0..=root).rev() {
            let Some(place) = sweep.take(id) else { continue };
            // The box goes out of its place for as long as others are written.
            let adjoint =
                std::mem::replace(&mut sweep.adjoints[place as usize], sweep.spare.take().unwrap_or_default());
            let meta = arena.nodes[id as usize];
            // Regrouped sums and products err as a whole, where something else takes their value.
            let counts = !meta.exact && (!rearranged || id == root || !meta.is_regrouped());
            if counts {
                let share = &mut sweep.part.0;
                add(arena.local.get(id as usize), (&adjoint, &reach), &mut bounds.bound, share);
                see(id, share);
            }
            if rearranged && !meta.is_regrouped() {
                // Each polynomial argument errs as a whole, as far as this node hands it on.
                regrouped(arena, sweep, id, &adjoint, &mut |a, worth, share| {
                    add(arena.local.get(a as usize), (worth, &reach), &mut bounds.bound, share);
                    see(a, share);
                });
            }
            propagate(arena, sweep, id, &adjoint);
            sweep.spare = Some(std::mem::replace(&mut sweep.adjoints[place as usize], adjoint));
            sweep.free.push(place);
            if id % STRIDE == 0 && enough(&bounds.bound) {
                break;
            }
        }
        for (bound, given_up) in bounds.bound.iter_mut().zip(&self.given_up) {
            if given_up.is_some() {
                *bound = f64::INFINITY;
            }
        }
        bounds
    }
}

/// Adds a node's own error, times what it is worth. `share` becomes what was added. `reach` is the radius of the output.
fn add(local: &Slots, worth: (&Adjoint, &Slots), bound: &mut Slots, share: &mut Slots) {
    let finite = number::wide(|| add_finite(local, worth, bound, share));
    if !finite {
        for (bound, share) in bound.iter_mut().zip(share) {
            // Infinite or NaN.
            if !(*share < f64::INFINITY) {
                *bound = f64::INFINITY;
            }
        }
    }
}

/// The loop of [`add`]. True when every share is finite.
#[inline(always)]
fn add_finite(local: &Slots, (Adjoint(m, r), reach): (&Adjoint, &Slots), bound: &mut Slots, share: &mut Slots) -> bool {
    let mut lost = 0_u64;
    for slot in 0..SLOTS {
        let worth = m[slot].abs() + r[slot];
        // What does not reach the output is not looked at, whatever it is. What reaches it on two ways whose derivatives
        // cancel does not cancel where it is infinite, and the radius knows.
        let part = worth * local[slot];
        let endless = local[slot] == f64::INFINITY && reach[slot] == f64::INFINITY;
        let still = if endless { f64::INFINITY } else { 0.0 };
        let part = if worth == 0.0 || local[slot] == 0.0 { still } else { part };
        share[slot] = part;
        bound[slot] += part;
        lost |= u64::from(!(part < f64::INFINITY));
    }
    lost == 0
}

/// What an argument gets from a node: the node's adjoint times the partial.
#[inline(always)]
fn handed(m: f64, r: f64, slope: f64, bend: f64) -> (f64, f64) {
    let reaches = m != 0.0 || r != 0.0;
    let (more, moved) = (m * slope, m.abs() * bend + r * (slope.abs() + bend));
    if reaches { (more, moved) } else { (0.0, 0.0) }
}

/// Adds to an adjoint what a node hands on, or writes it where the adjoint is new.
#[inline(always)]
fn pass((Adjoint(am, ar), new): (&mut Adjoint, bool), Adjoint(m, r): &Adjoint, slope: &Slots, bend: &Slots) {
    number::wide(|| {
        if new {
            for slot in 0..SLOTS {
                (am[slot], ar[slot]) = handed(m[slot], r[slot], slope[slot], bend[slot]);
            }
        } else {
            for slot in 0..SLOTS {
                let (more, moved) = handed(m[slot], r[slot], slope[slot], bend[slot]);
                am[slot] += more;
                ar[slot] += moved;
            }
        }
    });
}

/// The arguments of a function with their partials.
pub(super) fn partials(arena: &Arena, id: Id) -> impl Iterator<Item = (Id, (&Slots, &Slots))> {
    let both = match arena.nodes[id as usize].kind {
        NodeKind::One { a, partial } => [Some((a, partial)), None],
        NodeKind::Two { a, b, partials } => [Some((a, partials[0])), Some((b, partials[1]))],
        NodeKind::Leaf | NodeKind::Sum { .. } | NodeKind::Product { .. } | NodeKind::Select { .. } => [None, None],
    };
    both.into_iter().flatten().map(|(to, partial)| (to, arena.partial_at(partial)))
}

/// Hands each polynomial argument of a function to `used`, with what it gets and room for its share.
fn regrouped(
    arena: &Arena,
    sweep: &mut Scratch,
    id: Id,
    adjoint: &Adjoint,
    used: &mut dyn FnMut(Id, &Adjoint, &mut Slots),
) {
    for (to, (slope, bend)) in partials(arena, id) {
        if arena.nodes[to as usize].kind.is_polynomial() {
            let mut share = [0.0; SLOTS];
            pass((&mut sweep.part, true), adjoint, slope, bend);
            used(to, &sweep.part, &mut share);
        }
    }
}

/// Hands an adjoint on to the arguments.
fn propagate(arena: &Arena, sweep: &mut Scratch, id: Id, adjoint: &Adjoint) {
    let Adjoint(m, r) = adjoint;
    match arena.nodes[id as usize].kind {
        NodeKind::Leaf => {}
        NodeKind::Sum { a, b, signs } => {
            for (to, sign) in [(a, signs.0), (b, signs.1)] {
                if sign != 0.0 {
                    let (Adjoint(am, ar), new) = sweep.of(to);
                    number::wide(|| {
                        if new {
                            for slot in 0..SLOTS {
                                am[slot] = sign * m[slot];
                                ar[slot] = r[slot];
                            }
                        } else {
                            for slot in 0..SLOTS {
                                am[slot] += sign * m[slot];
                                ar[slot] += r[slot];
                            }
                        }
                    });
                }
            }
        }
        NodeKind::Product { a, b } => {
            for (to, other) in [(a, b), (b, a)] {
                let other = other as usize;
                pass(sweep.of(to), adjoint, arena.value.get(other), arena.radius.get(other));
            }
        }
        NodeKind::One { .. } | NodeKind::Two { .. } => {
            for (to, (slope, bend)) in partials(arena, id) {
                pass(sweep.of(to), adjoint, slope, bend);
            }
        }
        NodeKind::Select { mask, a, b } => {
            let mask = arena.masks[mask as usize];
            for (to, wanted) in [(a, true), (b, false)] {
                let (Adjoint(am, ar), new) = sweep.of(to);
                if new {
                    am.fill(0.0);
                    ar.fill(0.0);
                }
                for slot in 0..SLOTS {
                    // A slot that is not handed on must not hand on a NaN either.
                    if mask.has(slot) == wanted {
                        am[slot] += m[slot];
                        ar[slot] += r[slot];
                    }
                }
            }
        }
    }
}
