//! Loads, stores and atomic functions of a workgroup.

use super::super::code::{File, Register};
use super::super::domain::Domain;
use super::super::plain::{Column, Number, Plain};
use super::super::slots::SLOTS;
use super::access::{Combine, MemoryAccess, MemoryOp};
use super::memory::{Access, Incident, Party, Wrong};
use super::{Group, Space};
use base::value::Scalar;

impl<'e, N: Number> Group<'e, '_, N>
where
    Plain<N>: Domain<Column = Column<N>>,
{
    /// Carries out an access in all invocations that are here, one after the other.
    pub(super) fn access(&mut self, access: &'e MemoryAccess) {
        for k in 0..self.machines.len() {
            let active = self.machines[k].active;
            for slot in active.slots() {
                let place = self.place(access, k, slot);
                self.one(access, k, slot, place);
            }
        }
    }

    /// The word that an invocation means; `None` where an index leads out of its array.
    fn place(&mut self, access: &MemoryAccess, k: usize, slot: usize) -> Option<usize> {
        let contents = &self.contents[access.memory as usize];
        let mut at = u64::from(access.offset);
        for step in &access.steps {
            let index = self.machines[k].words[step.reg as usize][slot];
            let len = step.len.unwrap_or(contents.elements);
            if index >= len {
                let touch = match access.op {
                    MemoryOp::Load(_) => Access::Read,
                    MemoryOp::Store(_) => Access::Write,
                    MemoryOp::Atomic { .. } => Access::Atomic,
                };
                let who =
                    Party { group: self.number, local: (k * SLOTS + slot) as u32, access: touch, site: step.site };
                let incident = Incident {
                    what: Wrong::Outside,
                    memory: Some(access.memory),
                    word: None,
                    index: Some((index, len)),
                    who,
                    other: None,
                    count: 1,
                };
                self.log.report(incident);
                return None;
            }
            at += u64::from(index) * u64::from(step.stride);
        }
        usize::try_from(at).ok()
    }

    fn one(&mut self, access: &MemoryAccess, k: usize, slot: usize, place: Option<usize>) {
        // What is outside reads as the dispatch says, and is not written.
        match &access.op {
            MemoryOp::Load(parts) => {
                for (to, at) in parts {
                    let word = place.map(|place| place + *at as usize);
                    self.read(access, k, slot, word, *to);
                }
            }
            MemoryOp::Store(parts) => {
                for (from, at) in parts {
                    if let Some(place) = place {
                        self.write(access, k, slot, place + *at as usize, *from);
                    }
                }
            }
            MemoryOp::Atomic { op, value, compare, before, exchanged } => {
                let word = place.filter(|word| *word < self.contents[access.memory as usize].len());
                let old = word.map_or(0, |word| self.contents[access.memory as usize].bits(word));
                let machine = &self.machines[k];
                let bits = |register: Register| match register.file() {
                    File::Real => (machine.reals[register.reg as usize].values()[slot].widen() as f32).to_bits(),
                    File::Word => machine.words[register.reg as usize][slot],
                };
                let argument = bits(*value);
                let expected = compare.map(|reg| bits(Register { reg, ..*value }));
                let hit = expected.is_none_or(|expected| expected == old);
                if let Some(word) = word {
                    self.unwritten(access, k, slot, word);
                    self.touch(access, k, slot, word, Access::Atomic, true);
                    let new = if hit { combine(*op, value.scalar, old, argument) } else { old };
                    self.contents[access.memory as usize].set_bits(word, new);
                }
                let machine = &mut self.machines[k];
                if let Some(to) = before {
                    match to.file() {
                        File::Word => machine.words[to.reg as usize][slot] = old,
                        File::Real => {
                            let number = N::nearest(f64::from(f32::from_bits(old)));
                            machine.reals[to.reg as usize].values_mut()[slot] = number;
                        }
                    }
                }
                if let Some(to) = exchanged {
                    machine.words[*to as usize][slot] = u32::from(hit);
                }
            }
        }
    }

    fn read(&mut self, access: &MemoryAccess, k: usize, slot: usize, word: Option<usize>, to: Register) {
        let word = word.filter(|word| *word < self.contents[access.memory as usize].len());
        if let Some(word) = word {
            self.unwritten(access, k, slot, word);
            let touch = if access.atomic { Access::Atomic } else { Access::Read };
            self.touch(access, k, slot, word, touch, false);
        }
        let contents = &self.contents[access.memory as usize];
        let machine = &mut self.machines[k];
        match to.file() {
            File::Real => {
                let outside = || N::nearest(f64::from(f32::from_bits(self.dispatch.outside)));
                let value = word.map_or_else(outside, |word| contents.real(word));
                machine.reals[to.reg as usize].values_mut()[slot] = value;
            }
            File::Word => {
                let bits = word.map_or(self.dispatch.outside, |word| contents.bits(word));
                machine.words[to.reg as usize][slot] =
                    if to.scalar == Scalar::Bool { u32::from(bits != 0) } else { bits };
            }
        }
    }

    fn write(&mut self, access: &MemoryAccess, k: usize, slot: usize, word: usize, from: Register) {
        let memory = access.memory as usize;
        if word >= self.contents[memory].len() {
            return;
        }
        let touch = if access.atomic { Access::Atomic } else { Access::Write };
        match from.file() {
            File::Real => {
                let value = self.machines[k].reals[from.reg as usize].values()[slot];
                let changes = (value.widen() as f32).to_bits() != self.contents[memory].bits(word);
                self.touch(access, k, slot, word, touch, changes);
                self.contents[memory].set_real(word, value);
            }
            File::Word => {
                let bits = self.machines[k].words[from.reg as usize][slot];
                let changes = bits != self.contents[memory].bits(word);
                self.touch(access, k, slot, word, touch, changes);
                self.contents[memory].set_bits(word, bits);
            }
        }
    }

    fn touch(&mut self, access: &MemoryAccess, k: usize, slot: usize, word: usize, touch: Access, changes: bool) {
        let who = Party { group: self.number, local: (k * SLOTS + slot) as u32, access: touch, site: access.site };
        let contents = &mut self.contents[access.memory as usize];
        self.log.touch((access.memory, contents), word, who, self.epoch, changes);
    }

    /// Notes a word of the workgroup's memory that has no value yet.
    fn unwritten(&mut self, access: &MemoryAccess, k: usize, slot: usize, word: usize) {
        let contents = &self.contents[access.memory as usize];
        if contents.space != Space::Workgroup || contents.is_written(word) {
            return;
        }
        let who =
            Party { group: self.number, local: (k * SLOTS + slot) as u32, access: Access::Read, site: access.site };
        let incident = Incident {
            what: Wrong::Unwritten,
            memory: Some(access.memory),
            word: u32::try_from(word).ok(),
            index: None,
            who,
            other: None,
            count: 1,
        };
        self.log.report(incident);
    }
}

/// What an atomic function leaves in memory.
fn combine(op: Combine, scalar: Scalar, old: u32, value: u32) -> u32 {
    if scalar == Scalar::F32 {
        let (a, b) = (f32::from_bits(old), f32::from_bits(value));
        let number = match op {
            Combine::Add => a + b,
            Combine::Subtract => a - b,
            Combine::Min => a.min(b),
            Combine::Max => a.max(b),
            Combine::And | Combine::Or | Combine::Xor | Combine::Exchange => return value,
        };
        return number.to_bits();
    }
    let signed = scalar == Scalar::I32;
    match op {
        Combine::Add => old.wrapping_add(value),
        Combine::Subtract => old.wrapping_sub(value),
        Combine::And => old & value,
        Combine::Or => old | value,
        Combine::Xor => old ^ value,
        Combine::Min if signed => old.cast_signed().min(value.cast_signed()).cast_unsigned(),
        Combine::Max if signed => old.cast_signed().max(value.cast_signed()).cast_unsigned(),
        Combine::Min => old.min(value),
        Combine::Max => old.max(value),
        Combine::Exchange => value,
    }
}
