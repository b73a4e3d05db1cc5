//! Whether systems of equations and inequalities hold for whole numbers: linear ones by elimination, alternatives one after
//! the other, and products of unknowns by what follows from the order of their factors.
//!
//! ```text
//! System ─ alternatives ─ lemmas about products ─▶ linear systems ─ eliminate ─▶ Solution
//! ```
//!
//! The answer that there is no solution is a proof. A point is checked by insertion. Anything else is left open.

mod eliminate;
mod polynomial;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use eliminate::{Found, Row};

pub use polynomial::{Monomial, Polynomial, Unknown};

/// Pairs of products that are compared with each other at most.
const MOST_PAIRS: usize = 20;

/// Terms of a condition that is multiplied, at most.
const MOST_TERMS: usize = 4;

/// Alternatives inside of each other.
const MOST_DEPTH: usize = 60;

/// A condition on a polynomial.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Constraint {
    /// What it is about.
    pub of: Polynomial,
    /// True where it is 0, false where it is at least 0.
    pub zero: bool,
}

impl Constraint {
    /// `a == b`.
    pub fn equal(a: &Polynomial, b: &Polynomial) -> Self {
        Self { of: a.minus(b), zero: true }
    }

    /// `a <= b`.
    pub fn at_most(a: &Polynomial, b: &Polynomial) -> Self {
        Self { of: b.minus(a), zero: false }
    }

    /// `a < b`.
    pub fn less(a: &Polynomial, b: &Polynomial) -> Self {
        Self::at_most(&a.offset(1), b)
    }

    fn holds(&self, at: &BTreeMap<Unknown, i128>) -> bool {
        self.of.value(at).is_some_and(|value| if self.zero { value == 0 } else { value >= 0 })
    }
}

/// Sets of conditions, one of which holds.
pub type Alternatives = Vec<Vec<Constraint>>;

/// Conditions that hold together.
#[derive(Clone, Debug, Default)]
pub struct System {
    /// Conditions on polynomials.
    pub all: Vec<Constraint>,
    /// Of each, one holds.
    pub one_of: Vec<Alternatives>,
}

/// What is known of a system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Solution {
    /// It has no solution in whole numbers.
    None,
    /// These numbers solve it; the others are 0.
    Point(BTreeMap<Unknown, i128>),
    /// It was not found out, within the steps or at all.
    Open,
}

impl System {
    /// Looks for a solution, for so many steps at most.
    pub fn solve(&self, steps: &mut u64) -> Solution {
        let pending: Vec<&Alternatives> = self.one_of.iter().collect();
        let mut search = Search { steps, whole: self };
        search.look(self.all.clone(), &pending, Stage::Plain, 0)
    }

    /// Unknowns that are factors of products.
    pub fn factors(&self) -> BTreeSet<Unknown> {
        let parts = self.one_of.iter().flatten().flatten();
        let products = self.all.iter().chain(parts).flat_map(|own| own.of.terms().map(|(product, _)| product.clone()));
        products.filter(|product| product.len() > 1).flatten().collect()
    }

    /// The same with numbers in the place of some unknowns.
    #[must_use]
    pub fn with(&self, numbers: &BTreeMap<Unknown, i128>) -> Self {
        let is = |unknown: &Unknown| numbers.contains_key(unknown);
        let one = |own: &Constraint| {
            let put = |unknown: Unknown| numbers.get(&unknown).map(|number| Polynomial::constant(*number));
            let of = own.of.substituted(&put).unwrap_or_else(|| own.of.clone());
            Constraint { of, zero: own.zero }
        };
        let mut all: Vec<Constraint> = self.all.iter().map(one).collect();
        // Where it could not be inserted, it holds beside.
        let left: BTreeSet<Unknown> = all.iter().flat_map(|own| own.of.unknowns()).filter(is).collect();
        all.extend(
            left.into_iter().map(|unknown| {
                Constraint::equal(&Polynomial::unknown(unknown), &Polynomial::constant(numbers[&unknown]))
            }),
        );
        let each =
            |alternatives: &Alternatives| alternatives.iter().map(|part| part.iter().map(one).collect()).collect();
        Self { all, one_of: self.one_of.iter().map(each).collect() }
    }
}

/// What is made use of about products.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Nothing.
    Plain,
    /// The order of those that the system has.
    Compared,
    /// Conditions that are multiplied as well.
    Multiplied,
}

struct Search<'s> {
    steps: &'s mut u64,
    whole: &'s System,
}

impl Search<'_> {
    fn look(&mut self, all: Vec<Constraint>, pending: &[&Alternatives], stage: Stage, depth: usize) -> Solution {
        let point = match self.linear(&all) {
            Found::Nothing => return Solution::None,
            Found::Point(point) => Some(point),
            Found::Open => None,
        };
        if *self.steps == 0 || depth > MOST_DEPTH {
            return Solution::Open;
        }
        if let Some(point) = point.filter(|point| self.is_solved_by(&all, point)) {
            return Solution::Point(point);
        }
        if let Some((first, rest)) = pending.split_first() {
            let mut open = false;
            for part in first.iter() {
                let mut all = all.clone();
                all.extend(part.iter().cloned());
                match self.look(all, rest, stage, depth + 1) {
                    Solution::None => {}
                    Solution::Open => open = true,
                    found @ Solution::Point(_) => return found,
                }
            }
            return if open { Solution::Open } else { Solution::None };
        }
        let stage = match stage {
            Stage::Plain if !all.iter().all(|own| own.of.is_linear()) => Stage::Compared,
            Stage::Compared => Stage::Multiplied,
            Stage::Plain | Stage::Multiplied => return Solution::Open,
        };
        let (more, lemmas) = lemmas(&all, stage == Stage::Multiplied);
        let all: Vec<Constraint> = all.into_iter().chain(more).collect();
        let pending: Vec<&Alternatives> = lemmas.iter().collect();
        self.look(all, &pending, stage, depth + 1)
    }

    fn is_solved_by(&self, all: &[Constraint], point: &BTreeMap<Unknown, i128>) -> bool {
        let part = |part: &Vec<Constraint>| part.iter().all(|own| own.holds(point));
        all.iter().all(|own| own.holds(point)) && self.whole.one_of.iter().all(|parts| parts.iter().any(part))
    }

    /// Takes each product for an unknown of its own.
    fn linear(&mut self, all: &[Constraint]) -> Found {
        let mut columns: BTreeMap<&Monomial, u32> = BTreeMap::new();
        let (mut zero, mut positive) = (Vec::new(), Vec::new());
        for own in all {
            let mut row = Row::default();
            for (product, count) in own.of.terms() {
                if product.is_empty() {
                    row.constant = count;
                    continue;
                }
                let next = columns.len() as u32;
                row.coefficients.insert(*columns.entry(product).or_insert(next), count);
            }
            if own.zero { zero.push(row) } else { positive.push(row) }
        }
        match eliminate::solve(zero, positive, self.steps) {
            Found::Point(point) => {
                let of = |(product, column): (&Monomial, u32)| match product[..] {
                    [unknown] => Some((unknown, point.get(&column).copied().unwrap_or(0))),
                    _ => None,
                };
                Found::Point(columns.into_iter().filter_map(of).collect())
            }
            other => other,
        }
    }
}

/// True where a condition says outright that an unknown is at least a number.
fn is_at_least(all: &[Constraint], unknown: Unknown, least: i128) -> bool {
    all.iter().any(|own| {
        let one = own.of.terms().filter(|(product, _)| !product.is_empty()).count() == 1;
        one && own.of.coefficient(&[unknown]) == 1 && (-own.of.constant_part() >= least)
    })
}

/// Products as one factor and the rest, none of which is negative.
fn split(products: &BTreeSet<Monomial>, all: &[Constraint]) -> BTreeSet<(Monomial, Unknown)> {
    let mut found = BTreeSet::new();
    for product in products {
        for k in 0..product.len() {
            let mut rest = product.clone();
            let one = rest.remove(k);
            if rest.iter().all(|unknown| is_at_least(all, *unknown, 0)) {
                found.insert((rest, one));
            }
        }
    }
    found
}

fn products_of<'c>(all: impl IntoIterator<Item = &'c Constraint>) -> BTreeSet<Monomial> {
    let products = all.into_iter().flat_map(|own| own.of.terms()).map(|(product, _)| product);
    products.filter(|product| product.len() > 1).cloned().collect()
}

/// What follows for products of unknowns from the order of their factors: conditions, and alternatives.
///
/// With `w >= 0`, from `a <= b - 1` follows `a w <= b w - w`; and a condition on `a` may be multiplied by `w`.
fn lemmas(all: &[Constraint], multiplied: bool) -> (Vec<Constraint>, Vec<Alternatives>) {
    let own = split(&products_of(all), all);
    if !multiplied {
        let mut alternatives = Vec::new();
        for (rest, a) in &own {
            let others = own.iter().filter(|(other, b)| other == rest && b > a);
            alternatives.extend(others.filter_map(|(_, b)| in_order(*a, *b, rest)));
        }
        alternatives.truncate(MOST_PAIRS);
        return (Vec::new(), alternatives);
    }
    let mut more = BTreeSet::new();
    for (rest, one) in &own {
        let by = product_of(rest);
        let short = |own: &&Constraint| own.of.is_linear() && own.of.has(*one) && own.of.terms().count() <= MOST_TERMS;
        more.extend(
            all.iter().filter(short).filter_map(|own| own.of.product(&by).map(|of| Constraint { of, zero: own.zero })),
        );
    }
    // Multiplied conditions bring in products that are to be compared as well.
    let new = split(&products_of(&more), all);
    let mut alternatives = Vec::new();
    for (rest, a) in &own {
        let others = new.iter().filter(|(other, b)| other == rest && b != a && !own.contains(&(rest.clone(), *b)));
        alternatives.extend(others.filter_map(|(_, b)| in_order(*a, *b, rest)));
    }
    for (rest, a) in &own {
        let (a, w, zero) = (Polynomial::unknown(*a), product_of(rest), Polynomial::default());
        if let Some(aw) = a.product(&w) {
            alternatives.push(vec![
                vec![Constraint::equal(&a, &zero), Constraint::equal(&aw, &zero)],
                vec![Constraint::less(&zero, &a), Constraint::at_most(&w, &aw)],
                vec![Constraint::less(&a, &zero), Constraint::at_most(&aw, &w.times(-1))],
            ]);
        }
    }
    alternatives.truncate(MOST_PAIRS);
    (more.into_iter().collect(), alternatives)
}

/// Which of two factors of the same rest is larger, and what follows.
fn in_order(a: Unknown, b: Unknown, rest: &[Unknown]) -> Option<Alternatives> {
    let (a, b, w) = (Polynomial::unknown(a), Polynomial::unknown(b), product_of(rest));
    let (aw, bw) = (a.product(&w)?, b.product(&w)?);
    Some(vec![
        vec![Constraint::equal(&a, &b), Constraint::equal(&aw, &bw)],
        vec![Constraint::less(&a, &b), Constraint::at_most(&aw.plus(&w), &bw)],
        vec![Constraint::less(&b, &a), Constraint::at_most(&bw.plus(&w), &aw)],
    ])
}

fn product_of(factors: &[Unknown]) -> Polynomial {
    let one = Polynomial::constant(1);
    factors.iter().fold(one, |all, factor| all.product(&Polynomial::unknown(*factor)).unwrap_or(all))
}
