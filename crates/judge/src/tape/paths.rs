//! Decisions that may go either way, each taken on a side that is asked for.
//!
//! Where a number lies nearer to a threshold than its error, a conforming device may come out on either side: a comparison, a
//! conversion to a whole number, the step of a `floor`. A tape that follows a path numbers these decisions in the order in
//! which a slot meets them, and takes the side that its path names for each. Values stay those of real numbers and radii as
//! wide as they were, so that what is derived on a side holds for every device that comes out there; devices that do not
//! are on one of the other paths.

use super::Tape;
use super::arena::{Id, NodeKind, Slots};
use super::functions::{image1, image2};
use super::kernels::reach;
use super::rounded::either_side;
use crate::profile::Op;
use program::interp::{Mask, SLOTS, Site, ToWords};

/// Decisions of a slot that are followed; behind these it is open.
const MOST_DECISIONS: usize = 24;

/// Sides of one decision that are followed.
const MOST_SIDES: usize = 4;

/// For each decision of a slot, in their order, the side that is taken: 0 is that of real numbers, which decisions behind the
/// last one take.
pub type Path = Vec<u8>;

/// What the slots of a chunk follow, and what they met.
#[derive(Default)]
pub(super) struct Paths {
    paths: Vec<Path>,
    /// For each slot, the number of sides of each decision.
    met: Vec<Vec<u8>>,
}

impl Paths {
    pub(super) fn begin(&mut self) {
        self.met.iter_mut().for_each(Vec::clear);
    }
}

impl Tape<'_> {
    /// From the next chunk on, slots follow these paths; those behind the last one leave their decisions open, and so do all
    /// where there are none.
    pub fn follow(&mut self, paths: Vec<Path>) {
        let met = vec![Vec::new(); paths.len()];
        self.paths = (!paths.is_empty()).then_some(Paths { paths, met });
    }

    /// For each decision that a slot met on its path, how many sides it has.
    pub fn sides(&self, slot: usize) -> &[u8] {
        self.paths.as_ref().and_then(|paths| paths.met.get(slot)).map_or(&[], Vec::as_slice)
    }

    /// True for a slot in which a function with steps may come out on either side of one, which bounds take for an error as
    /// large as the step.
    pub fn is_stepping(&self, slot: usize) -> bool {
        self.stepping.has(slot)
    }

    /// The side that a slot takes of a decision with so many; `None` where it is left open.
    pub(super) fn choose(&mut self, slot: usize, sides: usize) -> Option<usize> {
        let paths = self.paths.as_mut()?;
        let (path, met) = (paths.paths.get(slot)?, paths.met.get_mut(slot)?);
        if sides > MOST_SIDES || met.len() >= MOST_DECISIONS {
            return None;
        }
        met.push(sides as u8);
        Some(path.get(met.len() - 1).map_or(0, |side| usize::from(*side)))
    }

    /// Open decisions between two answers: those whose path says so are turned. The others are noted.
    pub(super) fn decide(&mut self, site: Site, forks: &[usize], turn: &mut dyn FnMut(usize)) {
        for &slot in forks {
            match self.choose(slot, 2) {
                Some(side) if side > 0 => turn(slot),
                Some(_) => {}
                None => self.note_fork(site, [slot].into_iter()),
            }
        }
    }

    /// The word that a slot gets by its path, of those that a conversion may give; `None` where that is left open.
    pub(super) fn word_on_path(&mut self, op: ToWords, slot: usize, exact: u32, ends: [u32; 2]) -> Option<u32> {
        self.paths.as_ref()?;
        let words = words_between(op, exact, ends)?;
        self.choose(slot, words.len()).and_then(|side| words.get(side).copied())
    }

    /// Values of a function with steps in slots that follow a path and come out on either side of one, with the movement that
    /// is left. Slots that are not followed are left out.
    pub(super) fn steps(&mut self, (site, op): (Site, Op), active: &Mask, a: Id, flushes: bool) -> Vec<PathStep> {
        if self.paths.is_none() || !has_steps(op) || op == Op::Step {
            return Vec::new();
        }
        let at = a as usize;
        let (x, e): (Slots, Slots) = (*self.arena.value.get(at), *self.arena.radius.get(at));
        let e = if self.is_open_at_ties(site) { either_side(&x, &e) } else { e };
        let mut all = Vec::new();
        for slot in active.slots() {
            let (x, e) = (x[slot], reach(x[slot], e[slot], flushes));
            if image1(op, x, e, false).bends.is_finite() {
                continue;
            }
            let Some(sides) = sides_of_step(op, x, e) else { continue };
            if let Some(side) = self.choose(slot, sides.len()) {
                let (moves, slope) = if op == Op::Fract { (e, 1.0) } else { (0.0, 0.0) };
                all.push(PathStep { slot, value: sides[side.min(sides.len() - 1)], moves, slope });
            }
        }
        all
    }

    /// The same for the step from 0 to 1 at an edge.
    pub(super) fn edge(&mut self, op: Op, active: &Mask, [a, b]: [Id; 2], flushes: [bool; 2]) -> Vec<PathStep> {
        if self.paths.is_none() || op != Op::Step {
            return Vec::new();
        }
        let column = |id: Id| (*self.arena.value.get(id as usize), *self.arena.radius.get(id as usize));
        let ((x, ex), (y, ey)) = (column(a), column(b));
        let mut all = Vec::new();
        for slot in active.slots() {
            let about = |v: &Slots, e: &Slots, flushes| (v[slot], reach(v[slot], e[slot], flushes));
            let image = image2(op, about(&x, &ex, flushes[0]), about(&y, &ey, flushes[1]));
            if image.bends.iter().all(|bend| bend.is_finite()) {
                continue;
            }
            if let Some(side) = self.choose(slot, 2) {
                let value = if side == 0 { image.value } else { 1.0 - image.value };
                all.push(PathStep { slot, value, moves: 0.0, slope: 0.0 });
            }
        }
        all
    }
}

/// A function with steps on one side of them.
pub(super) struct PathStep {
    pub slot: usize,
    pub value: f64,
    /// How far it may be from that, and its slope.
    pub moves: f64,
    pub slope: f64,
}

/// True for functions that are constant, or have one slope, between steps.
fn has_steps(op: Op) -> bool {
    matches!(op, Op::Sign | Op::Floor | Op::Ceil | Op::Trunc | Op::RoundEven | Op::Fract | Op::Step)
}

/// What such a function may give for an argument that may be anything within `e` of x, the value of real numbers first; `None`
/// where that is too much.
fn sides_of_step(op: Op, x: f64, e: f64) -> Option<Vec<f64>> {
    let whole: fn(f64) -> f64 = match op {
        Op::Sign => |x: f64| if x == 0.0 { 0.0 } else { x.signum() },
        Op::Floor | Op::Fract => f64::floor,
        Op::Ceil => f64::ceil,
        Op::Trunc => f64::trunc,
        _ => f64::round_ties_even,
    };
    let (exact, mut low, mut high) = (whole(x), whole(x - e), whole(x + e));
    if low == high {
        // A tie that an implementation may round to either side.
        (low, high) = (x.floor(), x.ceil());
    }
    if !(low.is_finite() && high.is_finite() && high - low < MOST_SIDES as f64) {
        return None;
    }
    let others = (0..MOST_SIDES).map(|k| low + k as f64).filter(|side| *side <= high && *side != exact);
    let all = std::iter::once(exact).chain(others);
    Some(all.map(|side| if op == Op::Fract { x - side } else { side }).collect())
}

/// The bit that is the sign of a number in what a conversion gives; 0 where there is none.
pub(super) fn sign_of(op: ToWords) -> u32 {
    match op {
        ToWords::Bits => 0x8000_0000,
        ToWords::HalfBits => 0x8000,
        ToWords::Signed | ToWords::Unsigned | ToWords::FrexpExponent | ToWords::Texel { .. } => 0,
    }
}

/// The words between the two ends of what a conversion may give, the exact one first; `None` where they are too many, or are not
/// in a row.
fn words_between(op: ToWords, exact: u32, [low, high]: [u32; 2]) -> Option<Vec<u32>> {
    let sign = sign_of(op);
    // Both zeros, and nothing else.
    if sign != 0 && [low, high, exact].iter().all(|word| word & (sign - 1) == 0) {
        return Some(vec![exact, exact ^ sign]);
    }
    if (low ^ high) & sign != 0 {
        return None;
    }
    let number = |word: u32| match op {
        ToWords::Signed | ToWords::FrexpExponent | ToWords::Texel { .. } => i64::from(word.cast_signed()),
        ToWords::Unsigned | ToWords::Bits | ToWords::HalfBits => i64::from(word),
    };
    let (low, high) = (number(low).min(number(high)), number(low).max(number(high)));
    if high - low >= MOST_SIDES as i64 || !(low..=high).contains(&number(exact)) {
        return None;
    }
    let others = (low..=high).map(|word| word as u32).filter(|word| *word != exact);
    Some(std::iter::once(exact).chain(others).collect())
}

/// How far an argument may be off for a step to be followed: with more, what is left on a side is as coarse as the step.
fn worth(op: Op) -> f64 {
    if op == Op::Fract { 1.0 / 64.0 } else { 0.5 }
}

impl Tape<'_> {
    /// Notes the slots in which a function with steps has no slope, as far as they are worth to be followed.
    pub(super) fn note_steps(&mut self, id: Id, slots: &[usize]) {
        let meta = self.arena.nodes[id as usize];
        let Some(op) = meta.op.filter(|op| has_steps(*op)) else { return };
        let args = match meta.kind {
            NodeKind::One { a, .. } => [a, a],
            NodeKind::Two { a, b, .. } => [a, b],
            NodeKind::Leaf | NodeKind::Sum { .. } | NodeKind::Product { .. } | NodeKind::Select { .. } => return,
        };
        let off = |slot: usize| args.iter().map(|a| self.arena.radius.get(*a as usize)[slot]).fold(0.0, f64::max);
        let noted: Vec<usize> = slots.iter().copied().filter(|slot| off(*slot) <= worth(op)).collect();
        noted.into_iter().for_each(|slot| self.stepping.insert(slot));
    }
}

const _: () = assert!(SLOTS <= u8::MAX as usize + 1 && MOST_SIDES <= u8::MAX as usize);

#[cfg(test)]
mod tests {
    use super::super::tests::{call, device};
    use super::*;
    use program::interp::{FUEL, Machine, OutputColumn};

    /// Values and bounds of a function of one number on all of its paths.
    fn on_paths(function: &str, x: f32) -> Vec<(f64, f64)> {
        let (executable, batch) = call(&format!("float f(float x) {{ {function} }}"), &[x]);
        let mut machine = Machine::new(&executable, Tape::new(device("vulkan-1.4", false)), FUEL);
        let mut pending = vec![Vec::new()];
        let mut found = Vec::new();
        while let Some(path) = pending.pop() {
            machine.domain().follow(vec![path.clone()]);
            machine.run(&batch, 0);
            let OutputColumn::Real(&column) = machine.output(0, 0) else { panic!("a real number") };
            let tape = machine.domain();
            assert!(tape.fork(0).is_none(), "{function} leaves a decision open");
            let bound = tape.bounds(column, &mut |_| false).bound[0];
            found.push((tape.values(column)[0], bound));
            let sides = tape.sides(0).to_vec();
            for k in path.len()..sides.len() {
                for side in 1..sides[k] {
                    let mut next = path.clone();
                    next.resize(k, 0);
                    next.push(side);
                    pending.push(next);
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
    }

    #[test]
    fn each_side_of_a_decision_has_its_own_value() {
        let third = 1.0_f32 / 3.0;
        for (function, expected) in [
            ("return x * 3.0 < 1.0 ? 5.0 : 7.0;", vec![5.0, 7.0]),
            ("return floor(x * 3.0);", vec![0.0, 1.0]),
            ("return ceil(x * 3.0) + 1.0;", vec![2.0, 3.0]),
            ("return sign(x * 3.0 - 1.0);", vec![-1.0, 0.0, 1.0]),
            ("return float(int(x * 3.0));", vec![0.0, 1.0]),
            ("return step(1.0, x * 3.0);", vec![0.0, 1.0]),
            ("return 2.0;", vec![2.0]),
            ("float s = 0.0; for (float t = 0.0; t < 1.0; t += x) s += 1.0; return s;", vec![3.0, 4.0]),
            ("if (x * 3.0 < 1.0) return 1.0; if (x * 6.0 < 2.0) return 2.0; return 3.0;", vec![1.0, 2.0, 3.0]),
        ] {
            let found = on_paths(function, third);
            let values: Vec<f64> = found.iter().map(|(value, _)| *value).collect();
            assert_eq!(values, expected, "{function}");
            assert!(found.iter().all(|(_, bound)| *bound < 1e-5), "{function}: {found:?}");
        }
    }

    #[test]
    fn a_fraction_beside_a_step_is_near_to_either_end() {
        let found = on_paths("return fract(x * 3.0);", 1.0 / 3.0);
        let near = |(value, bound): &(f64, f64), end: f64| (value - end).abs() < 1e-6 && *bound < 1e-6;
        assert!(found.len() == 2 && near(&found[0], 0.0) && near(&found[1], 1.0), "{found:?}");
    }

    #[test]
    fn words_between_two_ends_are_in_a_row_or_none() {
        assert_eq!(words_between(ToWords::Signed, 0, [u32::MAX, 1]), Some(vec![0, u32::MAX, 1]));
        assert_eq!(words_between(ToWords::Bits, 0x3f80_0000, [0x3f7f_ffff, 0x3f80_0000]).map(|all| all.len()), Some(2));
        assert_eq!(words_between(ToWords::Bits, 0x8000_0000, [0x8000_0000, 0]), Some(vec![0x8000_0000, 0]));
        assert_eq!(words_between(ToWords::Bits, 1, [0x8000_0001, 2]), None, "across zero");
        assert_eq!(words_between(ToWords::Unsigned, 100, [0, 200]), None);
    }

    #[test]
    fn a_tie_goes_to_both_sides() {
        assert_eq!(sides_of_step(Op::RoundEven, 2.5, 0.0), Some(vec![2.0, 3.0]));
        assert_eq!(sides_of_step(Op::Floor, 3.0, 1e-9), Some(vec![3.0, 2.0]));
        assert_eq!(sides_of_step(Op::Floor, 3.0, 1e9), None);
    }
}
