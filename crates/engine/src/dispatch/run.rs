//! Plays scenarios and collects what went wrong.

use program::interp::group::{Incident, Wrong};
use program::interp::{Finding as Hazard, HazardKind};

use super::Dispatched;
use super::host::{Length, Scenario};
use crate::fuzz::{Finding, FunctionReport};
use lanes::interrupt;

/// Contents of buffers that are tried for each size.
const VARIANTS: u64 = 2;

/// Something that went wrong, with the first scenario that shows it.
pub(super) struct Met {
    pub incident: Incident,
    pub scenario: Scenario,
    /// How the length of the array is guessed.
    pub length: Option<Length>,
    /// Fewer invocations than have no element came upon it: others are kept away.
    pub guarded: bool,
}

/// Dispatches a stage in many sizes, and adds what is found to its report. `command` shows it again.
pub fn run(subject: &Dispatched, command: &str, report: &mut FunctionReport) {
    let lengths = subject.lengths();
    let mut met: Vec<Met> = Vec::new();
    let mut endless: Vec<(Hazard, Scenario)> = Vec::new();
    for items in subject.sizes() {
        for variant in 0..VARIANTS {
            if interrupt::asked() {
                break;
            }
            let scenario = subject.scenario(items, Some(&lengths), variant);
            let outcome = subject.play(&scenario);
            report.dispatches += 1;
            for incident in outcome.incidents {
                note(&mut met, incident, &scenario, &lengths);
            }
            for hazard in outcome.findings.into_iter().filter(|hazard| hazard.kind == HazardKind::Fuel) {
                if endless.iter().all(|(own, _)| own.site != hazard.site) {
                    endless.push((hazard, scenario.clone()));
                }
            }
        }
    }
    let mut found: Vec<Finding> = met.iter().map(|met| subject.told(met, command)).collect();
    found.extend(endless.iter().map(|(hazard, scenario)| subject.told_endless(hazard, scenario, command)));
    report.findings.extend(found);
    report.findings.sort_by_key(|finding| (finding.severity, finding.kind));
}

fn note(met: &mut Vec<Met>, incident: Incident, scenario: &Scenario, lengths: &[Length]) {
    let unknown = |k: u32| matches!(lengths.get(k as usize), Some(Length::Unknown(_)));
    // Of an array whose length nobody knows, no index is outside.
    if incident.what == Wrong::Outside && incident.memory.is_some_and(unknown) {
        return;
    }
    let other = |incident: &Incident| incident.other.map(|party| party.site);
    let same = |own: &&mut Met| {
        own.incident.what == incident.what
            && own.incident.memory == incident.memory
            && own.incident.who.site == incident.who.site
            && other(&own.incident) == other(&incident)
    };
    match met.iter_mut().find(same) {
        Some(own) => own.incident.count += incident.count,
        None => {
            let length = incident.memory.and_then(|k| lengths.get(k as usize).copied());
            let guarded = incident.count < scenario.surplus;
            met.push(Met { incident, scenario: scenario.clone(), length, guarded });
        }
    }
}
