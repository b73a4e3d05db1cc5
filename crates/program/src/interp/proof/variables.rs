//! Unknown numbers of a kernel: who shares them, between which numbers they lie, and what else is known of them.

use std::collections::{BTreeSet, HashMap};
use std::rc::Rc;

use number::linear::{Alternatives, Constraint, Polynomial, Unknown};

use super::super::domain::Site;

/// One more than the largest number of 32 bits.
pub(super) const WORD: i128 = 1 << 32;

/// One more than the largest number of 32 bits with a sign.
pub(super) const HALF: i128 = 1 << 31;

/// Unknowns behind a fact that are looked at.
const MOST_BEHIND: usize = 200;

/// For whom a number is the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Scope {
    /// All invocations of a dispatch.
    Dispatch,
    /// The invocations of a workgroup; in loops, of one round.
    Group,
    /// One invocation.
    Invocation,
}

/// What an unknown number is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Meaning {
    /// The place of the invocation in its workgroup along an axis.
    Local(usize),
    /// The workgroup along an axis.
    Group(usize),
    /// The place of the invocation in the dispatch along an axis.
    Global(usize),
    /// Workgroups along an axis.
    Groups(usize),
    /// A number of the host: the memory and its word there.
    Host(u32, u32),
    /// Elements of the array of a memory.
    Length(u32),
    /// Texels of an image along an axis.
    Side(u32, usize),
    /// Rounds of a loop that are over.
    Round,
    /// Something that follows from other numbers: a quotient, the smaller of two, what one of two branches gives.
    Derived,
    /// Something that nothing is known of, and why.
    Open(Why, Option<Site>),
}

/// Why nothing is known of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Why {
    /// It is read from a memory.
    Data(u32),
    /// An atomic function gives it.
    Atomic(u32),
    /// It comes of real numbers.
    Real,
    /// It changes from round to round of a loop, and not by the same number each time.
    Loop,
    /// It comes of an operation that is no sum, and no product with a constant.
    Operation,
    /// It comes from other invocations of the subgroup, or is a place in it.
    Subgroup,
    /// It is an element of an array of the invocation's own, or a texel.
    Element,
}

/// An unknown number.
#[derive(Clone, Debug)]
pub(super) struct Variable {
    pub scope: Scope,
    pub low: Option<i128>,
    pub high: Option<i128>,
    pub meaning: Meaning,
    /// Rounds of loops that it changes with.
    pub rounds: BTreeSet<Unknown>,
    /// What else holds of it.
    pub facts: Vec<Fact>,
    /// True where as a number without a sign it is likely to be beyond those with a sign: what wraps around.
    pub wide: bool,
}

/// Something that holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Fact {
    Is(Constraint),
    OneOf(Rc<Alternatives>),
}

impl Fact {
    /// What holds where one of these does.
    pub(super) fn of(mut alternatives: Alternatives) -> Vec<Self> {
        match alternatives.len() {
            1 => alternatives.swap_remove(0).into_iter().map(Self::Is).collect(),
            _ if alternatives.iter().any(Vec::is_empty) => Vec::new(),
            _ => vec![Self::OneOf(Rc::new(alternatives))],
        }
    }

    pub(super) fn unknowns(&self) -> Vec<Unknown> {
        match self {
            Self::Is(one) => one.of.unknowns().collect(),
            Self::OneOf(parts) => parts.iter().flatten().flat_map(|one| one.of.unknowns()).collect(),
        }
    }
}

/// Between which numbers something lies.
pub(super) type Interval = (Option<i128>, Option<i128>);

/// All unknown numbers of a kernel.
#[derive(Debug, Default)]
pub(super) struct Variables {
    all: Vec<Variable>,
    made: HashMap<(String, Vec<Polynomial>), Unknown>,
    named: HashMap<Meaning, Unknown>,
}

impl Variables {
    pub(super) fn get(&self, unknown: Unknown) -> &Variable {
        &self.all[unknown as usize]
    }

    pub(super) fn get_mut(&mut self, unknown: Unknown) -> &mut Variable {
        &mut self.all[unknown as usize]
    }

    pub(super) fn count(&self) -> Unknown {
        self.all.len() as Unknown
    }

    pub(super) fn add(&mut self, variable: Variable) -> Unknown {
        self.all.push(variable);
        self.all.len() as Unknown - 1
    }

    /// Something between two numbers.
    pub(super) fn fresh(&mut self, meaning: Meaning, scope: Scope, (low, high): Interval) -> Unknown {
        let wide = matches!(meaning, Meaning::Open(..)) && high.is_none_or(|high| high >= HALF);
        let (rounds, facts) = (BTreeSet::new(), Vec::new());
        self.add(Variable { scope, low, high, meaning, rounds, facts, wide })
    }

    /// What has one meaning in the whole kernel.
    pub(super) fn named(&mut self, meaning: Meaning, scope: Scope, interval: Interval) -> Unknown {
        if let Some(own) = self.named.get(&meaning) {
            return *own;
        }
        let new = self.fresh(meaning, scope, interval);
        self.named.insert(meaning, new);
        new
    }

    /// The variable with a meaning, if anything asked for it.
    pub(super) fn find(&self, meaning: Meaning) -> Option<Unknown> {
        self.named.get(&meaning).copied()
    }

    /// What follows from other numbers; the same for the same ones. True where it is new.
    pub(super) fn derived(&mut self, what: &str, of: &[&Polynomial], interval: Interval) -> (Unknown, bool) {
        let key = (what.to_owned(), of.iter().map(|own| (*own).clone()).collect());
        if let Some(own) = self.made.get(&key) {
            return (*own, false);
        }
        let scope = of.iter().map(|own| self.scope(own)).max().unwrap_or(Scope::Dispatch);
        let rounds = of.iter().flat_map(|own| self.rounds(own)).collect();
        let wide = of.iter().any(|own| own.unknowns().any(|unknown| self.get(unknown).wide));
        let wide = wide && interval.1.is_none_or(|high| high >= HALF);
        let variable = Variable {
            scope,
            low: interval.0,
            high: interval.1,
            meaning: Meaning::Derived,
            rounds,
            facts: Vec::new(),
            wide,
        };
        let new = self.add(variable);
        self.made.insert(key, new);
        (new, true)
    }

    /// The operation that gives a number, and its operands.
    pub(super) fn made_of(&self, unknown: Unknown) -> Option<(&str, &[Polynomial])> {
        let own = self.made.iter().find(|(_, own)| **own == unknown)?;
        let (what, of) = own.0;
        matches!(&what[..], "/" | "min" | "max").then_some((&what[..], &of[..]))
    }

    /// For whom a polynomial is the same.
    pub(super) fn scope(&self, of: &Polynomial) -> Scope {
        of.unknowns().map(|unknown| self.get(unknown).scope).max().unwrap_or(Scope::Dispatch)
    }

    pub(super) fn rounds(&self, of: &Polynomial) -> BTreeSet<Unknown> {
        of.unknowns().flat_map(|unknown| self.get(unknown).rounds.iter().copied()).collect()
    }

    /// Between which numbers it lies, by those of its unknowns.
    pub(super) fn interval(&self, of: &Polynomial) -> Interval {
        let times = |a: Interval, b: Interval| -> Interval {
            let corners = [(a.0, b.0), (a.0, b.1), (a.1, b.0), (a.1, b.1)];
            let all: Option<Vec<i128>> =
                corners.iter().map(|(a, b)| a.zip(*b).and_then(|(a, b)| a.checked_mul(b))).collect();
            match all {
                Some(all) => (all.iter().min().copied(), all.iter().max().copied()),
                // With an open end, all that is simple to say is a sign.
                None if a.0.is_some_and(|low| low >= 0) && b.0.is_some_and(|low| low >= 0) => {
                    (a.0.zip(b.0).and_then(|(a, b)| a.checked_mul(b)), None)
                }
                None => (None, None),
            }
        };
        let mut sum: Interval = (Some(0), Some(0));
        for (product, count) in of.terms() {
            let mut one: Interval = (Some(1), Some(1));
            for unknown in product {
                let own = self.get(*unknown);
                one = times(one, (own.low, own.high));
            }
            let scaled = |end: Option<i128>| end.and_then(|end| end.checked_mul(count));
            let (low, high) = if count < 0 { (scaled(one.1), scaled(one.0)) } else { (scaled(one.0), scaled(one.1)) };
            let add = |a: Option<i128>, b: Option<i128>| a.zip(b).and_then(|(a, b)| a.checked_add(b));
            sum = (add(sum.0, low), add(sum.1, high));
        }
        sum
    }

    /// Why nothing is known of some of these numbers.
    pub(super) fn open(&self, of: &Polynomial) -> Option<(Why, Option<Site>)> {
        let mut seen: BTreeSet<Unknown> = BTreeSet::new();
        let mut next: Vec<Unknown> = of.unknowns().collect();
        while let Some(unknown) = next.pop() {
            if !seen.insert(unknown) {
                continue;
            }
            let own = self.get(unknown);
            match own.meaning {
                Meaning::Open(why, site) => return Some((why, site)),
                Meaning::Derived => next.extend(own.facts.iter().flat_map(Fact::unknowns)),
                _ => {}
            }
        }
        None
    }

    /// The unknowns of a fact, and those that these are made of.
    fn behind(&self, fact: &Fact) -> BTreeSet<Unknown> {
        let mut found = BTreeSet::new();
        let mut next = fact.unknowns();
        while let Some(unknown) = next.pop() {
            if found.insert(unknown) && found.len() < MOST_BEHIND {
                next.extend(self.get(unknown).facts.iter().flat_map(Fact::unknowns));
            }
        }
        found
    }

    /// All that is known of some numbers and of those that these have to do with, where `path` holds.
    pub(super) fn about(&self, of: &[Polynomial], path: &[Fact]) -> Vec<Fact> {
        let mut seen: BTreeSet<Unknown> = BTreeSet::new();
        let mut next: Vec<Unknown> = of.iter().flat_map(Polynomial::unknowns).collect();
        let mut used = vec![false; path.len()];
        let mut all = Vec::new();
        let of_path: Vec<BTreeSet<Unknown>> = path.iter().map(|fact| self.behind(fact)).collect();
        loop {
            while let Some(unknown) = next.pop() {
                if !seen.insert(unknown) {
                    continue;
                }
                let (own, x) = (self.get(unknown), Polynomial::unknown(unknown));
                let low = own.low.map(|low| Constraint::at_most(&Polynomial::constant(low), &x));
                let high = own.high.map(|high| Constraint::at_most(&x, &Polynomial::constant(high)));
                all.extend(low.into_iter().chain(high).map(Fact::Is));
                all.extend(own.facts.iter().cloned());
                next.extend(own.facts.iter().flat_map(Fact::unknowns));
            }
            for (k, fact) in path.iter().enumerate() {
                if !used[k] && (of_path[k].is_empty() || of_path[k].iter().any(|unknown| seen.contains(unknown))) {
                    used[k] = true;
                    all.push(fact.clone());
                    next.extend(of_path[k].iter().copied());
                }
            }
            if next.is_empty() {
                return all;
            }
        }
    }
}
