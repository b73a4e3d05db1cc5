//! Conditions of a kernel.

use std::collections::BTreeSet;
use std::rc::Rc;

use number::linear::{Alternatives, Constraint, Polynomial, Unknown};

use super::variables::{Scope, Variables};

/// Alternatives of a condition at most; what has more is taken for open.
const MOST_PARTS: usize = 12;

/// A condition.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Formula {
    Known(bool),
    /// The polynomial is at least 0.
    Positive(Polynomial),
    /// It is 0.
    Zero(Polynomial),
    And(Rc<(Formula, Formula)>),
    Or(Rc<(Formula, Formula)>),
    Not(Rc<Formula>),
    /// Conditions, one of which holds, each with what it is then; for whom it is the same which, in these rounds of loops.
    Cases(Rc<Vec<(Alternatives, Formula)>>, Scope, Rc<[Unknown]>),
    /// Nothing is known of it, but for whom it is the same.
    Open(Scope),
}

impl Formula {
    pub(super) fn not(self) -> Self {
        match self {
            Self::Known(truth) => Self::Known(!truth),
            Self::Not(inner) => (*inner).clone(),
            other => Self::Not(Rc::new(other)),
        }
    }

    pub(super) fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Known(false), _) | (_, Self::Known(false)) => Self::Known(false),
            (Self::Known(true), one) | (one, Self::Known(true)) => one,
            both => Self::And(Rc::new(both)),
        }
    }

    pub(super) fn or(self, other: Self) -> Self {
        match (self, other) {
            (Self::Known(true), _) | (_, Self::Known(true)) => Self::Known(true),
            (Self::Known(false), one) | (one, Self::Known(false)) => one,
            both => Self::Or(Rc::new(both)),
        }
    }

    /// `a <= b`.
    pub(super) fn at_most(a: &Polynomial, b: &Polynomial) -> Self {
        let of = b.minus(a);
        of.as_constant().map_or_else(|| Self::Positive(of.clone()), |value| Self::Known(value >= 0))
    }

    /// `a == b`.
    pub(super) fn equal(a: &Polynomial, b: &Polynomial) -> Self {
        let of = a.minus(b);
        of.as_constant().map_or_else(|| Self::Zero(of.clone()), |value| Self::Known(value == 0))
    }

    /// For whom it is the same.
    pub(super) fn scope(&self, variables: &Variables) -> Scope {
        match self {
            Self::Known(_) => Scope::Dispatch,
            Self::Positive(of) | Self::Zero(of) => variables.scope(of),
            Self::And(both) | Self::Or(both) => both.0.scope(variables).max(both.1.scope(variables)),
            Self::Not(inner) => inner.scope(variables),
            Self::Cases(cases, scope, _) => {
                cases.iter().map(|(_, own)| own.scope(variables)).max().unwrap_or(*scope).max(*scope)
            }
            Self::Open(scope) => *scope,
        }
    }

    /// Rounds of loops that it changes with.
    pub(super) fn rounds(&self, variables: &Variables) -> BTreeSet<Unknown> {
        match self {
            Self::Known(_) | Self::Open(_) => BTreeSet::new(),
            Self::Positive(of) | Self::Zero(of) => variables.rounds(of),
            Self::And(both) | Self::Or(both) => {
                both.0.rounds(variables).into_iter().chain(both.1.rounds(variables)).collect()
            }
            Self::Not(inner) => inner.rounds(variables),
            Self::Cases(cases, _, rounds) => {
                let when =
                    cases.iter().flat_map(|(when, _)| when.iter().flatten()).flat_map(|own| variables.rounds(&own.of));
                let then = cases.iter().flat_map(|(_, own)| own.rounds(variables));
                rounds.iter().copied().chain(when).chain(then).collect()
            }
        }
    }

    /// Sets of conditions of which one holds where this one is `truth`: as far as it is known, so they may say less.
    pub(super) fn alternatives(&self, truth: bool) -> Alternatives {
        let anything = || vec![Vec::new()];
        let found = match (self, truth) {
            (Self::Known(own), _) if *own == truth => anything(),
            (Self::Known(_), _) => Vec::new(),
            (Self::Open(_), _) => anything(),
            (Self::Positive(of), true) => vec![vec![Constraint { of: of.clone(), zero: false }]],
            (Self::Positive(of), false) => vec![vec![Constraint { of: of.times(-1).offset(-1), zero: false }]],
            (Self::Zero(of), true) => vec![vec![Constraint { of: of.clone(), zero: true }]],
            (Self::Zero(of), false) => vec![
                vec![Constraint { of: of.offset(-1), zero: false }],
                vec![Constraint { of: of.times(-1).offset(-1), zero: false }],
            ],
            (Self::And(both), true) | (Self::Or(both), false) => {
                both_of(&both.0.alternatives(truth), &both.1.alternatives(truth))
            }
            (Self::Or(both), true) | (Self::And(both), false) => {
                let mut all = both.0.alternatives(truth);
                all.extend(both.1.alternatives(truth));
                all
            }
            (Self::Not(inner), _) => inner.alternatives(!truth),
            (Self::Cases(cases, ..), _) => {
                cases.iter().flat_map(|(when, own)| both_of(when, &own.alternatives(truth))).collect()
            }
        };
        if found.len() > MOST_PARTS || found.iter().any(Vec::is_empty) { anything() } else { found }
    }
}

/// One of each holds.
pub(super) fn both_of(a: &Alternatives, b: &Alternatives) -> Alternatives {
    if a.len() * b.len() > MOST_PARTS {
        // One of them alone says less, and is true as well.
        return if a.len() <= b.len() { a.clone() } else { b.clone() };
    }
    a.iter().flat_map(|a| b.iter().map(|b| a.iter().chain(b).cloned().collect())).collect()
}
