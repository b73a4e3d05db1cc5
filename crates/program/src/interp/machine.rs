//! Runs an executable on the slots of one chunk.

use std::collections::HashMap;
use std::mem::take;

use super::POISON;
use super::code::{Constant, Executable, File, Inst, Reached, Reg, Register};
use super::control::Breakable;
use super::domain::{Domain, Site, WordSource};
use super::meaning::{Finding, Flags, HazardKind};
use super::slots::{Mask, SLOTS, Words};
use super::undefined::{Operand, Probe, Undefined};
use base::value::{Batch, Scalar};

/// Registers, masks and findings of one chunk after the other.
pub struct Machine<'e, D: Domain> {
    pub(super) executable: &'e Executable,
    pub(super) domain: D,
    pub(super) reals: Vec<D::Column>,
    pub(super) words: Vec<Words>,
    /// Vertices of a geometry stage: for each vertex, the columns of its outputs.
    pub(super) vertices: Vec<(Vec<D::Column>, Vec<Words>)>,
    pub(super) strips: Vec<Words>,
    pub(super) emitted: Words,
    pub(super) ended: Words,
    pub(super) active: Mask,
    /// Slots that were discarded, ran out of fuel or were given up.
    pub(super) stopped: Mask,
    pub(super) breakable: Vec<Breakable>,
    pub(super) fuel: Words,
    fuel_limit: u32,
    /// Rounds of all loops of this chunk, and of all chunks.
    pub(super) chunk_rounds: u64,
    pub(super) rounds: u64,
    pub(super) flags: [Flags; SLOTS],
    pub(super) findings: Vec<Finding>,
    /// Of variables that come to life without a value, the slots in which they have one: by file and register.
    pub(super) assigned: [HashMap<u32, Mask>; 2],
    /// What is put in the place of undefined values, and what is noted of them.
    pub(super) probe: Option<Probe>,
    /// The invocation of each slot; slots behind the last one follow the first.
    pub(super) invocations: [usize; SLOTS],
    pub(super) slots: usize,
    /// Slots that got to each place of [`Executable::reached`].
    reached: Vec<u64>,
}

impl<'e, D: Domain> Machine<'e, D> {
    /// A machine for an executable. Each slot may go through `fuel` rounds of loops.
    pub fn new(executable: &'e Executable, mut domain: D, fuel: u32) -> Self {
        let room = executable.max_vertices.unwrap_or(0) as usize;
        let reals_out = executable.outputs.iter().filter(|register| register.file() == File::Real).count();
        let words_out = executable.outputs.len() - reals_out;
        let mut columns = |n: usize| (0..n).map(|_| domain.column()).collect::<Vec<_>>();
        let reals = columns(executable.reals);
        let vertices = (0..room).map(|_| (columns(reals_out), vec![[0; SLOTS]; words_out])).collect();
        Self {
            executable,
            domain,
            reals,
            words: vec![[0; SLOTS]; executable.words],
            vertices,
            strips: vec![[0; SLOTS]; room],
            emitted: [0; SLOTS],
            ended: [0; SLOTS],
            active: Mask::NONE,
            stopped: Mask::NONE,
            breakable: Vec::new(),
            fuel: [0; SLOTS],
            fuel_limit: fuel,
            chunk_rounds: 0,
            rounds: 0,
            flags: [Flags::default(); SLOTS],
            findings: Vec::new(),
            assigned: std::array::from_fn(|file| executable.unset[file].iter().map(|&reg| (reg, Mask::NONE)).collect()),
            probe: None,
            invocations: [0; SLOTS],
            slots: 0,
            reached: vec![0; executable.reached.len()],
        }
    }

    /// Places at which invocations are counted, with how many got there in all runs.
    pub fn reached(&self) -> impl Iterator<Item = (Reached, u64)> + '_ {
        self.executable.reached.iter().copied().zip(self.reached.iter().copied())
    }

    /// Runs the invocations of `batch` from `first` on, at most [`SLOTS`] of them. Gives their number.
    pub fn run(&mut self, batch: &Batch, first: usize) -> usize {
        let slots = batch.invocation_count().saturating_sub(first).min(SLOTS);
        self.start(batch, slots, |slot| first + slot);
        slots
    }

    /// Runs any invocations of `batch`, at most [`SLOTS`] of them: those past that are left out. Gives
    /// their number.
    ///
    /// # Panics
    /// When the batch has no such invocation: a defect of the caller.
    pub fn run_some(&mut self, batch: &Batch, invocations: &[usize]) -> usize {
        let slots = invocations.len().min(SLOTS);
        self.start(batch, slots, |slot| invocations[slot]);
        slots
    }

    fn start(&mut self, batch: &Batch, slots: usize, invocation: impl Fn(usize) -> usize) {
        if slots > 0 {
            self.invocations = std::array::from_fn(|slot| invocation(if slot < slots { slot } else { 0 }));
        }
        self.prepare(slots);
        if slots > 0 {
            self.fill(batch);
        }
        for k in 0..self.executable.poisoned.len() {
            self.poison(self.executable.poisoned[k], Mask::ALL);
        }
        let executable = self.executable;
        // Slots behind the last invocation follow the first one, so that full masks stay full.
        if slots > 0 {
            self.active = Mask::ALL;
            self.block(&executable.body);
        }
    }

    /// Registers and masks as they are before the first instruction.
    pub(super) fn prepare(&mut self, slots: usize) {
        self.slots = slots;
        self.domain.begin();
        for &constant in &self.executable.constants {
            match constant {
                Constant::Real { to, value, site } => {
                    self.domain.constant(site, value, &mut self.reals[to as usize]);
                }
                Constant::Word { to, value } => self.words[to as usize] = [value; SLOTS],
            }
        }
        (self.emitted, self.ended) = ([0; SLOTS], [0; SLOTS]);
        self.flags = [Flags::default(); SLOTS];
        self.fuel = [self.fuel_limit; SLOTS];
        self.chunk_rounds = 0;
        self.active = Mask::first(slots);
        self.stopped = Mask::NONE;
        self.breakable.clear();
    }

    fn fill(&mut self, batch: &Batch) {
        let (words, case_words) = (batch.invocation_record.words(), batch.case_record.words());
        let own: [usize; SLOTS] = std::array::from_fn(|slot| self.invocations[slot] * words);
        let runs = Runs::of(&self.invocations, batch.per_case, case_words);
        let mut column = [0; SLOTS];
        for fill in &self.executable.fills {
            match fill.source {
                WordSource::Invocation(word) => gather(&batch.invocations[word as usize..], &own, &mut column),
                WordSource::Case(word) => runs.spread(&batch.cases[word as usize..], &mut column),
            }
            if fill.half {
                column = column.map(|word| super::halved(f32::from_bits(word)).to_bits());
            }
            let reg = fill.to.reg as usize;
            match fill.to.scalar {
                Scalar::F32 => self.domain.input(fill.source, &column, &mut self.reals[reg]),
                Scalar::I32 | Scalar::U32 => self.words[reg] = column,
                Scalar::Bool => self.words[reg] = column.map(|word| u32::from(word != 0)),
            }
        }
    }

    fn poison(&mut self, register: Register, mask: Mask) {
        match register.file() {
            File::Real => self.domain.poison(&mask, &mut self.reals[register.reg as usize]),
            File::Word => mask.merge(&[POISON; SLOTS], &mut self.words[register.reg as usize]),
        }
    }

    pub(super) fn report(&mut self, kind: HazardKind, site: Site, mask: Mask) {
        let mask = mask.and(self.active).and(Mask::first(self.slots));
        if mask.is_empty() {
            return;
        }
        for slot in mask.slots() {
            self.flags[slot].set(kind);
        }
        let count = mask.count() as u64;
        // Discarding is an event of the slot and not of a place.
        if kind == HazardKind::Killed {
            return;
        }
        match self.findings.iter_mut().find(|finding| finding.kind == kind && finding.site == site) {
            Some(finding) => finding.count += count,
            None => {
                let invocation = self.invocations[mask.slots().next().unwrap_or(0)];
                self.findings.push(Finding { kind, site, invocation, count });
            }
        }
    }

    pub(super) fn step(&mut self, inst: &'e Inst) {
        match inst {
            Inst::Real1 { op, to, a, site } => self.write_real(*to, |this, out| {
                this.domain.unary(*site, *op, &this.active, &this.reals[*a as usize], out);
            }),
            Inst::Real2 { op, to, a, b, site } => self.write_real(*to, |this, out| {
                let (a, b) = (&this.reals[*a as usize], &this.reals[*b as usize]);
                this.domain.binary(*site, *op, &this.active, a, b, out);
            }),
            Inst::Scale { to, a, exponent, site } => self.write_real(*to, |this, out| {
                this.domain.scale(*site, &this.reals[*a as usize], &this.words[*exponent as usize], out);
            }),
            Inst::Compare { op, to, a, b, site } => {
                let (a, b) = (&self.reals[*a as usize], &self.reals[*b as usize]);
                self.domain.compare(*site, *op, &self.active, a, b, &mut self.words[*to as usize]);
            }
            Inst::Classify { class, to, a, site } => {
                let (a, out) = (&self.reals[*a as usize], &mut self.words[*to as usize]);
                self.domain.classify(*site, *class, &self.active, a, out);
            }
            Inst::ToWords { op, to, a, site } => self.convert(*op, *to, *a, *site),
            Inst::FromWords { op, to, a, site } => {
                self.domain.reals_of(*site, *op, &self.words[*a as usize], &mut self.reals[*to as usize]);
            }
            Inst::Word1 { op, to, a, site } => self.word1(*op, *to, *a, *site),
            Inst::Word2 { op, to, a, b, site } => self.word2(*op, *to, [*a, *b], *site),
            Inst::Field { op, to, args, site } => self.field(*op, *to, *args, *site),
            Inst::Guard { what, to, from, args, site } => self.guard(*what, *to, *from, *args, *site),
            Inst::GuardWords { signed, to, from, args, site } => self.guard_words(*signed, *to, *from, *args, *site),
            Inst::Begin { to, zero, site } => self.come_to_life(*to, *zero, *site),
            Inst::Read { from, kind, site } => self.read(*from, *kind, *site),
            Inst::Overlap { of, equal, site } => self.overlap(*of, *equal, *site),
            Inst::Texel { table, index, channel, inside, to, site } => {
                let inside = inside.map_or(Mask::ALL, |reg| Mask::of(&self.words[reg as usize]));
                self.texel(*table, *index, *channel, inside, *to, *site);
            }
            Inst::Select { to, condition, accept, reject } => {
                let mask = Mask::of(&self.words[*condition as usize]);
                self.copy(*to, *reject);
                self.merge(&mask, *to, *accept);
            }
            Inst::Copy { to, from } => self.copy(*to, *from),
            Inst::Store { to, from } => {
                let mask = self.active;
                self.assign(*to, mask);
                self.merge(&mask, *to, *from);
            }
            Inst::Gather { index, choices, strays, unset } => {
                self.gather(*index, choices, *unset);
                self.astray(strays, choices);
            }
            Inst::Scatter { index, choices, strays } => self.scatter(*index, choices, strays),
            Inst::If { condition, accept, reject } => self.branch(*condition, accept, reject),
            Inst::Switch { selector, cases } => self.switch(*selector, cases),
            Inst::Loop { body, continuing, break_if, site } => self.repeat(body, continuing, *break_if, *site),
            Inst::Call { body } => {
                let before = self.active;
                self.block(body);
                self.active = before.minus(self.stopped);
            }
            Inst::Break => self.leave(),
            Inst::Continue => self.go_on(),
            Inst::Return => self.active = Mask::NONE,
            Inst::Kill => self.kill(),
            // A program with shared memory is run by a group, which does these itself.
            Inst::Memory(_) | Inst::Length { .. } | Inst::Barrier { .. } | Inst::Fence { .. } | Inst::Subgroup(_) => {}
            Inst::Agree { first, others, site } => self.agree(*first, others, *site),
            Inst::Reach { at } => {
                let own = self.active.slots().filter(|slot| *slot < self.slots).count();
                self.reached[*at as usize] += own as u64;
            }
            Inst::EmitVertex => self.emit_vertex(),
            Inst::EndPrimitive => {
                for slot in self.active.slots() {
                    self.ended[slot] += 1;
                }
            }
        }
    }

    /// Writes a column of real numbers, which is taken out of its file meanwhile, so that all others can be read.
    #[inline]
    fn write_real(&mut self, to: Reg, write: impl FnOnce(&mut Self, &mut D::Column)) {
        let mut out = take(&mut self.reals[to as usize]);
        write(self, &mut out);
        self.reals[to as usize] = out;
    }

    /// A word of a texel, 0 in slots that are not `inside`.
    #[inline]
    fn texel(&mut self, table: u32, index: Reg, channel: u8, inside: Mask, to: Reg, site: Site) {
        let table = &self.executable.tables[table as usize];
        let index = self.words[index as usize];
        let outside = self.active.minus(inside);
        if !outside.is_empty() {
            self.domain.doubt(site, &outside);
        }
        let word = |slot: usize| table.get(4 * index[slot] as usize + usize::from(channel)).copied();
        let found = |slot: usize| if inside.has(slot) { word(slot).unwrap_or(0) } else { 0 };
        self.words[to as usize] = std::array::from_fn(found);
        let of = Undefined { kind: HazardKind::Index, site, what: None };
        self.undefined(of, outside, Some(Register { scalar: Scalar::I32, reg: to }), [Operand::None; 2]);
    }

    pub(super) fn copy(&mut self, to: Register, from: u32) {
        let (at, from) = (to.reg as usize, from as usize);
        if at == from {
            return;
        }
        match to.file() {
            File::Real => self.write_real(to.reg, |this, out| this.domain.copy(&this.reals[from], out)),
            File::Word => self.words[at] = self.words[from],
        }
    }

    pub(super) fn merge(&mut self, mask: &Mask, to: Register, from: u32) {
        if mask.is_full() {
            return self.copy(to, from);
        }
        let (at, from) = (to.reg as usize, from as usize);
        if at == from {
            return;
        }
        match to.file() {
            File::Real => self.write_real(to.reg, |this, out| this.domain.merge(mask, &this.reals[from], out)),
            File::Word => {
                let from = self.words[from];
                mask.merge(&from, &mut self.words[at]);
            }
        }
    }

    /// For each value that the index takes in the active slots, the slots that have it.
    pub(super) fn groups(&self, index: u32) -> Vec<(usize, Mask)> {
        let index = &self.words[index as usize];
        let mut rest = self.active;
        let mut groups = Vec::new();
        while let Some(slot) = rest.slots().next() {
            let value = index[slot];
            let same = Mask::where_(|slot| index[slot] == value).and(self.active);
            groups.push((value as usize, same));
            rest = rest.minus(same);
        }
        groups
    }

    fn emit_vertex(&mut self) {
        let room = self.vertices.len() as u32;
        let mut rest = self.active;
        while let Some(slot) = rest.slots().next() {
            let count = self.emitted[slot];
            let same = Mask::where_(|slot| self.emitted[slot] == count).and(self.active);
            rest = rest.minus(same);
            if count < room {
                let (reals, words) = &mut self.vertices[count as usize];
                let (mut reals, mut words) = (reals.iter_mut(), words.iter_mut());
                for register in &self.executable.outputs {
                    let reg = register.reg as usize;
                    match register.file() {
                        File::Real => {
                            if let Some(to) = reals.next() {
                                self.domain.merge(&same, &self.reals[reg], to);
                            }
                        }
                        File::Word => {
                            if let Some(to) = words.next() {
                                same.merge(&self.words[reg], to);
                            }
                        }
                    }
                }
                same.merge(&self.ended, &mut self.strips[count as usize]);
            }
        }
        for slot in self.active.slots() {
            self.emitted[slot] += 1;
        }
        // Outputs are undefined behind EmitVertex (GLSL 4.60, 8.15): whatever is read again shows.
        for k in 0..self.executable.outputs.len() {
            self.poison(self.executable.outputs[k], self.active);
        }
    }
}

/// Slots side by side that have one case: its words are read once for each of them.
struct Runs {
    /// Where the words of a case begin, and the slot behind the last one that has it.
    ends: [(usize, usize); SLOTS],
    count: usize,
}

impl Runs {
    fn of(invocations: &[usize; SLOTS], per_case: usize, words: usize) -> Self {
        let mut runs = Self { ends: [(0, 0); SLOTS], count: 0 };
        let mut last = None;
        for (slot, invocation) in invocations.iter().enumerate() {
            let case = invocation / per_case;
            if last.replace(case) != Some(case) {
                runs.count += 1;
            }
            runs.ends[runs.count - 1] = (case * words, slot + 1);
        }
        runs
    }

    fn spread(&self, words: &[u32], column: &mut Words) {
        let mut from = 0;
        for &(at, end) in &self.ends[..self.count] {
            column[from..end].fill(words[at]);
            from = end;
        }
    }
}

fn gather(words: &[u32], places: &[usize; SLOTS], column: &mut Words) {
    column.iter_mut().zip(places).for_each(|(value, &at)| *value = words[at]);
}
