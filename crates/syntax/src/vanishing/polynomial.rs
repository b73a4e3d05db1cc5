//! Polynomials of unknown numbers, in which sums cancel exactly.

use std::collections::BTreeMap;

/// Terms of a polynomial that is still multiplied out.
const TERMS: usize = 64;

/// Factors of such a term.
const DEGREE: usize = 6;

/// A part of the sizes of all terms that counts as 0: coefficients are rounded to binary64.
const ROUNDED: f64 = 1e-13;

/// An unknown number.
pub type Atom = u32;

/// A sum of products of unknown numbers, with their coefficients.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polynomial {
    terms: BTreeMap<Vec<Atom>, f64>,
    rounded: bool,
}

impl Polynomial {
    /// A constant.
    pub fn constant(value: f64) -> Self {
        let terms = if value == 0.0 { BTreeMap::new() } else { BTreeMap::from([(Vec::new(), value)]) };
        Self { terms, rounded: false }
    }

    /// An unknown number.
    pub fn atom(atom: Atom) -> Self {
        Self { terms: BTreeMap::from([(vec![atom], 1.0)]), rounded: false }
    }

    /// True for 0.
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// The same, from an operation that rounds.
    pub fn rounded(self) -> Self {
        Self { rounded: true, ..self }
    }

    /// True where an operation on the way to it rounds.
    pub fn is_rounded(&self) -> bool {
        self.rounded
    }

    /// True where it depends on no unknown number.
    pub fn is_constant(&self) -> bool {
        self.terms.keys().all(Vec::is_empty)
    }

    /// This and `factor` times the other.
    pub fn plus(&self, other: &Self, factor: f64) -> Self {
        let mut terms = self.terms.clone();
        for (atoms, coefficient) in &other.terms {
            let before = terms.get(atoms).copied().unwrap_or(0.0);
            let (more, size) = (factor * coefficient, before.abs() + (factor * coefficient).abs());
            if (before + more).abs() <= size * ROUNDED {
                terms.remove(atoms);
            } else {
                terms.insert(atoms.clone(), before + more);
            }
        }
        Self { terms, rounded: self.rounded || other.rounded }
    }

    /// The product; none where it has too many terms.
    pub fn times(&self, other: &Self) -> Option<Self> {
        if self.terms.len() * other.terms.len() > TERMS {
            return None;
        }
        let mut product = Self { rounded: self.rounded || other.rounded, ..Self::default() };
        for (a, x) in &self.terms {
            for (b, y) in &other.terms {
                let mut atoms = [a.as_slice(), b].concat();
                atoms.sort_unstable();
                if atoms.len() > DEGREE {
                    return None;
                }
                product = product.plus(&Self { terms: BTreeMap::from([(atoms, x * y)]), rounded: false }, 1.0);
            }
        }
        Some(product)
    }

    /// The value of a constant.
    pub fn value(&self) -> Option<f64> {
        self.is_constant().then(|| self.terms.values().sum())
    }

    /// With other unknown numbers in the place of these.
    pub fn renamed(&self, rename: &mut dyn FnMut(Atom) -> Atom) -> Self {
        let mut all = Self { rounded: self.rounded, ..Self::default() };
        for (atoms, coefficient) in &self.terms {
            let mut atoms: Vec<Atom> = atoms.iter().map(|atom| rename(*atom)).collect();
            atoms.sort_unstable();
            all = all.plus(&Self { terms: BTreeMap::from([(atoms, *coefficient)]), rounded: false }, 1.0);
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_cancel_and_products_are_multiplied_out() {
        let [a, b] = [0, 1].map(Polynomial::atom);
        let square = a.plus(&b, 1.0).times(&a.plus(&b, -1.0)).unwrap();
        let difference = a.times(&a).unwrap().plus(&b.times(&b).unwrap(), -1.0);
        assert!(square.plus(&difference, -1.0).is_zero());
        assert!(!square.is_zero() && !square.is_constant());
        assert_eq!(Polynomial::constant(2.0).times(&Polynomial::constant(0.5)).unwrap().value(), Some(1.0));
    }

    #[test]
    fn what_grows_too_large_is_given_up() {
        let sum = (0..12).fold(Polynomial::default(), |sum, atom| sum.plus(&Polynomial::atom(atom), 1.0));
        assert_eq!(sum.times(&sum), None);
    }
}
