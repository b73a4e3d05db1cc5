//! Loads and stores at an index of each slot's own.

use super::code::{Choice, Register, Stray};
use super::domain::{Domain, Site};
use super::machine::Machine;
use super::meaning::HazardKind;
use super::slots::Mask;
use super::undefined::{Operand, Undefined};

/// Slots that have one index.
type Group = (usize, Mask);

impl<D: Domain> Machine<'_, D> {
    pub(super) fn gather(&mut self, index: u32, choices: &[Choice], unset: Option<Site>) {
        let groups = self.groups(index);
        for Choice { one, of } in choices {
            match groups[..] {
                // Slots that are not active may get any value.
                [(value, _)] => self.copy(*one, of[value]),
                _ => {
                    for (value, mask) in &groups {
                        self.merge(mask, *one, of[*value]);
                    }
                }
            }
            let Some(site) = unset else { continue };
            for (value, mask) in &groups {
                if let Some(&assigned) = self.assigned[one.file() as usize].get(&of[*value]) {
                    let found = Undefined { kind: HazardKind::Unset, site, what: None };
                    self.undefined(found, mask.minus(assigned), None, [Operand::None; 2]);
                }
            }
        }
    }

    pub(super) fn scatter(&mut self, index: u32, choices: &[Choice], strays: &[Stray]) {
        let mut groups = self.groups(index);
        if self.probe.is_some() {
            self.lead_astray(&mut groups, choices, strays);
        }
        for (value, mask) in groups {
            for Choice { one, of } in choices {
                let to = Register { reg: of[value], ..*one };
                self.assign(to, mask);
                self.merge(&mask, to, one.reg);
            }
        }
    }

    /// While undefined values are replaced: what a load outside of its array gives is one of them.
    pub(super) fn astray(&mut self, strays: &[Stray], choices: &[Choice]) {
        if self.probe.is_none() {
            return;
        }
        for stray in strays {
            let mask = self.outside(stray);
            choices.iter().for_each(|choice| self.substitute(HazardKind::Index, stray.site, mask, choice.one));
        }
    }

    /// While undefined values are replaced: a store outside of its array goes nowhere, or to another element.
    fn lead_astray(&self, groups: &mut Vec<Group>, choices: &[Choice], strays: &[Stray]) {
        let elements = choices.first().map_or(0, |choice| choice.of.len());
        for stray in strays.iter().filter(|stray| self.replaces(HazardKind::Index, stray.site)) {
            let mask = self.outside(stray);
            let before = groups.clone();
            groups.iter_mut().for_each(|(_, slots)| *slots = slots.minus(mask));
            let round = self.probe.as_ref().map_or(0, |probe| probe.round);
            if round % 2 == 1 && elements > 1 {
                let moved = before.into_iter().map(|(at, slots)| ((at + round) % elements, slots.and(mask)));
                groups.extend(moved);
            }
        }
    }

    fn outside(&self, stray: &Stray) -> Mask {
        let index = &self.words[stray.reg as usize];
        Mask::where_(|slot| index[slot] >= stray.len).and(self.active)
    }
}
