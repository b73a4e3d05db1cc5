//! Two invocations of a dispatch that touch one place, and indices outside of their arrays: as systems for the solver.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use number::linear::{Constraint, Polynomial, Solution, System, Unknown};

use super::super::group::{Extent, Space};
use super::accesses::{Seen, Touched};
use super::phases::{Last, Since};
use super::variables::{Fact, Meaning, Scope, Variables};
use super::walk::Walk;
use super::words::system;

/// Steps of the solver for a pair of accesses.
const STEPS: u64 = 200_000;

/// Distances between the words of two accesses that are looked at one by one.
const MOST_DISTANCES: usize = 16;

/// Copies of an unknown: of both invocations, of the first, of the second.
const COPIES: Unknown = 3;

/// Two invocations, and what is the same for both.
pub(super) struct Pair {
    /// True within one workgroup.
    pub within: bool,
    /// Loops of which both are in one round.
    rounds: BTreeSet<Unknown>,
}

impl Pair {
    /// The name of an unknown for the first or the second invocation.
    fn copy(&self, variables: &Variables, unknown: Unknown, second: bool) -> Unknown {
        let own = variables.get(unknown);
        let shared = match own.scope {
            Scope::Dispatch => own.rounds.is_empty() || self.rounds.is_superset(&own.rounds),
            Scope::Group => self.within && self.rounds.is_superset(&own.rounds),
            Scope::Invocation => false,
        };
        unknown * COPIES + if shared { 0 } else { 1 + u32::from(second) }
    }

    fn polynomial(&self, variables: &Variables, of: &Polynomial, second: bool) -> Polynomial {
        of.renamed(&mut |unknown| self.copy(variables, unknown, second))
    }

    fn constraint(&self, variables: &Variables, of: &Constraint, second: bool) -> Constraint {
        Constraint { of: self.polynomial(variables, &of.of, second), zero: of.zero }
    }

    fn fact(&self, variables: &Variables, fact: &Fact, second: bool) -> Fact {
        match fact {
            Fact::Is(one) => Fact::Is(self.constraint(variables, one, second)),
            Fact::OneOf(parts) => {
                let part =
                    |part: &Vec<Constraint>| part.iter().map(|one| self.constraint(variables, one, second)).collect();
                Fact::OneOf(parts.iter().map(part).collect::<Vec<_>>().into())
            }
        }
    }
}

/// The place of an access in words, where the words behind it are left out.
pub(super) fn place(seen: &Seen) -> Polynomial {
    let first = Polynomial::constant(i128::from(seen.offset));
    seen.steps.iter().fold(first, |all, step| all.plus_times(&step.index, i128::from(step.stride)))
}

/// True where two invocations may not touch one place so without a barrier between.
pub(super) fn conflicts(a: Touched, b: Touched) -> bool {
    use Touched::{AtomicRead, AtomicWrite, Read, Update, Write};
    match (a, b) {
        (Read | AtomicRead, Read | AtomicRead) => false,
        (Read | Write, _) | (_, Read | Write) => true,
        // A store undoes what other invocations count.
        (AtomicWrite, Update) | (Update, AtomicWrite) => true,
        // What one loads and then stores undoes what others stored between.
        (AtomicWrite, AtomicRead) | (AtomicRead, AtomicWrite) => true,
        (AtomicWrite, AtomicWrite) | (AtomicRead | Update, AtomicRead | Update) => false,
    }
}

impl Walk<'_> {
    /// The numbers of one invocation or workgroup differ from those of another one.
    fn different(&self, pair: &Pair) -> Vec<Vec<Constraint>> {
        let axes = (0..3).filter_map(|axis| {
            let meaning = if pair.within { Meaning::Local(axis) } else { Meaning::Group(axis) };
            let unknown = self.variables.find(meaning)?;
            let own = self.variables.get(unknown);
            (own.high != Some(0)).then_some(Polynomial::unknown(unknown))
        });
        let mut parts = Vec::new();
        let mut same: Vec<Constraint> = Vec::new();
        for axis in axes {
            let [a, b] = [false, true].map(|second| pair.polynomial(&self.variables, &axis, second));
            for less in [Constraint::less(&a, &b), Constraint::less(&b, &a)] {
                parts.push(same.iter().cloned().chain([less]).collect());
            }
            same.push(Constraint::equal(&a, &b));
        }
        parts
    }

    /// What holds of an access in one of the two invocations.
    fn facts(&self, seen: &Seen, about: &[Polynomial], pair: &Pair, second: bool) -> Vec<Fact> {
        let mut about = about.to_vec();
        for axis in 0..3 {
            let all = [Meaning::Local(axis), Meaning::Group(axis), Meaning::Global(axis)]
                .map(|meaning| self.variables.find(meaning));
            about.extend(all.into_iter().flatten().map(Polynomial::unknown));
        }
        let facts = self.variables.about(&about, &seen.path);
        facts.iter().map(|fact| pair.fact(&self.variables, fact, second)).collect()
    }

    /// An index lies in its array: what does not is another finding.
    fn inside(&mut self, seen: &Seen, pair: &Pair, second: bool) -> Vec<Fact> {
        let mut all = Vec::new();
        for step in &seen.steps {
            let len = self.extent(seen.memory, step.len);
            let [index, len] = [&step.index, &len].map(|of| pair.polynomial(&self.variables, of, second));
            all.push(Fact::Is(Constraint::at_most(&Polynomial::constant(0), &index)));
            all.push(Fact::Is(Constraint::less(&index, &len)));
        }
        all
    }

    /// What is known where the last barrier was the same one for both.
    fn in_phase(&self, pair: &Pair, a: &Last, b: &Last) -> Vec<Fact> {
        let mut facts = Vec::new();
        for (round, since) in &a.rounds {
            let x = Polynomial::unknown(*round);
            let [own, other] = [false, true].map(|second| pair.polynomial(&self.variables, &x, second));
            let zero = Polynomial::default();
            match (since, b.rounds.get(round)) {
                (Since::Rounds(n), Some(Since::Rounds(m))) => {
                    facts.push(Fact::Is(Constraint::equal(&own.offset(-n), &other.offset(-m))));
                }
                (Since::First, Some(Since::First)) => {
                    facts.extend([&own, &other].map(|own| Fact::Is(Constraint::equal(own, &zero))));
                }
                (Since::First, _) => facts.push(Fact::Is(Constraint::equal(&own, &zero))),
                (Since::Rounds(_), _) => {}
            }
        }
        for (round, _) in b.rounds.iter().filter(|(_, since)| **since == Since::First) {
            let other = pair.polynomial(&self.variables, &Polynomial::unknown(*round), true);
            facts.push(Fact::Is(Constraint::equal(&other, &Polynomial::default())));
        }
        facts
    }

    /// Whether two invocations may touch one place in these ways with nothing between; where they may, with numbers for
    /// which they do, as far as some were found.
    pub(super) fn meets(&mut self, a: &Seen, b: &Seen, within: bool, budget: &mut u64) -> Option<Met> {
        let shared: Vec<(Last, Last)> = if within {
            let all = a.lasts.iter().flat_map(|a| b.lasts.iter().map(move |b| (a, b)));
            all.filter(|(a, b)| a.barrier == b.barrier).map(|(a, b)| (a.clone(), b.clone())).collect()
        } else {
            let none = || Last { barrier: None, rounds: BTreeMap::new() };
            vec![(none(), none())]
        };
        let mut open = None;
        for (first, second) in shared {
            // In one round of a loop where both are so many rounds behind the barrier.
            let rounds = first.rounds.iter().filter(|(round, since)| second.rounds.get(round) == Some(since));
            let pair = Pair { within, rounds: rounds.map(|(round, _)| *round).collect() };
            let (places, mut facts) = (vec![place(a), place(b)], self.in_phase(&pair, &first, &second));
            for (seen, at, is_second) in [(a, &places[0], false), (b, &places[1], true)] {
                let rounds = first.rounds.keys().chain(second.rounds.keys()).map(|round| Polynomial::unknown(*round));
                let mut about: Vec<Polynomial> = seen.steps.iter().map(|step| step.index.clone()).collect();
                about.extend([at.clone()].into_iter().chain(rounds));
                facts.extend(self.facts(seen, &about, &pair, is_second));
                facts.extend(self.inside(seen, &pair, is_second));
            }
            let mut base = system(facts);
            base.one_of.insert(0, self.different(&pair));
            let [x, y] = [(&places[0], false), (&places[1], true)]
                .map(|(at, second)| pair.polynomial(&self.variables, at, second));
            if a.steps.iter().any(|step| matches!(step.len, Extent::Side(_))) {
                // A texel is told by its coordinates.
                let both = a.steps.iter().zip(&b.steps).map(|(a, b)| {
                    let [a, b] =
                        [(&a.index, false), (&b.index, true)].map(|(of, s)| pair.polynomial(&self.variables, of, s));
                    Constraint::equal(&a, &b)
                });
                base.all.extend(both);
                match spend(&base, budget) {
                    Solution::None => {}
                    Solution::Point(point) => return Some(Met { numbers: Some(self.numbers_of(&point)) }),
                    Solution::Open => open = Some(Met { numbers: None }),
                }
                continue;
            }
            let apart = x.minus(&y);
            let mut distances: BTreeSet<i128> = BTreeSet::new();
            for m in &b.words {
                distances.extend(a.words.iter().map(|n| i128::from(*m) - i128::from(*n)));
            }
            let number = Polynomial::constant;
            let all = match (distances.first(), distances.last()) {
                (Some(low), Some(high)) if low < high => {
                    let mut whole = base.clone();
                    whole.all.extend([
                        Constraint::at_most(&number(*low), &apart),
                        Constraint::at_most(&apart, &number(*high)),
                    ]);
                    if distances.len() > MOST_DISTANCES {
                        vec![whole]
                    } else if spend(&whole, budget) == Solution::None {
                        continue;
                    } else {
                        distances.iter().map(|by| with(&base, Constraint::equal(&apart, &number(*by)))).collect()
                    }
                }
                (Some(only), _) => vec![with(&base, Constraint::equal(&apart, &number(*only)))],
                _ => continue,
            };
            for system in all {
                match spend(&system, budget) {
                    Solution::None => {}
                    Solution::Point(point) => return Some(Met { numbers: Some(self.numbers_of(&point)) }),
                    Solution::Open => open = Some(Met { numbers: None }),
                }
            }
        }
        open
    }

    /// Numbers of the host in a solution.
    fn numbers_of(&self, point: &BTreeMap<Unknown, i128>) -> HashMap<Meaning, i128> {
        let of = |(unknown, value): (&Unknown, &i128)| {
            let own = self.variables.get(unknown / COPIES);
            let host = matches!(own.meaning, Meaning::Groups(_) | Meaning::Host(..) | Meaning::Length(_));
            host.then_some((own.meaning, *value))
        };
        point.iter().filter_map(of).collect()
    }

    /// Whether an index is never at or beyond a length where that is at least another one.
    pub(super) fn is_below_from(
        &mut self,
        seen: &Seen,
        index: &Polynomial,
        (len, least): (&Polynomial, &Polynomial),
        budget: &mut u64,
    ) -> bool {
        let about = [index.clone(), len.clone(), least.clone()];
        let mut beyond = system(self.variables.about(&about, &seen.path));
        beyond.all.extend([Constraint::at_most(len, index), Constraint::at_most(least, len)]);
        spend(&beyond, budget) == Solution::None
    }

    /// Whether an index is never at or beyond a length.
    pub(super) fn is_below(&mut self, seen: &Seen, index: &Polynomial, len: &Polynomial, budget: &mut u64) -> bool {
        let base = system(self.variables.about(&[index.clone(), len.clone()], &seen.path));
        let beyond = with(&base, Constraint::at_most(len, index));
        spend(&beyond, budget) == Solution::None
    }

    pub(super) fn is_positive(&mut self, seen: &Seen, index: &Polynomial, budget: &mut u64) -> bool {
        if self.variables.interval(index).0.is_some_and(|low| low >= 0) {
            return true;
        }
        let base = system(self.variables.about(std::slice::from_ref(index), &seen.path));
        let below = with(&base, Constraint::less(index, &Polynomial::default()));
        spend(&below, budget) == Solution::None
    }

    /// True for a memory that all workgroups see.
    pub(super) fn is_shared(&self, memory: u32) -> bool {
        self.executable.memories[memory as usize].space != Space::Workgroup
    }

    /// The length that an index stays below by itself, by its shape.
    pub(super) fn is_fixed(len: Extent) -> bool {
        matches!(len, Extent::Fixed(_))
    }
}

/// Two invocations that may meet.
pub(super) struct Met {
    /// Numbers of the host with which they do.
    pub numbers: Option<HashMap<Meaning, i128>>,
}

fn with(base: &System, one: Constraint) -> System {
    let mut system = base.clone();
    system.all.push(one);
    system
}

/// Solves a system with a part of what is left of a budget.
fn spend(system: &System, budget: &mut u64) -> Solution {
    let mut steps = STEPS.min(*budget);
    let before = steps;
    let found = system.solve(&mut steps);
    *budget -= before - steps;
    found
}
