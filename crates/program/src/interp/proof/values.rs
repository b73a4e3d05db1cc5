//! What registers hold: numbers, conditions, and values of which one is there on each way that leads to a place.

use std::collections::BTreeSet;
use std::rc::Rc;

use number::linear::{Alternatives, Constraint, Polynomial, Unknown};

use super::super::code::Reg;
use super::formula::{Formula, both_of};
use super::variables::{Fact, HALF, Interval, Meaning, Scope, Why};
use super::walk::Walk;

/// Alternatives of a value at most.
pub(super) const MOST_CASES: usize = 8;

/// What a register holds.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Number(Polynomial),
    Truth(Formula),
    One(Rc<Cases>),
}

/// A value of several.
#[derive(Debug)]
pub(super) struct Cases {
    /// Each with what holds where it is this one.
    all: Vec<(Vec<Fact>, Value)>,
    /// For whom it is the same one.
    scope: Scope,
    /// Rounds of loops that it may change with.
    rounds: Rc<[Unknown]>,
}

impl PartialEq for Value {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => a == b,
            (Self::Truth(a), Self::Truth(b)) => a == b,
            (Self::One(a), Self::One(b)) => Rc::ptr_eq(a, b),
            _ => false,
        }
    }
}

impl Walk<'_> {
    pub(super) fn value(&mut self, reg: Reg) -> Value {
        if let Some(value) = self.state.env.get(&reg) {
            return value.clone();
        }
        let value = self.open(Why::Operation, None, Scope::Invocation);
        self.set(reg, value.clone());
        value
    }

    /// The number in a register.
    pub(super) fn number(&mut self, reg: Reg) -> Polynomial {
        let value = self.value(reg);
        let number = self.number_of(&value);
        if matches!(value, Value::One(_)) {
            self.set(reg, Value::Number(number.clone()));
        }
        number
    }

    pub(super) fn number_of(&mut self, value: &Value) -> Polynomial {
        match value {
            Value::Number(number) => number.clone(),
            Value::Truth(Formula::Known(truth)) => Polynomial::constant(i128::from(*truth)),
            Value::Truth(formula) => {
                let scope = formula.scope(&self.variables);
                let unknown = self.variables.fresh(Meaning::Derived, scope, (Some(0), Some(1)));
                let x = Polynomial::unknown(unknown);
                let is = |truth: bool| {
                    let value = Constraint::equal(&x, &Polynomial::constant(i128::from(truth)));
                    both_of(&vec![vec![value]], &formula.alternatives(truth))
                };
                let mut parts = is(true);
                parts.extend(is(false));
                let rounds = formula.rounds(&self.variables);
                let own = self.variables.get_mut(unknown);
                (own.facts, own.rounds) = (Fact::of(parts), rounds);
                x
            }
            Value::One(cases) => {
                let key = Rc::as_ptr(cases) as usize;
                if let Some((_, found)) = self.resolved.get(&key) {
                    return found.clone();
                }
                let found = self.one_of(cases);
                self.resolved.insert(key, (value.clone(), found.clone()));
                found
            }
        }
    }

    /// One number of several.
    fn one_of(&mut self, cases: &Cases) -> Polynomial {
        let Cases { all: cases, scope, rounds } = cases;
        let numbers: Vec<Polynomial> = cases.iter().map(|(_, value)| self.number_of(value)).collect();
        if numbers.iter().all(|own| *own == numbers[0]) {
            return numbers[0].clone();
        }
        let intervals: Vec<Interval> = numbers.iter().map(|own| self.variables.interval(own)).collect();
        let low = intervals.iter().map(|own| own.0).try_fold(i128::MAX, |all, low| low.map(|low| low.min(all)));
        let high = intervals.iter().map(|own| own.1).try_fold(i128::MIN, |all, high| high.map(|high| high.max(all)));
        let scope = numbers.iter().map(|own| self.variables.scope(own)).max().unwrap_or(*scope).max(*scope);
        let unknown = self.variables.fresh(Meaning::Derived, scope, (low, high));
        let x = Polynomial::unknown(unknown);
        let mut parts: Alternatives = Vec::new();
        for ((facts, _), number) in cases.iter().zip(&numbers) {
            let is = vec![vec![Constraint::equal(&x, number)]];
            parts.extend(facts_of(facts, is));
        }
        let mut rounds: BTreeSet<Unknown> = rounds.iter().copied().collect();
        rounds.extend(numbers.iter().flat_map(|own| self.variables.rounds(own)));
        let about = cases.iter().flat_map(|(facts, _)| facts.iter().flat_map(Fact::unknowns));
        rounds.extend(about.flat_map(|unknown| self.variables.get(unknown).rounds.iter().copied()).collect::<Vec<_>>());
        let wide = numbers.iter().any(|own| own.unknowns().any(|unknown| self.variables.get(unknown).wide));
        let own = self.variables.get_mut(unknown);
        (own.facts, own.rounds, own.wide) = (Fact::of(parts), rounds, wide || high.is_none_or(|high| high >= HALF));
        x
    }

    pub(super) fn is_truth(&self, reg: Reg) -> bool {
        fn is(value: &Value) -> bool {
            match value {
                Value::Truth(_) => true,
                Value::Number(_) => false,
                Value::One(cases) => cases.all.iter().all(|(_, value)| is(value)),
            }
        }
        self.state.env.get(&reg).is_some_and(is)
    }

    /// The condition in a register.
    pub(super) fn truth(&mut self, reg: Reg) -> Formula {
        let value = self.value(reg);
        self.truth_of(&value)
    }

    fn truth_of(&mut self, value: &Value) -> Formula {
        match value {
            Value::Truth(formula) => formula.clone(),
            Value::Number(number) => Formula::equal(number, &Polynomial::constant(0)).not(),
            Value::One(cases) => {
                let all =
                    cases.all.iter().map(|(facts, value)| (facts_of(facts, vec![Vec::new()]), self.truth_of(value)));
                Formula::Cases(Rc::new(all.collect()), cases.scope, Rc::clone(&cases.rounds))
            }
        }
    }

    pub(super) fn selected(&mut self, condition: Reg, accept: Reg, reject: Reg) -> Value {
        let condition = self.truth(condition);
        let (a, b) = (self.value(accept), self.value(reject));
        match condition {
            Formula::Known(truth) => {
                if truth {
                    a
                } else {
                    b
                }
            }
            _ if a == b => a,
            condition => {
                let facts = |truth: bool| Fact::of(condition.alternatives(truth));
                let scope = condition.scope(&self.variables);
                self.one(vec![(facts(true), a), (facts(false), b)], scope)
            }
        }
    }

    pub(super) fn one(&self, all: Vec<(Vec<Fact>, Value)>, scope: Scope) -> Value {
        Value::One(Rc::new(Cases { all, scope, rounds: self.rounds.clone().into() }))
    }
}

/// Alternatives with facts that hold beside them.
fn facts_of(facts: &[Fact], beside: Alternatives) -> Alternatives {
    let mut all = beside;
    for fact in facts {
        match fact {
            Fact::Is(one) => all.iter_mut().for_each(|part| part.push(one.clone())),
            // With fewer facts, it says less, and is true as well.
            Fact::OneOf(parts) if parts.len() * all.len() <= MOST_CASES => all = both_of(&all, parts),
            Fact::OneOf(_) => {}
        }
    }
    all
}
