//! What operations on whole numbers give: exactly, as far as sums, products and quotients by constants go.
//!
//! A register holds 32 bits; a polynomial stands for the number that its reader takes them for. Sums and products are
//! assumed to stay within 32 bits, which is noted. A difference of numbers without a sign is not: below 0 it is exactly
//! what wraps around, for that is where faults are.

use number::linear::{Constraint, Polynomial, Solution, System, Unknown};

use super::super::code::{Reg, Word1, Word2};
use super::super::domain::Site;
use super::formula::Formula;
use super::values::Value;
use super::variables::{Fact, HALF, Interval, Meaning, Scope, WORD, Why};
use super::walk::{Assumed, Walk};

/// Steps of the solver for the question whether a number is negative.
const FEW_STEPS: u64 = 3_000;

/// Coefficients from here on make a hash, and no index: it is meant to wrap around.
const HASH: i128 = 1 << 16;

fn number(value: i128) -> Polynomial {
    Polynomial::constant(value)
}

/// The number with a sign that has these bits.
pub(super) fn from_bits(bits: u32) -> i128 {
    i128::from(bits.cast_signed())
}

impl Walk<'_> {
    /// Something that nothing is known of but its type.
    pub(super) fn open(&mut self, why: Why, site: Option<Site>, scope: Scope) -> Value {
        let unknown = self.variables.fresh(Meaning::Open(why, site), scope, (Some(-HALF), Some(WORD - 1)));
        Value::Number(Polynomial::unknown(unknown))
    }

    /// True where a polynomial is at least a number whatever its unknowns are, here.
    pub(super) fn is_at_least(&mut self, of: &Polynomial, least: i128) -> bool {
        if self.variables.interval(of).0.is_some_and(|low| low >= least) {
            return true;
        }
        if self.questions == 0 {
            return false;
        }
        self.questions -= 1;
        let mut system = system(self.variables.about(std::slice::from_ref(of), &self.state.path));
        system.all.push(Constraint::less(of, &number(least)));
        system.solve(&mut FEW_STEPS.clone()) == Solution::None
    }

    /// The number that takes part in an operation without signs.
    pub(super) fn unsigned(&mut self, of: Polynomial) -> Polynomial {
        let of = self.without_wraps(of);
        if let Some(value) = of.as_constant() {
            return number(value.rem_euclid(WORD));
        }
        if self.is_at_least(&of, 0) {
            return of;
        }
        self.wrapped(&of, 1, 0)
    }

    /// The number that takes part in an operation with signs.
    pub(super) fn signed(&mut self, of: Polynomial) -> Polynomial {
        let of = self.without_wraps(of);
        if let Some(value) = of.as_constant() {
            return number((value + HALF).rem_euclid(WORD) - HALF);
        }
        if self.variables.interval(&of).1.is_some_and(|high| high < HALF) {
            return of;
        }
        if of.unknowns().any(|unknown| self.variables.get(unknown).wide) {
            return self.wrapped(&of, -1, -HALF);
        }
        self.assumed.insert(Assumed::Fits);
        of
    }

    /// `of + 2^32 sign` or `of`, whichever lies between `least` and 2^32 more.
    fn wrapped(&mut self, of: &Polynomial, sign: i128, least: i128) -> Polynomial {
        let (wraps, new) = self.variables.derived("wrap", &[of, &number(sign)], (Some(0), Some(1)));
        let found = of.plus_times(&Polynomial::unknown(wraps), WORD * sign);
        if new {
            let range = [Constraint::at_most(&number(least), &found), Constraint::less(&found, &number(least + WORD))];
            let own = self.variables.get_mut(wraps);
            own.facts.extend(range.map(Fact::Is));
            own.wide = true;
        }
        found
    }

    /// Leaves out multiples of 2^32, which no 32 bits show.
    fn without_wraps(&self, of: Polynomial) -> Polynomial {
        let wraps: Vec<(Unknown, i128)> = of
            .terms()
            .filter_map(|(product, count)| match product[..] {
                [unknown] if count % WORD == 0 => Some((unknown, count)),
                _ => None,
            })
            .collect();
        wraps.into_iter().fold(of, |of, (unknown, count)| of.plus_times(&Polynomial::unknown(unknown), -count))
    }

    /// What a sum or product gives, which is assumed to fit.
    fn fits(&mut self, of: Polynomial, signed: bool, site: Site) -> Polynomial {
        let of = self.without_wraps(of);
        // A constant close to 2^32 is a negative number.
        let constant = of.constant_part();
        let of = if (HALF..WORD).contains(&constant) { of.offset(-WORD) } else { of };
        if of.as_constant().is_none() {
            if of.terms().any(|(product, count)| !product.is_empty() && count.abs() >= HASH) {
                return self.opened(Why::Operation, site, &[&of]);
            }
            let (low, high) = self.variables.interval(&of);
            let (least, most) = if signed { (-HALF, HALF) } else { (0, WORD) };
            if !(low.is_some_and(|low| low >= least || !signed) && high.is_some_and(|high| high < most)) {
                self.assumed.insert(Assumed::Fits);
            }
        }
        if signed { self.signed(of) } else { self.unsigned(of) }
    }

    /// Something that nothing is known of, for those for whom these are the same.
    fn opened(&mut self, why: Why, site: Site, of: &[&Polynomial]) -> Polynomial {
        let scope = of.iter().map(|own| self.variables.scope(own)).max().unwrap_or(Scope::Invocation);
        let rounds = of.iter().flat_map(|own| self.variables.rounds(own)).collect();
        let unknown = self.variables.fresh(Meaning::Open(why, Some(site)), scope, (Some(-HALF), Some(WORD - 1)));
        self.variables.get_mut(unknown).rounds = rounds;
        Polynomial::unknown(unknown)
    }

    /// The quotient by a positive number, rounded down.
    pub(super) fn quotient(&mut self, of: &Polynomial, by: &Polynomial) -> Option<Polynomial> {
        if let (Some(a), Some(b)) = (of.as_constant(), by.as_constant()) {
            return Some(number(a.div_euclid(b)));
        }
        if by.as_constant() == Some(1) {
            return Some(of.clone());
        }
        let (low, high) = self.variables.interval(of);
        let ends = by.as_constant().map_or((low.filter(|low| *low >= 0).map(|_| 0), high), |by| {
            (low.map(|low| low.div_euclid(by)), high.map(|high| high.div_euclid(by)))
        });
        if by.as_constant().is_none() {
            return self.parts(of, by, ends).map(|(quotient, _)| quotient);
        }
        let (quotient, new) = self.variables.derived("/", &[of, by], ends);
        let found = Polynomial::unknown(quotient);
        if new {
            let rest = of.minus(&found.product(by)?);
            let facts = [Constraint::at_most(&number(0), &rest), Constraint::less(&rest, by)];
            self.variables.get_mut(quotient).facts.extend(facts.map(Fact::Is));
        }
        Some(found)
    }

    /// The quotient by a number that is not known, and what remains.
    fn parts(&mut self, of: &Polynomial, by: &Polynomial, ends: Interval) -> Option<(Polynomial, Polynomial)> {
        let (quotient, new) = self.variables.derived("/", &[of, by], ends);
        let (rest, _) = self.variables.derived("%", &[of, by], (Some(0), None));
        let found = (Polynomial::unknown(quotient), Polynomial::unknown(rest));
        let whole = found.0.product(by)?.plus(&found.1);
        if new {
            let is = Fact::Is(Constraint::equal(of, &whole));
            let facts = [Constraint::less(&found.1, by), Constraint::at_most(&number(1), by)].map(Fact::Is);
            self.variables.get_mut(quotient).facts.push(is.clone());
            self.variables.get_mut(quotient).facts.extend(facts.clone());
            self.variables.get_mut(rest).facts.push(is);
            self.variables.get_mut(rest).facts.extend(facts);
        }
        Some(found)
    }

    /// What remains of a number behind its quotient.
    fn remainder(&mut self, of: &Polynomial, by: &Polynomial) -> Option<Polynomial> {
        let quotient = self.quotient(of, by)?;
        if by.as_constant().is_some() {
            return Some(of.minus(&quotient.product(by)?));
        }
        self.parts(of, by, (Some(0), None)).map(|(_, rest)| rest)
    }

    /// A bit of a number.
    fn bit(&mut self, of: &Polynomial, bit: u32) -> Option<Polynomial> {
        let low = self.quotient(of, &number(1 << bit))?;
        let high = self.quotient(of, &number(2 << bit))?;
        Some(low.plus_times(&high, -2))
    }

    pub(super) fn word1(&mut self, op: Word1, a: Reg, site: Site) -> Value {
        match op {
            Word1::LogicalNot => Value::Truth(self.truth(a).not()),
            Word1::Not => {
                if let Some(Value::Truth(own)) = self.state.env.get(&a) {
                    return Value::Truth(own.clone().not());
                }
                let of = self.number(a);
                let of = self.signed(of);
                Value::Number(of.times(-1).offset(-1))
            }
            Word1::Negate => {
                let of = self.number(a);
                let of = self.signed(of);
                Value::Number(of.times(-1))
            }
            Word1::Abs => {
                let of = self.number(a);
                let of = self.signed(of);
                let negative = of.times(-1);
                self.larger(&of, &negative)
            }
            _ => {
                let of = self.number(a);
                Value::Number(self.opened(Why::Operation, site, &[&of]))
            }
        }
    }

    /// The larger of two numbers.
    fn larger(&mut self, a: &Polynomial, b: &Polynomial) -> Value {
        self.chosen(a, b, false)
    }

    /// The smaller or the larger of two numbers.
    fn chosen(&mut self, a: &Polynomial, b: &Polynomial, smaller: bool) -> Value {
        let (first, second) = (self.variables.interval(a), self.variables.interval(b));
        let below = |low: (Option<i128>, Option<i128>), high: (Option<i128>, Option<i128>)| {
            low.1.zip(high.0).is_some_and(|(low, high)| low <= high)
        };
        if below(first, second) {
            return Value::Number(if smaller { a.clone() } else { b.clone() });
        }
        if below(second, first) {
            return Value::Number(if smaller { b.clone() } else { a.clone() });
        }
        let pick = |a: Option<i128>, b: Option<i128>| match (a, b, smaller) {
            (Some(a), Some(b), true) => Some(a.min(b)),
            (Some(a), Some(b), false) => Some(a.max(b)),
            _ => None,
        };
        let interval = (pick(first.0, second.0), pick(first.1, second.1));
        let (unknown, new) = self.variables.derived(if smaller { "min" } else { "max" }, &[a, b], interval);
        if new {
            let x = Polynomial::unknown(unknown);
            let order = |own: &Polynomial, other: &Polynomial| {
                if smaller { Constraint::at_most(own, other) } else { Constraint::at_most(other, own) }
            };
            let parts = vec![vec![Constraint::equal(&x, a), order(a, b)], vec![Constraint::equal(&x, b), order(b, a)]];
            let sides = [order(&x, a), order(&x, b)].map(Fact::Is);
            let own = self.variables.get_mut(unknown);
            own.facts.extend(sides);
            own.facts.extend(Fact::of(parts));
        }
        Value::Number(Polynomial::unknown(unknown))
    }

    pub(super) fn word2(&mut self, op: Word2, a: Reg, b: Reg, site: Site) -> Value {
        use Word2 as W;
        if matches!(op, W::And | W::Or | W::Xor | W::Equal | W::NotEqual) && self.is_truth(a) && self.is_truth(b) {
            let (a, b) = (self.truth(a), self.truth(b));
            let differ = |a: Formula, b: Formula| a.clone().and(b.clone().not()).or(a.not().and(b));
            return Value::Truth(match op {
                W::And => a.and(b),
                W::Or => a.or(b),
                W::Equal => differ(a, b).not(),
                _ => differ(a, b),
            });
        }
        let (a, b) = (self.number(a), self.number(b));
        match op {
            W::AddSigned | W::AddUnsigned => Value::Number(self.fits(a.plus(&b), op == W::AddSigned, site)),
            W::SubtractSigned | W::SubtractUnsigned => {
                Value::Number(self.fits(a.minus(&b), op == W::SubtractSigned, site))
            }
            W::MultiplySigned | W::MultiplyUnsigned => {
                let signed = op == W::MultiplySigned;
                let (a, b) =
                    if signed { (self.signed(a), self.signed(b)) } else { (self.unsigned(a), self.unsigned(b)) };
                Value::Number(match a.product(&b) {
                    Some(all) => self.fits(all, signed, site),
                    None => self.opened(Why::Operation, site, &[&a, &b]),
                })
            }
            W::DivideSigned | W::DivideUnsigned | W::RemainderSigned | W::RemainderUnsigned => {
                let signed = matches!(op, W::DivideSigned | W::RemainderSigned);
                let remainder = matches!(op, W::RemainderSigned | W::RemainderUnsigned);
                self.divided(a, b, signed, remainder, site)
            }
            W::And | W::Or | W::Xor => self.bits(op, &a, &b, site),
            W::ShiftLeft => match b.as_constant() {
                Some(by @ 0..32) => Value::Number(self.fits(a.times(1 << by), false, site)),
                _ => Value::Number(self.opened(Why::Operation, site, &[&a, &b])),
            },
            W::ShiftRightSigned | W::ShiftRightUnsigned => match b.as_constant() {
                Some(by @ 0..32) => {
                    let of = if op == W::ShiftRightSigned { self.signed(a) } else { self.unsigned(a) };
                    let found = self.quotient(&of, &number(1 << by));
                    Value::Number(found.unwrap_or_else(|| self.opened(Why::Operation, site, &[&of])))
                }
                _ => Value::Number(self.opened(Why::Operation, site, &[&a, &b])),
            },
            W::Equal | W::NotEqual => {
                // The same bits may have been read with a sign and without one.
                let mixed = |of: &Polynomial| of.as_constant().is_some_and(|value| value < 0);
                let (a, b) = if mixed(&a) || mixed(&b) { (self.unsigned(a), self.unsigned(b)) } else { (a, b) };
                let equal = Formula::equal(&a, &b);
                Value::Truth(if op == W::Equal { equal } else { equal.not() })
            }
            W::LessSigned | W::LessEqualSigned => {
                let (a, b) = (self.signed(a), self.signed(b));
                let a = if op == W::LessSigned { a.offset(1) } else { a };
                Value::Truth(Formula::at_most(&a, &b))
            }
            W::LessUnsigned | W::LessEqualUnsigned => {
                let (a, b) = (self.unsigned(a), self.unsigned(b));
                let a = if op == W::LessUnsigned { a.offset(1) } else { a };
                Value::Truth(Formula::at_most(&a, &b))
            }
            W::MinSigned | W::MaxSigned => {
                let (a, b) = (self.signed(a), self.signed(b));
                self.chosen(&a, &b, op == W::MinSigned)
            }
            W::MinUnsigned | W::MaxUnsigned => {
                let (a, b) = (self.unsigned(a), self.unsigned(b));
                self.chosen(&a, &b, op == W::MinUnsigned)
            }
            W::Index => Value::Number(self.opened(Why::Element, site, &[&a])),
        }
    }

    fn divided(&mut self, a: Polynomial, b: Polynomial, signed: bool, remainder: bool, site: Site) -> Value {
        let (a, b) = if signed { (self.signed(a), self.signed(b)) } else { (self.unsigned(a), self.unsigned(b)) };
        let positive = match b.as_constant() {
            Some(by) => by > 0,
            None => {
                // What a division by 0 gives is another question.
                self.assumed.insert(Assumed::Divisor);
                self.is_at_least(&b, 0)
            }
        };
        if !positive || (signed && !self.is_at_least(&a, 0)) {
            return Value::Number(self.opened(Why::Operation, site, &[&a, &b]));
        }
        let found = if remainder { self.remainder(&a, &b) } else { self.quotient(&a, &b) };
        Value::Number(found.unwrap_or_else(|| self.opened(Why::Operation, site, &[&a, &b])))
    }

    /// Masks and single bits; two numbers of which one has zeros where the other has bits.
    fn bits(&mut self, op: Word2, a: &Polynomial, b: &Polynomial, site: Site) -> Value {
        let (of, mask) = match (a.as_constant(), b.as_constant()) {
            (Some(a), Some(b)) => {
                let (a, b) = (a.rem_euclid(WORD), b.rem_euclid(WORD));
                let found = match op {
                    Word2::And => a & b,
                    Word2::Or => a | b,
                    _ => a ^ b,
                };
                return Value::Number(number(if found >= HALF { found - WORD } else { found }));
            }
            (Some(mask), None) => (b, mask),
            (None, Some(mask)) => (a, mask),
            (None, None) => {
                if op != Word2::And
                    && let Some(sum) = self.disjoint(a, b).or_else(|| self.disjoint(b, a))
                {
                    return Value::Number(sum);
                }
                return Value::Number(self.opened(Why::Operation, site, &[a, b]));
            }
        };
        let bits = mask.rem_euclid(WORD);
        let found = match op {
            Word2::And if bits == 0 => Some(number(0)),
            Word2::Or | Word2::Xor if bits == 0 => Some(of.clone()),
            // A run of ones from below, and one from above.
            Word2::And if (bits + 1) & bits == 0 => {
                self.quotient(of, &number(bits + 1)).map(|whole| of.plus_times(&whole, -(bits + 1)))
            }
            Word2::And if (WORD - bits) & (WORD - bits - 1) == 0 => {
                self.quotient(of, &number(WORD - bits)).map(|whole| whole.times(WORD - bits))
            }
            _ if bits & (bits - 1) == 0 && bits < HALF => {
                let at = bits.trailing_zeros();
                self.bit(of, at).map(|bit| match op {
                    Word2::And => bit.times(bits),
                    Word2::Or => of.plus_times(&bit, -bits).offset(bits),
                    _ => of.plus_times(&bit, -2 * bits).offset(bits),
                })
            }
            _ => None,
        };
        if let Some(found) = found {
            return Value::Number(found);
        }
        let open = self.opened(Why::Operation, site, &[of]);
        if op == Word2::And
            && bits < HALF
            && let Some(unknown) = open.unknowns().next()
        {
            let own = self.variables.get_mut(unknown);
            (own.low, own.high, own.wide) = (Some(0), Some(bits), false);
        }
        Value::Number(open)
    }

    /// The sum, where all that one number adds is a multiple of more than the other one may be.
    fn disjoint(&self, high: &Polynomial, low: &Polynomial) -> Option<Polynomial> {
        let (least, most) = self.variables.interval(low);
        let most = most.filter(|_| least.is_some_and(|least| least >= 0))?;
        let room = high.terms().map(|(_, count)| 1_i128 << count.trailing_zeros().min(40)).min()?;
        let positive = self.variables.interval(high).0.is_some_and(|low| low >= 0);
        (positive && most < room).then(|| high.plus(low))
    }
}

/// Facts as a system.
pub(super) fn system(facts: impl IntoIterator<Item = Fact>) -> System {
    let mut system = System::default();
    for fact in facts {
        match fact {
            Fact::Is(one) => system.all.push(one),
            Fact::OneOf(parts) => system.one_of.push((*parts).clone()),
        }
    }
    system
}
