//! Numbers of `mediump` on the least device that GLSL ES allows, beside binary32 on the same path.

use std::sync::Arc;

use crate::adversary::{Device, Place};
use base::value::Scalar;
use judge::profile::Op;
use judge::tape::lowered;
use program::Grade;
use program::interp::{
    Binary, Binary32, Class, Column as Numbers, Comparison, Domain, FromWords, Guarded, Mask, SLOTS, Site, ToWords,
    Unary, WordSource, Words, halved,
};
use property::mix;

/// What GLSL ES promises of the range of `mediump` (GLSL ES 3.00, 4.5.1): larger numbers may be infinite.
pub const LARGEST: f32 = 16384.0;
/// Numbers nearer to 0 may be 0.
pub const SMALLEST: f32 = 1.0 / 16384.0;

/// Part of a number, or of 1, that an operation may be off by before digits count as lost.
const LOST: f64 = 1.0 / 32.0;

/// What lower precision did to a value that is fine in binary32.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Harm {
    /// The value is beyond the range of the lower precision.
    Overflow,
    /// Not 0, and taken for 0.
    Underflow,
    /// Digits that the operation needed were not there.
    Digits,
}

/// The first time that something happened to a slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// The operation in the program.
    pub site: Site,
    /// What is computed there: a name as in the text.
    pub op: &'static str,
    /// The larger of the arguments, as binary32 has them.
    pub argument: f32,
    /// The value in binary32.
    pub value: f32,
    /// The value at the lower precision.
    pub lowered: f32,
}

/// One number for each slot, twice.
#[derive(Clone, Debug, Default)]
pub struct Column {
    lowered: Numbers<f32>,
    wide: Numbers<f32>,
}

impl Column {
    /// The numbers at the lower precision.
    pub fn lowered(&self) -> &[f32; SLOTS] {
        self.lowered.values()
    }
}

/// Which numbers a device has at lower precision.
#[derive(Clone, Debug, Default)]
pub enum Narrowing {
    /// The nearest of 11 bits, within the range that GLSL ES promises.
    #[default]
    Least,
    /// The nearest of binary16.
    Binary16,
    /// Any that GLSL ES and Vulkan allow, as this device chooses.
    Device(Arc<Device>),
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Beside {
    strict: Binary32,
    narrowing: Narrowing,
    events: [[Option<Event>; SLOTS]; 3],
    jumped: [bool; SLOTS],
    /// Names the inputs of each slot.
    invocations: [u64; SLOTS],
}

impl Default for Beside {
    fn default() -> Self {
        Self::new(Narrowing::default())
    }
}

/// A number as the least device has it.
pub fn least(x: f32) -> f32 {
    let near = halved(x);
    if near.abs() > LARGEST {
        f32::INFINITY.copysign(near)
    } else if near.abs() < SMALLEST {
        0.0_f32.copysign(near)
    } else {
        near
    }
}

fn is_lower(site: Site) -> bool {
    site.grade() != Grade::Full
}

/// True where the number of the lower precision is not near to the other.
fn is_off(wide: f32, lowered: f32) -> bool {
    let (wide, lowered) = (f64::from(wide), f64::from(lowered));
    !((wide - lowered).abs() <= LOST * wide.abs().max(1.0 / 16.0))
}

impl Beside {
    /// Numbers of lower precision as a device has them.
    pub fn new(narrowing: Narrowing) -> Self {
        let events = [[None; SLOTS]; 3];
        let strict = Binary32::default();
        Self { strict, narrowing, events, jumped: [false; SLOTS], invocations: [0; SLOTS] }
    }

    /// True where a decision or a rounding to whole numbers went to the other side of an edge that its operands are near to.
    pub fn jumped(&self, slot: usize) -> bool {
        self.jumped[slot]
    }

    /// A number as an operation gives it, or takes it where `op` is none.
    fn narrowed(&self, site: Site, op: Option<Op>, argument: f32, x: f32, slot: usize) -> f32 {
        match &self.narrowing {
            // A number of that type has no more than binary16.
            Narrowing::Least if site.grade() == Grade::Half => halved(x),
            Narrowing::Least => least(x),
            Narrowing::Binary16 => halved(x),
            Narrowing::Device(device) => {
                let place = Place { site: site.index(), invocation: self.invocations[slot] };
                let op = op.filter(|op| !lowered::keeps(*op));
                device.lowered(site.grade(), op, f64::from(argument), x, place)
            }
        }
    }

    /// The first time in a slot that a harm was done.
    pub fn event(&self, harm: Harm, slot: usize) -> Option<Event> {
        self.events[harm as usize][slot]
    }

    /// Notes where results are farther apart than `apart` though their operands are not.
    fn note_jumps(&mut self, active: &Mask, args: [&Column; 2], out: &Column, apart: f32) {
        for slot in active.slots() {
            let near = args.iter().all(|a| !is_off(a.wide.values()[slot], a.lowered.values()[slot]));
            self.jumped[slot] |= near && (out.wide.values()[slot] - out.lowered.values()[slot]).abs() >= apart;
        }
    }

    fn note(&mut self, harm: Harm, slot: usize, event: Event) {
        self.events[harm as usize][slot].get_or_insert(event);
    }

    fn operand(&self, site: Site, active: &Mask, column: &Column) -> Option<Numbers<f32>> {
        is_lower(site).then(|| {
            let mut own = column.lowered.clone();
            let values = own.values_mut();
            active.each(|slot| values[slot] = self.narrowed(site, None, 0.0, values[slot], slot));
            own
        })
    }

    /// Rounds the results of an operation, and notes what that did.
    fn settle(
        &mut self,
        site: Site,
        op: &'static str,
        of: Option<Op>,
        active: &Mask,
        args: &[&Column],
        out: &mut Column,
    ) {
        if !is_lower(site) {
            return;
        }
        for slot in active.slots() {
            let size = |x: f32| if x.is_nan() { 0.0 } else { x.abs() };
            let argument = args.iter().map(|a| size(a.wide.values()[slot])).fold(0.0, f32::max);
            let lowered = self.narrowed(site, of, argument, out.lowered.values()[slot], slot);
            out.lowered.values_mut()[slot] = lowered;
            let wide = out.wide.values()[slot];
            if lowered == wide || !wide.is_finite() {
                continue;
            }
            let event = Event { site, op, argument, value: wide, lowered };
            let before = args.iter().any(|a| is_off(a.wide.values()[slot], a.lowered.values()[slot]));
            if lowered.is_infinite() {
                self.note(Harm::Overflow, slot, event);
            } else if lowered == 0.0 && wide != 0.0 && wide.abs() < 2.0 * SMALLEST {
                self.note(Harm::Underflow, slot, event);
            } else if !before && is_off(wide, lowered) {
                self.note(Harm::Digits, slot, event);
            }
            // A literal that is taken for 0 is an operand of what uses it.
            for arg in args {
                let wide = arg.wide.values()[slot];
                let taken = self.narrowed(site, None, 0.0, arg.lowered.values()[slot], slot);
                if taken == 0.0 && wide != 0.0 && wide.abs() < 2.0 * SMALLEST {
                    self.note(Harm::Underflow, slot, Event { value: wide, lowered: taken, ..event });
                } else if taken.is_infinite() && wide.is_finite() {
                    self.note(Harm::Overflow, slot, Event { value: wide, lowered: taken, ..event });
                }
            }
        }
    }
}

fn unary_name(op: Unary) -> &'static str {
    match op {
        Unary::Floor => "floor",
        Unary::Ceil => "ceil",
        Unary::Round => "round",
        Unary::Trunc => "trunc",
        Unary::Fract => "fract",
        Unary::Sqrt => "sqrt",
        Unary::InverseSqrt | Unary::NormalScale => "inversesqrt",
        Unary::Exp | Unary::Exp2 => "exp",
        Unary::Log | Unary::Log2 => "log",
        Unary::Sin => "sin",
        Unary::Cos => "cos",
        Unary::Narrow => "the value",
        _ => "the function",
    }
}

fn binary_name(op: Binary) -> &'static str {
    match op {
        Binary::Add => "the sum",
        Binary::Subtract => "the difference",
        Binary::Multiply => "the product",
        Binary::Divide => "the quotient",
        Binary::Remainder => "the remainder",
        Binary::Pow => "pow",
        Binary::Min => "min",
        Binary::Max => "max",
        Binary::Atan2 => "atan",
        Binary::Step => "step",
    }
}

impl Domain for Beside {
    type Column = Column;
    type Word = u32;

    fn begin(&mut self) {
        self.events = [[None; SLOTS]; 3];
        self.jumped = [false; SLOTS];
        self.invocations = [0; SLOTS];
    }

    fn outside(&self, _: Guarded, _: &Mask, _: &Column, _: &Column) -> Mask {
        Mask::NONE
    }

    fn column(&mut self) -> Column {
        Column { lowered: self.strict.column(), wide: self.strict.column() }
    }

    fn constant(&mut self, site: Option<Site>, value: f32, out: &mut Column) {
        self.strict.constant(site, value, &mut out.lowered);
        self.strict.constant(site, value, &mut out.wide);
    }

    fn input(&mut self, source: WordSource, words: &Words, out: &mut Column) {
        self.strict.input(source, words, &mut out.lowered);
        self.strict.input(source, words, &mut out.wide);
        for (invocation, &word) in self.invocations.iter_mut().zip(words) {
            *invocation = mix(*invocation, u64::from(word));
        }
    }

    fn unary(&mut self, site: Site, op: Unary, active: &Mask, a: &Column, out: &mut Column) {
        let own = self.operand(site, active, a);
        self.strict.unary(site, op, active, own.as_ref().unwrap_or(&a.lowered), &mut out.lowered);
        self.strict.unary(site, op, active, &a.wide, &mut out.wide);
        let whole = matches!(op, Unary::Floor | Unary::Ceil | Unary::Round | Unary::Trunc | Unary::Fract | Unary::Sign);
        if whole {
            self.note_jumps(active, [a, a], out, 0.5);
        }
        self.settle(site, unary_name(op), Op::of_unary(op).ok(), active, &[a], out);
    }

    fn binary(&mut self, site: Site, op: Binary, active: &Mask, a: &Column, b: &Column, out: &mut Column) {
        let own = [self.operand(site, active, a), self.operand(site, active, b)];
        let (x, y) = (own[0].as_ref().unwrap_or(&a.lowered), own[1].as_ref().unwrap_or(&b.lowered));
        self.strict.binary(site, op, active, x, y, &mut out.lowered);
        self.strict.binary(site, op, active, &a.wide, &b.wide, &mut out.wide);
        match op {
            Binary::Step => self.note_jumps(active, [a, b], out, 0.5),
            Binary::Remainder => {
                let period = b.wide.values().map(f32::abs);
                active.each(|slot| {
                    let [p, x] = [out.wide.values()[slot], out.lowered.values()[slot]];
                    let near = !is_off(a.wide.values()[slot], a.lowered.values()[slot]);
                    self.jumped[slot] |= near && (p - x).abs() > 0.5 * period[slot];
                });
            }
            _ => {}
        }
        self.settle(site, binary_name(op), Some(Op::of_binary(op)), active, &[a, b], out);
    }

    fn scale(&mut self, site: Site, a: &Column, exponent: &Words, out: &mut Column) {
        self.strict.scale(site, &a.lowered, exponent, &mut out.lowered);
        self.strict.scale(site, &a.wide, exponent, &mut out.wide);
        self.settle(site, "ldexp", Some(Op::Ldexp), &Mask::ALL, &[a], out);
    }

    fn compare(&mut self, site: Site, op: Comparison, active: &Mask, a: &Column, b: &Column, out: &mut Words) {
        let own = [self.operand(site, active, a), self.operand(site, active, b)];
        let (x, y) = (own[0].as_ref().unwrap_or(&a.lowered), own[1].as_ref().unwrap_or(&b.lowered));
        self.strict.compare(site, op, active, x, y, out);
        for slot in active.slots() {
            let (p, q) = (a.wide.values()[slot], b.wide.values()[slot]);
            let (x, y) = (x.values()[slot], y.values()[slot]);
            let before = is_off(p, x) || is_off(q, y);
            if op.holds(p, q) != (out[slot] != 0) && p.is_finite() && q.is_finite() && !before {
                self.jumped[slot] = true;
                if !is_lower(site) {
                    continue;
                }
                let event =
                    Event { site, op: "the comparison", argument: p.abs().max(q.abs()), value: p - q, lowered: x - y };
                self.note(Harm::Digits, slot, event);
            }
        }
    }

    fn classify(&mut self, site: Site, class: Class, active: &Mask, a: &Column, out: &mut Words) {
        self.strict.classify(site, class, active, &a.lowered, out);
    }

    fn words_of(&mut self, site: Site, op: ToWords, active: &Mask, a: &Column, out: &mut Words) -> Mask {
        let own = self.operand(site, active, a);
        let mut wide = *out;
        self.strict.words_of(site, op, active, &a.wide, &mut wide);
        let outside = self.strict.words_of(site, op, active, own.as_ref().unwrap_or(&a.lowered), out);
        for slot in active.slots().filter(|&slot| wide[slot] != out[slot]) {
            let (p, x) = (a.wide.values()[slot], a.lowered.values()[slot]);
            if p.is_finite() && p != x {
                self.jumped[slot] |= !is_off(p, x);
                let op = if matches!(op, ToWords::Texel { .. }) { "the texel" } else { "the integer" };
                let event = Event { site, op, argument: p.abs(), value: p, lowered: x };
                self.note(Harm::Digits, slot, event);
            }
        }
        outside
    }

    fn reals_of(&mut self, site: Site, op: FromWords, a: &Words, out: &mut Column) {
        self.strict.reals_of(site, op, a, &mut out.lowered);
        self.strict.reals_of(site, op, a, &mut out.wide);
        self.settle(site, "the conversion", Some(Op::Convert), &Mask::ALL, &[], out);
    }

    fn copy(&mut self, from: &Column, to: &mut Column) {
        self.strict.copy(&from.lowered, &mut to.lowered);
        self.strict.copy(&from.wide, &mut to.wide);
    }

    fn merge(&mut self, mask: &Mask, from: &Column, to: &mut Column) {
        self.strict.merge(mask, &from.lowered, &mut to.lowered);
        self.strict.merge(mask, &from.wide, &mut to.wide);
    }

    fn poison(&mut self, mask: &Mask, to: &mut Column) {
        self.strict.poison(mask, &mut to.lowered);
        self.strict.poison(mask, &mut to.wide);
    }

    fn word(&self, column: &Column, slot: usize) -> Option<u32> {
        self.strict.word(&column.lowered, slot)
    }

    fn exact(word: u32, scalar: Scalar) -> u32 {
        Binary32::exact(word, scalar)
    }
}
