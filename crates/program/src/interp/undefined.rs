//! Values that the language leaves undefined, and whether an output depends on them.
//!
//! The machine notes where an operation is undefined ([`HazardKind::is_undefined`]) and goes on with one of the values
//! that the operation may have. Whether that matters is found out by running the same invocation with others in
//! its place: an output that changes depends on it. What is not selected, multiplied by 0 or never read does not.

use std::collections::HashSet;

use super::code::{Guarded, Reg, Register};
use super::domain::{Domain, Site, ToWords};
use super::machine::Machine;
use super::meaning::HazardKind;
use super::plain::Binary64;
use super::results::OutputColumn;
use super::slots::{Mask, SLOTS};
use crate::Written;
use crate::lane::interrupt;
use base::value::{Batch, Scalar};

/// An operation whose value is undefined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Undefined {
    /// Which rule makes it undefined.
    pub kind: HazardKind,
    /// The operation in the program.
    pub site: Site,
    /// The function, for [`HazardKind::Argument`].
    pub what: Option<Guarded>,
}

/// An undefined value that an output of an invocation depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Dependence {
    /// The operation.
    pub of: Undefined,
    /// Its arguments, in the first of the invocations that were looked at together.
    pub args: Vec<f64>,
}

/// Where an argument of an undefined operation lies.
#[derive(Clone, Copy, Debug)]
pub(super) enum Operand {
    None,
    Real(Reg),
    Signed(Reg),
    Unsigned(Reg),
}

/// What stands in the place of undefined values, and what was noted of them.
#[derive(Debug, Default)]
pub(super) struct Probe {
    /// Which of the other values; 0 for those that the machine takes by itself.
    pub round: usize,
    /// The operation whose value is replaced; all of them without one.
    only: Option<(HazardKind, Site)>,
    events: Vec<UndefinedEvent>,
}

#[derive(Debug)]
struct UndefinedEvent {
    of: Undefined,
    slots: Mask,
    args: Vec<f64>,
}

/// Other values, for rounds from 1 on: of any size and sign, the last two such as a device may have as well although
/// sums and products hide no more behind them.
const REALS: [f32; 6] = [0.375, -1.5e6, 0.0, 7.25e11, f32::NAN, f32::INFINITY];
const WORDS: [u32; 6] = [3, 0xffff_fff1, 0, 0x5bd1_e995, 0x8000_0000, 0x7fff_ffff];
/// Rounds in which values are finite.
const FINITE: usize = 4;
/// Operations of one look that are tried alone.
const ALONE: usize = 16;

impl<D: Domain> Machine<'_, D> {
    /// Notes slots in which an operation leaves the range of its type, and replaces its value in `to` while other
    /// values are tried.
    pub(super) fn undefined(&mut self, of: Undefined, slots: Mask, to: Option<Register>, args: [Operand; 2]) {
        let slots = slots.and(self.active);
        if slots.is_empty() || of.is_defined_in(self.executable.written) {
            return;
        }
        if of.kind.is_undefined() && self.probe.is_some() {
            self.note(of, slots.and(Mask::first(self.slots)), args);
        }
        self.report(of.kind, of.site, slots);
        if let Some(to) = to.filter(|_| of.kind.is_undefined()) {
            self.substitute(of.kind, of.site, slots, to);
        }
    }

    /// Notes slots in which a variable is read that has no value.
    pub(super) fn read(&mut self, from: Register, kind: HazardKind, site: Site) {
        let assigned = self.assigned[from.file() as usize].get(&from.reg).copied().unwrap_or(Mask::ALL);
        self.undefined(Undefined { kind, site, what: None }, Mask::ALL.minus(assigned), None, [Operand::None; 2]);
    }

    /// Notes slots in which two `out` arguments are one place.
    pub(super) fn overlap(&mut self, of: Register, equal: Option<[Reg; 2]>, site: Site) {
        let word = |reg: Reg, slot: usize| self.words[reg as usize][slot];
        let slots = equal.map_or(Mask::ALL, |[a, b]| Mask::where_(|slot| word(a, slot) == word(b, slot)));
        self.undefined(Undefined { kind: HazardKind::Overlap, site, what: None }, slots, Some(of), [Operand::None; 2]);
    }

    /// A number as an integer, which says nothing where the number does not fit.
    #[inline]
    pub(super) fn convert(&mut self, op: ToWords, to: Reg, a: Reg, site: Site) {
        let (from, out) = (&self.reals[a as usize], &mut self.words[to as usize]);
        let mut outside = self.domain.words_of(site, op, &self.active, from, out);
        if self.executable.written == Written::Wgsl && !outside.is_empty() {
            outside = outside.and(Mask::where_(|slot| self.domain.shown(from, slot).is_nan()));
        }
        let to = Register { scalar: Scalar::I32, reg: to };
        let found = Undefined { kind: HazardKind::Conversion, site, what: None };
        self.undefined(found, outside, Some(to), [Operand::Real(a), Operand::None]);
    }

    /// Copies the result of a function, and notes the slots in which it is undefined.
    #[inline]
    pub(super) fn guard(&mut self, what: Guarded, to: Reg, from: Reg, args: [Reg; 2], site: Site) {
        let to = Register { scalar: Scalar::F32, reg: to };
        self.copy(to, from);
        let [x, y] = args.map(|reg| &self.reals[reg as usize]);
        let outside = self.domain.outside(what, &self.active, x, y);
        let found = Undefined { kind: HazardKind::Argument, site, what: Some(what) };
        self.undefined(found, outside, Some(to), args.map(Operand::Real));
    }

    /// The same for `clamp` of integers.
    #[inline]
    pub(super) fn guard_words(&mut self, signed: bool, to: Register, from: Reg, args: [Reg; 2], site: Site) {
        self.copy(to, from);
        let [low, high] = args.map(|reg| &self.words[reg as usize]);
        let number = |word: u32| if signed { i64::from(word.cast_signed()) } else { i64::from(word) };
        let outside = Mask::where_(|slot| number(low[slot]) > number(high[slot]));
        let found = Undefined { kind: HazardKind::Argument, site, what: Some(Guarded::Clamp) };
        let operand = if signed { Operand::Signed } else { Operand::Unsigned };
        self.undefined(found, outside, Some(to), args.map(operand));
    }

    /// A variable comes to life without a value.
    #[inline]
    pub(super) fn come_to_life(&mut self, to: Register, zero: Reg, site: Site) {
        self.copy(to, zero);
        if let Some(assigned) = self.assigned[to.file() as usize].get_mut(&to.reg) {
            *assigned = Mask::NONE;
            self.substitute(HazardKind::Unset, site, Mask::ALL, to);
        }
    }

    fn note(&mut self, of: Undefined, slots: Mask, args: [Operand; 2]) {
        let Some(first) = slots.slots().next() else { return };
        let arg = |arg: Operand| match arg {
            Operand::None => None,
            Operand::Real(reg) => Some(self.domain.shown(&self.reals[reg as usize], first)),
            Operand::Signed(reg) => Some(f64::from(self.words[reg as usize][first].cast_signed())),
            Operand::Unsigned(reg) => Some(f64::from(self.words[reg as usize][first])),
        };
        let args = args.into_iter().filter_map(arg).collect();
        let Some(probe) = &mut self.probe else { return };
        match probe.events.iter_mut().find(|event| event.of == of) {
            Some(event) => event.slots = event.slots.or(slots),
            None => probe.events.push(UndefinedEvent { of, slots, args }),
        }
    }

    /// True while the value of this operation is replaced.
    pub(super) fn replaces(&self, kind: HazardKind, site: Site) -> bool {
        self.probe.as_ref().is_some_and(|probe| {
            // A variable begins at its declaration, and is noted where it is read.
            let variable = |kind| matches!(kind, HazardKind::Unset | HazardKind::NoReturn);
            let same = |only: (HazardKind, Site)| only == (kind, site) || (variable(kind) && variable(only.0));
            probe.round > 0 && probe.only.is_none_or(same)
        })
    }

    /// Replaces an undefined value in some slots.
    pub(super) fn substitute(&mut self, kind: HazardKind, site: Site, slots: Mask, to: Register) {
        if slots.is_empty() || !self.replaces(kind, site) {
            return;
        }
        let round = self.probe.as_ref().map_or(0, |probe| probe.round - 1) % REALS.len();
        // Two undefined values are two values.
        let salt = (site.index() as u32).wrapping_mul(7).wrapping_add(to.reg) % 61;
        match to.scalar {
            Scalar::F32 => {
                let mut other = self.domain.column();
                self.domain.constant(None, REALS[round] * (1.0 + salt as f32 / 64.0), &mut other);
                self.domain.merge(&slots, &other, &mut self.reals[to.reg as usize]);
            }
            Scalar::I32 | Scalar::U32 => {
                slots.merge(&[WORDS[round].wrapping_add(salt); SLOTS], &mut self.words[to.reg as usize]);
            }
            Scalar::Bool => slots.merge(&[(round as u32 + salt) % 2; SLOTS], &mut self.words[to.reg as usize]),
        }
    }

    /// Marks a variable as having a value in some slots.
    pub(super) fn assign(&mut self, to: Register, slots: Mask) {
        let assigned = &mut self.assigned[to.file() as usize];
        if !assigned.is_empty()
            && let Some(assigned) = assigned.get_mut(&to.reg)
        {
            *assigned = assigned.or(slots);
        }
    }
}

/// All that came out of a chunk, slot by slot, to be compared.
type ChunkOutcome = Vec<Vec<u64>>;

impl Machine<'_, Binary64> {
    /// For each of some invocations, at most [`SLOTS`], the undefined value that an output depends on. `any` tries NaN
    /// and infinity as well, which even a product with 0 passes on.
    ///
    /// # Panics
    /// When the batch has no such invocation: a defect of the caller.
    pub fn dependences(&mut self, batch: &Batch, invocations: &[usize], any: bool) -> Vec<Option<Dependence>> {
        self.probe = Some(Probe::default());
        let slots = self.run_some(batch, invocations);
        let before = self.outcome(slots);
        let events = self.probe.take().map_or_else(Vec::new, |probe| probe.events);
        let candidates = events.iter().fold(Mask::NONE, |all, event| all.or(event.slots));
        let rounds = if any { REALS.len() } else { FINITE };
        let depends = self.changed(batch, invocations, &before, rounds, candidates, None);
        let mut found: Vec<Option<Dependence>> = vec![None; slots];
        let mut rest = depends;
        let of = |event: &UndefinedEvent| Dependence { of: event.of, args: event.args.clone() };
        // Where a slot came upon several, the first that matters alone is named.
        for event in events.iter().take(ALONE) {
            let others = events.iter().filter(|other| other.of != event.of);
            let shared = others.fold(Mask::NONE, |all, other| all.or(other.slots)).and(event.slots).and(rest);
            let only = Some((event.of.kind, event.of.site));
            let alone = event.slots.minus(shared).or(self.changed(batch, invocations, &before, rounds, shared, only));
            alone.and(rest).slots().for_each(|slot| found[slot] = Some(of(event)));
            rest = rest.minus(alone);
        }
        for slot in rest.slots() {
            found[slot] = events.iter().find(|event| event.slots.has(slot)).map(of);
        }
        // A store outside of its array may write to anything, also to what outputs of others are made of.
        if events.iter().any(|event| event.of.kind == HazardKind::Index) {
            let stores = self.executable.stray_stores();
            for event in events.iter().filter(|event| event.of.strays(&stores)) {
                event.slots.slots().for_each(|slot| found[slot] = found[slot].take().or_else(|| Some(of(event))));
            }
        }
        self.take_findings();
        found
    }

    /// For each of some invocations, at most [`SLOTS`], the first operation of those that `counts` picks whose value is
    /// undefined, whether or not an output depends on it.
    ///
    /// # Panics
    /// When the batch has no such invocation: a defect of the caller.
    pub fn undefined_on_the_way(
        &mut self,
        batch: &Batch,
        invocations: &[usize],
        counts: &dyn Fn(&Undefined) -> bool,
    ) -> Vec<Option<Dependence>> {
        self.probe = Some(Probe::default());
        let slots = self.run_some(batch, invocations);
        let events = self.probe.take().map_or_else(Vec::new, |probe| probe.events);
        self.take_findings();
        let first = |slot: usize| events.iter().find(|event| event.slots.has(slot) && counts(&event.of));
        (0..slots).map(|slot| first(slot).map(|event| Dependence { of: event.of, args: event.args.clone() })).collect()
    }

    /// The slots among `rest` in which something changes with other values.
    fn changed(
        &mut self,
        batch: &Batch,
        invocations: &[usize],
        before: &ChunkOutcome,
        rounds: usize,
        mut rest: Mask,
        only: Option<(HazardKind, Site)>,
    ) -> Mask {
        let mut changed = Mask::NONE;
        for round in 1..=rounds {
            if rest.is_empty() || interrupt::asked() {
                break;
            }
            self.probe = Some(Probe { round, only, events: Vec::new() });
            let slots = self.run_some(batch, invocations);
            let after = self.outcome(slots);
            let other = Mask::where_(|slot| slot < slots && before[slot] != after[slot]).and(rest);
            changed = changed.or(other);
            rest = rest.minus(other);
        }
        self.probe = None;
        changed
    }

    fn outcome(&self, slots: usize) -> ChunkOutcome {
        let flags = |slot: usize| {
            let flags = self.flags()[slot];
            u64::from(flags.has(HazardKind::Fuel)) | u64::from(flags.has(HazardKind::Killed)) << 1
        };
        let shape = |slot: usize| [flags(slot), u64::from(self.emitted()[slot]), u64::from(self.ended()[slot])];
        let mut all: ChunkOutcome = (0..slots).map(|slot| shape(slot).to_vec()).collect();
        for vertex in 0..self.room() {
            for word in 0..self.width() {
                let column = self.output(vertex, word);
                for (slot, all) in all.iter_mut().enumerate() {
                    if self.is_emitting() && vertex as u32 >= self.emitted()[slot] {
                        continue;
                    }
                    all.push(match column {
                        // Zeros are one number, and so are all that are none.
                        OutputColumn::Real(column) => match column.values()[slot] {
                            x if x.is_nan() => f64::NAN.to_bits(),
                            x => (x + 0.0).to_bits(),
                        },
                        OutputColumn::Word(words) => u64::from(words[slot]),
                    });
                }
            }
        }
        all
    }
}

impl Undefined {
    /// True where a language says what the operation gives all the same.
    fn is_defined_in(&self, written: Written) -> bool {
        match (written, self.kind) {
            // WGSL (17.9, `pack2x16float`, `quantizeToF16`): indeterminate. The conversion of GLSL and SPIR-V has infinity.
            (_, HazardKind::Argument) => self.what == Some(Guarded::Half) && written != Written::Wgsl,
            (Written::Glsl, _) => false,
            // WGSL (15.7.6) clamps numbers and says of NaN alone that its value is indeterminate, which the machine sorts
            // out. SPIR-V (`OpConvertFToS`) and HLSL leave the conversion of what does not fit undefined.
            (_, HazardKind::Conversion) => false,
            // SPIR-V (`OpSDiv`, `OpSRem`) and HLSL leave both undefined; WGSL (8.7) gives the dividend.
            (_, HazardKind::DivisionByZero | HazardKind::Quotient) => written == Written::Wgsl,
            (Written::Wgsl | Written::SpirV | Written::SpirVAssembly | Written::Hlsl | Written::Slang, kind) => {
                kind.is_defined_by_wgsl()
            }
        }
    }

    /// True for one of these stores, outside of its array.
    pub fn strays(&self, stores: &HashSet<Site>) -> bool {
        self.kind == HazardKind::Index && stores.contains(&self.site)
    }

    /// Why the value is undefined, with the arguments; a clause without a full stop.
    pub fn why(&self, args: &[f64]) -> String {
        let arg = |k: usize| args.get(k).copied().unwrap_or(f64::NAN);
        let (a, b) = (arg(0), arg(1));
        match self.kind {
            HazardKind::Index if args.is_empty() => "the place is outside of the texture".to_owned(),
            HazardKind::Index => format!("index {a} is outside of 0 to {}", b - 1.0),
            HazardKind::DivisionByZero => format!("{a} is divided by zero"),
            HazardKind::Quotient => format!("{a} / {b} does not fit 32 bits"),
            HazardKind::Remainder => format!("`%` has a negative operand: {a} % {b}"),
            HazardKind::Shift => format!("a shift by {b} bits, where 0 to 31 are defined"),
            HazardKind::Conversion if a.is_nan() => "nan is converted to an integer".to_owned(),
            HazardKind::Conversion => format!("{a:?} is converted to an integer type that does not hold it"),
            HazardKind::BitField => format!("a bit field at offset {a} with {b} bits reaches outside of 32 bits"),
            HazardKind::Argument => self.what.map_or_else(String::new, |what| outside(what, a, b)),
            HazardKind::Unset => "it is read before it has a value".to_owned(),
            HazardKind::NoReturn => "the function ends without `return`".to_owned(),
            HazardKind::Overlap => {
                "two `out` arguments are one variable, and the order in which they are copied back is open".to_owned()
            }
            HazardKind::Divergence => "invocations of a workgroup do not come to a barrier together".to_owned(),
            HazardKind::Overflow | HazardKind::Fuel | HazardKind::Killed | HazardKind::GivenUp => {
                "the operation leaves its range".to_owned()
            }
        }
    }
}

/// Why a function is undefined at its arguments.
fn outside(what: Guarded, x: f64, y: f64) -> String {
    match what {
        Guarded::Sqrt => format!("`sqrt` of {x:?}, a negative number"),
        Guarded::InverseSqrt => format!("`inversesqrt` of {x:?}, which is not above 0"),
        Guarded::Log => format!("`log` of {x:?}, which is not above 0"),
        Guarded::Log2 => format!("`log2` of {x:?}, which is not above 0"),
        Guarded::Asin => format!("`asin` of {x:?}, which is outside of -1 to 1"),
        Guarded::Acos => format!("`acos` of {x:?}, which is outside of -1 to 1"),
        Guarded::Acosh => format!("`acosh` of {x:?}, which is below 1"),
        Guarded::Atanh => format!("`atanh` of {x:?}, which is not between -1 and 1"),
        Guarded::Pow if x < 0.0 => format!("`pow` of {x:?}, a negative base"),
        Guarded::Pow => format!("`pow` of 0 to the power of {y:?}, which is not above 0"),
        Guarded::Atan2 => "`atan` of 0, 0".to_owned(),
        Guarded::Half => format!("{x:?} becomes a number of binary16, which ends at 65504"),
        Guarded::Clamp => format!("`clamp` with a lower end of {x:?} above the upper end of {y:?}"),
        Guarded::SmoothStep => {
            format!("`smoothstep` with edges {x:?} and {y:?}, the first of which is not below the second")
        }
    }
}
