//! Polynomials with whole coefficients in a few unknowns.

use std::collections::BTreeMap;

/// Number of an unknown.
pub type Unknown = u32;

/// A product of unknowns, in ascending order; of none, the number 1.
pub type Monomial = Vec<Unknown>;

/// Factors of a product at most: what has more is not followed.
const MOST_FACTORS: usize = 4;

/// Coefficients beyond this are not followed, so that sums of their products fit.
const LARGEST: i128 = 1 << 80;

/// A sum of products with whole coefficients, none of them 0.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Polynomial {
    terms: BTreeMap<Monomial, i128>,
}

impl Polynomial {
    /// A number.
    pub fn constant(value: i128) -> Self {
        let mut found = Self::default();
        found.add(Vec::new(), value);
        found
    }

    /// An unknown.
    pub fn unknown(unknown: Unknown) -> Self {
        Self { terms: [(vec![unknown], 1)].into() }
    }

    /// Its products with their coefficients.
    pub fn terms(&self) -> impl Iterator<Item = (&Monomial, i128)> {
        self.terms.iter().map(|(product, count)| (product, *count))
    }

    /// The number that it is, whatever its unknowns are.
    pub fn as_constant(&self) -> Option<i128> {
        match self.terms.len() {
            0 => Some(0),
            1 => self.terms.get(&Vec::new()).copied(),
            _ => None,
        }
    }

    /// The summand without an unknown.
    pub fn constant_part(&self) -> i128 {
        self.terms.get(&Vec::new()).copied().unwrap_or(0)
    }

    /// The coefficient of a product.
    pub fn coefficient(&self, of: &[Unknown]) -> i128 {
        self.terms.get(of).copied().unwrap_or(0)
    }

    /// Its unknowns, each as often as it occurs.
    pub fn unknowns(&self) -> impl Iterator<Item = Unknown> {
        self.terms.keys().flatten().copied()
    }

    /// True when an unknown occurs.
    pub fn has(&self, unknown: Unknown) -> bool {
        self.unknowns().any(|own| own == unknown)
    }

    /// True without products of unknowns.
    pub fn is_linear(&self) -> bool {
        self.terms.keys().all(|product| product.len() < 2)
    }

    fn add(&mut self, product: Monomial, count: i128) {
        let sum = self.terms.entry(product).or_default();
        *sum += count;
        if *sum == 0 {
            self.terms.retain(|_, count| *count != 0);
        }
    }

    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        self.plus_times(other, 1)
    }

    /// The difference.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        self.plus_times(other, -1)
    }

    /// The sum with a number.
    #[must_use]
    pub fn offset(&self, by: i128) -> Self {
        self.plus(&Self::constant(by))
    }

    /// The sum with a multiple of another one.
    #[must_use]
    pub fn plus_times(&self, other: &Self, factor: i128) -> Self {
        let mut sum = self.clone();
        other.terms.iter().for_each(|(product, count)| sum.add(product.clone(), count * factor));
        sum
    }

    /// A multiple.
    #[must_use]
    pub fn times(&self, factor: i128) -> Self {
        Self::default().plus_times(self, factor)
    }

    /// The product; `None` where it grows beyond what is followed.
    pub fn product(&self, other: &Self) -> Option<Self> {
        let mut found = Self::default();
        for (a, n) in &self.terms {
            for (b, m) in &other.terms {
                let mut both = [a.as_slice(), b].concat();
                both.sort_unstable();
                if both.len() > MOST_FACTORS {
                    return None;
                }
                found.add(both, n.checked_mul(*m)?);
            }
        }
        found.is_small().then_some(found)
    }

    /// True where no coefficient is beyond what is followed.
    pub fn is_small(&self) -> bool {
        self.terms.values().all(|count| count.abs() < LARGEST)
    }

    /// The same with each unknown replaced by another one.
    #[must_use]
    pub fn renamed(&self, rename: &mut impl FnMut(Unknown) -> Unknown) -> Self {
        let mut found = Self::default();
        for (product, count) in &self.terms {
            let mut product: Monomial = product.iter().map(|unknown| rename(*unknown)).collect();
            product.sort_unstable();
            found.add(product, *count);
        }
        found
    }

    /// The same with polynomials in place of unknowns; `None` where it grows beyond what is followed.
    pub fn substituted(&self, with: &impl Fn(Unknown) -> Option<Self>) -> Option<Self> {
        let mut found = Self::default();
        for (product, count) in &self.terms {
            let mut all = Self::constant(*count);
            for unknown in product {
                all = all.product(&with(*unknown).unwrap_or_else(|| Self::unknown(*unknown)))?;
            }
            found = found.plus(&all);
        }
        Some(found)
    }

    /// Its value; unknowns that have none are 0.
    pub fn value(&self, of: &BTreeMap<Unknown, i128>) -> Option<i128> {
        self.terms.iter().try_fold(0_i128, |sum, (product, count)| {
            let value = product
                .iter()
                .try_fold(*count, |value, unknown| value.checked_mul(of.get(unknown).copied().unwrap_or(0)))?;
            sum.checked_add(value)
        })
    }
}
