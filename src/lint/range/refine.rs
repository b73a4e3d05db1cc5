//! What conditions say about what they compare.

use crate::glsl::ast::{BinaryOp, ExprId, ExprKind, UnaryOp};
use crate::glsl::types::ScalarType;

use super::eval::Machine;
use super::key;
use super::value::{Evidence, Range, Sources};

impl Machine<'_> {
    /// Goes on where `condition` has the value `truth`.
    pub fn assume(&mut self, condition: ExprId, truth: bool) {
        let sources = self.look(condition).sources();
        self.narrow(condition, truth);
        self.state.path = self.state.path.and(sources);
    }

    fn narrow(&mut self, condition: ExprId, truth: bool) {
        let shader = self.shader;
        match &shader.expr(condition).kind {
            ExprKind::Paren(inner) => self.narrow(*inner, truth),
            ExprKind::Unary { op: UnaryOp::Not, op_span: _, operand } => self.narrow(*operand, !truth),
            ExprKind::Binary { op, op_span: _, left, right } => match (op, truth) {
                (BinaryOp::And, true) | (BinaryOp::Or, false) => {
                    self.narrow(*left, truth);
                    self.narrow(*right, truth);
                }
                (BinaryOp::Less, true) | (BinaryOp::GreaterEqual, false) => self.below(*left, *right, true, truth),
                (BinaryOp::LessEqual, true) | (BinaryOp::Greater, false) => self.below(*left, *right, false, truth),
                (BinaryOp::Greater, true) | (BinaryOp::LessEqual, false) => self.below(*right, *left, true, truth),
                (BinaryOp::GreaterEqual, true) | (BinaryOp::Less, false) => self.below(*right, *left, false, truth),
                (BinaryOp::Equal, true) | (BinaryOp::NotEqual, false) => self.equal(*left, *right),
                (BinaryOp::NotEqual, true) | (BinaryOp::Equal, false) => {
                    self.unequal(*left, *right);
                    self.unequal(*right, *left);
                }
                _ => {}
            },
            _ => {}
        }
    }

    /// `low < high` holds, or `low <= high`; or, when it is the opposite that is false, one is NaN.
    fn below(&mut self, low: ExprId, high: ExprId, strictly: bool, holds: bool) {
        let (Some(a), Some(b)) = (self.range(low), self.range(high)) else { return };
        let integer = self.is_integer(low) && self.is_integer(high);
        let nan = !holds;
        if b.hi < a.hi || (strictly && b.hi == a.hi) {
            let hi = if strictly { before(b.hi, integer) } else { b.hi };
            self.learn(low, Range { hi, hi_by: Evidence::Bound, nan: a.nan && nan, ..a });
        } else {
            self.learn(low, Range { nan: a.nan && nan, ..a });
        }
        if a.lo > b.lo || (strictly && a.lo == b.lo) {
            let lo = if strictly { -before(-a.lo, integer) } else { a.lo };
            self.learn(high, Range { lo, lo_by: Evidence::Bound, nan: b.nan && nan, ..b });
        } else {
            self.learn(high, Range { nan: b.nan && nan, ..b });
        }
        self.difference(low, high, strictly);
    }

    /// What a comparison of two expressions says about their difference.
    fn difference(&mut self, low: ExprId, high: ExprId, strictly: bool) {
        let (Some(l), Some(h)) = (key::of(self.shader, low), key::of(self.shader, high)) else { return };
        let mut positive = Range::of(0.0, f64::INFINITY, Evidence::Bound, Sources::ALL).or_nan();
        positive.nonzero = strictly;
        let negative = Range { lo: f64::NEG_INFINITY, hi: 0.0, ..positive };
        self.state.facts.insert(key::of_binary(BinaryOp::Sub, &h, &l), positive);
        self.state.facts.insert(key::of_binary(BinaryOp::Sub, &l, &h), negative);
    }

    fn equal(&mut self, left: ExprId, right: ExprId) {
        let (Some(a), Some(b)) = (self.range(left), self.range(right)) else { return };
        let (lo, hi) = (a.lo.max(b.lo), a.hi.min(b.hi));
        if lo <= hi {
            let both = Range { lo, hi, nan: false, nonzero: a.nonzero || b.nonzero, ..a }.vague();
            self.learn(left, both);
            self.learn(right, both);
        }
    }

    fn unequal(&mut self, left: ExprId, right: ExprId) {
        if let (Some(a), Some(b)) = (self.range(left), self.range(right))
            && b.single() == Some(0.0)
        {
            self.learn(left, Range { nonzero: true, ..a });
        }
    }

    /// The range of a scalar.
    fn range(&mut self, id: ExprId) -> Option<Range> {
        let value = self.look(id);
        match value.parts.as_slice() {
            [only] => Some(*only),
            _ => None,
        }
    }

    fn is_integer(&self, id: ExprId) -> bool {
        self.shader.type_of(id).scalar().is_some_and(ScalarType::is_integer)
    }

    /// Keeps the range of an expression until a variable in it is written. What is narrowed by the
    /// condition itself is as well known as before: only what else depends on the condition is not.
    fn learn(&mut self, id: ExprId, range: Range) {
        if self.shader.fold(id).is_some() || range.lo > range.hi {
            return;
        }
        if let Some(key) = key::of(self.shader, id) {
            let sources = Sources::of(120 + id.index() % 8);
            self.state.facts.insert(key, Range { sources, ..range });
        }
    }
}

/// The next number below.
fn before(x: f64, integer: bool) -> f64 {
    if integer {
        return x - 1.0;
    }
    #[expect(clippy::cast_possible_truncation, reason = "the next binary32 number is what is asked for")]
    let near = x as f32;
    let next = f64::from(near.next_down());
    // A number between two of binary32 is its own bound.
    if f64::from(near) == x { next } else { x }
}
