//! What speaks against what was met: numbers of a host of whose meaning nothing in the shader tells.
//!
//! A finding that appears only where a guessed number makes a divisor zero, where elements fill no whole tiles, or
//! through numbers that share a vector of four for different purposes, is a note.

use std::collections::{BTreeMap, BTreeSet};

use program::interp::group::{Incident, Sources, Space, Wrong};

use super::Dispatched;
use super::host::Length;
use super::run::{Met, SPREAD, VARIANTS, is_spread};
use base::value::Scalar;

/// Elements along an axis, in the order in which axes get them: multiples of what kernels take for tiles, and different.
const WHOLE: [u32; 3] = [128, 192, 64];

impl Dispatched {
    /// True where it takes place because numbers were guessed that do not fit together.
    pub(super) fn is_doubtful(&self, met: &Met, lengths: &[Length]) -> bool {
        let incident = &met.incident;
        let shape = incident.memory.and_then(|k| self.executable.memories().get(k as usize));
        let storage = shape.is_some_and(|shape| matches!(shape.space, Space::Storage { .. }));
        if !storage || !matches!(incident.what, Wrong::Race | Wrong::Outside) {
            return false;
        }
        let sources = self.depends.of(incident.who.site);
        if met.is_of_unknown_length(shape) && incident.what == Wrong::Outside && self.is_by_settings(sources) {
            return !self.is_met_with_all_numbers(incident, lengths);
        }
        if met.degenerate && self.is_by_settings(sources) {
            return true;
        }
        self.is_by_packed_numbers(incident) || (incident.what == Wrong::Race && !self.is_with_whole_tiles(met, lengths))
    }

    /// True where it takes place whatever numbers a host is given.
    fn is_met_with_all_numbers(&self, incident: &Incident, lengths: &[Length]) -> bool {
        let items = self.sizes().pop().unwrap_or(self.size);
        let mut outcomes =
            (0..VARIANTS).chain(SPREAD).map(|variant| self.play(&self.scenario(items, Some(lengths), variant), 0));
        outcomes.all(|outcome| outcome.incidents.iter().any(|other| other.is_same(incident) && other.is_in_front()))
    }

    /// True where numbers in uniforms have a say.
    pub(super) fn is_by_settings(&self, sources: Sources) -> bool {
        let memories = self.executable.memories().iter().enumerate();
        memories.into_iter().any(|(k, shape)| shape.space == Space::Uniform && sources.has(k))
    }

    /// True where numbers have a say that a vector of four holds for different purposes.
    fn is_by_packed_numbers(&self, incident: &Incident) -> bool {
        let packed = self.packed();
        let sites = [Some(incident.who), incident.other].into_iter().flatten().map(|party| party.site);
        let sources = sites.map(|site| match incident.what {
            // A guard may compare with them.
            Wrong::Outside => self.depends.of(site),
            _ => self.depends.leads(site),
        });
        sources.into_iter().any(|sources| packed.iter().any(|&k| sources.has(k)))
    }

    /// Uniform memories with a vector of four whole numbers that is no size: a dispatch has three axes, from x on.
    fn packed(&self) -> Vec<usize> {
        let is_packed = |k: usize| {
            let shape = &self.executable.memories()[k];
            let mut vectors: BTreeMap<&str, (bool, BTreeSet<u32>)> = BTreeMap::new();
            for leaf in shape.fixed.iter().filter(|leaf| leaf.scalar != Scalar::F32) {
                let Some(component) = leaf.component else { continue };
                let (of_four, read) = vectors.entry(&leaf.name).or_default();
                *of_four |= component == 3;
                if self.uses.names(k as u32, leaf.offset) {
                    read.insert(component);
                }
            }
            let is_no_size = |read: &BTreeSet<u32>| read.contains(&3) || read.iter().zip(0..).any(|(k, n)| *k != n);
            shape.space == Space::Uniform && vectors.values().any(|(of_four, read)| *of_four && is_no_size(read))
        };
        (0..self.executable.memories().len()).filter(|&k| is_packed(k)).collect()
    }

    /// True where two invocations meet as well when all numbers of elements are multiples of 64: a kernel that counts tiles
    /// is dispatched for whole ones, and `n / 32` is 0 otherwise. What does not depend on numbers of the host is left alone.
    fn is_with_whole_tiles(&self, met: &Met, lengths: &[Length]) -> bool {
        let incident = &met.incident;
        let parties = [Some(incident.who), incident.other].into_iter().flatten();
        let led = parties.into_iter().any(|party| self.is_by_settings(self.depends.leads(party.site)));
        if !led || self.axes.is_empty() {
            return true;
        }
        let mut items = self.size;
        for (&axis, whole) in self.axes.iter().zip(WHOLE) {
            items[axis] = whole.next_multiple_of(self.size[axis]);
        }
        let meets = |variant: u64, lengths: &[Length]| {
            let outcome = self.play(&self.scenario(items, Some(lengths), variant), 0);
            // What was cut off may have met behind that.
            !outcome.whole || outcome.incidents.iter().any(|other| other.is_same(incident))
        };
        match is_spread(met.scenario.variant) {
            true => SPREAD.into_iter().any(|variant| meets(variant, &self.lengths_with(variant))),
            false => meets(0, lengths),
        }
    }
}
