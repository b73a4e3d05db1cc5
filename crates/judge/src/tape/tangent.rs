//! Forward derivatives: how far outputs move when every operation errs by as much as it may, each in one direction.
//!
//! A bound is Σ |∂y/∂v_k|·b_k over the nodes. For any signs the displacement |Σ ±∂y/∂v_k·b_k| is at most that, so an error
//! that is no larger is within the bound, provided that the bound is finite, which the radius of the output says. One pass
//! over the operations gives it for all outputs at once; the sign of each error is the one that adds to the displacement that
//! its operation has from those before it.

use super::arena::{Arena, Id, NodeKind, Pool, Slots, ZEROS};
use super::held::HeldNodes;
use super::kernels::{ClosedNode, MovedNode, Once, SeenNode, farther};
use super::sweep::partials;
use super::{Column, Model, Tape, lowered};
use crate::profile::{Allowed, Op};
use program::interp::{Mask, SLOTS};

/// Rounding of the displacement itself, in binary64: some thousand operations are off by less than this part.
pub(super) const ROUNDING: f64 = 1.0 / (1_u64 << 36) as f64;

/// What a tape has on the way to outputs, beside what it remembers in any case.
#[derive(Default)]
pub(super) struct Tangents {
    /// Those of nodes that do not move are zeros.
    displacements: Pool,
    /// For each node, the slots in which nothing bounds it.
    open: Vec<OpenSlots>,
    pub(super) held: HeldNodes,
    /// Radii alone are wanted, and no displacements.
    still: bool,
}

/// Slots in which nothing bounds a node.
#[derive(Clone, Copy, Default)]
struct OpenSlots {
    all: Mask,
    /// Those in which nothing is promised for an operation.
    unpromised: Mask,
}

impl Tangents {
    pub(super) fn begin(&mut self) {
        self.held.begin();
    }

    pub(super) fn is_full(&self) -> bool {
        self.held.is_full()
    }

    fn of(&self, id: Id) -> &Slots {
        self.displacements.get(id as usize)
    }

    fn moves(&self, id: Id) -> bool {
        !self.displacements.is_zero(id as usize)
    }

    /// Makes room for a node.
    fn reach(&mut self, id: Id) {
        self.displacements.reach(id as usize);
        if self.open.len() <= id as usize {
            self.open.resize(id as usize + 1, OpenSlots::default());
        }
    }

    /// Writes the displacement of a new node.
    fn follow(&mut self, arena: &Arena, rearranged: bool, id: Id) {
        if !self.write(arena, rearranged, id) {
            self.displacements.set_zero(id as usize);
        }
    }

    /// Writes the displacement of a new node. False when it does not move.
    fn write(&mut self, arena: &Arena, rearranged: bool, id: Id) -> bool {
        let meta = arena.nodes[id as usize];
        let mut moving = match meta.kind {
            NodeKind::Leaf => return false,
            NodeKind::Sum { a, b, .. } | NodeKind::Product { a, b } | NodeKind::Select { a, b, .. } => {
                self.moves(a) || self.moves(b)
            }
            NodeKind::One { .. } | NodeKind::Two { .. } => false,
        };
        let (before, out) = self.displacements.split(id as usize);
        let of = |id: Id| before.get(id as usize);
        match meta.kind {
            NodeKind::Sum { a, b, signs } if moving => {
                let (dx, dy) = (of(a), of(b));
                number::wide(|| {
                    for slot in 0..SLOTS {
                        out[slot] = signs.0 * dx[slot] + signs.1 * dy[slot];
                    }
                });
            }
            NodeKind::Product { a, b } if moving => {
                let (x, y) = (arena.value.get(a as usize), arena.value.get(b as usize));
                let (dx, dy) = (of(a), of(b));
                number::wide(|| {
                    for slot in 0..SLOTS {
                        out[slot] = y[slot] * dx[slot] + x[slot] * dy[slot];
                    }
                });
            }
            NodeKind::Select { mask, a, b } if moving => {
                *out = *of(b);
                arena.masks[mask as usize].merge(of(a), out);
            }
            _ => {}
        }
        for (a, (slope, _)) in partials(arena, id) {
            // A regrouped sum or product errs as a whole, where a function takes its value.
            let whole = rearranged && arena.nodes[a as usize].kind.is_polynomial();
            if !whole && before.is_zero(a as usize) {
                continue;
            }
            let (dx, own) = (of(a), if whole { arena.local.get(a as usize) } else { &ZEROS });
            let first = !std::mem::replace(&mut moving, true);
            number::wide(|| {
                for slot in 0..SLOTS {
                    let moved = slope[slot] * (dx[slot] + own[slot].copysign(dx[slot]));
                    out[slot] = if first { moved } else { out[slot] + moved };
                }
            });
        }
        if meta.exact || (rearranged && meta.is_regrouped()) {
            return moving;
        }
        let own = arena.local.get(id as usize);
        number::wide(|| {
            for slot in 0..SLOTS {
                out[slot] = farther(if moving { out[slot] } else { 0.0 }, own[slot]);
            }
        });
        true
    }
}

impl Tape<'_> {
    /// The same tape with displacements, for [`Tape::allowance`].
    #[must_use]
    pub fn with_tangents(self) -> Self {
        Self { tangents: Some(Tangents::default()), ..self }
    }

    /// The same tape with radii alone, of what registers hold: what a program without an end on the number of its operations
    /// needs.
    #[must_use]
    pub fn with_radii(self) -> Self {
        Self { tangents: Some(Tangents { still: true, ..Tangents::default() }), ..self }
    }

    /// True for a tape of radii alone.
    pub(super) fn is_still(&self) -> bool {
        self.tangents.as_ref().is_some_and(|tangents| tangents.still)
    }

    fn tangents(&self) -> &Tangents {
        self.tangents.as_ref().expect("the tape was made without displacements")
    }

    /// At most the bound of an output in each slot. NaN in slots where its bound may be infinite, and where it is not known.
    ///
    /// # Panics
    /// When the tape was made without displacements: a defect of the caller.
    pub fn allowance(&self, output: Column) -> Slots {
        let id = self.id(&output);
        let (at, kind) = (id as usize, self.arena.nodes[id as usize].kind);
        let (moved, radius) = (self.tangents().of(id), self.arena.radius.get(at));
        let whole = self.model.is_rearranged() && kind.is_polynomial();
        let own = if whole { self.arena.local.get(at) } else { &ZEROS };
        let mut out = [0.0; SLOTS];
        number::wide(|| {
            for slot in 0..SLOTS {
                let moved = (moved[slot].abs() + own[slot]) * (1.0 - ROUNDING);
                out[slot] = if radius[slot] < f64::INFINITY { moved } else { f64::NAN };
            }
        });
        for (out, given_up) in out.iter_mut().zip(&self.given_up) {
            if given_up.is_some() {
                *out = f64::NAN;
            }
        }
        out
    }

    /// Slots in which nothing bounds an output because nothing is promised for an operation on the way to it, at its exact
    /// arguments. There, [`Tape::cause`] says the same; it knows others, of arguments that are only reached within a radius.
    ///
    /// # Panics
    /// When the tape was made without displacements: a defect of the caller.
    pub fn unpromised(&self, output: Column) -> Mask {
        self.tangents().open[self.id(&output) as usize].unpromised
    }

    /// How far a device may be from the values of a column, over everything before it.
    #[cfg(test)]
    pub(super) fn radii(&self, output: Column) -> &Slots {
        self.arena.radius.get(self.id(&output) as usize)
    }

    /// The displacement of a new node, whose other columns are complete.
    pub(super) fn move_on(&mut self, id: Id) {
        if self.is_still() {
            return;
        }
        let Some(tangents) = &mut self.tangents else { return };
        tangents.reach(id);
        tangents.follow(&self.arena, self.model.is_rearranged(), id);
        let exact = self.arena.radius.is_zero(id as usize);
        self.note_open(id, if exact { Mask::NONE } else { not_finite(self.arena.radius.get(id as usize)) });
    }

    /// Writes all columns of a new sum or product at once, where it is rounded once, in the order that is written, and nothing
    /// but its displacement is wanted of its local error. False, with nothing written, for others.
    pub(super) fn moved_once(&mut self, id: Id, [a, b]: [Id; 2], op: Op, form: Once) -> bool {
        if !self.wants_displacements_alone(id) {
            return false;
        }
        let at = id as usize;
        let tiny = [a, b].map(|id| self.arena.nodes[id as usize].tiny);
        let Some(closing) = self.model.closing(op, tiny, self.arena.nodes[at].is_kept()) else { return false };
        let Some(tangents) = &mut self.tangents else { return false };
        tangents.reach(id);
        let (values, value) = self.arena.value.split(at);
        let (radii, radius) = self.arena.radius.split(at);
        let (before, moved) = tangents.displacements.split(at);
        let args = [a, b].map(|id| {
            let at = id as usize;
            (values.get(at), radii.get(at), before.get(at))
        });
        let seen = number::run_wide(MovedNode { form, closing, args, value, radius, moved });
        self.note_seen(id, seen);
        true
    }

    /// The same for what completes a function, whose local error is known.
    pub(super) fn closed_moving(&mut self, id: Id) -> bool {
        let Model::Device { .. } = self.model else { return false };
        if !self.wants_displacements_alone(id) {
            return false;
        }
        let at = id as usize;
        let args = match self.arena.nodes[at].kind {
            NodeKind::One { a, partial } => [Some((a, partial)), None],
            NodeKind::Two { a, b, partials: [of_a, of_b] } => [Some((a, of_a)), Some((b, of_b))],
            NodeKind::Leaf | NodeKind::Sum { .. } | NodeKind::Product { .. } | NodeKind::Select { .. } => return false,
        };
        let flushes = self.model.flushes();
        let Some(tangents) = &mut self.tangents else { return false };
        tangents.reach(id);
        let Arena { value, radius, local, partials, .. } = &mut self.arena;
        let (radii, radius) = radius.split(at);
        let (before, moved) = tangents.displacements.split(at);
        let args = args.map(|arg| match arg {
            Some((a, partial)) => (radii.get(a as usize), partials.get(2 * partial as usize), before.get(a as usize)),
            None => (&ZEROS, &ZEROS, &ZEROS),
        });
        let (value, local) = (value.get(at), local.get(at));
        let seen = number::run_wide(ClosedNode { flushes, args, value, local, radius, moved });
        self.note_seen(id, seen);
        true
    }

    /// Notes what was seen of the columns of a node that is complete.
    fn note_seen(&mut self, id: Id, seen: SeenNode) {
        self.arena.nodes[id as usize].tiny = seen.tiny;
        self.note_open(id, if seen.open { not_finite(self.arena.radius.get(id as usize)) } else { Mask::NONE });
    }

    /// True where nothing but displacements and radii are wanted of a node, in the order that is written.
    fn wants_displacements_alone(&self, id: Id) -> bool {
        let wanted = self.tangents.as_ref().is_some_and(|tangents| !tangents.still);
        let lower = lowered::is_lower(self.arena.nodes[id as usize].site);
        wanted && !self.model.is_rearranged() && self.brackets.is_none() && !lower
    }

    fn note_open(&mut self, id: Id, all: Mask) {
        let open = if all.is_empty() { OpenSlots::default() } else { self.open_at(self.tangents(), id, all) };
        if let Some(tangents) = &mut self.tangents {
            tangents.open[id as usize] = open;
        }
    }

    /// What is open of a new node, in `all` slots in which its radius is not finite.
    fn open_at(&self, tangents: &Tangents, id: Id, all: Mask) -> OpenSlots {
        let args: [Option<(Id, Mask)>; 2] = match self.arena.nodes[id as usize].kind {
            // Inputs and constants are known.
            NodeKind::Leaf => return OpenSlots::default(),
            NodeKind::Sum { a, signs: (_, 0.0), .. } | NodeKind::One { a, .. } => [Some((a, Mask::ALL)), None],
            NodeKind::Sum { a, b, .. } | NodeKind::Product { a, b } | NodeKind::Two { a, b, .. } => {
                [Some((a, Mask::ALL)), Some((b, Mask::ALL))]
            }
            NodeKind::Select { mask, a, b } => {
                let mask = self.arena.masks[mask as usize];
                [Some((a, mask)), Some((b, Mask::ALL.minus(mask)))]
            }
        };
        let args = || args.into_iter().flatten();
        let lost = |id: Id| not_finite(self.arena.value.get(id as usize));
        // A value that is not finite is another cause, and comes first.
        let mut rest = args().fold(all.minus(lost(id)), |rest, (a, taken)| rest.minus(lost(a).and(taken)));
        let mut unpromised = Mask::NONE;
        for (a, taken) in args() {
            let before = tangents.open[a as usize];
            let through = before.all.and(taken).and(rest);
            unpromised = unpromised.or(before.unpromised.and(through));
            rest = rest.minus(through);
        }
        rest.each(|slot| {
            if self.is_unpromised(id, slot) {
                unpromised.insert(slot);
            }
        });
        OpenSlots { all, unpromised }
    }

    /// True when nothing is promised for the operation of a node at its exact arguments.
    fn is_unpromised(&self, id: Id, slot: usize) -> bool {
        let meta = self.arena.nodes[id as usize];
        let (Model::Device { profile, stage, .. }, Some(op)) = (self.model, meta.op) else { return false };
        let value = |id: Id| self.arena.value.get(id as usize)[slot];
        let allowed = match meta.kind {
            NodeKind::One { a, .. } => profile.allowed(op, &[value(a)], value(id), stage),
            NodeKind::Two { a, b, .. } | NodeKind::Product { a, b } => {
                profile.allowed(op, &[value(a), value(b)], value(id), stage)
            }
            NodeKind::Leaf | NodeKind::Sum { .. } | NodeKind::Select { .. } => return false,
        };
        matches!(allowed, Allowed::NoPromise | Allowed::OutsideDomain)
    }
}

/// The slots of a column that hold no finite number.
fn not_finite(column: &Slots) -> Mask {
    // Hardly ever any: one look at all slots without branches.
    let some = number::wide(|| {
        let mut some = 0_u64;
        for number in column {
            some |= u64::from(!(number.abs() < f64::INFINITY));
        }
        some != 0
    });
    if some { Mask::where_(|slot| !column[slot].is_finite()) } else { Mask::NONE }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{THIRD, call, device};
    use super::super::{Tape, Why};
    use super::*;
    use program::interp::{Binary64, FUEL, Machine, OutputColumn};

    /// Allowance and bound of a function, its value, and whether it is open for want of a promise; by both tapes.
    fn both(model: Model<'_>, function: &str, arguments: &[f32]) -> (f64, f64, bool) {
        let (executable, batch) = call(function, arguments);
        let mut moving = Machine::new(&executable, Tape::new(model).with_tangents(), FUEL);
        let mut whole = Machine::new(&executable, Tape::new(model), FUEL);
        let mut plain = Machine::new(&executable, Binary64::default(), FUEL);
        moving.run(&batch, 0);
        whole.run(&batch, 0);
        plain.run(&batch, 0);
        let columns = (moving.output(0, 0), whole.output(0, 0), plain.output(0, 0));
        let (OutputColumn::Real(&moved), OutputColumn::Real(&column), OutputColumn::Real(values)) = columns else {
            panic!("a real number")
        };
        let value = moving.as_domain().values(moved)[0];
        assert_eq!(value.to_bits(), values.values()[0].to_bits(), "{function} {arguments:?}");
        // Both tapes take a node's columns in loops of their own.
        let radius = |tape: &Tape<'_>, column: Column| tape.arena.radius.get(tape.id(&column) as usize)[0].to_bits();
        let radii = (radius(moving.as_domain(), moved), radius(whole.as_domain(), column));
        assert_eq!(radii.0, radii.1, "{function} {arguments:?}");
        let allowance = moving.as_domain().allowance(moved)[0];
        let unpromised = moving.as_domain().unpromised(moved).has(0);
        let bound = whole.domain().bounds(column, &mut |_| false).bound[0];
        let why = whole.domain().cause(column, 0).map(|cause| cause.why);
        let known = value.is_finite() && bound == f64::INFINITY;
        // What is only reached within the radius is left to the cause.
        assert!(!unpromised || (known && why == Some(Why::NoPromise)), "{function} {arguments:?} {why:?}");
        (allowance, bound, unpromised)
    }

    const FUNCTIONS: [&str; 12] = [
        "return x * y + z;",
        "return (x + y) * (x - z);",
        "return sin(x) * y - cos(x * z);",
        "return pow(abs(x) + 0.5, y) / (1.0 + z * z);",
        "return sqrt(abs(x * y)) + inversesqrt(z * z + 0.25) * x;",
        "float s = x * y; return s * s - s * z;",
        "return x > y ? exp(x * z) : log2(abs(y) + 1.0);",
        "return mix(x, y, clamp(z, 0.0, 1.0)) - min(x * y, z);",
        "float s = 0.0; for (int i = 0; i < 5; ++i) s = s * x + y; return s / z;",
        "return fract(x * 7.0) + floor(y * z) - mod(x, abs(y) + 0.1);",
        "vec3 v = normalize(vec3(x, y, z)); return dot(v, vec3(z, x, y));",
        "return atan(x, y) + tan(x * 0.5) + smoothstep(0.0, 1.0, z);",
    ];

    #[test]
    fn an_allowance_is_never_more_than_the_bound() {
        let numbers = [0.0_f32, 1e-40, -1e-19, THIRD, -0.75, 1.0, 2.5, -7.25, 1e19, 3e38];
        let mut known = 0;
        for (profile, rearranged) in [
            ("vulkan-1.4", false),
            ("vulkan-cts", true),
            ("wgsl", false),
            ("binary32", false),
            ("llvmpipe-22.3.6", true),
        ] {
            for body in FUNCTIONS {
                let function = format!("float f(float x, float y, float z) {{ {body} }}");
                for k in 0..60_usize {
                    let at = |n: usize| numbers[(k * (2 * n + 3) + k / 7 * n + n) % numbers.len()];
                    let arguments = [at(0), at(1), at(2)];
                    let (allowance, bound, _) = both(device(profile, rearranged), &function, &arguments);
                    assert!(
                        allowance.is_nan() || (allowance <= bound && bound.is_finite()),
                        "{profile} {body} {arguments:?}: {allowance:e} {bound:e}"
                    );
                    known += usize::from(allowance.is_finite());
                }
            }
        }
        assert!(known > 1000, "{known}");
    }

    #[test]
    fn where_every_value_is_used_once_the_allowance_is_the_bound() {
        for body in ["return x * y + z * x;", "return sin(x) * y + z;", "return -pow(x, y) * z;", "return x - y - z;"] {
            let function = format!("float f(float x, float y, float z) {{ {body} }}");
            for profile in ["vulkan-1.4", "binary32"] {
                let (allowance, bound, _) = both(device(profile, false), &function, &[0.3, 0.7, 1.1]);
                assert!(allowance >= 0.998 * bound, "{profile} {body}: {allowance:e} {bound:e}");
            }
        }
    }

    #[test]
    fn what_nothing_bounds_does_not_move_and_says_why() {
        let of = |body: &str, x: f32| {
            both(device("vulkan-1.4", false), &format!("float f(float x) {{ return {body}; }}"), &[x])
        };
        let (allowance, _, unpromised) = of("1.0 + 0.5 * cos(2.0 * x)", 3.0);
        assert!(allowance.is_nan() && unpromised);
        let (allowance, _, unpromised) = of("1.0 + 0.5 * cos(2.0 * x)", 1.0);
        assert!(allowance > 0.0 && !unpromised);
        for (body, x) in [("log2(x - 1.5) * 2.0", 1.0), ("x * x - x", 1e20), ("1.0 / (x * x - 0.25)", 0.5)] {
            let (allowance, _, unpromised) = of(body, x);
            assert!(allowance.is_nan() && !unpromised, "{body}");
        }
    }
}
