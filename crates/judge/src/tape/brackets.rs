//! Between which binary32 numbers a value lies on a device that rounds to nearest, in the order that is written.
//!
//! A radius counts half a step for each operation, whichever way the device rounded. Where it is known how the device rounds,
//! so is the result of exact arguments; rounding is monotonic, so that of arguments between two numbers lies between the
//! rounded results of these. A sum of thousands of terms is one number then, and its radius the error that was made and not
//! the largest that there could be.

use super::Tape;
use super::arena::{Arena, Id, Meta, NodeKind, Pool, Slots};
use super::memory::UNKNOWN;
use super::model::Model;
use crate::profile::Op;
use crate::profile::grid::MIN_NORMAL;
use program::Grade;
use program::interp::{Mask, SLOTS};

/// Lower and upper ends.
type Ends<'a> = (&'a Slots, &'a Slots);

/// The ends of every node. They are binary32 numbers, or infinite where none are known.
#[derive(Default)]
pub(super) struct Brackets {
    low: Pool,
    high: Pool,
    /// How deep the tape is in definitions of functions: no device has to compute the parts of these by themselves.
    inside: usize,
}

impl Brackets {
    fn of(&self, id: Id) -> Ends<'_> {
        (self.low.get(id as usize), self.high.get(id as usize))
    }

    /// The ends of a slot.
    pub(super) fn at(&self, id: Id, slot: usize) -> [f32; 2] {
        [self.low.get(id as usize)[slot] as f32, self.high.get(id as usize)[slot] as f32]
    }

    /// The ends of a new node, and its radius where they are nearer than that.
    fn follow(&mut self, arena: &mut Arena, model: &Model<'_>, id: Id) {
        let at = id as usize;
        self.low.reach(at);
        self.high.reach(at);
        let meta = arena.nodes[at];
        let found = (self.inside == 0).then(|| self.rounded(arena, model, meta, id)).flatten();
        let (value, radius) = (arena.value.get(at), arena.radius.get_mut(at));
        let (low, high) = (self.low.get_mut(at), self.high.get_mut(at));
        number::wide(|| {
            for slot in 0..SLOTS {
                (low[slot], high[slot]) = inward(value[slot], radius[slot]);
            }
        });
        if let Some(ends) = found {
            number::wide(|| narrow(low, high, &ends, value, radius));
        }
    }

    /// Takes in what else is known of the ends of a node.
    fn take(&mut self, arena: &mut Arena, id: Id, ends: &[Slots; 2]) {
        let at = id as usize;
        let (value, radius) = (arena.value.get(at), arena.radius.get_mut(at));
        narrow(self.low.get_mut(at), self.high.get_mut(at), ends, value, radius);
    }

    /// The ends of an operation that is rounded to nearest, or exact, from those of its arguments; NaN or infinite where they
    /// are not known.
    fn rounded(&self, arena: &Arena, model: &Model<'_>, meta: Meta, id: Id) -> Option<[Slots; 2]> {
        if let NodeKind::Select { mask, a, b } = meta.kind {
            let mut ends = [*self.of(b).0, *self.of(b).1];
            let [low, high] = &mut ends;
            let (mask, (a_low, a_high)) = (arena.masks[mask as usize], self.of(a));
            mask.merge(a_low, low);
            mask.merge(a_high, high);
            return Some(ends);
        }
        let op = meta.op?;
        let full = meta.site.is_none_or(|site| site.grade() == Grade::Full);
        if !full || !(matches!(op, Op::Neg | Op::Abs | Op::Min | Op::Max) || model.rounds_to_nearest(op)) {
            return None;
        }
        let flushes = model.flushes();
        Some(match meta.kind {
            NodeKind::Leaf if op == Op::Convert => {
                let value = arena.value.get(id as usize);
                columns(flushes, |slot| (value[slot], value[slot], 0.0, 0.0), |x, _, _, _| (nearest(x), nearest(x)))
            }
            NodeKind::Sum { a, signs: (sign, 0.0), .. } => match sign < 0.0 {
                true => self.one(a, flushes, |x0, x1| (-x1, -x0)),
                false => self.one(a, flushes, |x0, x1| (x0, x1)),
            },
            NodeKind::Sum { a, b, signs } => match (signs.0 < 0.0, signs.1 < 0.0) {
                (false, false) => self.two([a, b], flushes, |x0, x1, y0, y1| (nearest(x0 + y0), nearest(x1 + y1))),
                (false, true) => self.two([a, b], flushes, |x0, x1, y0, y1| (nearest(x0 - y1), nearest(x1 - y0))),
                (true, false) => self.two([a, b], flushes, |x0, x1, y0, y1| (nearest(y0 - x1), nearest(y1 - x0))),
                (true, true) => self.two([a, b], flushes, |x0, x1, y0, y1| (nearest(-x1 - y1), nearest(-x0 - y0))),
            },
            NodeKind::Product { a, b } => {
                self.two([a, b], flushes, |x0, x1, y0, y1| corners([x0 * y0, x0 * y1, x1 * y0, x1 * y1]))
            }
            NodeKind::Two { a, b, .. } => match op {
                Op::Div => self.two([a, b], flushes, |x0, x1, y0, y1| {
                    let quotients = corners([x0 / y0, x0 / y1, x1 / y0, x1 / y1]);
                    if (y0 > 0.0) | (y1 < 0.0) { quotients } else { (f64::NAN, f64::NAN) }
                }),
                Op::Min => self.two([a, b], flushes, |x0, x1, y0, y1| (x0.min(y0), x1.min(y1))),
                Op::Max => self.two([a, b], flushes, |x0, x1, y0, y1| (x0.max(y0), x1.max(y1))),
                _ => return None,
            },
            NodeKind::One { a, .. } => match op {
                Op::Abs => self.one(a, flushes, |x0, x1| (x0.max(-x1).max(0.0), x1.max(-x0))),
                Op::Sqrt => self.one(a, flushes, |x0, x1| (nearest(x0.sqrt()), nearest(x1.sqrt()))),
                _ => return None,
            },
            NodeKind::Leaf | NodeKind::Select { .. } => return None,
        })
    }

    /// The ends of a function of one argument. Only what is inlined into `of` becomes vector instructions.
    #[inline(always)]
    fn one(&self, x: Id, flushes: bool, of: impl Fn(f64, f64) -> (f64, f64)) -> [Slots; 2] {
        let (low, high) = self.of(x);
        columns(flushes, |slot| (low[slot], high[slot], 0.0, 0.0), |x0, x1, _, _| of(x0, x1))
    }

    /// The same of two arguments.
    #[inline(always)]
    fn two(&self, [x, y]: [Id; 2], flushes: bool, of: impl Fn(f64, f64, f64, f64) -> (f64, f64)) -> [Slots; 2] {
        let ((x0, x1), (y0, y1)) = (self.of(x), self.of(y));
        columns(flushes, |slot| (x0[slot], x1[slot], y0[slot], y1[slot]), of)
    }
}

/// The nearest binary32. What binary64 gives for a sum, product, quotient or root of binary32 numbers is never rounded to
/// another one by being rounded twice: 53 ≥ 2·24 + 2 (Figueroa, When is double rounding innocuous?).
#[inline(always)]
fn nearest(x: f64) -> f64 {
    f64::from(x as f32)
}

#[inline(always)]
fn corners([a, b, c, d]: [f64; 4]) -> (f64, f64) {
    (nearest(a.min(b).min(c.min(d))), nearest(a.max(b).max(c.max(d))))
}

/// The binary32 numbers at the ends of what lies within a radius of a value; infinite where there is none in between.
#[inline(always)]
fn inward(v: f64, e: f64) -> (f64, f64) {
    // Binary64 rounds the ends themselves.
    let slack = v.abs() * f64::EPSILON;
    let (lo, hi) = (v - e - slack, v + e + slack);
    let (l, h) = (lo as f32, hi as f32);
    let low = if f64::from(l) < lo { l.next_up() } else { l };
    let high = if f64::from(h) > hi { h.next_down() } else { h };
    let known = (low <= high) & (e < f64::INFINITY);
    if known { (f64::from(low), f64::from(high)) } else { (f64::NEG_INFINITY, f64::INFINITY) }
}

/// Ends in all slots. Where subnormal numbers may become zero, nothing is known of operations on them and with them.
#[inline(always)]
fn columns(
    flushes: bool,
    args: impl Fn(usize) -> (f64, f64, f64, f64),
    of: impl Fn(f64, f64, f64, f64) -> (f64, f64),
) -> [Slots; 2] {
    let (mut low, mut high) = ([0.0; SLOTS], [0.0; SLOTS]);
    let stays = |lo: f64, hi: f64| !flushes | (lo >= MIN_NORMAL) | (hi <= -MIN_NORMAL) | ((lo == 0.0) & (hi == 0.0));
    number::wide(|| {
        for slot in 0..SLOTS {
            let (x0, x1, y0, y1) = args(slot);
            let (l, h) = of(x0, x1, y0, y1);
            let known = stays(x0, x1) & stays(y0, y1) & stays(l, h);
            (low[slot], high[slot]) = if known { (l, h) } else { (f64::NAN, f64::NAN) };
        }
    });
    [low, high]
}

/// Takes ends in that are known otherwise, and the radius that follows.
#[inline(always)]
fn narrow(low: &mut Slots, high: &mut Slots, ends: &[Slots; 2], value: &Slots, radius: &mut Slots) {
    for slot in 0..SLOTS {
        let (l, h) = (ends[0][slot], ends[1][slot]);
        // Infinite ends are none: nothing is promised beyond the range.
        let known = ((h - l) >= 0.0) & ((h - l) < f64::INFINITY) & (radius[slot] < f64::INFINITY);
        let (l, h) = (l.max(low[slot]), h.min(high[slot]));
        let known = known & (l <= h);
        let off = (value[slot] - l).max(h - value[slot]);
        (low[slot], high[slot]) = if known { (l, h) } else { (low[slot], high[slot]) };
        radius[slot] = if known & (off < radius[slot]) { off } else { radius[slot] };
    }
}

impl Tape<'_> {
    /// The same tape with what is known of a device that rounds to nearest in the order that is written; of another device
    /// there is no more to know.
    #[must_use]
    pub fn with_brackets(self) -> Self {
        let brackets = self.model.rounds_to_nearest(Op::Add).then(Brackets::default);
        Self { brackets, ..self }
    }

    /// The ends of a new node, whose other columns are complete.
    pub(super) fn bracket(&mut self, id: Id) {
        if let Some(brackets) = &mut self.brackets {
            brackets.follow(&mut self.arena, &self.model, id);
        }
    }

    /// Ends that came out of memory, in some slots.
    pub(super) fn bracket_by(&mut self, id: Id, before: Id, mask: &Mask, ends: &[Slots; 2]) {
        let Some(brackets) = &mut self.brackets else { return };
        let (low, high) = brackets.of(before);
        let mut all = [*low, *high];
        all.iter_mut().zip(ends).for_each(|(all, ends)| mask.merge(ends, all));
        brackets.take(&mut self.arena, id, &all);
    }

    /// The ends of a slot, for memory.
    pub(super) fn ends(&self, id: Id, slot: usize) -> [f32; 2] {
        self.brackets.as_ref().map_or(UNKNOWN, |brackets| brackets.at(id, slot))
    }

    /// From here on, nodes are parts of a definition; to be ended by [`Tape::leave`].
    pub(super) fn enter(&mut self) {
        self.brackets.iter_mut().for_each(|brackets| brackets.inside += 1);
    }

    pub(super) fn leave(&mut self) {
        self.brackets.iter_mut().for_each(|brackets| brackets.inside -= 1);
    }
}

#[cfg(test)]
mod tests {
    use super::super::Tape;
    use super::super::tests::{call, device};
    use super::*;
    use program::interp::{Binary32, FUEL, Machine, OutputColumn};

    /// Value and radius of a function on a tape of radii with brackets, its radius without them, and what binary32 gives.
    fn of(profile: &str, body: &str, x: f32) -> (f64, f64, f64, f64) {
        let (executable, batch) = call(&format!("float f(float x) {{ {body} }}"), &[x]);
        let radius = |tape: Tape<'_>| {
            let mut machine = Machine::new(&executable, tape.with_radii(), FUEL);
            machine.run(&batch, 0);
            let OutputColumn::Real(&column) = machine.output(0, 0) else { panic!("a real number") };
            let tape = machine.as_domain();
            (tape.values(column)[0], tape.arena.radius.get(tape.id(&column) as usize)[0])
        };
        let model = device(profile, false);
        let ((value, narrow), (_, wide)) = (radius(Tape::new(model).with_brackets()), radius(Tape::new(model)));
        let mut machine = Machine::new(&executable, Binary32::default(), FUEL);
        machine.run(&batch, 0);
        let OutputColumn::Real(column) = machine.output(0, 0) else { panic!("a real number") };
        (value, narrow, wide, f64::from(column.values()[0]))
    }

    const EXACT: [&str; 5] = [
        "float s = 0.0; for (int i = 0; i < 1000; ++i) { s += x * float(i); } return s;",
        "return (x + 0.1) * (x - 0.3) / (x * x + 7.0);",
        "return sqrt(abs(x)) - max(x, 0.3) + min(-x, 0.7);",
        "float s = 1.0; for (int i = 0; i < 40; ++i) { s = s > 2.0 ? s / 1.7 : s * (1.1 + abs(x)); } return s;",
        "return float(16777217 + int(x * 0.0)) + x;",
    ];

    #[test]
    fn what_is_rounded_to_nearest_is_known_to_the_bit() {
        for body in EXACT {
            for x in [0.1, -0.7, 1.0, 3.25, 1e-3, -123.456] {
                let (value, narrow, wide, found) = of("binary32", body, x);
                assert_eq!((found - value).abs(), narrow, "{body} {x}");
                // A device that is off by one step away from the value is found.
                let off = found as f32;
                let off = if found >= value { off.next_up() } else { off.next_down() };
                assert!((f64::from(off) - value).abs() > narrow, "{body} {x}");
                assert!(narrow <= wide, "{body} {x}: {narrow:e} {wide:e}");
            }
        }
        let (_, narrow, wide, _) = of("binary32", EXACT[0], 0.1);
        assert!(narrow < 0.1 * wide, "{narrow:e} {wide:e}");
    }

    #[test]
    fn what_binary32_gives_lies_within_whatever_functions_it_goes_through() {
        let functions = [
            "return sin(x) * x + exp(x * 0.1);",
            "vec3 v = normalize(vec3(x, 0.3, 1.0)); return dot(v, vec3(0.1, x, 0.2));",
            "float s = 0.0; for (int i = 0; i < 200; ++i) { s += tan(x * 0.01 * float(i)) * 0.1; } return s;",
            "return mod(x * 7.0, 0.3) + smoothstep(-1.0, 1.0, x) + mix(x, 2.0, 0.3) + radians(x);",
        ];
        for body in functions {
            for x in [0.1, -0.7, 1.0, 1.14159, 1e-3, -0.456] {
                let (value, narrow, wide, found) = of("binary32", body, x);
                assert!((found - value).abs() <= narrow && narrow <= wide, "{body} {x}: {value} ± {narrow:e} {found}");
            }
        }
    }

    #[test]
    fn where_either_neighbour_is_right_or_sums_are_fused_nothing_more_is_known() {
        for profile in ["vulkan-1.4", "wgsl", "glsl-4.60"] {
            let (_, narrow, wide, _) = of(profile, EXACT[0], 0.1);
            assert_eq!(narrow, wide, "{profile}");
        }
    }

    #[test]
    fn ends_are_numbers_within_the_radius() {
        assert_eq!(inward(1.0, 0.0), (1.0, 1.0));
        assert_eq!(inward(0.1, 0.0), (f64::NEG_INFINITY, f64::INFINITY), "no number is 0.1");
        let (low, high) = inward(0.1, 1e-8);
        assert!(0.1 - 1e-8 <= low && low <= high && high <= 0.1 + 1e-8);
        assert_eq!(inward(1.0, f64::INFINITY), (f64::NEG_INFINITY, f64::INFINITY));
    }
}
