//! Dispatches: workgroups whose invocations share memory and wait for each other.
//!
//! The invocations of a workgroup go through the instructions side by side, all of them through one before any is at the
//! next one. A program in which no two of them meet at a word without a barrier or an atomic function between gives the
//! same in any order, and where two meet, that is what is found ([`Wrong::Race`]). Workgroups run one after the other.
//!
//! ```text
//! Executable ─ machines, SLOTS invocations each ─┐
//! buffers ─▶ contents, word by word ─────────────┴─ run ─▶ Outcome: contents behind it, incidents
//! ```
//!
//! So barriers cost nothing, and no invocation needs a stack of its own. The price: an invocation that waits in a
//! loop for another one of its workgroup never ends.

mod access;
mod cells;
mod contents;
mod depends;
mod epochs;
mod memory;
mod packed;
mod results;
mod shape;
mod subgroup;
#[cfg(test)]
mod tests;
mod texels;
mod turns;
mod whole;

use naga::BuiltIn;

use super::code::{Executable, Inst};
use super::control::Breakable;
use super::domain::Site;
use super::machine::Machine;
use super::meaning::{Finding, HazardKind};
use super::plain::{Column, Number, Plain};
use super::slots::{Mask, SLOTS};
use crate::lane::interrupt;

pub use cells::{InMemory, RealCombine};
pub use depends::{Depends, Sources, Uses};
pub use memory::{Access, Incident, Party, Wrong};
pub use packed::Bits;
pub use shape::{Array, Leaf, MemoryShape, Space};
pub use subgroup::WIDTH;
pub use texels::{Channel, Texels};
pub use turns::{Turn, Turns};
pub use whole::{Ran, Whole};

pub(super) use access::{Combine, Extent, MemoryAccess, MemoryOp, Step};
use epochs::Epochs;
use memory::{Contents, Epoch, Log};
pub(super) use subgroup::{Fold, From, Subgroup, SubgroupOp};
use turns::Early;

/// A dispatch.
#[derive(Clone, Debug)]
pub struct Dispatch<'b> {
    /// Invocations of a workgroup along x, y and z.
    pub size: [u32; 3],
    /// Workgroups along x, y and z.
    pub groups: [u32; 3],
    /// What each memory holds before it, in the order of [`Executable::memories`]; of a workgroup's memory nothing.
    pub buffers: &'b [Buffer],
    /// The memory of a workgroup begins with zeros (WGSL, 7.2), or with anything.
    pub zeroed: bool,
    /// What a load outside of its array gives: any bits (WGSL, 7.6.1).
    pub outside: u32,
    /// Rounds of loops that one invocation may go through.
    pub fuel: u32,
    /// Rounds of loops that all invocations together may go through.
    pub work: u64,
    /// Whether it is watched who touches which word; without that no race is found.
    pub watched: bool,
    /// Another order of the workgroups, and of the invocations of each at its memory, for each number; 0 for theirs.
    pub order: u64,
    /// An order in which who comes first says more than by `order`.
    pub turns: Turns,
    /// Invocations of a subgroup: a power of two, at most 128.
    pub subgroup: u32,
}

/// The place of the k-th of some things in an order; each number but 0 names one in which others come first.
fn placed(k: usize, count: usize, order: u64) -> usize {
    if order == 0 || count < 2 {
        return k;
    }
    let first = (order % count as u64) as usize;
    let backwards = order / count as u64 % 2 == 1;
    let k = if backwards { count - 1 - k } else { k };
    (k + first) % count
}

/// The places along x, y and z of what is counted along x first.
pub fn apart(n: u32, of: [u32; 3]) -> [u32; 3] {
    [n % of[0], n / of[0] % of[1], n / of[0] / of[1]]
}

/// What a host fills.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Buffer {
    /// Its words.
    pub words: Vec<u32>,
    /// Elements of the array at its end.
    pub elements: u32,
    /// Texels of an image along each axis.
    pub sides: [u32; 3],
}

/// What a dispatch did.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Words of each memory behind it.
    pub contents: Vec<Vec<u32>>,
    /// Words of each memory up to the last one that was touched.
    pub reach: Vec<usize>,
    /// Whether anything was stored to a memory.
    pub changed: Vec<bool>,
    /// What is wrong with how memory is used, one for each place.
    pub incidents: Vec<Incident>,
    /// Where invocations left the range of a type, by place; the invocation is counted through all workgroups.
    pub findings: Vec<Finding>,
    /// The first decision that could have gone the other way; none in a domain that does not look.
    pub doubted: Option<Site>,
    /// How much work it was: rounds of loops, each for as many invocations as go side by side.
    pub rounds: u64,
    /// False when the limit of work was met, or the run was asked to end.
    pub whole: bool,
}

impl Executable {
    /// Memory that invocations share.
    pub fn memories(&self) -> &[MemoryShape] {
        &self.memories
    }

    /// Runs a dispatch in numbers of one type.
    pub fn dispatch<N: Number>(&self, dispatch: &Dispatch<'_>) -> Outcome
    where
        Plain<N>: InMemory<Column = Column<N>, Cell = N>,
    {
        self.dispatch_in(dispatch, Plain::<N>::default).0
    }

    /// Runs a dispatch in a domain, with what each memory holds of it behind the dispatch.
    pub fn dispatch_in<D: InMemory>(
        &self,
        dispatch: &Dispatch<'_>,
        domain: impl Fn() -> D,
    ) -> (Outcome, Vec<Left<D::Cell>>) {
        let size: u32 = dispatch.size.iter().product();
        let machines = (0..(size as usize).div_ceil(SLOTS)).map(|_| Machine::new(self, domain(), 0)).collect();
        let fill = |(shape, buffer): (&MemoryShape, &Buffer)| match shape.space {
            Space::Workgroup => {
                let empty = Buffer { words: vec![0; shape.words as usize], ..Buffer::default() };
                Contents::new(shape, empty, dispatch.zeroed, dispatch.watched)
            }
            Space::Storage { .. } | Space::Uniform => {
                let mut buffer = buffer.clone();
                shape.narrow(&mut buffer.words);
                Contents::new(shape, buffer, true, dispatch.watched)
            }
        };
        let contents = self.memories.iter().zip(dispatch.buffers).map(fill).collect();
        let mut group = Workgroup {
            executable: self,
            dispatch,
            machines,
            contents,
            log: Log::default(),
            number: 0,
            epochs: Epochs::default(),
            subgroup_epochs: Vec::new(),
            work: dispatch.work,
            rounds: 0,
            findings: Vec::new(),
            doubted: None,
            astray: None,
            doubts_noticed: false,
            turns: dispatch.turns.invocations.order(size as usize),
            early: Early::default(),
        };
        let count: u32 = dispatch.groups.iter().product();
        let turns = dispatch.turns.groups.order(count as usize);
        for k in 0..count as usize {
            if !group.goes_on() {
                break;
            }
            let number = turns.as_ref().map_or_else(|| placed(k, count as usize, dispatch.order), |turns| turns[k]);
            group.run(number as u32);
        }
        let whole = group.goes_on();
        let reach = group.contents.iter().map(|contents| contents.reach).collect();
        let changed = group.contents.iter().map(|contents| contents.is_changed).collect();
        let (mut contents, mut left) = (Vec::new(), Vec::new());
        for memory in group.contents {
            let (bits, known) = memory.into_parts();
            contents.push(bits);
            left.push(known);
        }
        let (incidents, findings) = (group.log.into_incidents(), group.findings);
        let (doubted, rounds) = (group.doubted, group.rounds);
        (Outcome { contents, reach, changed, incidents, findings, doubted, rounds, whole }, left)
    }
}

/// What a memory holds behind a dispatch, in the numbers of a domain.
#[derive(Clone, Debug)]
pub struct Left<C> {
    /// Each word as a number; empty where bits say it all.
    cells: Vec<C>,
    /// True for words of which nothing is known, for a decision before them could have gone the other way; empty where there
    /// are none.
    open: Vec<bool>,
}

impl<C: Copy> Left<C> {
    /// A word as a number; `None` where its bits are one.
    pub fn cell(&self, word: usize) -> Option<C> {
        self.cells.get(word).copied()
    }

    /// True when nothing is known of a word.
    pub fn is_open(&self, word: usize) -> bool {
        self.open.get(word).is_some_and(|&open| open)
    }
}

/// A workgroup after the other.
struct Workgroup<'e, 'd, D: InMemory> {
    executable: &'e Executable,
    dispatch: &'d Dispatch<'d>,
    machines: Vec<Machine<'e, D>>,
    contents: Vec<Contents<D>>,
    log: Log,
    /// Number of the workgroup.
    number: u32,
    /// Barriers that it is behind.
    epochs: Epochs,
    /// Barriers that each of its subgroups is behind.
    subgroup_epochs: Vec<u32>,
    /// Rounds of loops that are left.
    work: u64,
    /// Rounds so far, of all machines.
    rounds: u64,
    findings: Vec<Finding>,
    /// The first decision that could have gone the other way.
    doubted: Option<Site>,
    /// From then on, memories in which it may have been written elsewhere.
    astray: Option<Vec<bool>>,
    /// It was in this workgroup.
    doubts_noticed: bool,
    /// Its invocations in the order in which they come; `None` for that of their numbers.
    turns: Option<Vec<usize>>,
    /// What one that runs ahead still sees.
    early: Early,
}

impl<'e, D: InMemory> Workgroup<'e, '_, D> {
    fn goes_on(&self) -> bool {
        self.work > 0 && !interrupt::asked()
    }

    fn run(&mut self, number: u32) {
        self.number = number;
        self.epochs = Epochs::default();
        self.subgroup_epochs.clear();
        self.doubts_noticed = false;
        self.early.meet();
        let size: usize = self.dispatch.size.iter().map(|&n| n as usize).product();
        for (contents, shape) in self.contents.iter_mut().zip(&self.executable.memories) {
            if shape.space == Space::Workgroup {
                let empty = Buffer { words: vec![0; shape.words as usize], ..Buffer::default() };
                *contents = Contents::new(shape, empty, self.dispatch.zeroed, self.dispatch.watched);
            }
        }
        for (k, machine) in self.machines.iter_mut().enumerate() {
            machine.prepare((size - k * SLOTS).min(SLOTS));
            machine.fuel = [self.dispatch.fuel; SLOTS];
        }
        self.rounds += self.machines.len() as u64;
        self.fill_numbers();
        let executable = self.executable;
        self.block(&executable.body);
        self.notice_doubts();
        for (k, machine) in self.machines.iter_mut().enumerate() {
            for finding in machine.take_findings() {
                let invocation = number as usize * size + k * SLOTS + finding.invocation;
                match self.findings.iter_mut().find(|own| own.kind == finding.kind && own.site == finding.site) {
                    Some(own) => own.count += finding.count,
                    None => self.findings.push(Finding { invocation, ..finding }),
                }
            }
        }
    }

    /// Gives the arguments of the entry point their values.
    fn fill_numbers(&mut self) {
        let (size, groups) = (self.dispatch.size, self.dispatch.groups);
        let group = apart(self.number, groups);
        let width = self.dispatch.subgroup;
        for (k, machine) in self.machines.iter_mut().enumerate() {
            machine.invocations = std::array::from_fn(|slot| slot);
            for (built_in, registers) in &self.executable.numbers {
                for (axis, register) in registers.iter().enumerate() {
                    let word = |slot: usize| {
                        let index = (k * SLOTS + slot) as u32;
                        let local = apart(index, size);
                        match built_in {
                            BuiltIn::LocalInvocationIndex => index,
                            BuiltIn::LocalInvocationId => local[axis],
                            BuiltIn::GlobalInvocationId => {
                                group[axis].wrapping_mul(size[axis]).wrapping_add(local[axis])
                            }
                            BuiltIn::WorkGroupId => group[axis],
                            BuiltIn::WorkGroupSize => size[axis],
                            BuiltIn::NumWorkGroups => groups[axis],
                            BuiltIn::SubgroupSize => width,
                            BuiltIn::SubgroupInvocationId => index % width,
                            BuiltIn::SubgroupId => index / width,
                            BuiltIn::NumSubgroups => size.iter().product::<u32>().div_ceil(width),
                            _ => 0,
                        }
                    };
                    machine.words[register.reg as usize] = std::array::from_fn(word);
                }
            }
        }
    }

    fn masks(&self) -> Vec<Mask> {
        self.machines.iter().map(|machine| machine.active).collect()
    }

    fn set(&mut self, masks: impl IntoIterator<Item = Mask>) {
        self.machines.iter_mut().zip(masks).for_each(|(machine, mask)| machine.active = mask);
    }

    fn is_idle(&self) -> bool {
        self.machines.iter().all(|machine| machine.active.is_empty())
    }

    fn block(&mut self, block: &'e [Inst]) {
        for inst in block {
            if self.is_idle() {
                return;
            }
            self.step(inst);
        }
    }

    fn step(&mut self, inst: &'e Inst) {
        match inst {
            Inst::Memory(access) => self.access(access),
            Inst::Length { memory, of, to } => {
                let count = self.contents[*memory as usize].extent(*of);
                self.machines.iter_mut().for_each(|machine| machine.words[*to as usize] = [count; SLOTS]);
            }
            Inst::Barrier { orders, .. } if *orders == naga::Barrier::SUB_GROUP => self.barrier_of_subgroups(),
            Inst::Barrier { orders, site } => {
                self.epochs.pass(*orders);
                self.early.meet();
                self.log.fenced(self.number, *orders);
                self.barrier(*site);
            }
            Inst::Fence { orders } => {
                self.epochs.fence(*orders);
                self.log.fenced(self.number, *orders);
            }
            Inst::Subgroup(inst) => self.subgroup(inst),
            Inst::If { condition, accept, reject } => {
                let before = self.masks();
                let condition: Vec<Mask> =
                    self.machines.iter().map(|machine| Mask::of(&machine.words[*condition as usize])).collect();
                let both = || before.iter().zip(&condition);
                self.set(both().map(|(before, condition)| before.and(*condition)));
                self.block(accept);
                let accepted = self.masks();
                self.set(both().map(|(before, condition)| before.minus(*condition)));
                self.block(reject);
                let rejected = self.masks();
                self.set(accepted.iter().zip(rejected).map(|(a, b)| a.or(b)));
            }
            Inst::Switch { selector, cases } => self.switch(*selector, cases),
            Inst::Loop { body, continuing, break_if, site } => self.repeat(body, continuing, *break_if, *site),
            Inst::Call { body } => {
                let before = self.masks();
                self.block(body);
                for (machine, before) in self.machines.iter_mut().zip(before) {
                    machine.active = before.minus(machine.stopped);
                }
            }
            leaf => {
                for machine in &mut self.machines {
                    if !machine.active.is_empty() {
                        machine.step(leaf);
                    }
                }
            }
        }
    }

    fn switch(&mut self, selector: u32, cases: &'e [super::code::Case]) {
        let before = self.masks();
        let selectors: Vec<_> = self.machines.iter().map(|machine| machine.words[selector as usize]).collect();
        let matching = |k: usize, value: u32| Mask::where_(|slot| selectors[k][slot] == value).and(before[k]);
        let named = |k: usize| {
            let values = cases.iter().filter_map(|case| case.value);
            values.fold(Mask::NONE, |all, value| all.or(matching(k, value)))
        };
        self.machines.iter_mut().for_each(|machine| machine.breakable.push(Breakable::default()));
        let count = self.machines.len();
        let (mut falling, mut done) = (vec![Mask::NONE; count], vec![Mask::NONE; count]);
        for case in cases {
            let own = |k: usize| case.value.map_or_else(|| before[k].minus(named(k)), |value| matching(k, value));
            let masks: Vec<Mask> = (0..count).map(|k| falling[k].or(own(k))).collect();
            self.set(masks);
            self.block(&case.body);
            for k in 0..count {
                let left = self.machines[k].active;
                if case.fall_through {
                    falling[k] = left;
                } else {
                    falling[k] = Mask::NONE;
                    done[k] = done[k].or(left);
                }
            }
        }
        let has_default = cases.iter().any(|case| case.value.is_none());
        for k in 0..count {
            let left = self.machines[k].breakable.pop().unwrap_or_default().left;
            let unmatched = if has_default { Mask::NONE } else { before[k].minus(named(k)) };
            self.machines[k].active = done[k].or(falling[k]).or(left).or(unmatched);
        }
    }

    fn repeat(&mut self, body: &'e [Inst], continuing: &'e [Inst], break_if: Option<u32>, site: Site) {
        let round = || Breakable { left: Mask::NONE, next: Some(Mask::NONE) };
        self.machines.iter_mut().for_each(|machine| machine.breakable.push(round()));
        while !self.is_idle() {
            let goes_on = self.goes_on();
            for machine in &mut self.machines {
                let dry = Mask::where_(|slot| machine.fuel[slot] == 0).and(machine.active);
                if !dry.is_empty() {
                    machine.report(HazardKind::Fuel, site, dry);
                }
                let stopped = if goes_on { dry } else { machine.active };
                machine.stopped = machine.stopped.or(stopped);
                machine.active = machine.active.minus(stopped);
                self.work = self.work.saturating_sub(machine.active.count() as u64);
                self.rounds += u64::from(!machine.active.is_empty());
                for (slot, fuel) in machine.fuel.iter_mut().enumerate() {
                    *fuel -= u32::from(machine.active.has(slot));
                }
            }
            self.block(body);
            for machine in &mut self.machines {
                let next =
                    machine.breakable.last_mut().and_then(|b| b.next.as_mut()).map_or(Mask::NONE, std::mem::take);
                machine.active = machine.active.or(next);
            }
            self.block(continuing);
            let Some(reg) = break_if else { continue };
            for machine in &mut self.machines {
                let leaves = Mask::of(&machine.words[reg as usize]).and(machine.active);
                if let Some(around) = machine.breakable.last_mut() {
                    around.left = around.left.or(leaves);
                }
                machine.active = machine.active.minus(leaves);
            }
        }
        for machine in &mut self.machines {
            machine.active = machine.breakable.pop().unwrap_or_default().left;
        }
    }

    /// Orders what the invocations of each subgroup did that are here (GL_KHR_shader_subgroup_basic).
    fn barrier_of_subgroups(&mut self) {
        let width = self.dispatch.subgroup as usize;
        let count = (self.machines.len() * SLOTS).div_ceil(width);
        self.subgroup_epochs.resize(count, 0);
        for (k, epoch) in self.subgroup_epochs.iter_mut().enumerate() {
            let here = |n: usize| self.machines.get(n / SLOTS).is_some_and(|machine| machine.active.has(n % SLOTS));
            *epoch += u32::from((k * width..(k + 1) * width).any(here));
        }
    }

    /// When an invocation touches memory.
    fn now(&self, local: usize) -> Epoch {
        let subgroup = local / self.dispatch.subgroup as usize;
        let within = self.subgroup_epochs.get(subgroup).copied().unwrap_or(0);
        Epoch { barriers: self.epochs.now(), subgroup: subgroup as u32, within }
    }

    /// Every invocation of the workgroup has to be here (WGSL, 17.11; GLSL 4.60, 8.16).
    fn barrier(&mut self, site: Site) {
        let find = |is: &dyn Fn(&Machine<'e, D>) -> Mask| {
            let slots = |(k, machine): (usize, &Machine<'e, D>)| Some(k * SLOTS + is(machine).slots().next()?);
            self.machines.iter().enumerate().find_map(slots)
        };
        // One that was stopped for its loop is told there.
        let missing = find(&|machine| Mask::first(machine.slots).minus(machine.active).minus(machine.stopped));
        let (Some(missing), Some(there)) = (missing, find(&|machine| machine.active)) else { return };
        let party = |local: usize| Party { group: self.number, local: local as u32, access: Access::Read, site };
        let incident = Incident {
            what: Wrong::Divergence,
            memory: None,
            word: None,
            index: None,
            who: party(missing),
            other: Some(party(there)),
            count: 1,
        };
        self.log.report(incident);
    }
}
