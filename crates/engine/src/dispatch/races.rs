//! How bad a race is: whether it takes numbers that were guessed, or contents that a host would not give.
//!
//! What is in a buffer is data, and a kernel has to be right for any. Two invocations that meet for the data at hand are
//! an error, but where their indices lie in a buffer as they are: of these, a host may know that none comes twice. How
//! numbers of the host relate to each other was chosen here, and what takes such a relation is a warning that says so.

use program::interp::group::{Access, Incident, Sources, Space};

use super::Dispatched;

/// What decides over whether two invocations meet.
pub(super) struct Meeting {
    /// For each of them, what its index is computed from.
    aims: Vec<Sources>,
    /// They are of one workgroup, or each is one.
    within: bool,
    /// One of them writes and the other one does not, or by an atomic function.
    pub mixed: bool,
}

impl Dispatched {
    pub(super) fn meeting(&self, incident: &Incident) -> Meeting {
        let parties = [Some(incident.who), incident.other];
        let aims = parties.into_iter().flatten().map(|party| self.depends.aims(party.site)).collect();
        let one = self.size.iter().product::<u32>() == 1;
        let within = incident.other.is_some_and(|other| one || other.group == incident.who.group);
        let mixed =
            incident.other.is_some_and(|other| (incident.who.access, other.access) != (Access::Write, Access::Write));
        Meeting { aims, within, mixed }
    }

    /// Memories that hold numbers of the host, of those that indices are computed from.
    fn settings(&self, meeting: &Meeting) -> Vec<&str> {
        let is_setting = |k: usize| match self.executable.memories()[k].space {
            Space::Uniform => true,
            Space::Storage { writes } => !writes && !self.uses.is_indexed(k as u32),
            Space::Workgroup => false,
        };
        self.aimed(meeting, &|k| is_setting(k))
    }

    fn aimed(&self, meeting: &Meeting, is: &dyn Fn(usize) -> bool) -> Vec<&str> {
        let memories = self.executable.memories().iter().enumerate();
        let aimed = |k: usize| meeting.aims.iter().any(|aims| aims.has(k));
        memories.filter(|(k, _)| aimed(*k) && is(*k)).map(|(_, shape)| &shape.name[..]).collect()
    }

    /// True where two invocations get to one place by their numbers alone, or by folded data, whatever a host gives.
    pub(super) fn is_met_whatever(&self, meeting: &Meeting, by_contents: bool) -> bool {
        if !self.settings(meeting).is_empty() {
            return false;
        }
        if meeting.aims.iter().all(|aims| aims.is_empty()) {
            // That one alone gets there, the contents may see to; and that there is one workgroup, the host.
            return meeting.within && (!by_contents || meeting.mixed);
        }
        meeting.aims.iter().all(|aims| aims.is_empty() || aims.is_folded())
    }

    /// True where what is stored comes of what was loaded there. Workgroups run one after the other: that two of them
    /// could have met is told where nothing in the text makes one wait for another.
    pub(super) fn loses_updates(&self, incident: &Incident) -> bool {
        let Some(memory) = incident.memory else { return false };
        let apart = incident.other.is_some_and(|other| other.group != incident.who.group);
        let waits = apart && (self.executable.uses_changes() || self.uses.atomics.len() > 1);
        self.depends.carried(incident.who.site).has_atomic(memory as usize) && !waits
    }

    /// What a race that is no error depends on, as the end of a message.
    pub(super) fn told_condition(&self, incident: &Incident) -> String {
        let meeting = self.meeting(incident);
        let list = |names: &[&str]| names.iter().map(|name| format!("`{name}`")).collect::<Vec<String>>().join(", ");
        let settings = self.settings(&meeting);
        if !settings.is_empty() {
            return format!("; where they go depends on {}, whose numbers are guessed", list(&settings));
        }
        let data = self.aimed(&meeting, &|k| self.executable.memories()[k].space == (Space::Storage { writes: false }));
        if data.is_empty() {
            return String::new();
        }
        format!("; where they go depends on {}, of which the host may know that no place comes twice", list(&data))
    }
}
