//! Which slots go on: branches, loops, and ways out of them.

use std::mem::take;

use super::code::{Case, Inst, Reg};
use super::domain::{Domain, Site};
use super::machine::Machine;
use super::meaning::HazardKind;
use super::slots::Mask;
use crate::lane::interrupt;

/// Rounds of loops that a chunk may still go through once the process was asked to end: what shaders usually need, so that
/// samples that were found can still be described.
const LAST_ROUNDS: u64 = 1 << 10;

/// A loop or switch that slots can leave.
#[derive(Default)]
pub(super) struct Breakable {
    pub left: Mask,
    /// Slots that go on with the next round; `None` for a switch.
    pub next: Option<Mask>,
}

impl<'e, D: Domain> Machine<'e, D> {
    #[inline]
    pub(super) fn block(&mut self, block: &'e [Inst]) {
        for inst in block {
            if self.active.is_empty() {
                return;
            }
            self.step(inst);
        }
    }

    #[inline]
    pub(super) fn branch(&mut self, condition: Reg, accept: &'e [Inst], reject: &'e [Inst]) {
        let (before, condition) = (self.active, Mask::of(&self.words[condition as usize]));
        self.active = before.and(condition);
        self.block(accept);
        let accepted = self.active;
        self.active = before.minus(condition);
        self.block(reject);
        self.active = self.active.or(accepted);
    }

    pub(super) fn switch(&mut self, selector: Reg, cases: &'e [Case]) {
        let before = self.active;
        let selector = self.words[selector as usize];
        let matching = |value: u32| Mask::where_(|slot| selector[slot] == value).and(before);
        let named = cases.iter().filter_map(|case| case.value).fold(Mask::NONE, |all, value| all.or(matching(value)));
        self.breakable.push(Breakable::default());
        let (mut falling, mut done) = (Mask::NONE, Mask::NONE);
        for case in cases {
            let own = case.value.map_or(before.minus(named), matching);
            self.active = falling.or(own);
            self.block(&case.body);
            if case.fall_through {
                falling = self.active;
            } else {
                falling = Mask::NONE;
                done = done.or(self.active);
            }
        }
        let left = self.breakable.pop().unwrap_or_default().left;
        let has_default = cases.iter().any(|case| case.value.is_none());
        let unmatched = if has_default { Mask::NONE } else { before.minus(named) };
        self.active = done.or(falling).or(left).or(unmatched);
    }

    pub(super) fn repeat(&mut self, body: &'e [Inst], continuing: &'e [Inst], break_if: Option<Reg>, site: Site) {
        self.breakable.push(Breakable { left: Mask::NONE, next: Some(Mask::NONE) });
        while !self.active.is_empty() {
            let dry = Mask::where_(|slot| self.fuel[slot] == 0).and(self.active);
            if !dry.is_empty() {
                self.report(HazardKind::Fuel, site, dry);
                self.stopped = self.stopped.or(dry);
                self.active = self.active.minus(dry);
            }
            if self.domain.is_full() {
                self.domain.give_up(site, &self.active);
                self.stopped = self.stopped.or(self.active);
                self.active = Mask::NONE;
            }
            self.chunk_rounds += 1;
            self.rounds += 1;
            if self.chunk_rounds > LAST_ROUNDS && interrupt::asked() {
                self.report(HazardKind::GivenUp, site, self.active);
                self.domain.give_up(site, &self.active);
                self.stopped = self.stopped.or(self.active);
                self.active = Mask::NONE;
            }
            for (slot, fuel) in self.fuel.iter_mut().enumerate() {
                *fuel -= u32::from(self.active.has(slot));
            }
            self.block(body);
            let next = self.breakable.last_mut().and_then(|b| b.next.as_mut()).map_or(Mask::NONE, take);
            self.active = self.active.or(next);
            self.block(continuing);
            if let Some(reg) = break_if {
                let leaves = Mask::of(&self.words[reg as usize]).and(self.active);
                if let Some(around) = self.breakable.last_mut() {
                    around.left = around.left.or(leaves);
                }
                self.active = self.active.minus(leaves);
            }
        }
        self.active = self.breakable.pop().unwrap_or_default().left;
    }

    /// `break`.
    #[inline]
    pub(super) fn leave(&mut self) {
        if let Some(around) = self.breakable.last_mut() {
            around.left = around.left.or(self.active);
        }
        self.active = Mask::NONE;
    }

    /// `continue`.
    #[inline]
    pub(super) fn go_on(&mut self) {
        let mut around = self.breakable.iter_mut().rev();
        if let Some(next) = around.find_map(|b| b.next.as_mut()) {
            *next = next.or(self.active);
        }
        self.active = Mask::NONE;
    }

    /// `discard`.
    pub(super) fn kill(&mut self) {
        self.report(HazardKind::Killed, Site::new(0), Mask::ALL);
        self.stopped = self.stopped.or(self.active);
        self.active = Mask::NONE;
    }

    /// Gives up the slots that would go another way than invocations with which they have to stay together.
    pub(super) fn agree(&mut self, first: Reg, others: &[Reg], site: Site) {
        let first = &self.words[first as usize];
        let differs = |slot: usize| others.iter().any(|&reg| self.words[reg as usize][slot] != first[slot]);
        let mask = Mask::where_(differs).and(self.active);
        if !mask.is_empty() {
            self.report(HazardKind::Divergence, site, mask);
            self.domain.give_up(site, &mask);
        }
    }
}
