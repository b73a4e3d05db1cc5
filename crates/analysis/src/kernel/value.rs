//! Integers as the invocations of a work group have them: a number for each invocation, plus multiples of what is not known.

use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::rc::Rc;

use syntax::ast::BinaryOp;
use syntax::types::ScalarType;

/// A value that is not known.
pub type Term = usize;

/// What is known of a value that is not.
#[derive(Clone, Copy, Debug, Default)]
pub struct Origin {
    /// The same for all invocations of the work group.
    pub uniform: bool,
    /// It follows from data: what it is, no other part of the kernel restricts.
    pub data: bool,
}

/// An integer or a truth value: the sum of `lanes` (one number for all invocations, or one for each) and the terms.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Number {
    /// Factors of terms, none of them 0, by term.
    pub terms: Vec<(Term, i64)>,
    /// The part that is known.
    pub lanes: Rc<[i64]>,
}

impl Number {
    /// The same number everywhere.
    pub fn constant(value: i64) -> Self {
        Self { terms: Vec::new(), lanes: Rc::from([value]) }
    }

    /// A number for each invocation.
    pub fn of_lanes(lanes: Vec<i64>) -> Self {
        Self { terms: Vec::new(), lanes: lanes.into() }
    }

    /// Something that is not known.
    pub fn unknown(term: Term) -> Self {
        Self { terms: vec![(term, 1)], lanes: Rc::from([0]) }
    }

    /// The part that is known, of one invocation.
    pub fn lane(&self, lane: usize) -> i64 {
        self.lanes.get(lane).or(self.lanes.first()).copied().unwrap_or(0)
    }

    /// True where nothing is left open.
    pub fn is_known(&self) -> bool {
        self.terms.is_empty()
    }

    /// The one number that all invocations have.
    pub fn single(&self) -> Option<i64> {
        let first = *self.lanes.first()?;
        (self.is_known() && self.lanes.iter().all(|l| *l == first)).then_some(first)
    }

    /// The truth that a condition decides about, and whether the condition is true with it.
    pub fn atom(&self) -> Option<(Term, bool)> {
        match (self.terms.as_slice(), &*self.lanes) {
            ([(term, 1)], [0]) => Some((*term, true)),
            ([(term, -1)], [1]) => Some((*term, false)),
            _ => None,
        }
    }

    fn hashed(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.hash(&mut hasher);
        hasher.finish()
    }

    fn zip(&self, other: &Self, combine: impl Fn(i64, i64) -> i64) -> Rc<[i64]> {
        let count = self.lanes.len().max(other.lanes.len());
        (0..count).map(|l| combine(self.lane(l), other.lane(l))).collect()
    }

    fn plus(&self, other: &Self, factor: i64) -> Self {
        let mut terms: Vec<(Term, i64)> = self.terms.clone();
        for (term, count) in &other.terms {
            let count = count.wrapping_mul(factor);
            match terms.binary_search_by_key(term, |t| t.0) {
                Ok(at) => terms[at].1 = terms[at].1.wrapping_add(count),
                Err(at) => terms.insert(at, (*term, count)),
            }
        }
        terms.retain(|t| t.1 != 0);
        Self { terms, lanes: self.zip(other, |a, b| a.wrapping_add(b.wrapping_mul(factor))) }
    }

    /// One minus the number: the opposite of a truth value.
    pub fn negated(&self) -> Self {
        Self::constant(1).plus(self, -1)
    }
}

/// All terms of a walk.
#[derive(Default)]
pub struct Terms {
    origins: Vec<Origin>,
    /// Terms by what they are computed from: the same operation on the same values is the same value.
    made: HashMap<(String, u64, u64), Term>,
}

impl Terms {
    /// Something new that is not known.
    pub fn fresh(&mut self, origin: Origin) -> Number {
        self.origins.push(origin);
        Number::unknown(self.origins.len() - 1)
    }

    /// What goes by a name and never changes.
    pub fn named(&mut self, name: &str, origin: Origin) -> Number {
        self.made_of(name, (0, 0), origin)
    }

    fn made_of(&mut self, what: &str, of: (u64, u64), origin: Origin) -> Number {
        let next = self.origins.len();
        let term = *self.made.entry((what.to_owned(), of.0, of.1)).or_insert(next);
        if term == next {
            self.origins.push(origin);
        }
        Number::unknown(term)
    }

    /// What is known of a term.
    pub fn origin(&self, term: Term) -> Origin {
        self.origins.get(term).copied().unwrap_or_default()
    }

    /// What is known of a number: it is uniform where all of it is, and follows from data where any of it does.
    pub fn origin_of(&self, number: &Number) -> Origin {
        let same = number.lanes.iter().all(|l| Some(l) == number.lanes.first());
        let all = number.terms.iter().map(|t| self.origin(t.0));
        all.fold(Origin { uniform: same, data: false }, |sum, o| Origin {
            uniform: sum.uniform && o.uniform,
            data: sum.data || o.data,
        })
    }

    /// What comes of two values: uniform where both are.
    pub fn both(&self, a: &Number, b: &Number) -> Origin {
        let (a, b) = (self.origin_of(a), self.origin_of(b));
        Origin { uniform: a.uniform && b.uniform, data: a.data || b.data }
    }

    /// An operator on two values of a type.
    pub fn binary(&mut self, op: BinaryOp, a: &Number, b: &Number, ty: Option<ScalarType>) -> Number {
        use BinaryOp as O;
        match op {
            O::Greater => return self.binary(O::Less, b, a, ty),
            O::GreaterEqual => return self.binary(O::Less, a, b, ty).negated(),
            O::LessEqual => return self.binary(O::Less, b, a, ty).negated(),
            O::NotEqual => return self.binary(O::Equal, a, b, ty).negated(),
            _ => {}
        }
        let known = a.is_known() && b.is_known();
        match (op, a.single(), b.single()) {
            (O::Add, ..) => return wrapped(a.plus(b, 1), ty),
            (O::Sub, ..) => return wrapped(a.plus(b, -1), ty),
            (O::Mul, Some(factor), _) if !known => return Number::constant(0).plus(b, factor),
            (O::Mul, _, Some(factor)) if !known => return Number::constant(0).plus(a, factor),
            (O::And, Some(0), _) | (O::And, _, Some(0)) => return Number::constant(0),
            (O::Or, Some(1), _) | (O::Or, _, Some(1)) => return Number::constant(1),
            (O::And, Some(1), _) | (O::Or, Some(0), _) => return b.clone(),
            (O::And, _, Some(1)) | (O::Or, _, Some(0)) => return a.clone(),
            _ => {}
        }
        if known && let Some(lanes) = computed(op, a, b) {
            return wrapped(Number { terms: Vec::new(), lanes }, ty);
        }
        let difference = a.plus(b, -1);
        if matches!(op, O::Less | O::Equal) && difference.is_known() {
            let truth = |d: i64| i64::from(if op == O::Less { d < 0 } else { d == 0 });
            return Number::of_lanes(difference.lanes.iter().map(|d| truth(*d)).collect());
        }
        let mut origin = self.both(a, b);
        // Two numbers that are the same distance apart everywhere compare alike: `i + first < i + end`.
        if matches!(op, O::Less | O::Equal) {
            origin.uniform |= self.origin_of(&difference).uniform;
        }
        self.made_of(op.text(), (a.hashed(), b.hashed()), origin)
    }

    /// `a` where the mask is set, `b` elsewhere.
    pub fn select(&mut self, mask: &[u8], a: &Number, b: &Number) -> Number {
        if mask.iter().all(|m| *m != 0) || a == b {
            return a.clone();
        }
        if a.terms == b.terms {
            let lanes = mask.iter().enumerate().map(|(l, m)| if *m != 0 { a.lane(l) } else { b.lane(l) });
            return Number { terms: a.terms.clone(), lanes: lanes.collect() };
        }
        let data = self.both(a, b).data;
        self.fresh(Origin { uniform: false, data })
    }
}

/// An operator on known numbers; none where it has no result, or is not modelled.
fn computed(op: BinaryOp, a: &Number, b: &Number) -> Option<Rc<[i64]>> {
    let divisor = b.lanes.iter().all(|d| *d != 0);
    let shift = b.lanes.iter().all(|s| (0..32).contains(s));
    Some(match op {
        BinaryOp::Mul => a.zip(b, i64::wrapping_mul),
        BinaryOp::Div if divisor => a.zip(b, i64::wrapping_div),
        BinaryOp::Rem if divisor => a.zip(b, i64::wrapping_rem),
        BinaryOp::Shl if shift => a.zip(b, |x, s| x.wrapping_shl(u32::try_from(s).unwrap_or(0))),
        BinaryOp::Shr if shift => a.zip(b, |x, s| x.wrapping_shr(u32::try_from(s).unwrap_or(0))),
        BinaryOp::Less => a.zip(b, |x, y| i64::from(x < y)),
        BinaryOp::Equal => a.zip(b, |x, y| i64::from(x == y)),
        BinaryOp::BitAnd | BinaryOp::And => a.zip(b, |x, y| x & y),
        BinaryOp::BitOr | BinaryOp::Or => a.zip(b, |x, y| x | y),
        BinaryOp::BitXor | BinaryOp::Xor => a.zip(b, |x, y| x ^ y),
        _ => return None,
    })
}

/// A number in 32 bits.
pub fn wrapped(number: Number, ty: Option<ScalarType>) -> Number {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "what 32 bits keep of a number")]
    let wrap = |v: &i64| match ty {
        Some(ScalarType::Uint) => i64::from(*v as u32),
        Some(ScalarType::Int) => i64::from(*v as i32),
        _ => *v,
    };
    match number.is_known() {
        true => Number { lanes: number.lanes.iter().map(wrap).collect(), ..number },
        false => number,
    }
}

/// A value of a variable: components of a vector, or one number; of what has no integers, one number that is not known.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// One number.
    One(Number),
    /// The components of a vector.
    Vector(Vec<Number>),
}

impl Value {
    /// The number, or the first component.
    pub fn number(&self) -> Option<&Number> {
        match self {
            Self::One(number) => Some(number),
            Self::Vector(all) => all.first(),
        }
    }

    /// Its numbers.
    pub fn numbers(&self) -> &[Number] {
        match self {
            Self::One(number) => std::slice::from_ref(number),
            Self::Vector(all) => all,
        }
    }
}
