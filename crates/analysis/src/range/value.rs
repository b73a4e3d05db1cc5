//! What is known of a value: an interval a component, where its ends come from, and what it depends on.

/// How well an end of an interval is known to be met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Evidence {
    /// Nothing is beyond the end, but values near it may never come up.
    #[default]
    Bound,
    /// The end belongs to a function or variable of the language whose argument is free: the sine of
    /// an angle, the scalar product of two directions.
    Nature,
    /// The text states it: a constant, a range of the configuration, an end of `clamp` or `max`.
    Stated,
}

/// The inputs that a value depends on, as a set of 128 marks. Two inputs may share a mark: sets that
/// have no mark in common are independent, others need not be dependent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sources(u128);

impl Sources {
    /// No input: a constant.
    pub const NONE: Self = Self(0);
    /// Any input.
    pub const ALL: Self = Self(u128::MAX);

    /// The input with this number.
    pub fn of(number: usize) -> Self {
        Self(1 << (number % 120))
    }

    /// What a condition made of the expression with this number: a value of its own.
    pub fn narrowed(number: usize) -> Self {
        Self(1 << (120 + number % 8))
    }

    /// The inputs of `self` that are not in `other`.
    #[must_use]
    pub fn less(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// The inputs of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// True when no input is in both.
    pub fn apart_from(self, other: Self) -> bool {
        self.0 & other.0 == 0
    }

    /// True when all inputs of `self` are in `other`.
    pub fn within(self, other: Self) -> bool {
        self.0 & !other.0 == 0
    }
}

/// What is known of one component. Ends may be infinite; integers and truth values (0 and 1) are
/// numbers too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least value.
    pub lo: f64,
    /// Greatest value.
    pub hi: f64,
    /// How well the least value is known.
    pub lo_by: Evidence,
    /// How well the greatest value is known.
    pub hi_by: Evidence,
    /// True when it may be NaN as well.
    pub nan: bool,
    /// True when 0 is left out, though it lies between the ends.
    pub nonzero: bool,
    /// What it depends on.
    pub sources: Sources,
}

impl Range {
    /// Anything, and nothing is known of it.
    pub fn unknown(sources: Sources) -> Self {
        Self::of(f64::NEG_INFINITY, f64::INFINITY, Evidence::Bound, sources).or_nan()
    }

    /// Between two ends that are known equally well.
    pub fn of(lo: f64, hi: f64, by: Evidence, sources: Sources) -> Self {
        Self { lo, hi, lo_by: by, hi_by: by, nan: false, nonzero: false, sources }
    }

    /// One value that the text states.
    pub fn exactly(value: f64) -> Self {
        let mut range = Self::of(value, value, Evidence::Stated, Sources::NONE);
        if value.is_nan() {
            range = Self::unknown(Sources::NONE);
        }
        range
    }

    /// True or false, and it is not known which.
    pub fn truth(sources: Sources) -> Self {
        Self::of(0.0, 1.0, Evidence::Bound, sources)
    }

    /// The same, possibly NaN.
    #[must_use]
    pub fn or_nan(mut self) -> Self {
        self.nan = true;
        self
    }

    /// The same with ends of which it is not known whether they are met.
    #[must_use]
    pub fn vague(mut self) -> Self {
        (self.lo_by, self.hi_by) = (Evidence::Bound, Evidence::Bound);
        self
    }

    /// The only value, when there is one.
    pub fn single(&self) -> Option<f64> {
        (self.lo == self.hi && !self.nan).then_some(self.lo)
    }

    /// True when `value` is possible; NaN asks for the mark.
    #[cfg(test)]
    pub fn contains(&self, value: f64) -> bool {
        if value.is_nan() {
            return self.nan;
        }
        self.lo <= value && value <= self.hi && !(value == 0.0 && self.nonzero)
    }

    /// What is possible in either.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        let (lo, lo_by) = lower((self.lo, self.lo_by), (other.lo, other.lo_by));
        let (hi, hi_by) = upper((self.hi, self.hi_by), (other.hi, other.hi_by));
        Self {
            lo,
            hi,
            lo_by,
            hi_by,
            nan: self.nan || other.nan,
            nonzero: self.excludes_zero() && other.excludes_zero(),
            sources: self.sources.and(other.sources),
        }
    }

    /// The same where `fact` holds as well.
    #[must_use]
    pub fn narrowed(self, fact: &Self) -> Self {
        let (lo, lo_by) = if fact.lo >= self.lo { (fact.lo, fact.lo_by) } else { (self.lo, self.lo_by) };
        let (hi, hi_by) = if fact.hi <= self.hi { (fact.hi, fact.hi_by) } else { (self.hi, self.hi_by) };
        if lo > hi {
            return self;
        }
        let nonzero = self.nonzero || fact.nonzero;
        Self { lo, hi, lo_by, hi_by, nan: self.nan && fact.nan, nonzero, sources: fact.sources }
    }

    /// True when 0 is not possible.
    pub fn excludes_zero(&self) -> bool {
        self.nonzero || self.lo > 0.0 || self.hi < 0.0
    }

    /// True when the text shows that it can be 0: an end that is met is 0, or both ends are stated
    /// and 0 lies between them.
    pub fn shows_zero(&self) -> bool {
        let stated = Evidence::Stated;
        !self.excludes_zero()
            && ((self.lo == 0.0 && self.lo_by == stated)
                || (self.hi == 0.0 && self.hi_by == stated)
                || (self.lo_by == stated && self.hi_by == stated))
    }

    /// True when values below `limit` are possible, and the lower end is known at least so well.
    pub fn goes_below(&self, limit: f64, by: Evidence) -> bool {
        self.lo < limit && self.lo_by >= by
    }

    /// True when values above `limit` are possible, and the upper end is known at least so well.
    pub fn goes_above(&self, limit: f64, by: Evidence) -> bool {
        self.hi > limit && self.hi_by >= by
    }

    /// True when both ends are finite.
    pub fn is_finite(&self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }
}

/// The lower of two ends; the better known one when they are equal.
pub fn lower(a: (f64, Evidence), b: (f64, Evidence)) -> (f64, Evidence) {
    if a.0 < b.0 || (a.0 == b.0 && a.1 >= b.1) { a } else { b }
}

/// The upper of two ends; the better known one when they are equal.
pub fn upper(a: (f64, Evidence), b: (f64, Evidence)) -> (f64, Evidence) {
    if a.0 > b.0 || (a.0 == b.0 && a.1 >= b.1) { a } else { b }
}

/// What is known of a value.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// One range a component of a scalar or vector; none of anything else.
    pub parts: Vec<Range>,
    /// True when the length is 1, up to rounding.
    pub unit: bool,
    /// Which directions it was made from: marks of `normalize` calls.
    pub made_from: u128,
    /// What a value without ranges depends on.
    pub rest: Sources,
}

impl Value {
    /// A value that is no scalar or vector.
    pub fn opaque(sources: Sources) -> Self {
        Self { rest: sources, ..Self::new(Vec::new()) }
    }

    /// A value of these components.
    pub fn new(parts: Vec<Range>) -> Self {
        Self { parts, unit: false, made_from: 0, rest: Sources::NONE }
    }

    /// A scalar.
    pub fn scalar(range: Range) -> Self {
        Self::new(vec![range])
    }

    /// `n` components of which nothing is known.
    pub fn unknown(n: usize, sources: Sources) -> Self {
        Self::new(vec![Range::unknown(sources); n])
    }

    /// The component with that index; a scalar stands for all of them.
    pub fn part(&self, index: usize) -> Option<Range> {
        if let [only] = self.parts.as_slice() { Some(*only) } else { self.parts.get(index).copied() }
    }

    /// All components in one.
    pub fn hull(&self) -> Option<Range> {
        self.parts.iter().copied().reduce(Range::join)
    }

    /// What all components depend on.
    pub fn sources(&self) -> Sources {
        let Some(first) = self.parts.first() else { return self.rest };
        self.parts.iter().fold(first.sources, |all, p| all.and(p.sources))
    }

    /// What is possible in either.
    #[must_use]
    pub fn join(&self, other: &Self) -> Self {
        let parts = if self.parts.len() == other.parts.len() {
            self.parts.iter().zip(&other.parts).map(|(a, b)| a.join(*b)).collect()
        } else {
            Vec::new()
        };
        let rest = self.rest.and(other.rest);
        Self { parts, unit: self.unit && other.unit, made_from: self.made_from | other.made_from, rest }
    }

    /// The same, depending on more.
    #[must_use]
    pub fn depending(mut self, sources: Sources) -> Self {
        self.parts.iter_mut().for_each(|p| p.sources = p.sources.and(sources));
        self.rest = self.rest.and(sources);
        self
    }

    /// The same with ends of which it is not known whether they are met.
    #[must_use]
    pub fn vague(mut self) -> Self {
        self.parts.iter_mut().for_each(|p| *p = p.vague());
        self
    }
}
