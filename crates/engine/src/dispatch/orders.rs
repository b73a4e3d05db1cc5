//! Dispatches of which the results of atomic functions are used, in several orders of workgroups and invocations.
//!
//! ```text
//! scenario ─ natural order ─▶ Outcome ─┬─ contents that differ ─▶ a warning, or a note
//!          ─ other orders ──▶ Outcomes ┴─ races, stray indices, barriers ─▶ Met, with the simplest order that shows it
//! ```
//!
//! A dispatch that does not end in another order is left out: a workgroup may wait for one before it, which is one of
//! the first to start on every device. Contents that are the same numbers at other places are no fault, for the place
//! came from an atomic function.

use std::collections::BTreeMap;

use base::value::Scalar;
use program::interp::HazardKind;
use program::interp::group::{Incident, MemoryShape, Outcome, Space, Turn, Turns, Wrong};

use super::Dispatched;
use super::host::{Length, Scenario};
use super::run::{Met, Said, is_same_whatever_is_outside, note};
use crate::fuzz::{Finding, FunctionReport, FuzzFindingKind, Severity};
use lanes::interrupt;

/// Part of a number that the order of a sum may change in binary64, seen in binary32.
const SLACK: f64 = 1e-6;

/// Instructions that all dispatches in other orders together may take, each for as many invocations as go side by side:
/// a second or two.
const BUDGET: u64 = 1 << 20;

/// Words of buffers that are prepared in the time of one instruction.
const WORDS: u64 = 128;

/// Orders that are tried for a dispatch, the simple ones first.
fn turns(groups: u32, size: u32) -> Vec<Turns> {
    let natural = Turns::default();
    let of_groups = |groups: Turn| Turns { groups, ..natural };
    let of_invocations = |invocations: Turn| Turns { invocations, ..natural };
    let mut all = Vec::new();
    if groups > 1 {
        all.push(of_groups(Turn::First(1)));
    }
    if size > 1 {
        all.push(of_invocations(Turn::First(1)));
        all.push(of_invocations(Turn::First(size - 1)));
        all.push(Turns { ahead: Some(0), ..natural });
        all.push(Turns { ahead: Some(size - 1), ..natural });
        all.push(of_invocations(Turn::Reversed));
    }
    if groups > 2 {
        all.push(of_groups(Turn::Reversed));
    }
    if groups.max(size) > 1 {
        all.push(Turns { groups: Turn::Shuffled(1), invocations: Turn::Shuffled(2), ahead: None });
    }
    all
}

/// Simpler orders in which two invocations may meet as well, the simplest first.
fn simpler(incident: &Incident, turns: Turns) -> Vec<Turns> {
    let natural = Turns::default();
    let parties = || [Some(incident.who), incident.other].into_iter().flatten();
    let mut all = Vec::new();
    if turns.groups != Turn::Natural {
        all.extend(parties().map(|party| Turns { groups: Turn::First(party.group), ..natural }));
    }
    if turns.invocations != Turn::Natural {
        let first = |local: u32| Turns { invocations: Turn::First(local), ..natural };
        let last = |local: u32| Turns { invocations: Turn::Last(local), ..natural };
        all.extend(parties().map(|party| first(party.local)));
        all.extend(parties().map(|party| last(party.local)));
    }
    all
}

/// An order in words, as they stand behind "where".
fn told(turns: Turns, scenario: &Scenario) -> String {
    let groups: u32 = scenario.groups.iter().product();
    let mut parts = Vec::new();
    match turns.groups {
        Turn::Natural => {}
        Turn::Reversed | Turn::First(1) | Turn::Last(0) if groups == 2 => {
            parts.push("workgroup 1 comes before workgroup 0".to_owned());
        }
        Turn::First(k) => parts.push(format!("workgroup {k} comes before the others")),
        Turn::Last(k) => parts.push(format!("workgroup {k} comes after the others")),
        Turn::Reversed => parts.push("the last workgroup comes first, and so on".to_owned()),
        Turn::Shuffled(_) if groups == 1 => {}
        Turn::Shuffled(_) => parts.push("workgroups come in no order".to_owned()),
    }
    match turns.invocations {
        Turn::Natural => {}
        Turn::First(k) => parts.push(format!("invocation {k} comes before the others of its workgroup")),
        Turn::Last(k) => parts.push(format!("invocation {k} comes after the others of its workgroup")),
        Turn::Reversed => parts.push("the last invocation of a workgroup comes first, and so on".to_owned()),
        Turn::Shuffled(_) => parts.push("invocations of a workgroup come in no order".to_owned()),
    }
    if let Some(k) = turns.ahead {
        parts.push(format!("invocation {k} runs ahead of the others of its workgroup"));
    }
    parts.join(" and ")
}

/// True for what may take a certain order.
fn is_of_order(wrong: Wrong) -> bool {
    matches!(
        wrong,
        Wrong::Race | Wrong::Unordered | Wrong::Outside | Wrong::Divergence | Wrong::Unwritten | Wrong::LostUpdate
    )
}

/// True for invocations that meet in a memory, within a workgroup or not, where others do: that one is told.
fn is_known(met: &[Met], incident: &Incident) -> bool {
    let within = |incident: &Incident| incident.other.map(|party| party.group == incident.who.group);
    let races = |wrong: Wrong| matches!(wrong, Wrong::Race | Wrong::Unordered | Wrong::SameValue);
    met.iter().any(|met| {
        let own = &met.incident;
        own.is_same(incident)
            || (races(own.what)
                && races(incident.what)
                && own.memory == incident.memory
                && within(own) == within(incident))
    })
}

/// True where a dispatch came to its end, none of its loops cut off.
fn ended(outcome: &Outcome) -> bool {
    outcome.whole && outcome.findings.iter().all(|hazard| hazard.kind != HazardKind::Fuel)
}

/// Runs a stage that goes on with results of atomic functions in other orders. What is met there and nowhere else is
/// added to `met`; the answer is an output that depends on the order.
pub(super) fn run(
    subject: &Dispatched,
    lengths: &[Length],
    met: &mut Vec<Met>,
    report: &mut FunctionReport,
    command: &str,
) -> Option<Finding> {
    if !subject.executable.uses_results() {
        return None;
    }
    let mut depends = None;
    let (known, instructions, mut spent) = (met.len(), subject.executable.length(), 0);
    for items in subject.sizes() {
        if spent > BUDGET {
            break;
        }
        let scenario = subject.scenario(items, Some(lengths), 0);
        let natural = subject.play_in::<f64>(&scenario, 0);
        let words: usize = scenario.buffers.iter().map(|buffer| buffer.words.len()).sum();
        let cost = natural.rounds * instructions + words as u64 / WORDS;
        spent += cost;
        if !ended(&natural) {
            continue;
        }
        // What a race leaves depends on the order as well.
        let clean = natural.incidents.is_empty();
        for turns in turns(scenario.groups.iter().product(), subject.size.iter().product()) {
            if interrupt::asked() {
                return None;
            }
            if spent + cost > BUDGET {
                break;
            }
            let scenario = Scenario { turns, ..scenario.clone() };
            let outcome = subject.play_in::<f64>(&scenario, 0);
            report.dispatches += 1;
            spent += outcome.rounds * instructions + words as u64 / WORDS;
            if !ended(&outcome) {
                continue;
            }
            if clean && depends.is_none() && outcome.incidents.is_empty() {
                depends = subject.told_order(&natural, &outcome, &scenario, command);
            }
            let harmless = subject.zeroed && is_same_whatever_is_outside(subject, &scenario, &outcome);
            let said = Said { harmless, ..Said::default() };
            for incident in outcome.incidents {
                if is_of_order(incident.what) && !is_known(&met[..known], &incident) {
                    note(subject, met, incident, &scenario, said, lengths);
                }
            }
        }
    }
    for met in &mut met[known..] {
        simplify(subject, met);
    }
    // That the flag of another workgroup orders nothing is of no weight where nobody waits for it.
    let raced: Vec<Option<u32>> =
        met.iter().filter(|met| met.incident.what == Wrong::Race).map(|met| met.incident.memory).collect();
    met.retain(|met| met.incident.what != Wrong::Relaxed || !raced.contains(&met.incident.memory));
    // It may be how the race shows.
    depends.filter(|_| met.iter().all(|met| !is_of_order(met.incident.what)))
}

/// Replaces the order that shows something by the simplest one that does.
fn simplify(subject: &Dispatched, met: &mut Met) {
    for turns in simpler(&met.incident, met.scenario.turns) {
        let scenario = Scenario { turns, ..met.scenario.clone() };
        let outcome = subject.play_in::<f64>(&scenario, 0);
        let same = outcome.incidents.iter().find(|incident| incident.is_same(&met.incident));
        if let Some(incident) = same.filter(|_| ended(&outcome)) {
            met.incident = Incident { count: met.incident.count, ..incident.clone() };
            met.scenario = scenario;
            return;
        }
    }
}

impl Scenario {
    /// The order that it takes, as the end of a message.
    pub(super) fn told_order(&self) -> String {
        if self.turns == Turns::default() { String::new() } else { format!(", where {}", told(self.turns, self)) }
    }
}

impl Dispatched {
    /// A buffer that holds other numbers behind a dispatch in another order.
    fn told_order(&self, one: &Outcome, other: &Outcome, scenario: &Scenario, command: &str) -> Option<Finding> {
        for (k, shape) in self.executable.memories().iter().enumerate() {
            if shape.space != (Space::Storage { writes: true }) {
                continue;
            }
            let (own, theirs) = (&one.contents[k], &other.contents[k]);
            if own == theirs || is_permuted(shape, own, theirs) {
                continue;
            }
            let differs = |(word, (a, b)): (usize, (&u32, &u32))| !is_near(scalar(shape, word), *a, *b);
            let word = own.iter().zip(theirs).enumerate().position(differs)?;
            let shown = |bits: u32| match scalar(shape, word) {
                Scalar::F32 => f32::from_bits(bits).to_string(),
                Scalar::I32 => bits.cast_signed().to_string(),
                Scalar::U32 | Scalar::Bool => bits.to_string(),
            };
            let message = format!(
                "`{}` depends on the order of invocations: it is {} in the order of their numbers, and {} where {}",
                shape.place(word as u32),
                shown(own[word]),
                shown(theirs[word]),
                told(scenario.turns, scenario)
            );
            let site = self.executable.only_store(k as u32);
            // Lists and locks are made of exchanges. Whoever stores a ticket, or at the place of one, knows that anyone may
            // have it.
            let of_tickets = |site| self.depends.aims(site).or(self.depends.carried(site)).is_by_atomics();
            let meant = site.is_none_or(of_tickets)
                || self.executable.uses_exchanges()
                || self.uses.atomics.contains(&(k as u32));
            let severity = if meant { Severity::Note } else { Severity::Warning };
            return Some(self.finding(FuzzFindingKind::Order, severity, message, site, (1, scenario), command));
        }
        None
    }
}

fn scalar(shape: &MemoryShape, word: usize) -> Scalar {
    shape.at(word as u32).map_or(Scalar::U32, |(_, leaf)| leaf.scalar)
}

fn is_near(scalar: Scalar, a: u32, b: u32) -> bool {
    let (x, y) = (f64::from(f32::from_bits(a)), f64::from(f32::from_bits(b)));
    a == b || (scalar == Scalar::F32 && (x - y).abs() <= SLACK * x.abs().max(y.abs()).max(SLACK))
}

/// True where each member of a buffer has the same numbers in another order.
fn is_permuted(shape: &MemoryShape, one: &[u32], other: &[u32]) -> bool {
    type Member = (bool, String, Option<u32>);
    let members = |words: &[u32]| {
        let mut all: BTreeMap<Member, (Scalar, Vec<u32>)> = BTreeMap::new();
        for (word, &bits) in words.iter().enumerate() {
            if let Some((index, leaf)) = shape.at(word as u32) {
                let key = (index.is_some(), leaf.name.to_string(), leaf.component);
                all.entry(key).or_insert_with(|| (leaf.scalar, Vec::new())).1.push(bits);
            }
        }
        for (scalar, words) in all.values_mut() {
            match scalar {
                Scalar::F32 => words.sort_unstable_by(|a, b| f32::from_bits(*a).total_cmp(&f32::from_bits(*b))),
                Scalar::I32 | Scalar::U32 | Scalar::Bool => words.sort_unstable(),
            }
        }
        all
    };
    let (own, theirs) = (members(one), members(other));
    own.values()
        .zip(theirs.values())
        .all(|((scalar, a), (_, b))| a.iter().zip(b).all(|(a, b)| is_near(*scalar, *a, *b)))
}
