//! Whether linear equations and inequalities hold for some whole numbers, by elimination of one unknown after the other.
//!
//! Equations go first, those without a coefficient of 1 by the step of Pugh's Omega test; inequalities are combined in
//! pairs (Fourier and Motzkin), each divided by what divides its coefficients and its constant rounded down. That finds no
//! contradiction where there is none. What remains gives a point by insertion, which may fail where an elimination is not
//! exact.

use std::collections::BTreeMap;

/// Inequalities of a system at most.
const MOST_ROWS: usize = 600;

/// A sum of multiples of columns and a constant.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Row {
    pub coefficients: BTreeMap<u32, i128>,
    pub constant: i128,
}

/// What is known of a system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Found {
    /// No whole numbers solve it.
    Nothing,
    /// These do, by column.
    Point(BTreeMap<u32, i128>),
    /// It was not found out.
    Open,
}

/// How an unknown goes away.
enum Step {
    /// It is this.
    Is(u32, Row),
    /// It lies between these.
    Between(u32, Vec<Row>),
}

/// The system has no solution.
struct Contradiction;

/// Why elimination ends early.
enum End {
    Nothing,
    TooMuch,
}

impl From<Contradiction> for End {
    fn from(_: Contradiction) -> Self {
        Self::Nothing
    }
}

impl Row {
    fn of(&self, column: u32) -> i128 {
        self.coefficients.get(&column).copied().unwrap_or(0)
    }

    /// `self * a + other * b`; `None` where a number grows too large.
    fn combined(&self, a: i128, other: &Self, b: i128) -> Option<Self> {
        let mut sum = Self { coefficients: BTreeMap::new(), constant: 0 };
        sum.constant = self.constant.checked_mul(a)?.checked_add(other.constant.checked_mul(b)?)?;
        for (column, count) in &self.coefficients {
            sum.coefficients.insert(*column, count.checked_mul(a)?);
        }
        for (column, count) in &other.coefficients {
            let own = sum.coefficients.entry(*column).or_default();
            *own = own.checked_add(count.checked_mul(b)?)?;
        }
        sum.coefficients.retain(|_, count| *count != 0);
        (sum.constant.abs() < 1 << 100 && sum.coefficients.values().all(|c| c.abs() < 1 << 100)).then_some(sum)
    }

    fn divisor(&self) -> i128 {
        self.coefficients.values().fold(0, |all, count| gcd(all, *count))
    }

    /// An inequality with the smallest coefficients that mean the same to whole numbers; `None` where it always holds.
    fn tightened(mut self) -> Result<Option<Self>, Contradiction> {
        let divisor = self.divisor();
        if divisor == 0 {
            return if self.constant < 0 { Err(Contradiction) } else { Ok(None) };
        }
        self.coefficients.values_mut().for_each(|count| *count /= divisor);
        self.constant = self.constant.div_euclid(divisor);
        Ok(Some(self))
    }

    /// The same of an equation.
    fn reduced(mut self) -> Result<Option<Self>, Contradiction> {
        let divisor = self.divisor();
        if divisor == 0 {
            return if self.constant == 0 { Ok(None) } else { Err(Contradiction) };
        }
        if self.constant % divisor != 0 {
            return Err(Contradiction);
        }
        self.coefficients.values_mut().for_each(|count| *count /= divisor);
        self.constant /= divisor;
        Ok(Some(self))
    }

    fn value(&self, point: &BTreeMap<u32, i128>, without: u32) -> Option<i128> {
        self.coefficients
            .iter()
            .filter(|(column, _)| **column != without)
            .try_fold(self.constant, |sum, (c, n)| sum.checked_add(n.checked_mul(point.get(c).copied().unwrap_or(0))?))
    }
}

fn gcd(a: i128, b: i128) -> i128 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// Whether whole numbers exist for which all of `zero` is 0 and nothing of `positive` is less.
pub(super) fn solve(zero: Vec<Row>, positive: Vec<Row>, steps: &mut u64) -> Found {
    let mut system = Elimination { zero, positive, done: Vec::new(), next: 0 };
    let used = |row: &Row| row.coefficients.keys().last().copied();
    system.next = system.zero.iter().chain(&system.positive).filter_map(used).max().map_or(0, |last| last + 1);
    let first_new = system.next;
    match system.run(steps) {
        Err(End::Nothing) => Found::Nothing,
        Err(End::TooMuch) => Found::Open,
        Ok(()) => match system.point() {
            Some(mut point) => {
                point.retain(|column, _| *column < first_new);
                Found::Point(point)
            }
            None => Found::Open,
        },
    }
}

struct Elimination {
    zero: Vec<Row>,
    positive: Vec<Row>,
    done: Vec<Step>,
    next: u32,
}

impl Elimination {
    fn run(&mut self, steps: &mut u64) -> Result<(), End> {
        loop {
            self.equations(steps)?;
            if self.tidy()? {
                continue;
            }
            let Some(column) = self.cheapest() else { return Ok(()) };
            self.eliminate(column, steps)?;
        }
    }

    fn spend(steps: &mut u64, count: usize) -> Result<(), End> {
        *steps = steps.saturating_sub(count as u64);
        if *steps == 0 { Err(End::TooMuch) } else { Ok(()) }
    }

    /// Solves all equations for one of their unknowns each.
    fn equations(&mut self, steps: &mut u64) -> Result<(), End> {
        while let Some(row) = self.zero.pop() {
            let Some(row) = row.reduced()? else { continue };
            Self::spend(steps, 1 + self.zero.len() + self.positive.len())?;
            let (&column, &count) = row.coefficients.iter().min_by_key(|(_, n)| n.abs()).ok_or(End::TooMuch)?;
            if count.abs() == 1 {
                let mut rest = row.clone();
                rest.coefficients.remove(&column);
                let is = rest.combined(-count, &Row::default(), 0).ok_or(End::TooMuch)?;
                self.insert(column, &is)?;
                continue;
            }
            // One more unknown makes smaller coefficients of it (Pugh 1991, "The Omega test", 2.2).
            let m = count.abs() + 1;
            let hat = |n: i128| {
                let rest = n.rem_euclid(m);
                if 2 * rest < m { rest } else { rest - m }
            };
            let new = self.next;
            self.next += 1;
            let mut other = Row { coefficients: BTreeMap::new(), constant: hat(row.constant) };
            other.coefficients.extend(row.coefficients.iter().map(|(c, n)| (*c, hat(*n))).filter(|(_, n)| *n != 0));
            other.coefficients.insert(new, -m);
            let own = other.of(column);
            debug_assert_eq!(own.abs(), 1, "the step of the Omega test makes a coefficient of 1");
            let mut rest = other;
            rest.coefficients.remove(&column);
            let is = rest.combined(-own, &Row::default(), 0).ok_or(End::TooMuch)?;
            self.zero.push(row);
            self.insert(column, &is)?;
        }
        Ok(())
    }

    /// Puts a sum in the place of an unknown everywhere.
    fn insert(&mut self, column: u32, is: &Row) -> Result<(), End> {
        for row in self.zero.iter_mut().chain(&mut self.positive) {
            let count = row.of(column);
            if count != 0 {
                row.coefficients.remove(&column);
                *row = row.combined(1, is, count).ok_or(End::TooMuch)?;
            }
        }
        self.done.push(Step::Is(column, is.clone()));
        Ok(())
    }

    /// Keeps the tightest of inequalities with the same coefficients. True where two of them make an equation.
    fn tidy(&mut self) -> Result<bool, End> {
        let mut kept: BTreeMap<Vec<(u32, i128)>, i128> = BTreeMap::new();
        for row in std::mem::take(&mut self.positive) {
            let Some(row) = row.tightened()? else { continue };
            let key: Vec<(u32, i128)> = row.coefficients.into_iter().collect();
            let constant = kept.entry(key).or_insert(row.constant);
            *constant = row.constant.min(*constant);
        }
        let mut equations = false;
        for (key, constant) in &kept {
            let opposite: Vec<(u32, i128)> = key.iter().map(|(c, n)| (*c, -n)).collect();
            let row = Row { coefficients: key.iter().copied().collect(), constant: *constant };
            match kept.get(&opposite) {
                Some(other) if constant + other < 0 => return Err(End::Nothing),
                Some(other) if constant + other == 0 => {
                    equations = true;
                    if key < &opposite {
                        self.zero.push(row);
                    }
                }
                _ => self.positive.push(row),
            }
        }
        if self.positive.len() > MOST_ROWS { Err(End::TooMuch) } else { Ok(equations) }
    }

    /// The unknown whose elimination makes the fewest inequalities; of these, one whose elimination is exact.
    fn cheapest(&self) -> Option<u32> {
        let mut of: BTreeMap<u32, (usize, usize, bool, bool)> = BTreeMap::new();
        for row in &self.positive {
            for (column, count) in &row.coefficients {
                let own = of.entry(*column).or_insert((0, 0, true, true));
                if *count > 0 {
                    own.0 += 1;
                    own.2 &= *count == 1;
                } else {
                    own.1 += 1;
                    own.3 &= *count == -1;
                }
            }
        }
        of.into_iter().min_by_key(|(_, (low, high, one, other))| (!(*one || *other), low * high)).map(|(c, _)| c)
    }

    fn eliminate(&mut self, column: u32, steps: &mut u64) -> Result<(), End> {
        let (about, rest): (Vec<Row>, Vec<Row>) =
            std::mem::take(&mut self.positive).into_iter().partition(|row| row.of(column) != 0);
        self.positive = rest;
        let (lows, highs): (Vec<&Row>, Vec<&Row>) = about.iter().partition(|row| row.of(column) > 0);
        Self::spend(steps, 1 + lows.len() * highs.len())?;
        for low in &lows {
            for high in &highs {
                let sum = low.combined(-high.of(column), high, low.of(column)).ok_or(End::TooMuch)?;
                self.positive.push(sum);
            }
        }
        self.done.push(Step::Between(column, about));
        Ok(())
    }

    /// A point that solves it, inserted backwards: each number as near to 0 as it may be.
    fn point(&self) -> Option<BTreeMap<u32, i128>> {
        let mut point = BTreeMap::new();
        for step in self.done.iter().rev() {
            match step {
                Step::Is(column, row) => {
                    let value = row.value(&point, *column)?;
                    point.insert(*column, value);
                }
                Step::Between(column, rows) => {
                    let (mut low, mut high) = (None::<i128>, None::<i128>);
                    for row in rows {
                        let (count, rest) = (row.of(*column), row.value(&point, *column)?);
                        if count > 0 {
                            let least = (-rest).div_euclid(count) + i128::from((-rest).rem_euclid(count) != 0);
                            low = Some(low.map_or(least, |own| own.max(least)));
                        } else {
                            let most = rest.div_euclid(-count);
                            high = Some(high.map_or(most, |own| own.min(most)));
                        }
                    }
                    if low.zip(high).is_some_and(|(low, high)| low > high) {
                        return None;
                    }
                    let value = 0.max(low.unwrap_or(i128::MIN)).min(high.unwrap_or(i128::MAX));
                    point.insert(*column, value);
                }
            }
        }
        Some(point)
    }
}
