//! The reverse sweep: how much each node's error is worth at an output.

use super::arena::{Arena, Id, Kind, Lanes};
use super::{Column, Tape};
use crate::interp::LANES;

const NONE: u32 = u32::MAX;

/// Derivatives of the output by a node: at the exact values, and how far they move from there.
struct Adjoint(Lanes, Lanes);

impl Default for Adjoint {
    fn default() -> Self {
        Self([0.0; LANES], [0.0; LANES])
    }
}

/// Room for sweeps, used again and again.
#[derive(Default)]
pub(super) struct Scratch {
    /// For each node, the number of its adjoint.
    slots: Vec<u32>,
    adjoints: Vec<Box<Adjoint>>,
    free: Vec<u32>,
    spare: Option<Box<Adjoint>>,
}

impl Scratch {
    fn begin(&mut self, nodes: usize) {
        self.slots.clear();
        self.slots.resize(nodes, NONE);
        self.free.clear();
        self.free.extend(0..self.adjoints.len() as u32);
    }

    fn take(&mut self, node: Id) -> Option<u32> {
        let slot = std::mem::replace(&mut self.slots[node as usize], NONE);
        (slot != NONE).then_some(slot)
    }

    /// The adjoint of a node; zeros when there was none.
    fn of(&mut self, node: Id) -> &mut Adjoint {
        let slot = &mut self.slots[node as usize];
        if *slot == NONE {
            *slot = match self.free.pop() {
                Some(free) => {
                    *self.adjoints[free as usize] = Adjoint::default();
                    free
                }
                None => {
                    self.adjoints.push(Box::default());
                    (self.adjoints.len() - 1) as u32
                }
            };
        }
        &mut self.adjoints[*slot as usize]
    }
}

/// What a sweep found.
#[derive(Clone, Debug)]
pub struct Bounds {
    /// How far a conforming device may be from the exact value, for each lane. A sweep that was ended
    /// early gives less. Infinite where nothing can be said.
    pub bound: Box<[f64; LANES]>,
}

/// Nodes between two looks at whether the sweep may end.
const STRIDE: u32 = 8;

impl Tape<'_> {
    /// Bounds for one output in all lanes. The sweep may end once `enough` says so of the bounds that
    /// it has: they only grow.
    pub fn bounds(&mut self, output: Column, enough: &mut dyn FnMut(&[f64; LANES]) -> bool) -> Bounds {
        self.bounds_with(output, enough, &mut |_, _| {})
    }

    /// The same; `see` gets each node's part of the bound, node after node.
    pub(super) fn bounds_with(
        &mut self,
        output: Column,
        enough: &mut dyn FnMut(&[f64; LANES]) -> bool,
        see: &mut dyn FnMut(Id, &Lanes),
    ) -> Bounds {
        let root = self.id(&output);
        let rearranged = self.model.is_rearranged();
        let Self { arena, sweep, .. } = self;
        let mut bounds = Bounds { bound: Box::new([0.0; LANES]) };
        sweep.begin(root as usize + 1);
        sweep.of(root).0.fill(1.0);
        for id in (0..=root).rev() {
            let Some(slot) = sweep.take(id) else { continue };
            // The box goes out of its place for as long as others are written.
            let adjoint = std::mem::replace(&mut sweep.adjoints[slot as usize], sweep.spare.take().unwrap_or_default());
            let meta = arena.nodes[id as usize];
            // Regrouped sums and products err as a whole, where something else takes their value.
            let counts = !meta.exact && (!rearranged || id == root || !meta.kind.is_polynomial());
            if counts {
                add(arena, id, &adjoint, &mut bounds, see);
            }
            propagate(arena, sweep, id, &adjoint, |arena, a, part| {
                if rearranged && arena.nodes[a as usize].kind.is_polynomial() && !meta.kind.is_polynomial() {
                    add(arena, a, part, &mut bounds, see);
                }
            });
            sweep.spare = Some(std::mem::replace(&mut sweep.adjoints[slot as usize], adjoint));
            sweep.free.push(slot);
            if id % STRIDE == 0 && enough(&bounds.bound) {
                break;
            }
        }
        bounds
    }
}

/// Adds a node's own error, times what it is worth.
fn add(arena: &Arena, id: Id, Adjoint(m, r): &Adjoint, bounds: &mut Bounds, see: &mut dyn FnMut(Id, &Lanes)) {
    let local = arena.local.get(id as usize);
    let mut part = [0.0; LANES];
    let mut finite = true;
    for lane in 0..LANES {
        let worth = m[lane].abs() + r[lane];
        // What does not reach the output is not looked at, whatever it is.
        let share = if worth == 0.0 || local[lane] == 0.0 { 0.0 } else { worth * local[lane] };
        part[lane] = share;
        bounds.bound[lane] += share;
        finite &= share < f64::INFINITY;
    }
    if !finite {
        for (bound, share) in bounds.bound.iter_mut().zip(part) {
            // Infinite or NaN.
            if !(share < f64::INFINITY) {
                *bound = f64::INFINITY;
            }
        }
    }
    see(id, &part);
}

/// Hands an adjoint on to the arguments. `used` sees what each argument gets from this node.
fn propagate(
    arena: &Arena,
    sweep: &mut Scratch,
    id: Id,
    Adjoint(m, r): &Adjoint,
    mut used: impl FnMut(&Arena, Id, &Adjoint),
) {
    let mut pass = |sweep: &mut Scratch, to: Id, slope: &Lanes, bend: &Lanes| {
        let mut part = Adjoint::default();
        for lane in 0..LANES {
            let reaches = m[lane] != 0.0 || r[lane] != 0.0;
            let (p, d) = (slope[lane], bend[lane]);
            part.0[lane] = if reaches { m[lane] * p } else { 0.0 };
            part.1[lane] = if reaches { m[lane].abs() * d + r[lane] * (p.abs() + d) } else { 0.0 };
        }
        let Adjoint(am, ar) = sweep.of(to);
        for lane in 0..LANES {
            am[lane] += part.0[lane];
            ar[lane] += part.1[lane];
        }
        used(arena, to, &part);
    };
    match arena.nodes[id as usize].kind {
        Kind::Leaf => {}
        Kind::Sum { a, b, signs } => {
            for (to, sign) in [(a, signs.0), (b, signs.1)] {
                if sign != 0.0 {
                    let Adjoint(am, ar) = sweep.of(to);
                    for lane in 0..LANES {
                        am[lane] += sign * m[lane];
                        ar[lane] += r[lane];
                    }
                }
            }
        }
        Kind::Product { a, b } => {
            for (to, other) in [(a, b), (b, a)] {
                let other = other as usize;
                pass(sweep, to, arena.value.get(other), arena.radius.get(other));
            }
        }
        Kind::One { a, partial } => {
            let (slope, bend) = arena.partial_at(partial);
            pass(sweep, a, slope, bend);
        }
        Kind::Two { a, b, partials } => {
            for (to, partial) in [(a, partials[0]), (b, partials[1])] {
                let (slope, bend) = arena.partial_at(partial);
                pass(sweep, to, slope, bend);
            }
        }
        Kind::Select { mask, a, b } => {
            let mask = arena.masks[mask as usize];
            for (to, wanted) in [(a, true), (b, false)] {
                let Adjoint(am, ar) = sweep.of(to);
                for lane in 0..LANES {
                    let here = if mask.has(lane) == wanted { 1.0 } else { 0.0 };
                    // A lane that is not handed on must not hand on a NaN either.
                    if here != 0.0 {
                        am[lane] += m[lane];
                        ar[lane] += r[lane];
                    }
                }
            }
        }
    }
}
