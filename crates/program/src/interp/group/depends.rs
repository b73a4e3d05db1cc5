//! What a place of a dispatch depends on that invocations do not bring with them: what a host puts into memory.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use naga::BuiltIn;

use super::super::code::{Constant, Executable, Field, File, Inst, Reg, TEMPORARY, Touch, Word2};
use super::super::domain::{Binary, Site};
use super::access::{Extent, MemoryAccess, MemoryOp, Step};
use super::packed::{self, Bits, Words};
use super::shape::Space;

/// Sets of memories by their numbers, those whose contents and those whose sizes have a say; all from the 64th on are one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sources {
    contents: u64,
    /// Of these, the ones that have a say as they are: see [`Sources::is_folded`].
    raw: u64,
    sizes: u64,
    /// Memories whose atomic numbers have a say.
    atomics: u64,
    /// What invocations of a workgroup collected has a say.
    collected: bool,
}

impl Sources {
    fn one(memory: u32) -> Self {
        let bit = 1 << memory.min(63);
        Self { contents: bit, raw: bit, ..Self::default() }
    }

    fn atomic(memory: u32) -> Self {
        Self { atomics: 1 << memory.min(63), ..Self::default() }
    }

    fn size(memory: u32) -> Self {
        Self { sizes: 1 << memory.min(63), ..Self::default() }
    }

    /// What either has a say in.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            contents: self.contents | other.contents,
            raw: self.raw | other.raw,
            sizes: self.sizes | other.sizes,
            atomics: self.atomics | other.atomics,
            collected: self.collected | other.collected,
        }
    }

    /// True where only the numbers of the invocation, constants and lengths have a say.
    pub fn is_empty(self) -> bool {
        self.contents == 0
    }

    /// True when the contents of a memory have a say.
    pub fn has(self, memory: usize) -> bool {
        self.contents >> memory.min(63) & 1 == 1
    }

    /// True where contents have a say and all of them were brought down to a few numbers, as by `% 16u`, or rounded from a
    /// product of real numbers: whatever they are, indices that come of them repeat. A permutation is none of these.
    pub fn is_folded(self) -> bool {
        self.contents != 0 && self.raw == 0
    }

    /// True when an atomic number of any memory has a say, that of a workgroup too.
    pub fn is_by_atomics(self) -> bool {
        self.atomics != 0
    }

    /// True when an atomic number of a memory has a say.
    pub fn has_atomic(self, memory: usize) -> bool {
        self.atomics >> memory.min(63) & 1 == 1
    }

    /// True when the memory of a workgroup has a say, in which its invocations collect sums and the like.
    pub fn is_collected(self) -> bool {
        self.collected
    }

    /// True when the size of an image has a say.
    pub fn has_size(self, memory: usize) -> bool {
        self.sizes >> memory.min(63) & 1 == 1
    }
}

/// For each place of a program, the memories whose contents decide over where it leads and whether it is reached.
#[derive(Clone, Debug, Default)]
pub struct Depends {
    sites: HashMap<Site, (Sources, Sources)>,
    values: HashMap<Site, Sources>,
    /// Where places lead, and what is written there, without the conditions under which that was computed.
    aims: HashMap<Site, Sources>,
    carried: HashMap<Site, Sources>,
}

impl Depends {
    /// What decides over whether a place is reached, and where it leads.
    pub fn of(&self, site: Site) -> Sources {
        let (leads, reached) = self.sites.get(&site).copied().unwrap_or_default();
        leads.or(reached)
    }

    /// What has a say in what is written there, and in whether it is.
    pub fn value(&self, site: Site) -> Sources {
        self.values.get(&site).copied().unwrap_or_default()
    }

    /// What an index is computed from. A guard around that has no say, in contrast to [`Depends::leads`].
    pub fn aims(&self, site: Site) -> Sources {
        self.aims.get(&site).copied().unwrap_or_default()
    }

    /// What a value that is written is computed from, without the conditions around.
    pub fn carried(&self, site: Site) -> Sources {
        self.carried.get(&site).copied().unwrap_or_default()
    }

    /// What decides over where it leads, once it is reached.
    pub fn leads(&self, site: Site) -> Sources {
        self.sites.get(&site).copied().unwrap_or_default().0
    }
}

/// Memories that are asked for their length, or counted in.
#[derive(Clone, Debug, Default)]
pub struct Uses {
    /// Memories whose length the program reads.
    pub lengths: HashSet<u32>,
    /// Images whose size the program reads.
    pub sizes: HashSet<u32>,
    /// Memories on which atomic functions are used.
    pub atomics: HashSet<u32>,
    /// Words that are read at a fixed place: the memory, and the distance from its beginning.
    words: HashSet<(u32, u32)>,
    /// Memories that are read by an index.
    indexed: HashSet<u32>,
    /// Words that hold several numbers.
    packed: BTreeMap<(u32, u32), Vec<Bits>>,
    real_too: BTreeSet<(u32, u32)>,
    /// Where the program stores to what a host may read behind the dispatch.
    pub stores: Vec<Site>,
}

impl Uses {
    /// False for a word of a memory that no instruction reads: it pads out a structure, or the program has no use for it.
    pub fn reads(&self, memory: u32, word: u32) -> bool {
        self.indexed.contains(&memory) || self.names(memory, word)
    }

    /// True for a memory that is read by an index: it holds data, and not only numbers of the host.
    pub fn is_indexed(&self, memory: u32) -> bool {
        self.indexed.contains(&memory)
    }

    /// The bits of each number that the program finds in a word of a memory, from the lowest on; none where the word is one
    /// number. A word in an array stands for that of every element: it is given for the first one.
    pub fn packed(&self, memory: u32, word: u32) -> &[Bits] {
        self.packed.get(&(memory, word)).map_or(&[], |bits| bits)
    }

    /// True for a word, or a part of one, that the program makes a real number of.
    pub fn is_real_too(&self, memory: u32, word: u32) -> bool {
        self.real_too.contains(&(memory, word))
    }

    /// True for a word of a memory that an instruction reads by its name, and not by an index.
    pub fn names(&self, memory: u32, word: u32) -> bool {
        self.words.contains(&(memory, word))
    }
}

#[derive(Default)]
struct DependencePass {
    registers: HashMap<(File, Reg), Sources>,
    contents: HashMap<u32, Sources>,
    /// Conditions under which invocations leave a block early.
    left: Sources,
    sites: HashMap<Site, (Sources, Sources)>,
    values: HashMap<Site, Sources>,
    changed: bool,
    /// Conditions have no say in what is computed under them, only in what a variable holds behind them.
    plain: bool,
    /// Loops and calls around, behind which those go on that left them early.
    within: u32,
    constants: HashMap<Reg, u32>,
}

impl Executable {
    /// What each place depends on.
    pub fn depends(&self) -> Depends {
        let DependencePass { sites, values, .. } = self.dependences(false);
        let DependencePass { sites: aims, values: carried, .. } = self.dependences(true);
        let aims = aims.into_iter().map(|(site, (leads, _))| (site, leads)).collect();
        Depends { sites, values, aims, carried }
    }

    fn dependences(&self, plain: bool) -> DependencePass {
        let constants = self.constants.iter().filter_map(|constant| match constant {
            Constant::Word { to, value } => Some((*to, *value)),
            Constant::Real { .. } => None,
        });
        let mut pass = DependencePass { plain, constants: constants.collect(), ..DependencePass::default() };
        let mut body = self.draft.body.clone();
        loop {
            pass.changed = false;
            pass.left = Sources::default();
            pass.block(self, &mut body, Sources::default());
            if !pass.changed {
                return pass;
            }
        }
    }

    /// For each memory, whether real numbers that lie in memory have a say in where it is written: a device that decides
    /// the other way for a rounding may write elsewhere.
    pub(super) fn led_by_reals(&self) -> Vec<bool> {
        let is_real = |leaf: &super::Leaf| leaf.scalar == base::value::Scalar::F32;
        let holds_reals: Vec<bool> = self
            .memories
            .iter()
            .map(|shape| shape.fixed.iter().chain(shape.array.iter().flat_map(|array| &array.leaves)).any(is_real))
            .collect();
        let depends = self.depends();
        let mut led = vec![false; self.memories.len()];
        let mut look = |inst: &Inst| {
            if let Inst::Memory(access) = inst
                && !matches!(access.op, MemoryOp::Load(_))
            {
                let by = depends.of(access.site);
                led[access.memory as usize] |= holds_reals.iter().enumerate().any(|(k, real)| *real && by.has(k));
            }
        };
        every(&self.body, &mut look);
        led
    }

    /// What the program does with memory.
    pub fn uses(&self) -> Uses {
        let Words { packed, real_too } = packed::words(self);
        let mut uses = Uses { packed, real_too, ..Uses::default() };
        super::super::shape::each(&self.body, &mut |inst| {
            if let Inst::Memory(MemoryAccess { memory, site, op, .. }) = inst
                && !matches!(op, MemoryOp::Load(_))
                && self.memories[*memory as usize].space != Space::Workgroup
            {
                uses.stores.push(*site);
            }
            match inst {
                Inst::Length { memory, of: Extent::Side(_), .. } => {
                    uses.sizes.insert(*memory);
                }
                Inst::Length { memory, .. } => {
                    uses.lengths.insert(*memory);
                }
                Inst::Memory(access) if reads_size(self, access) => {
                    uses.sizes.insert(access.memory);
                }
                Inst::Memory(MemoryAccess { memory, atomic: true, .. }) => {
                    uses.atomics.insert(*memory);
                }
                Inst::Memory(MemoryAccess { memory, offset, steps, op: MemoryOp::Load(parts), .. }) => {
                    if !steps.is_empty() {
                        uses.indexed.insert(*memory);
                    }
                    uses.words.extend(parts.iter().map(|(_, distance)| (*memory, offset + distance)));
                }
                _ => {}
            }
        });
        uses
    }

    /// Whether the program asks for the place of an invocation in its workgroup along an axis. Whether it is a certain one,
    /// as in `if (id.y == 0)`, is not asked for the place.
    pub fn reads_local(&self, axis: usize) -> bool {
        self.reads_numbers(&[BuiltIn::LocalInvocationId], axis)
    }

    /// Whether the program asks along an axis for its workgroup, the place in the dispatch, or its size.
    pub fn reads_global(&self, axis: usize) -> bool {
        self.reads_numbers(&[BuiltIn::GlobalInvocationId, BuiltIn::WorkGroupId, BuiltIn::NumWorkGroups], axis)
    }

    /// Whether the program asks for its place in the dispatch, and not for that in its workgroup alone.
    pub fn reads_place(&self) -> bool {
        (0..3).any(|axis| self.reads_numbers(&[BuiltIn::GlobalInvocationId], axis))
    }

    fn reads_numbers(&self, built_ins: &[BuiltIn], axis: usize) -> bool {
        let of = self.numbers.iter().filter(|(own, _)| built_ins.contains(own));
        let registers: HashSet<Reg> = of.filter_map(|(_, all)| all.get(axis)).map(|register| register.reg).collect();
        if registers.is_empty() {
            return false;
        }
        let constants = self.constants.iter().filter_map(|constant| match constant {
            Constant::Word { to, .. } => Some(*to),
            Constant::Real { .. } => None,
        });
        let constants: HashSet<Reg> = constants.collect();
        let mut body = self.draft.body.clone();
        let mut held = registers;
        // A front end may copy all components of a number into a variable: what matters is who reads that.
        loop {
            let before = held.len();
            if reads(&mut body, &mut held, &constants) {
                return true;
            }
            if held.len() == before {
                return false;
            }
        }
    }
}

/// True for a body that does more with one of these registers than to copy it or compare it with a constant; where it goes
/// to is added to them.
fn reads(body: &mut [Inst], held: &mut HashSet<Reg>, constants: &HashSet<Reg>) -> bool {
    body.iter_mut().any(|inst| {
        if let Inst::Word2 { op, a, b, .. } = inst
            && op.question().is_some()
            && (constants.contains(a) || constants.contains(b))
        {
            return false;
        }
        if let Inst::Copy { to, from } | Inst::Store { to, from } = inst {
            if to.file() == File::Word && held.contains(from) {
                held.insert(to.reg);
            }
            return false;
        }
        let mut found = false;
        inst.registers(&mut |touch, file, reg| {
            found |= (touch, file) == (Touch::Read, File::Word) && held.contains(reg);
        });
        found
            || match inst {
                Inst::If { accept, reject, .. } => reads(accept, held, constants) || reads(reject, held, constants),
                Inst::Switch { cases, .. } => cases.iter_mut().any(|case| reads(&mut case.body, held, constants)),
                Inst::Loop { body, continuing, .. } => {
                    reads(body, held, constants) || reads(continuing, held, constants)
                }
                Inst::Call { body } => reads(body, held, constants),
                _ => false,
            }
    })
}

impl DependencePass {
    fn note(&mut self, site: Site, leads: Sources, reached: Sources) {
        let own = self.sites.entry(site).or_default();
        let all = (own.0.or(leads), own.1.or(reached));
        self.changed |= all != *own;
        *own = all;
    }

    fn block(&mut self, executable: &Executable, body: &mut [Inst], around: Sources) {
        for inst in body {
            self.step(executable, inst, around);
        }
    }

    fn of(&self, file: File, reg: Reg) -> Sources {
        self.registers.get(&(file, reg)).copied().unwrap_or_default()
    }

    fn step(&mut self, executable: &Executable, inst: &mut Inst, around: Sources) {
        // Whoever left for good comes to nothing that is behind it.
        let here = if self.plain && self.within == 0 { around } else { around.or(self.left) };
        let mut read = if self.plain && !sets_variable(inst) { Sources::default() } else { here };
        inst.registers(&mut |touch, file, reg| {
            if touch == Touch::Read {
                read = read.or(self.of(file, *reg));
            }
        });
        let mut given = read;
        match inst {
            Inst::Memory(access) if reads_size(executable, access) => {
                self.note(access.site, Sources::default(), here);
                given = here.or(Sources::size(access.memory));
            }
            Inst::Memory(access) => {
                let step = |all: Sources, step: &Step| all.or(self.of(File::Word, step.reg));
                let leads = access.steps.iter().fold(Sources::default(), step);
                access.steps.iter().for_each(|step| self.note(step.site, leads, here));
                self.note(access.site, leads, here);
                let space = executable.memories.get(access.memory as usize).map(|shape| shape.space);
                if !matches!(access.op, MemoryOp::Load(_)) {
                    let own = self.contents.entry(access.memory).or_default();
                    let all = own.or(read);
                    self.changed |= all != *own;
                    *own = all;
                    let value = self.values.entry(access.site).or_default();
                    *value = value.or(read);
                }
                given = given.or(self.contents.get(&access.memory).copied().unwrap_or_default());
                if access.atomic {
                    given = given.or(Sources::atomic(access.memory));
                }
                given = given.or(match space {
                    Some(Space::Workgroup) => Sources { collected: true, ..Sources::default() },
                    _ => Sources::one(access.memory),
                });
            }
            Inst::Length { memory, of: Extent::Side(_), .. } => given = here.or(Sources::size(*memory)),
            Inst::Length { .. } => given = here,
            Inst::Barrier { site, .. } => self.note(*site, Sources::default(), here),
            Inst::Subgroup(inst) => self.note(inst.site, Sources::default(), here),
            Inst::Loop { site, .. } => self.note(*site, Sources::default(), here),
            _ => given.raw = self.raw(inst, given),
        }
        inst.registers(&mut |touch, file, reg| {
            if touch == Touch::Write {
                let own = self.registers.entry((file, *reg)).or_default();
                let all = own.or(given);
                self.changed |= all != *own;
                *own = all;
            }
        });
        match inst {
            Inst::If { condition, accept, reject } => {
                let inside = here.or(self.of(File::Word, *condition));
                self.block(executable, accept, inside);
                self.block(executable, reject, inside);
                if leaves(accept) || leaves(reject) {
                    self.leave(inside);
                }
            }
            Inst::Switch { selector, cases } => {
                let inside = here.or(self.of(File::Word, *selector));
                cases.iter_mut().for_each(|case| self.block(executable, &mut case.body, inside));
                if cases.iter().any(|case| continues(&case.body)) {
                    self.leave(inside);
                }
            }
            Inst::Loop { body, continuing, .. } => {
                // All invocations that do not return get behind the loop.
                let before = self.left;
                self.within += 1;
                self.block(executable, body, here);
                self.block(executable, continuing, here);
                self.within -= 1;
                if !returns(body) {
                    self.left = before;
                }
            }
            Inst::Call { body } => {
                // Who returns early from a function goes on behind its call.
                let before = self.left;
                self.within += 1;
                self.block(executable, body, here);
                self.within -= 1;
                let after = std::mem::replace(&mut self.left, before);
                if ends(body) {
                    self.left = after;
                }
            }
            _ => {}
        }
    }

    fn leave(&mut self, sources: Sources) {
        self.left = self.left.or(sources);
    }

    /// Which memories still have a say as they are in what an instruction makes of `given`: see [`Sources::is_folded`].
    fn raw(&self, inst: &Inst, given: Sources) -> u64 {
        let constant = |reg: &Reg| self.constants.get(reg).copied();
        let few = |reg: &Reg, more: u32| constant(reg).is_some_and(|value| value < FEW + more);
        let folds = match inst {
            Inst::Word2 { op, a, b, .. } => match op {
                Word2::And | Word2::MinUnsigned => few(a, 0) || few(b, 0),
                Word2::RemainderUnsigned | Word2::RemainderSigned => few(b, 1),
                Word2::ShiftRightUnsigned => {
                    constant(b).is_some_and(|by| (1 << (by & 31)) >= (1_u64 << 32) / u64::from(FEW))
                }
                _ => {
                    // Two numbers beside each other make one with more values.
                    let both = [a, b].map(|reg| self.of(File::Word, *reg).contents != 0) == [true; 2];
                    return if both { given.contents } else { given.raw };
                }
            },
            Inst::Field { op: Field::ExtractUnsigned, args, .. } => {
                constant(&args[2]).is_some_and(|count| 1 << count.min(31) <= FEW)
            }
            Inst::Real2 { op: Binary::Multiply | Binary::Divide, .. } => true,
            _ => false,
        };
        if folds { 0 } else { given.raw }
    }
}

/// Values of a number at most that is no index of many elements.
const FEW: u32 = 256;

/// True for an instruction that leaves a value in a variable, which may be read behind the conditions around it.
fn sets_variable(inst: &mut Inst) -> bool {
    let mut sets = false;
    inst.registers(&mut |touch, _, reg| sets |= touch == Touch::Write && *reg < TEMPORARY);
    sets
}

/// True for a load of the size in front of an image that lies in a buffer.
fn reads_size(executable: &Executable, access: &MemoryAccess) -> bool {
    let shape = executable.memories.get(access.memory as usize);
    let texels = shape.filter(|shape| shape.image.is_some()).and_then(|shape| shape.array.as_ref());
    access.steps.is_empty() && texels.is_some_and(|array| access.offset < array.offset)
}

fn any(body: &[Inst], is: &dyn Fn(&Inst) -> bool) -> bool {
    body.iter().any(|inst| {
        is(inst)
            || match inst {
                Inst::If { accept, reject, .. } => any(accept, is) || any(reject, is),
                Inst::Switch { cases, .. } => cases.iter().any(|case| any(&case.body, is)),
                Inst::Loop { body, continuing, .. } => any(body, is) || any(continuing, is),
                _ => false,
            }
    })
}

/// Shows each instruction to `look`.
fn every(body: &[Inst], look: &mut dyn FnMut(&Inst)) {
    for inst in body {
        look(inst);
        match inst {
            Inst::If { accept, reject, .. } => {
                every(accept, look);
                every(reject, look);
            }
            Inst::Switch { cases, .. } => cases.iter().for_each(|case| every(&case.body, look)),
            Inst::Loop { body, continuing, .. } => {
                every(body, look);
                every(continuing, look);
            }
            Inst::Call { body } => every(body, look),
            _ => {}
        }
    }
}

/// True for a block that some invocations leave before its end. What leaves a loop or a choice inside of it does not.
fn leaves(body: &[Inst]) -> bool {
    body.iter().any(|inst| match inst {
        Inst::Break | Inst::Continue | Inst::Return | Inst::Kill => true,
        Inst::If { accept, reject, .. } => leaves(accept) || leaves(reject),
        Inst::Switch { cases, .. } => cases.iter().any(|case| continues(&case.body)),
        Inst::Loop { body, .. } => returns(body),
        _ => false,
    })
}

fn returns(body: &[Inst]) -> bool {
    any(body, &|inst| matches!(inst, Inst::Return | Inst::Kill))
}

/// True for a case of which some way leads past what is behind it.
fn continues(body: &[Inst]) -> bool {
    any(body, &|inst| matches!(inst, Inst::Continue | Inst::Return | Inst::Kill))
}

/// True for a function that ends invocations.
fn ends(body: &[Inst]) -> bool {
    any(body, &|inst| matches!(inst, Inst::Kill))
}
