//! Quotients of polynomials over whatever is no sum, product or quotient: sums over a common denominator, with all that
//! cancels taken out.

use std::collections::BTreeMap;

use egg::Id;

use crate::term::{Binary, Node, Term, Unary, rooted};

/// Products of polynomials have no more terms than that.
const TERMS: usize = 32;

/// Powers of atoms, by their index.
type Monomial = BTreeMap<usize, u32>;
/// Coefficients, exact in binary64.
type Polynomial = BTreeMap<Monomial, f64>;

/// A numerator over factors with their powers.
#[derive(Clone)]
struct Quotient {
    above: Polynomial,
    below: Vec<(Polynomial, u32)>,
}

struct Atoms<'t> {
    term: &'t Term,
    all: Vec<Id>,
}

/// The normal form; none where it is too large, or coefficients are not exact.
pub fn of(term: &Term) -> Option<Term> {
    let root = Id::from(term.len().checked_sub(1)?);
    let mut atoms = Atoms { term, all: Vec::new() };
    let quotient = atoms.quotient(root)?;
    let mut nodes: Term = term.clone();
    let above = sum(&quotient.above, &atoms.all, &mut nodes);
    let mut below: Option<Id> = None;
    for (factor, power) in &quotient.below {
        let id = sum(factor, &atoms.all, &mut nodes);
        for _ in 0..*power {
            below = Some(match below {
                None => id,
                Some(all) => nodes.add(Node::Binary(Binary::Mul, [all, id])),
            });
        }
    }
    let root = match below {
        None => above,
        Some(below) => nodes.add(Node::Binary(Binary::Div, [above, below])),
    };
    Some(rooted(&nodes, root))
}

impl Atoms<'_> {
    fn atom(&mut self, id: Id) -> Polynomial {
        let place = self.all.iter().position(|known| *known == id).unwrap_or_else(|| {
            self.all.push(id);
            self.all.len() - 1
        });
        Polynomial::from([(Monomial::from([(place, 1)]), 1.0)])
    }

    fn quotient(&mut self, id: Id) -> Option<Quotient> {
        let whole = |above| Quotient { above, below: Vec::new() };
        match self.term[id] {
            Node::Number(c) if c.value() == 0.0 => Some(whole(Polynomial::new())),
            Node::Number(c) => Some(whole(Polynomial::from([(Monomial::new(), c.value())]))),
            Node::Unary(Unary::Neg, x) => {
                let x = self.quotient(x)?;
                Some(Quotient { above: scaled(&x.above, -1.0)?, ..x })
            }
            Node::Binary(Binary::Add, [a, b]) => {
                let (a, b) = (self.quotient(a)?, self.quotient(b)?);
                self.added(a, b)
            }
            Node::Binary(Binary::Sub, [a, b]) => {
                let (a, b) = (self.quotient(a)?, self.quotient(b)?);
                let b = Quotient { above: scaled(&b.above, -1.0)?, ..b };
                self.added(a, b)
            }
            Node::Binary(Binary::Mul, [a, b]) => {
                let (a, b) = (self.quotient(a)?, self.quotient(b)?);
                let above = self.product(&a.above, &b.above)?;
                let mut below = a.below;
                b.below.into_iter().for_each(|(factor, power)| push(&mut below, factor, power));
                Some(cancelled(Quotient { above, below }))
            }
            Node::Binary(Binary::Div, [a, b]) => {
                let (a, b) = (self.quotient(a)?, self.quotient(b)?);
                let mut above = a.above;
                for (factor, power) in &b.below {
                    for _ in 0..*power {
                        above = self.product(&above, factor)?;
                    }
                }
                let mut below = a.below;
                if b.above.is_empty() {
                    return None;
                }
                // A product of atoms is as many factors.
                if let (1, Some((monomial, c))) = (b.above.len(), b.above.first_key_value()) {
                    for (atom, power) in monomial {
                        push(&mut below, Polynomial::from([(Monomial::from([(*atom, 1)]), 1.0)]), *power);
                    }
                    above = over(&above, *c)?;
                } else {
                    push(&mut below, b.above, 1);
                }
                Some(cancelled(Quotient { above, below }))
            }
            Node::Pi | Node::Leaf(_) | Node::Unary(..) | Node::Binary(..) => Some(whole(self.atom(id))),
        }
    }

    fn added(&mut self, a: Quotient, b: Quotient) -> Option<Quotient> {
        let mut below = a.below.clone();
        for (factor, power) in &b.below {
            match below.iter_mut().find(|(known, _)| known == factor) {
                Some((_, most)) => *most = (*most).max(*power),
                None => below.push((factor.clone(), *power)),
            }
        }
        let mut above = Polynomial::new();
        for one in [&a, &b] {
            let mut part = one.above.clone();
            for (factor, power) in &below {
                let has = one.below.iter().find(|(known, _)| known == factor).map_or(0, |(_, power)| *power);
                for _ in has..*power {
                    part = self.product(&part, factor)?;
                }
            }
            for (monomial, c) in part {
                add(&mut above, monomial, c)?;
            }
        }
        Some(cancelled(Quotient { above, below }))
    }

    fn product(&mut self, a: &Polynomial, b: &Polynomial) -> Option<Polynomial> {
        let mut product = Polynomial::new();
        for (m, c) in a {
            for (n, d) in b {
                let mut monomial = m.clone();
                n.iter().for_each(|(atom, power)| *monomial.entry(*atom).or_default() += power);
                let both = c * d;
                if c.mul_add(*d, -both) != 0.0 {
                    return None;
                }
                add(&mut product, monomial, both)?;
            }
        }
        self.without_roots(product)
    }

    /// The square of a root is what is under it.
    fn without_roots(&mut self, from: Polynomial) -> Option<Polynomial> {
        let root = |atom: usize| match self.term[self.all[atom]] {
            Node::Unary(Unary::Sqrt, under) => Some((atom, under)),
            _ => None,
        };
        let square = from.keys().flatten().filter(|(_, power)| **power >= 2).find_map(|(atom, _)| root(*atom));
        let Some((atom, under)) = square else { return (from.len() <= TERMS).then_some(from) };
        let under = self.quotient(under).filter(|under| under.below.is_empty())?.above;
        let mut all = Polynomial::new();
        for (mut monomial, c) in from {
            let power = monomial.remove(&atom).unwrap_or(0);
            if power % 2 == 1 {
                monomial.insert(atom, 1);
            }
            let mut part = Polynomial::from([(monomial, c)]);
            for _ in 0..power / 2 {
                part = self.product(&part, &under)?;
            }
            for (monomial, c) in part {
                add(&mut all, monomial, c)?;
            }
        }
        self.without_roots(all)
    }
}

fn add(to: &mut Polynomial, monomial: Monomial, c: f64) -> Option<()> {
    let sum = to.get(&monomial).copied().unwrap_or(0.0);
    let new = sum + c;
    let part = new - sum;
    if (sum - (new - part)) + (c - part) != 0.0 || !new.is_finite() {
        return None;
    }
    if new == 0.0 {
        to.remove(&monomial);
    } else {
        to.insert(monomial, new);
    }
    (to.len() <= TERMS).then_some(())
}

fn scaled(of: &Polynomial, by: f64) -> Option<Polynomial> {
    Some(of.iter().map(|(m, c)| (m.clone(), c * by)).collect())
}

fn over(of: &Polynomial, by: f64) -> Option<Polynomial> {
    let part = |(m, c): (&Monomial, &f64)| {
        let q = c / by;
        (q.mul_add(by, -c) == 0.0).then(|| (m.clone(), q))
    };
    of.iter().map(part).collect()
}

fn push(below: &mut Vec<(Polynomial, u32)>, factor: Polynomial, power: u32) {
    match below.iter_mut().find(|(known, _)| *known == factor) {
        Some((_, known)) => *known += power,
        None => below.push((factor, power)),
    }
}

/// Without the atoms that every term above has and that are factors below, and without a factor that is the numerator.
fn cancelled(mut quotient: Quotient) -> Quotient {
    if quotient.above.is_empty() {
        return Quotient { below: Vec::new(), ..quotient };
    }
    for (factor, power) in &mut quotient.below {
        if *power > 0 && quotient.above == *factor {
            *power -= 1;
            quotient.above = Polynomial::from([(Monomial::new(), 1.0)]);
        }
        let Some((monomial, _)) = factor.first_key_value().filter(|_| factor.len() == 1) else { continue };
        let Some((atom, _)) = monomial.first_key_value().filter(|_| monomial.len() == 1) else { continue };
        let shared = quotient.above.keys().map(|m| m.get(atom).copied().unwrap_or(0)).min().unwrap_or(0).min(*power);
        *power -= shared;
        quotient.above = std::mem::take(&mut quotient.above)
            .into_iter()
            .map(|(mut m, c)| {
                if let Some(left) = m.get(atom).map(|has| has - shared) {
                    if left == 0 {
                        m.remove(atom)
                    } else {
                        m.insert(*atom, left)
                    };
                }
                (m, c)
            })
            .collect();
    }
    quotient.below.retain(|(_, power)| *power > 0);
    quotient
}

/// A polynomial as nodes, what all terms share in front.
fn sum(of: &Polynomial, atoms: &[Id], nodes: &mut Term) -> Id {
    let shared = |atom: usize| of.keys().map(|m| m.get(&atom).copied().unwrap_or(0)).min().unwrap_or(0);
    let front: Monomial = (0..atoms.len()).map(|atom| (atom, shared(atom))).filter(|(_, power)| *power > 0).collect();
    let mut total: Option<Id> = None;
    for (monomial, c) in of.iter().rev() {
        let rest: Monomial = monomial
            .iter()
            .map(|(atom, power)| (*atom, power - front.get(atom).copied().unwrap_or(0)))
            .filter(|(_, power)| *power > 0)
            .collect();
        let subtracted = *c < 0.0 && total.is_some();
        let part = product(&rest, if subtracted { -c } else { *c }, atoms, nodes);
        total = Some(match total {
            None => part,
            Some(total) => {
                let op = if subtracted { Binary::Sub } else { Binary::Add };
                nodes.add(Node::Binary(op, [total, part]))
            }
        });
    }
    let total = total.unwrap_or_else(|| nodes.add(Node::number(0.0)));
    if front.is_empty() {
        return total;
    }
    let front = product(&front, 1.0, atoms, nodes);
    if nodes[total] == Node::number(1.0) { front } else { nodes.add(Node::Binary(Binary::Mul, [front, total])) }
}

fn product(of: &Monomial, c: f64, atoms: &[Id], nodes: &mut Term) -> Id {
    let mut all = (c != 1.0 || of.is_empty()).then(|| nodes.add(Node::number(c)));
    for (atom, power) in of {
        for _ in 0..*power {
            all = Some(match all {
                None => atoms[*atom],
                Some(all) => nodes.add(Node::Binary(Binary::Mul, [all, atoms[*atom]])),
            });
        }
    }
    all.unwrap_or_else(|| nodes.add(Node::number(1.0)))
}
