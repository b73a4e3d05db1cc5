//! Loads, stores and atomic functions of a workgroup.

use super::super::code::{File, Reg, Register};
use super::super::slots::{Mask, SLOTS};
use super::access::{Combine, MemoryAccess, MemoryOp};
use super::cells::InMemory;
use super::memory::{Access, Effect, Incident, Party, Wrong};
use super::{Space, Workgroup, placed};
use base::value::Scalar;

impl<'e, D: InMemory> Workgroup<'e, '_, D> {
    /// Carries out an access in all invocations that are here, one after the other.
    pub(super) fn access(&mut self, access: &'e MemoryAccess) {
        self.notice_doubts();
        let (count, order) = (self.machines.len(), self.dispatch.order);
        if let Some(turns) = self.turns.take() {
            let loads = if let MemoryOp::Load(parts) = &access.op { Some(parts) } else { None };
            if let Some(parts) = loads {
                (0..count).filter(|&k| !self.machines[k].active.is_empty()).collect::<Vec<_>>().into_iter().for_each(
                    |k| {
                        self.load(access, k, parts);
                    },
                );
            }
            let places = turns.iter().map(|local| (local / SLOTS, local % SLOTS));
            for (k, slot) in places.filter(|_| loads.is_none()) {
                if self.machines[k].active.has(slot) {
                    let place = self.place(access, k, slot);
                    self.one(access, k, slot, place);
                }
            }
            self.turns = Some(turns);
            return;
        }
        for k in (0..count).map(|k| placed(k, count, order)) {
            let active = self.machines[k].active;
            if active.is_empty() {
                continue;
            }
            if let MemoryOp::Load(parts) = &access.op {
                self.load(access, k, parts);
                continue;
            }
            for slot in (0..SLOTS).map(|slot| placed(slot, SLOTS, order)).filter(|&slot| active.has(slot)) {
                let place = self.place(access, k, slot);
                self.one(access, k, slot, place);
            }
        }
    }

    /// Loads of all invocations of a machine: what is outside reads as the dispatch says.
    fn load(&mut self, access: &MemoryAccess, k: usize, parts: &[(Register, u32)]) {
        let active = self.machines[k].active;
        let memory = access.memory as usize;
        let outside = if self.contents[memory].is_image { 0 } else { self.dispatch.outside };
        let touch = if access.atomic { Access::Atomic } else { Access::Read };
        let mut cells = vec![[D::cell(outside); SLOTS]; parts.iter().filter(|(to, _)| to.file() == File::Real).count()];
        let mut open = Mask::NONE;
        for slot in active.slots() {
            let place = self.place(access, k, slot);
            let mut reals = 0;
            for (to, at) in parts {
                let word = place.map(|place| place + *at as usize).filter(|word| *word < self.contents[memory].len());
                if let Some(word) = word {
                    self.unwritten(access, k, slot, word);
                    self.touch(access, k, slot, word, touch, Effect::Kept);
                    if access.atomic && self.contents[memory].is_watched() {
                        self.log.looked((access.memory, word), (self.number, (k * SLOTS + slot) as u32));
                    }
                    if self.contents[memory].is_open(word) {
                        open.insert(slot);
                    }
                }
                let contents = &self.contents[memory];
                match to.file() {
                    File::Real => {
                        if let Some(word) = word {
                            cells[reals][slot] =
                                if access.atomic { contents.passing(word) } else { contents.real(word) };
                        }
                        reals += 1;
                    }
                    File::Word => {
                        let ahead = self
                            .dispatch
                            .turns
                            .ahead
                            .filter(|&local| access.atomic && local as usize == k * SLOTS + slot);
                        let early =
                            word.zip(ahead).and_then(|(word, local)| self.early.load((access.memory, word), local));
                        let bits = early.unwrap_or_else(|| word.map_or(outside, |word| contents.bits(word)));
                        let bits = if to.scalar == Scalar::Bool { u32::from(bits != 0) } else { bits };
                        self.machines[k].words[to.reg as usize][slot] = bits;
                    }
                }
            }
        }
        let machine = &mut self.machines[k];
        let registers = parts.iter().map(|(to, _)| to).filter(|to| to.file() == File::Real);
        for (to, cells) in registers.zip(&cells) {
            let mut out = std::mem::take(&mut machine.reals[to.reg as usize]);
            machine.domain.put(&active, cells, &mut out);
            machine.reals[to.reg as usize] = out;
        }
        if !open.is_empty() {
            machine.domain.doubt(access.site, &open);
        }
    }

    /// Where an invocation decided what could have gone the other way, it may have written elsewhere.
    pub(super) fn notice_doubts(&mut self) {
        if self.doubts_noticed {
            return;
        }
        let Some(site) = self.machines.iter().find_map(|machine| machine.domain.first_doubt()) else { return };
        self.doubts_noticed = true;
        self.doubted.get_or_insert(site);
        let executable = self.executable;
        let astray = self.astray.get_or_insert_with(|| executable.led_by_reals());
        let led = astray.iter().zip(&mut self.contents).filter(|(astray, _)| **astray);
        led.for_each(|(_, contents)| contents.open_all());
    }

    /// Whether nothing is known of what a slot writes to a memory.
    fn is_open(&self, memory: usize, k: usize, slot: usize) -> bool {
        let Some(astray) = &self.astray else { return false };
        // The memory of a workgroup is its own.
        let apart = self.contents[memory].space == Space::Workgroup && !self.doubts_noticed;
        (astray[memory] && !apart) || self.machines[k].domain.doubted(slot).is_some()
    }

    /// The word that an invocation means; `None` where an index leads out of its array.
    fn place(&mut self, access: &MemoryAccess, k: usize, slot: usize) -> Option<usize> {
        let contents = &self.contents[access.memory as usize];
        let mut at = u64::from(access.offset);
        for step in &access.steps {
            let index = self.machines[k].words[step.reg as usize][slot];
            let len = contents.extent(step.len);
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
            at += u64::from(index) * u64::from(step.stride) * contents.row(step.len);
        }
        usize::try_from(at).ok()
    }

    fn one(&mut self, access: &MemoryAccess, k: usize, slot: usize, place: Option<usize>) {
        // What is outside is not written.
        match &access.op {
            MemoryOp::Load(_) => {}
            MemoryOp::Store(parts) => {
                for (from, at) in parts {
                    if let Some(place) = place {
                        self.write(access, k, slot, place + *at as usize, *from);
                    }
                }
            }
            MemoryOp::Atomic { op, value, compare, before, exchanged } => {
                self.atomic(access, k, slot, place, (*op, *value, *compare), (*before, *exchanged));
            }
        }
    }

    /// An atomic function: the word before goes to one register, whether it was exchanged to another.
    fn atomic(
        &mut self,
        access: &MemoryAccess,
        k: usize,
        slot: usize,
        place: Option<usize>,
        (op, value, compare): (Combine, Register, Option<Reg>),
        (before, exchanged): (Option<Register>, Option<Reg>),
    ) {
        let memory = access.memory as usize;
        let word = place.filter(|word| *word < self.contents[memory].len());
        let machine = &self.machines[k];
        let real = |reg: Reg| machine.domain.kept(&machine.reals[reg as usize], slot);
        let bits = |register: Register| match register.file() {
            File::Real => D::bits(real(register.reg)),
            File::Word => machine.words[register.reg as usize][slot],
        };
        let old = word.map_or(0, |word| self.contents[memory].bits(word));
        let argument = bits(value);
        let expected = compare.map(|reg| bits(Register { reg, ..value }));
        // Any other invocation may have been here before.
        let old_real = word.map_or(D::cell(0), |word| D::passing(self.contents[memory].real(word)));
        let hit = expected.is_none_or(|expected| expected == old);
        let sum = (value.file() == File::Real).then(|| op.of_reals().map(|sum| (sum, real(value.reg)))).flatten();
        if let Some(word) = word {
            self.unwritten(access, k, slot, word);
            let new = if hit { combine(op, value.scalar, old, argument) } else { old };
            let updated = op != Combine::Exchange && (sum.is_some() || new != old);
            let effect = if updated { Effect::Updated } else { Effect::Kept };
            self.touch(access, k, slot, word, Access::Atomic, effect);
            let open = self.contents[memory].is_open(word) || self.is_open(memory, k, slot);
            match sum {
                Some((sum, own)) if hit => {
                    self.contents[memory].combine(&self.machines[k].domain, sum, (word, own), open);
                }
                _ => {
                    self.contents[memory].set_bits(word, new, open);
                    self.changed(access, k, slot, word, (old, new));
                }
            }
            if open && before.is_some() {
                let mut only = Mask::NONE;
                only.insert(slot);
                self.machines[k].domain.doubt(access.site, &only);
            }
        }
        let machine = &mut self.machines[k];
        if let Some(to) = before {
            match to.file() {
                File::Word => machine.words[to.reg as usize][slot] = old,
                File::Real => {
                    let mut only = Mask::NONE;
                    only.insert(slot);
                    let mut out = std::mem::take(&mut machine.reals[to.reg as usize]);
                    machine.domain.put(&only, &[old_real; SLOTS], &mut out);
                    machine.reals[to.reg as usize] = out;
                }
            }
        }
        if let Some(to) = exchanged {
            machine.words[to as usize][slot] = u32::from(hit);
        }
    }

    fn write(&mut self, access: &MemoryAccess, k: usize, slot: usize, word: usize, from: Register) {
        let memory = access.memory as usize;
        if word >= self.contents[memory].len() {
            return;
        }
        let touch = if access.atomic { Access::Atomic } else { Access::Write };
        if access.atomic {
            self.stores_atomically(access, k, slot, word);
        }
        // Whoever stores atomically means the value to stand, also where it was there before.
        let effect = |changes: bool| if changes || access.atomic { Effect::Replaced } else { Effect::Kept };
        let open = self.is_open(memory, k, slot);
        match from.file() {
            File::Real => {
                let machine = &self.machines[k];
                let value = machine.domain.kept(&machine.reals[from.reg as usize], slot);
                let bits = D::bits(value);
                let changes = bits != self.contents[memory].bits(word);
                self.touch(access, k, slot, word, touch, effect(changes));
                self.contents[memory].set_real(word, value, open);
                if f32::from_bits(bits).is_nan() {
                    self.not_a_number(access, k, slot, word);
                }
            }
            File::Word => {
                let bits = self.machines[k].words[from.reg as usize][slot];
                let before = self.contents[memory].bits(word);
                self.touch(access, k, slot, word, touch, effect(bits != before));
                self.contents[memory].set_bits(word, bits, open);
                if access.atomic {
                    self.changed(access, k, slot, word, (before, bits));
                }
            }
        }
    }

    /// Notes what an atomic function left, for one that runs ahead of it.
    #[inline]
    fn changed(&mut self, access: &MemoryAccess, k: usize, slot: usize, word: usize, change: (u32, u32)) {
        if let Some(ahead) = self.dispatch.turns.ahead.filter(|_| change.0 != change.1) {
            self.early.changed((access.memory, word), change, (k * SLOTS + slot) as u32, ahead);
        }
    }

    /// Notes an atomic store that undoes what another invocation stored since this one looked.
    fn stores_atomically(&mut self, access: &MemoryAccess, k: usize, slot: usize, word: usize) {
        let contents = &self.contents[access.memory as usize];
        if contents.is_watched() {
            let local = (k * SLOTS + slot) as u32;
            let who = Party { group: self.number, local, access: Access::Atomic, site: access.site };
            self.log.stored((access.memory, word), who, contents.space);
        }
    }

    #[inline]
    fn touch(&mut self, access: &MemoryAccess, k: usize, slot: usize, word: usize, touch: Access, effect: Effect) {
        let who = Party { group: self.number, local: (k * SLOTS + slot) as u32, access: touch, site: access.site };
        let now = self.now(k * SLOTS + slot);
        let contents = &mut self.contents[access.memory as usize];
        self.log.touch((access.memory, contents), word, who, (&self.epochs, now), effect);
    }

    /// Notes a NaN that gets into a buffer.
    #[cold]
    fn not_a_number(&mut self, access: &MemoryAccess, k: usize, slot: usize, word: usize) {
        let contents = &self.contents[access.memory as usize];
        if contents.is_watched() && matches!(contents.space, Space::Storage { .. }) {
            let local = (k * SLOTS + slot) as u32;
            let who = Party { group: self.number, local, access: Access::Write, site: access.site };
            self.log.report(Incident {
                what: Wrong::NotANumber,
                memory: Some(access.memory),
                word: u32::try_from(word).ok(),
                index: None,
                who,
                other: None,
                count: 1,
            });
        }
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

/// What an atomic function on words leaves in memory.
fn combine(op: Combine, scalar: Scalar, old: u32, value: u32) -> u32 {
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
