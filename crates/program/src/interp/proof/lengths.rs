//! Up to where an index goes, in numbers of the host: what the length of an array has to be at least.

use std::collections::BTreeSet;
use std::rc::Rc;

use number::linear::{Constraint, Polynomial, Unknown};

use super::accesses::{Seen, SeenStep};
use super::variables::{Fact, Meaning, Scope, Variables};
use super::walk::Walk;

/// Lengths that are tried for an index.
const MOST_TRIED: usize = 40;

/// Unknowns that are replaced by their bounds, one after the other.
const MOST_REPLACED: usize = 6;

/// A length that is a number is told up to here.
const MOST_ELEMENTS: i128 = 1 << 20;

impl Walk<'_> {
    /// A length in numbers of the host that an index never reaches.
    pub(super) fn length_for(&mut self, seen: &Seen, step: &SeenStep, budget: &mut u64) -> Option<Polynomial> {
        let index = &step.index;
        let facts = self.variables.about(std::slice::from_ref(index), &seen.path);
        let len = self.extent(seen.memory, step.len);
        let mut found = BTreeSet::new();
        self.bounds(index, &facts, MOST_REPLACED, &mut found);
        // Where an index is put together of quotients, its parts say less than what they are parts of.
        let limits: Vec<Polynomial> = facts.iter().filter_map(|fact| self.limit(fact)).collect();
        let mut all: Vec<Polynomial> = found.into_iter().map(|most| most.offset(1)).collect();
        all.extend(limits.iter().cloned());
        all.extend(limits.iter().enumerate().flat_map(|(k, a)| limits[k + 1..].iter().filter_map(|b| a.product(b))));
        all.retain(|length| match length.as_constant() {
            Some(value) => (1..=MOST_ELEMENTS).contains(&value),
            None => {
                // What an array has to be longer than itself for is out of bounds.
                let is_own = |unknown: Unknown| {
                    let made = self.variables.made_of(unknown);
                    len.has(unknown)
                        || made.is_some_and(|(_, of)| of.iter().any(|own| len.unknowns().any(|l| own.has(l))))
                };
                let told = |unknown: Unknown| self.variables.is_told(unknown) && !is_own(unknown);
                length.unknowns().all(told) && length.terms().all(|(_, count)| count.abs() <= MOST_ELEMENTS)
            }
        });
        // Whoever asks for the length keeps to it, however many workgroups there are.
        let asked = self.asked.contains(&seen.memory);
        all.retain(|length| !asked || !self.by_groups(length));
        all.sort_by_key(|length| (self.by_groups(length), length.terms().count(), length.constant_part().abs()));
        all.dedup();
        all.truncate(MOST_TRIED);
        all.into_iter().find(|length| self.is_below_from(seen, index, (&len, length), budget))
    }

    /// The same access where all numbers of the host that have to do with an index are at least 1, with these.
    pub(super) fn with_counts(&self, seen: &Seen, step: &SeenStep) -> (Seen, Vec<Unknown>) {
        let facts = self.variables.about(std::slice::from_ref(&step.index), &seen.path);
        let all: BTreeSet<Unknown> = facts.iter().flat_map(Fact::unknowns).chain(step.index.unknowns()).collect();
        let is_host = |unknown: &Unknown| matches!(self.variables.get(*unknown).meaning, Meaning::Host(..));
        let hosts: Vec<Unknown> = all.into_iter().filter(is_host).collect();
        let one = Polynomial::constant(1);
        let counts = hosts.iter().map(|unknown| Fact::Is(Constraint::at_most(&one, &Polynomial::unknown(*unknown))));
        let path = seen.path.iter().cloned().chain(counts).collect();
        (Seen { path: Rc::new(path), ..seen.clone() }, hosts)
    }

    /// What a fact says of the host's numbers alone: the other side of a comparison with them.
    fn limit(&self, fact: &Fact) -> Option<Polynomial> {
        let Fact::Is(one) = fact else { return None };
        let mut limit = Polynomial::default();
        let mut others = false;
        for (product, count) in one.of.terms() {
            let dispatch = product.iter().all(|unknown| self.variables.get(*unknown).scope == Scope::Dispatch);
            if dispatch && !product.is_empty() {
                let own = product.iter().try_fold(Polynomial::constant(count), |all, unknown| {
                    all.product(&Polynomial::unknown(*unknown))
                })?;
                limit = limit.plus(&own);
            }
            others |= !dispatch;
        }
        (others && limit.terms().count() > 0 && limit.terms().all(|(_, count)| count > 0)).then_some(limit)
    }

    fn by_groups(&self, of: &Polynomial) -> bool {
        of.unknowns().any(|unknown| matches!(self.variables.get(unknown).meaning, Meaning::Groups(_)))
    }

    /// Largest values of a polynomial, with the bounds of its unknowns in their places.
    fn bounds(&self, of: &Polynomial, facts: &[Fact], left: usize, found: &mut BTreeSet<Polynomial>) {
        if found.len() > 4 * MOST_TRIED {
            return;
        }
        let open = |unknown: &Unknown| self.variables.get(*unknown).scope != Scope::Dispatch;
        let Some(unknown) = of.unknowns().filter(open).max() else {
            found.insert(of.clone());
            return;
        };
        if left == 0 {
            return;
        }
        let mut most: Vec<Polynomial> = facts.iter().filter_map(|fact| bound(fact, unknown)).collect();
        if let Some(high) = self.variables.get(unknown).high.filter(|high| *high < MOST_ELEMENTS) {
            most.push(Polynomial::constant(high));
        }
        most.sort_by_key(|own| (self.by_groups(own), own.terms().count()));
        most.dedup();
        for own in most.into_iter().take(4) {
            let with = |other: Unknown| (other == unknown).then(|| own.clone());
            if let Some(next) = of.substituted(&with) {
                self.bounds(&next, facts, left - 1, found);
            }
        }
    }
}

/// The largest value that a fact leaves an unknown.
fn bound(fact: &Fact, unknown: Unknown) -> Option<Polynomial> {
    let Fact::Is(one) = fact else { return None };
    let count = one.of.coefficient(&[unknown]);
    let x = Polynomial::unknown(unknown);
    let rest = one.of.plus_times(&x, -count);
    match (one.zero, count) {
        _ if rest.has(unknown) => None,
        (_, -1) => Some(rest),
        (true, 1) => Some(rest.times(-1)),
        (_, count) if count < 0 => rest.as_constant().map(|rest| Polynomial::constant(rest.div_euclid(-count))),
        _ => None,
    }
}

impl Variables {
    /// True for what has a name in the text or in a dispatch.
    fn is_told(&self, unknown: Unknown) -> bool {
        let own = self.get(unknown);
        match own.meaning {
            Meaning::Groups(_) | Meaning::Host(..) | Meaning::Length(_) | Meaning::Side(..) => true,
            Meaning::Derived => own.scope == Scope::Dispatch && self.made_of(unknown).is_some(),
            _ => false,
        }
    }
}
