//! Races and indices outside of arrays that dispatches show, by the memory that they are about.

use program::interp::group::{Incident, Space, Wrong};
use program::interp::proof::HostNumbers;

use super::Dispatched;
use super::host::{Chosen, Scenario};
use super::run::{Met, Said, is_same_whatever_is_outside, note};
use crate::fuzz::{Finding, Severity};
use lanes::interrupt;

/// Contents of buffers that are tried for each size.
const VARIANTS: u64 = 2;

/// Workgroups of a dispatch with numbers that were worked out, at most.
const MOST_GROUPS: u32 = 64;

/// Elements of an array in it, at most.
const MOST_ELEMENTS: u32 = 1 << 16;

/// A fault of a memory.
#[derive(Clone, Debug)]
pub struct Shown {
    /// The number of the memory.
    pub memory: u32,
    /// True for two invocations that meet, false for an index outside of its array.
    pub race: bool,
    /// What a report says of it.
    pub finding: Finding,
}

/// True for what two invocations do to each other.
fn is_race(incident: &Incident) -> bool {
    matches!(incident.what, Wrong::Race | Wrong::Unordered | Wrong::SameValue | Wrong::LostUpdate)
}

impl Dispatched {
    /// Dispatches the stage as [`run`](super::run()) does. Gives what is no note, and the number of dispatches.
    pub fn shown(&self, command: &str) -> (Vec<Shown>, u64) {
        let lengths = self.lengths();
        let (mut met, mut dispatches): (Vec<Met>, u64) = (Vec::new(), 0);
        for items in self.sizes() {
            for variant in 0..VARIANTS {
                if interrupt::asked() {
                    break;
                }
                let scenario = self.scenario(items, Some(&lengths), variant);
                let outcome = self.play(&scenario, 0);
                dispatches += 1;
                let harmless = self.zeroed && is_same_whatever_is_outside(self, &scenario, &outcome);
                let said = Said { harmless, degenerate: false };
                let about = |incident: &Incident| is_race(incident) || incident.what == Wrong::Outside;
                for incident in outcome.incidents.into_iter().filter(about) {
                    note(self, &mut met, incident, &scenario, said, &lengths);
                }
            }
        }
        met.iter_mut().for_each(|met| met.doubtful = self.is_doubtful(met, &lengths));
        let one = |met: &Met| {
            let finding = self.told(met, command);
            let memory = met.incident.memory.filter(|_| finding.severity <= Severity::Warning)?;
            Some(Shown { memory, race: is_race(&met.incident), finding })
        };
        let mut shown: Vec<Shown> = met.iter().filter_map(one).collect();
        shown.sort_by_key(|own| own.finding.severity);
        (shown, dispatches)
    }

    /// What a dispatch with numbers that were worked out does to a memory, in words; none where nothing is seen of it.
    pub fn shown_with(&self, numbers: &HostNumbers, memory: u32, command: &str) -> Option<Finding> {
        if numbers.groups.iter().try_fold(1_u32, |all, n| all.checked_mul(*n)).is_none_or(|all| all > MOST_GROUPS) {
            return None;
        }
        let lengths = self.lengths();
        let items = std::array::from_fn(|axis| numbers.groups[axis].max(1) * self.size[axis]);
        let mut scenario = self.scenario(items, Some(&lengths), 0);
        scenario.groups = numbers.groups.map(|n| n.max(1));
        for (k, elements) in &numbers.lengths {
            let shape = &self.executable.memories()[*k as usize];
            let elements = (*elements).min(MOST_ELEMENTS);
            let buffer = &mut scenario.buffers[*k as usize];
            if shape.is_open() && elements > 0 {
                buffer.words.resize(shape.words_with(elements), 0);
                buffer.elements = elements;
            }
        }
        for (k, word, value) in &numbers.words {
            let buffer = &mut scenario.buffers[*k as usize];
            *buffer.words.get_mut(*word as usize)? = *value;
            let name = self.executable.memories()[*k as usize].place(*word);
            state(&mut scenario, name, (*k, *word), *value);
        }
        self.seen_in(&scenario, memory, command)
    }

    fn seen_in(&self, scenario: &Scenario, memory: u32, command: &str) -> Option<Finding> {
        let outcome = self.play(scenario, 0);
        let is_about = |incident: &Incident| {
            let shape = &self.executable.memories()[memory as usize];
            incident.memory == Some(memory) && shape.space != Space::Uniform && incident.what == Wrong::Race
        };
        let incident = outcome.incidents.into_iter().find(is_about)?;
        let mut met = Vec::new();
        note(self, &mut met, incident, scenario, Said::default(), &[]);
        met.first().map(|met| self.told(met, command))
    }
}

/// States a number of the host at a word of a memory.
fn state(scenario: &mut Scenario, name: String, place: (u32, u32), value: u32) {
    match scenario.settings.iter_mut().find(|own| own.place == place) {
        Some(own) => own.value = value,
        None => scenario.settings.push(Chosen { name, value, place }),
    }
}
