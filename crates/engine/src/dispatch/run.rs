//! Plays scenarios and collects what went wrong.

use program::interp::group::{Access, Incident, MemoryShape, Outcome, Space, Wrong};
use program::interp::{Finding as Hazard, HazardKind};

use super::Dispatched;
use super::host::{Length, Scenario};
use crate::fuzz::{Finding, FunctionReport};
use judge::verdict::diagnosis::Place;
use lanes::interrupt;

/// Contents of buffers that are tried for each size.
pub(super) const VARIANTS: u64 = 2;

/// The choices of a host that puts one number everywhere.
pub(super) const EQUAL: u64 = 2;

/// The choices of a host that puts 0 everywhere.
pub(super) const ZERO: u64 = 3;

/// The choices of a host one of whose numbers is 0: there is nothing of something.
pub(super) const EMPTY: u64 = 4;

/// Bits that loads outside of their arrays give the second time; as a number, 1.2e17.
const OTHER: u32 = 0x5bd1_e995;

/// The choices of a host that puts numbers into buffers of which functions may be too large for binary32.
pub(super) const LARGE: u64 = 5;

/// The choices of a host whose numbers differ from each other, first and last.
pub(super) const SPREAD: std::ops::Range<u64> = LARGE + 1..LARGE + 5;

/// True for the choices of such a host.
pub(super) fn is_spread(variant: u64) -> bool {
    SPREAD.contains(&variant)
}

/// Something that went wrong, with the first scenario that shows it.
pub(super) struct Met {
    pub incident: Incident,
    pub scenario: Scenario,
    /// How the length of the array is guessed.
    pub length: Option<Length>,
    /// Fewer invocations than have no element came upon it: others are kept away.
    pub guarded: bool,
    /// A load whose value has no say in what buffers hold in the end.
    pub harmless: bool,
    /// Integers were divided by zero in each dispatch that shows it: its numbers are none that a host gives.
    pub degenerate: bool,
    /// It takes place because numbers of the host were guessed that do not fit together.
    pub doubtful: bool,
}

impl Met {
    /// True for an array whose length nobody knows: an index is outside in front of it alone.
    pub fn is_of_unknown_length(&self, shape: Option<&MemoryShape>) -> bool {
        is_of_unknown_length(shape, self.length)
    }

    /// True where one fault is likelier than two: an invocation goes outside at one index of several arrays or in several
    /// places, and invocations meet in one memory.
    fn has_same_cause(&self, other: &Self) -> bool {
        let (own, their) = (&self.incident, &other.incident);
        if own.what != their.what
            || (self.doubtful, self.harmless) != (other.doubtful, other.harmless)
            || self.scenario.turns != other.scenario.turns
        {
            return false;
        }
        let within = |incident: &Incident| incident.other.map(|party| party.group == incident.who.group);
        match own.what {
            Wrong::Outside => {
                let at = |incident: &Incident| (incident.who.group, incident.who.local, incident.index);
                at(own) == at(their) && self.length == other.length && self.guarded == other.guarded
            }
            Wrong::Race | Wrong::Unordered | Wrong::SameValue | Wrong::LostUpdate | Wrong::Relaxed => {
                own.memory == their.memory && within(own) == within(their)
            }
            Wrong::Unwritten => own.memory == their.memory,
            Wrong::Divergence | Wrong::Apart | Wrong::NotANumber => false,
        }
    }
}

fn is_of_unknown_length(shape: Option<&MemoryShape>, length: Option<Length>) -> bool {
    shape.is_some_and(MemoryShape::is_open) && matches!(length, Some(Length::Unknown(_)))
}

/// What a dispatch says of all that is met in it.
#[derive(Clone, Copy, Default)]
pub(super) struct Said {
    pub harmless: bool,
    pub degenerate: bool,
}

/// Dispatches a stage in many sizes, and adds what is found to its report. `command` shows it again. Of a caller that was
/// made up, nobody asks whether it stores anything.
pub fn run(subject: &Dispatched, made_up: bool, command: &str, report: &mut FunctionReport) {
    let (lengths, widths) = (subject.lengths(), subject.widths());
    let mut met: Vec<Met> = Vec::new();
    let mut endless: Vec<(Hazard, Scenario)> = Vec::new();
    let mut cut_off: Option<(u64, Scenario)> = None;
    let mut unknown: Option<Finding> = None;
    // A stage that stores nothing has not been tried.
    let mut idle: Option<Scenario> = None;
    let mut stores = made_up || subject.uses.stores.is_empty();
    for items in subject.sizes() {
        for (variant, subgroup) in (0..VARIANTS).flat_map(|variant| widths.iter().map(move |&width| (variant, width))) {
            if interrupt::asked() {
                break;
            }
            let scenario = Scenario { subgroup, ..subject.scenario(items, Some(&lengths), variant) };
            let outcome = subject.play(&scenario, 0);
            report.dispatches += 1;
            stores |= subject.stores_in(&outcome) || !outcome.whole;
            idle.get_or_insert_with(|| scenario.clone());
            if !outcome.whole && !interrupt::asked() {
                cut_off.get_or_insert_with(|| (0, scenario.clone())).0 += 1;
            }
            unknown = unknown.or_else(|| subject.told_unknown(&lengths, &scenario, command));
            let harmless = subject.zeroed && is_same_whatever_is_outside(subject, &scenario, &outcome);
            // The root of a negative number is what was chosen here.
            let chosen = |incident: &Incident| incident.what == Wrong::NotANumber && variant == 0;
            let by_zero = |hazard: &Hazard| hazard.kind == HazardKind::DivisionByZero;
            let said = Said { harmless, degenerate: outcome.findings.iter().any(by_zero) };
            for incident in outcome.incidents.into_iter().filter(|incident| !chosen(incident)) {
                note(subject, &mut met, incident, &scenario, said, &lengths);
            }
            for hazard in outcome.findings.into_iter().filter(|hazard| hazard.kind == HazardKind::Fuel) {
                if endless.iter().all(|(own, _)| own.site != hazard.site) {
                    endless.push((hazard, scenario.clone()));
                }
            }
        }
        for &smaller in subject.smaller_images() {
            let scenario = subject.scenario_with(items, Some(&lengths), 0, Some(smaller));
            let outcome = subject.play(&scenario, 0);
            report.dispatches += 1;
            let about = |incident: &Incident| subject.guarded_by(incident, scenario.groups).is_some();
            for incident in outcome.incidents.into_iter().filter(about) {
                note(subject, &mut met, incident, &scenario, Said::default(), &lengths);
            }
        }
    }
    with_other_numbers(subject, &mut met, report);
    without_value(subject, &lengths, &mut met, report);
    let ordered = super::orders::run(subject, &lengths, &mut met, report, command);
    met.iter_mut().for_each(|met| met.doubtful = subject.is_doubtful(met, &lengths));
    let mut found = by_cause(subject, &met, command);
    found.extend(endless.iter().map(|(hazard, scenario)| subject.told_endless(hazard, scenario, command)));
    let all = report.dispatches;
    found.extend(idle.filter(|_| !stores).map(|scenario| subject.told_idle(all, &scenario, command)));
    found.extend(cut_off.map(|(count, scenario)| subject.told_cut_off(count, all, &scenario, command)));
    found.extend(unknown);
    found.extend(ordered);
    found.extend(subject.told_width(&lengths, command));
    report.findings.extend(found);
    report.findings.sort_by_key(|finding| (finding.severity, finding.kind));
}

/// What was met as findings: one of those with the same cause and weight, with the places of the others.
fn by_cause(subject: &Dispatched, met: &[Met], command: &str) -> Vec<Finding> {
    let mut found: Vec<(&Met, Finding)> = Vec::new();
    for met in met {
        let told = subject.told(met, command);
        let same = |(other, own): &&mut (&Met, Finding)| own.severity == told.severity && met.has_same_cause(other);
        match found.iter_mut().find(same) {
            Some((_, own)) => {
                let known =
                    |place: &Place| own.place.iter().chain(own.also.iter().map(|(at, _)| at)).any(|at| at == place);
                let further = told.place.filter(|place| !known(place)).map(|place| (place, told.count));
                own.also.extend(further);
            }
            None => found.push((met, told)),
        }
    }
    found.into_iter().map(|(_, finding)| finding).collect()
}

/// Looks for invocations that get in each other's way where the numbers of a host differ from each other, and get to what the
/// small ones of other hosts keep them from.
fn with_other_numbers(subject: &Dispatched, met: &mut Vec<Met>, report: &mut FunctionReport) {
    if !subject.has_open_numbers() {
        return;
    }
    // Two workgroups write at one place where a host would not dispatch both of them.
    let reads = |incident: &Incident| {
        let both = [Some(incident.who), incident.other].into_iter().flatten();
        let within = incident.other.is_some_and(|other| other.group == incident.who.group);
        within || both.into_iter().any(|party| party.access == Access::Read)
    };
    let among = |incident: &Incident| match incident.what {
        Wrong::Unordered | Wrong::Divergence => true,
        Wrong::Race => reads(incident),
        _ => false,
    };
    for variant in SPREAD {
        let lengths = subject.lengths_with(variant);
        for items in subject.sizes().into_iter().rev().step_by(3) {
            if interrupt::asked() || met.iter().any(|met| among(&met.incident)) {
                return;
            }
            let scenario = subject.scenario(items, Some(&lengths), variant);
            let outcome = subject.play(&scenario, 0);
            report.dispatches += 1;
            for incident in outcome.incidents.into_iter().filter(among) {
                note(subject, met, incident, &scenario, Said::default(), &lengths);
            }
        }
    }
}

/// Looks for NaN with contents of buffers on which formulas break. Others follow from the first one, which is told.
fn without_value(subject: &Dispatched, lengths: &[Length], met: &mut Vec<Met>, report: &mut FunctionReport) {
    let is_nan = |incident: &Incident| incident.what == Wrong::NotANumber;
    let mut found = met.iter().any(|met| is_nan(&met.incident));
    let mut look = |scenario: &Scenario, wanted: &dyn Fn(&Incident) -> bool| {
        let outcome = subject.play(scenario, 0);
        report.dispatches += 1;
        let first = outcome.incidents.into_iter().find(wanted);
        let found = first.is_some();
        first.into_iter().for_each(|incident| note(subject, met, incident, scenario, Said::default(), lengths));
        found
    };
    for items in subject.sizes().into_iter().rev().step_by(4) {
        if interrupt::asked() || found {
            break;
        }
        found = look(&subject.scenario(items, Some(lengths), EQUAL), &is_nan);
    }
    // What a workgroup sums up may be nothing. Of single elements, such as masses, a host may know that none is 0.
    let collected = |incident: &Incident| is_nan(incident) && subject.depends.value(incident.who.site).is_collected();
    let mut memories = subject.executable.memories().iter();
    let last = subject.sizes().pop();
    if let Some(items) = last.filter(|_| !found && memories.any(|shape| shape.space == Space::Workgroup)) {
        found = look(&subject.scenario(items, Some(lengths), ZERO), &collected);
    }
    if let Some(items) = last.filter(|_| !found) {
        let large = subject.scenario(items, Some(lengths), LARGE);
        // Where binary64 has no number either, a host may know that it never comes to that.
        let of_binary32 = !subject.play_in::<f64>(&large, 0).incidents.iter().any(is_nan);
        found = of_binary32 && look(&large, &is_nan);
    }
    if let Some(items) = last.filter(|_| !found) {
        let whole = subject.scenario(items, Some(lengths), EMPTY);
        // The first is told.
        let _ = subject.emptied(&whole).any(|scenario| look(&scenario, &is_nan));
    }
    let mut first = true;
    met.retain(|met| met.incident.what != Wrong::NotANumber || std::mem::take(&mut first));
}

/// WGSL bounds loads: what they give outside matters where it gets into a buffer. `select` evaluates both of its values,
/// so that `select(0u, sums[i - 1u], i > 0u)` is a load outside that has no say.
pub(super) fn is_same_whatever_is_outside(subject: &Dispatched, scenario: &Scenario, outcome: &Outcome) -> bool {
    let outside = |incident: &Incident| incident.what == Wrong::Outside && incident.who.access == Access::Read;
    if !outcome.incidents.iter().any(outside) {
        return true;
    }
    let other = subject.play(scenario, OTHER);
    let storage = |k: usize| matches!(subject.executable.memories()[k].space, Space::Storage { .. });
    (0..outcome.contents.len()).filter(|&k| storage(k)).all(|k| outcome.contents[k] == other.contents[k])
}

pub(super) fn note(
    subject: &Dispatched,
    met: &mut Vec<Met>,
    incident: Incident,
    scenario: &Scenario,
    said: Said,
    lengths: &[Length],
) {
    let shape = incident.memory.and_then(|k| subject.executable.memories().get(k as usize));
    let length = incident.memory.and_then(|k| lengths.get(k as usize).copied());
    // Of an array whose length nobody knows, an index is outside in front of it alone.
    if incident.what == Wrong::Outside && is_of_unknown_length(shape, length) && !incident.is_in_front() {
        return;
    }
    if incident.what == Wrong::LostUpdate && !subject.loses_updates(&incident) {
        return;
    }
    match met.iter_mut().find(|own| own.incident.is_same(&incident)) {
        Some(own) => {
            own.incident.count += incident.count;
            own.harmless &= said.harmless;
            own.degenerate &= said.degenerate;
        }
        None => {
            let guarded = incident.count < scenario.surplus;
            let (Said { harmless, degenerate }, scenario) = (said, scenario.clone());
            met.push(Met { incident, scenario, length, guarded, harmless, degenerate, doubtful: false });
        }
    }
}
