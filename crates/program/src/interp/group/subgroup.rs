//! Subgroups: invocations of a workgroup that work side by side and see each other's values.
//!
//! How many make one is up to the device: a [dispatch](super::Dispatch::subgroup) states it. Neighbours by
//! `local_invocation_index` are together, as on every device of today; WGSL and Vulkan leave that open.

use super::super::code::{File, Inst, Reg, Register, Touch};
use super::super::domain::Site;
use super::super::slots::{Mask, SLOTS};
use super::cells::{InMemory, RealCombine};
use super::memory::{Access, Incident, Party, Wrong};
use super::{Executable, Workgroup};
use base::value::Scalar;

/// Invocations of a subgroup where nothing else is said; a divisor of [`SLOTS`], as all widths are.
pub const WIDTH: u32 = 32;

/// How the values of a subgroup become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::interp) enum Fold {
    Add,
    Multiply,
    Min,
    Max,
    And,
    Or,
    Xor,
}

/// Where an invocation takes its value from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::interp) enum From {
    /// The first one.
    First,
    /// One by its number.
    Number,
    /// One that is so much farther.
    Down,
    /// One that is so much nearer.
    Up,
    /// One whose number has other bits.
    Xor,
    /// One of the same four.
    OfFour,
    /// One of the same four whose number has other bits.
    Swapped(u32),
}

/// What is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::interp) enum SubgroupOp {
    /// Bits of the invocations for which something holds.
    Ballot,
    /// One value of all.
    All(Fold),
    /// One value of those up to this one, this one included.
    UpTo(Fold),
    /// One value of those before this one.
    Before(Fold),
    /// The value of another one.
    Take(From),
}

/// An operation of a subgroup.
#[derive(Clone, Debug)]
pub(in crate::interp) struct Subgroup {
    pub op: SubgroupOp,
    /// Components of the value that each invocation gives.
    pub args: Vec<Register>,
    /// Which one is asked.
    pub number: Option<Reg>,
    pub to: Vec<Register>,
    pub site: Site,
}

impl Subgroup {
    /// Calls `f` for each register that the instruction touches.
    pub(in crate::interp) fn registers(&mut self, f: &mut impl FnMut(Touch, File, &mut Reg)) {
        self.args.iter_mut().for_each(|from| f(Touch::Read, from.file(), &mut from.reg));
        self.number.iter_mut().for_each(|reg| f(Touch::Read, File::Word, reg));
        self.to.iter_mut().for_each(|to| f(Touch::Write, to.file(), &mut to.reg));
    }
}

/// A value of one invocation.
#[derive(Clone, Copy)]
enum SubgroupValue<C> {
    Word(u32),
    Real(C),
}

impl Executable {
    /// True when it has operations of subgroups, or asks how many invocations one has.
    pub fn has_subgroups(&self) -> bool {
        let mut any = self.numbers.iter().any(|(built_in, _)| is_of_subgroups(*built_in));
        super::super::shape::each(&self.body, &mut |inst| any |= matches!(inst, Inst::Subgroup(_)));
        any
    }

    /// The place of the first operation of a subgroup.
    pub fn subgroup_site(&self) -> Option<Site> {
        let mut first = None;
        super::super::shape::each(&self.body, &mut |inst| {
            if let Inst::Subgroup(inst) = inst {
                first.get_or_insert(inst.site);
            }
        });
        first
    }
}

/// True for what an invocation is told of its subgroup.
pub(super) fn is_of_subgroups(built_in: naga::BuiltIn) -> bool {
    use naga::BuiltIn::{NumSubgroups, SubgroupId, SubgroupInvocationId, SubgroupSize};
    matches!(built_in, NumSubgroups | SubgroupId | SubgroupInvocationId | SubgroupSize)
}

impl<'e, D: InMemory> Workgroup<'e, '_, D> {
    /// Carries out an operation in all subgroups.
    pub(super) fn subgroup(&mut self, inst: &'e Subgroup) {
        let width = self.dispatch.subgroup as usize;
        let size: usize = self.dispatch.size.iter().map(|&n| n as usize).product();
        let mut cells = vec![vec![[D::cell(0); SLOTS]; inst.to.len()]; self.machines.len()];
        for first in (0..size).step_by(width) {
            let all: Vec<usize> = (first..size.min(first + width)).collect();
            let here: Vec<usize> = all.iter().copied().filter(|&k| self.is_here(k)).collect();
            if here.is_empty() {
                continue;
            }
            self.note_missing(inst.site, &all, &here);
            if here.iter().any(|&k| self.machines[k / SLOTS].domain.doubted(k % SLOTS).is_some()) {
                for &k in &here {
                    let mut only = Mask::NONE;
                    only.insert(k % SLOTS);
                    self.machines[k / SLOTS].domain.doubt(inst.site, &only);
                }
            }
            for (component, to) in inst.to.iter().enumerate() {
                let results = self.results(inst, component, first, &here);
                for (&k, result) in here.iter().zip(results) {
                    match result {
                        SubgroupValue::Word(word) => self.machines[k / SLOTS].words[to.reg as usize][k % SLOTS] = word,
                        SubgroupValue::Real(cell) => cells[k / SLOTS][component][k % SLOTS] = cell,
                    }
                }
            }
        }
        for (machine, cells) in self.machines.iter_mut().zip(&cells) {
            let active = machine.active;
            for (to, cells) in inst.to.iter().zip(cells).filter(|(to, _)| to.file() == File::Real) {
                let mut out = std::mem::take(&mut machine.reals[to.reg as usize]);
                machine.domain.put(&active, cells, &mut out);
                machine.reals[to.reg as usize] = out;
            }
        }
    }

    fn is_here(&self, k: usize) -> bool {
        self.machines[k / SLOTS].active.has(k % SLOTS)
    }

    /// One that is missing where others of its subgroup are. One that was stopped for its loop is told there.
    fn note_missing(&mut self, site: Site, all: &[usize], here: &[usize]) {
        let stopped = |k: usize| self.machines[k / SLOTS].stopped.has(k % SLOTS);
        let missing = all.iter().copied().find(|&k| !self.is_here(k) && !stopped(k));
        let (Some(missing), Some(&there)) = (missing, here.first()) else { return };
        let party = |local: usize| Party { group: self.number, local: local as u32, access: Access::Read, site };
        let (who, other) = (party(missing), Some(party(there)));
        let what = Wrong::Apart;
        self.log.report(Incident { what, memory: None, word: None, index: None, who, other, count: 1 });
    }

    fn value(&self, from: Register, k: usize) -> SubgroupValue<D::Cell> {
        let machine = &self.machines[k / SLOTS];
        match from.file() {
            File::Word => SubgroupValue::Word(machine.words[from.reg as usize][k % SLOTS]),
            File::Real => SubgroupValue::Real(machine.domain.kept(&machine.reals[from.reg as usize], k % SLOTS)),
        }
    }

    /// What each invocation that is here gets of a component.
    fn results(&self, inst: &Subgroup, component: usize, first: usize, here: &[usize]) -> Vec<SubgroupValue<D::Cell>> {
        match inst.op {
            SubgroupOp::Ballot => {
                let holds = |k: &&usize| match self.value(inst.args[0], **k) {
                    SubgroupValue::Word(word) => word != 0,
                    SubgroupValue::Real(_) => false,
                };
                let bit = |k: &usize| (*k - first).checked_sub(32 * component).filter(|bit| *bit < 32);
                let bits = here.iter().filter(holds).filter_map(bit).fold(0, |bits, bit| bits | 1 << bit);
                vec![SubgroupValue::Word(bits); here.len()]
            }
            SubgroupOp::All(fold) => {
                let all = self.folded(inst.args[component], fold, here, None);
                vec![all.last().copied().unwrap_or(SubgroupValue::Word(0)); here.len()]
            }
            SubgroupOp::UpTo(fold) => self.folded(inst.args[component], fold, here, None),
            SubgroupOp::Before(fold) => {
                let neutral = u32::from(fold == Fold::Multiply);
                let neutral = match inst.args[component].file() {
                    File::Word => SubgroupValue::Word(neutral),
                    File::Real => SubgroupValue::Real(D::cell((neutral as f32).to_bits())),
                };
                let all = self.folded(inst.args[component], fold, here, Some(neutral));
                all[..here.len()].to_vec()
            }
            SubgroupOp::Take(from) => here.iter().map(|&k| self.taken(inst, component, first, here, k, from)).collect(),
        }
    }

    /// The values of those that are here, each combined with those before; behind one that is given, that one first.
    fn folded(
        &self,
        from: Register,
        fold: Fold,
        here: &[usize],
        neutral: Option<SubgroupValue<D::Cell>>,
    ) -> Vec<SubgroupValue<D::Cell>> {
        let mut all: Vec<SubgroupValue<D::Cell>> = neutral.into_iter().collect();
        let mut sum = D::Sum::default();
        let mut last: Option<SubgroupValue<D::Cell>> = None;
        for &k in here {
            let value = self.value(from, k);
            let next = match (last, value) {
                (Some(SubgroupValue::Word(a)), SubgroupValue::Word(b)) => {
                    SubgroupValue::Word(combined(fold, from.scalar, a, b))
                }
                (Some(SubgroupValue::Real(a)), SubgroupValue::Real(b)) => {
                    SubgroupValue::Real(self.machines[k / SLOTS].domain.combined(of_reals(fold), a, b, &mut sum))
                }
                _ => value,
            };
            last = Some(next);
            all.push(next);
        }
        all
    }

    /// What one takes from another; anything from one that is not there.
    fn taken(
        &self,
        inst: &Subgroup,
        component: usize,
        first: usize,
        here: &[usize],
        k: usize,
        from: From,
    ) -> SubgroupValue<D::Cell> {
        let own = (k - first) as u32;
        let number = inst.number.map_or(0, |reg| self.machines[k / SLOTS].words[reg as usize][k % SLOTS]);
        let wanted = match from {
            From::First => Some((here[0] - first) as u32),
            From::Number => Some(number),
            From::Down => own.checked_add(number),
            From::Up => own.checked_sub(number),
            From::Xor => Some(own ^ number),
            From::OfFour => Some(own / 4 * 4 + number % 4),
            From::Swapped(bits) => Some(own ^ bits),
        };
        let found = wanted.and_then(|wanted| here.iter().find(|&&k| (k - first) as u32 == wanted));
        let register = inst.args[component];
        match (found, register.file()) {
            (Some(&k), _) => self.value(register, k),
            (None, File::Word) => SubgroupValue::Word(self.dispatch.outside),
            (None, File::Real) => SubgroupValue::Real(D::cell(self.dispatch.outside)),
        }
    }
}

/// The function on real numbers. Products of reals are refused before.
fn of_reals(fold: Fold) -> RealCombine {
    match fold {
        Fold::Min => RealCombine::Min,
        Fold::Max => RealCombine::Max,
        _ => RealCombine::Add,
    }
}

fn combined(fold: Fold, scalar: Scalar, a: u32, b: u32) -> u32 {
    let signed = scalar == Scalar::I32;
    match fold {
        Fold::Add => a.wrapping_add(b),
        Fold::Multiply => a.wrapping_mul(b),
        Fold::Min if signed => a.cast_signed().min(b.cast_signed()).cast_unsigned(),
        Fold::Max if signed => a.cast_signed().max(b.cast_signed()).cast_unsigned(),
        Fold::Min => a.min(b),
        Fold::Max => a.max(b),
        Fold::And => a & b,
        Fold::Or => a | b,
        Fold::Xor => a ^ b,
    }
}
